//! The keyboard while something heats: each key comes at once and is not shown, so that a stop key needs no Enter.

use std::io::{IsTerminal, Read};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use firmware_logic::console::line::is_stop_key;

/// Bytes that wait for a question; of what is typed while nothing is asked, more is lost.
const AHEAD: usize = 256;

/// A key that ends or holds a program on a terminal: Ctrl-Z and Ctrl-\. Whoever presses it wants it to stop.
fn is_end_key(byte: u8) -> bool {
    matches!(byte, 0x1A | 0x1C)
}

/// Whether standard input is a terminal whose keys are this program's.
pub(super) fn are_ours() -> bool {
    std::io::stdin().is_terminal() && mode::is_foreground()
}

/// What is typed, byte by byte; `None`: the input has ended. Where keys are ours a stop key calls `stop`, and so does a terminal that is
/// closed.
pub(super) fn listen(keys: bool, stop: impl Fn() + Send + 'static) -> Receiver<Option<u8>> {
    let (tell, told) = sync_channel(AHEAD);
    std::thread::spawn(move || {
        let mut bytes = [0; 64];
        loop {
            let read = std::io::stdin().read(&mut bytes);
            let came = bytes.get(..read.unwrap_or(0)).unwrap_or_default();
            if keys && (came.is_empty() || came.iter().any(|&byte| is_stop_key(byte) || is_end_key(byte))) {
                stop();
            } else if !came.iter().all(|&byte| pass_on(&tell, keys, byte)) {
                return;
            }
            if came.is_empty() {
                let _ = tell.send(None);
                return;
            }
        }
    });
    told
}

/// Whoever types ahead of any question must not keep a stop key waiting; a pipe can wait. `false`: nobody listens any more.
fn pass_on(tell: &SyncSender<Option<u8>>, keys: bool, byte: u8) -> bool {
    if keys {
        let _ = tell.try_send(Some(byte));
        return true;
    }
    tell.send(Some(byte)).is_ok()
}

pub(super) use mode::{Single, remember, restore};

#[cfg(unix)]
mod mode {
    use std::io::stdin;
    use std::sync::{Mutex, PoisonError};

    use nix::sys::termios::{
        InputFlags, LocalFlags, SetArg, SpecialCharacterIndices, Termios, tcgetattr, tcsetattr,
    };
    use nix::unistd::{getpgrp, tcgetpgrp};

    /// The terminal as it was.
    static BEFORE: Mutex<Option<Termios>> = Mutex::new(None);

    /// A program in the background must not read: it would be held, while the board heats on. A terminal that controls nobody is ours.
    pub(super) fn is_foreground() -> bool {
        tcgetpgrp(stdin()).map_or(true, |group| group == getpgrp())
    }

    /// Keeps the terminal's mode for [`restore`].
    pub(in super::super) fn remember() -> Option<Termios> {
        let before = tcgetattr(stdin()).ok()?;
        *BEFORE.lock().unwrap_or_else(PoisonError::into_inner) = Some(before.clone());
        Some(before)
    }

    /// Gives the terminal its mode back, if it was changed.
    pub(in super::super) fn restore() {
        if let Some(before) = BEFORE.lock().unwrap_or_else(PoisonError::into_inner).take() {
            let _ = tcsetattr(stdin(), SetArg::TCSANOW, &before);
        }
    }

    /// Keys come singly until this is dropped.
    pub(in super::super) struct Single;

    impl Single {
        /// Ctrl-C, Ctrl-Z, Ctrl-\ and Ctrl-S come as bytes, too: none of them may hold the program while the board heats.
        pub(in super::super) fn keys() -> Option<Self> {
            let mut mode = remember()?;
            mode.local_flags -= LocalFlags::ICANON | LocalFlags::ECHO | LocalFlags::ISIG;
            mode.input_flags -= InputFlags::IXON;
            let places = [(SpecialCharacterIndices::VMIN, 1), (SpecialCharacterIndices::VTIME, 0)];
            places.into_iter().for_each(|(place, value)| mode.control_chars[place as usize] = value);
            tcsetattr(stdin(), SetArg::TCSANOW, &mode).ok().map(|()| Self)
        }
    }

    impl Drop for Single {
        fn drop(&mut self) {
            restore();
        }
    }
}

/// Elsewhere keys come with Enter.
#[cfg(not(unix))]
mod mode {
    pub(super) fn is_foreground() -> bool {
        false
    }

    pub(in super::super) fn remember() {}

    pub(in super::super) fn restore() {}

    pub(in super::super) struct Single;

    impl Single {
        pub(in super::super) fn keys() -> Option<Self> {
            None
        }
    }
}
