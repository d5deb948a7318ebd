//! The log over the serial port: the lines of [`log_line`](crate::log_line) and those for people, each a [`frame`], beside what the console
//! says. A line that finds no room is dropped whole and counted, and the next that finds some is told after the number of those
//! dropped; nobody ever waits.

pub mod codes;
pub mod frame;

use core::fmt::{self, Display, Write};

use heapless::Deque;

use crate::log_line::LogLine;
use crate::log_line::tick::LONGEST;

/// Bytes that wait to be sent: ten ticks, or what a start has to tell where tables are full and ten faults taught.
pub const ROOM: usize = 4096;

/// Bits a second of the port, and bits of a byte on it.
pub const BAUD: u32 = 115_200;
const BYTE: u32 = 10;

/// The longest record of a tick takes 27 ms on the wire: half of the shortest sample time that a board keeps, 50 ms.
const _: () = assert!((LONGEST + frame::AROUND) as u32 * BYTE * 1000 / BAUD < 50);

/// What waits to be sent.
#[derive(Clone, Debug, Default)]
pub struct Stream {
    on: bool,
    waiting: Deque<u8, ROOM>,
    untold: u32,
    dropped: u32,
}

impl Stream {
    /// Begins, or ends with the frames that wait.
    pub fn switch(&mut self, on: bool) {
        self.on = on;
    }

    /// A line on its way, while it is on; before it, how many had no room.
    pub fn push(&mut self, line: &impl Display) {
        if !self.on {
            return;
        }
        let before = self.waiting.len();
        if (self.untold == 0 || self.add(&LogLine::Dropped { count: self.untold })) && self.add(line) {
            self.untold = 0;
        } else {
            self.waiting.truncate(before);
            self.untold = self.untold.saturating_add(1);
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// Lines that found no room.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Takes what is to be sent next: no more than the rest of a frame.
    pub fn take(&mut self, out: &mut [u8]) -> usize {
        let mut taken = 0;
        for place in out {
            let Some(byte) = self.waiting.pop_front() else { break };
            *place = byte;
            taken += 1;
            if byte == frame::END {
                break;
            }
        }
        taken
    }

    fn add(&mut self, line: &impl Display) -> bool {
        frame::write(line, &mut Back(&mut self.waiting)).is_ok()
    }
}

/// Writes at the end.
struct Back<'a>(&'a mut Deque<u8, ROOM>);

impl Write for Back<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().try_for_each(|byte| self.0.push_back(byte)).map_err(|_| fmt::Error)
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;
    use fdi_core::diagnosis::signature::Signature;
    use fdi_core::likelihood::taught::{EFFECTS, Response};
    use fdi_core::name::Name;

    use super::*;

    fn on() -> Stream {
        Stream { on: true, ..Stream::default() }
    }

    /// Takes all lines, in pieces of 7 bytes.
    fn lines(stream: &mut Stream) -> Vec<String> {
        let (mut lines, mut line, mut piece) = (vec![], vec![], [0; 7]);
        loop {
            let n = stream.take(&mut piece);
            if n == 0 {
                assert_eq!(line, [], "a frame is cut");
                return lines;
            }
            line.extend(&piece[..n]);
            if line.last() == Some(&frame::END) {
                assert_eq!(line[0], frame::START);
                lines.push(frame::read(&line[1..]).expect("whole").to_owned());
                line.clear();
            }
        }
    }

    #[test]
    fn nothing_waits_until_it_is_on() {
        let mut stream = Stream::default();
        stream.push(&"a");
        assert_eq!(lines(&mut stream), [""; 0]);
        stream.switch(true);
        stream.push(&"b");
        stream.switch(false);
        stream.push(&"c");
        assert_eq!(lines(&mut stream), ["b"]);
        assert_eq!(stream.dropped(), 0);
    }

    /// Full tables and ten faults, as `order .. settings` is told with, behind two ticks that wait.
    #[test]
    fn all_that_can_be_taught_finds_room_at_once() {
        let mut config = Config::default();
        let name: Name = "twelve-bytes".parse().expect("a name");
        let pattern = "+1 -1 +1 -1 +1".parse().expect("a pattern");
        for rows in [&mut config.diagnosis.detection, &mut config.diagnosis.isolation] {
            while rows.push(Signature { number: 100, pattern, name }).is_ok() {}
        }
        while config.likelihood.taught.push(Response { name, effects: [-1234; EFFECTS] }).is_ok() {}
        let mut stream = on();
        (0..2).for_each(|_| stream.push(&"x".repeat(LONGEST)));
        crate::log_line::settings(&config, |line| stream.push(&line));
        assert_eq!(stream.dropped(), 0);
        assert_eq!(lines(&mut stream).len(), 2 + 11 + 10 + 10);
    }

    #[test]
    fn what_finds_no_room_is_dropped_whole_counted_and_told() {
        let mut stream = on();
        let line = "x".repeat(ROOM / 5); // and what is around it
        (0..7).for_each(|_| stream.push(&line));
        assert_eq!(stream.dropped(), 3);
        assert_eq!(lines(&mut stream).len(), 4);
        stream.push(&"next");
        assert_eq!(lines(&mut stream), ["dropped 3", "next"]);
        stream.push(&"again");
        assert_eq!(lines(&mut stream), ["again"], "told once");
    }

    #[test]
    fn a_short_line_does_not_overtake_what_was_dropped() {
        let mut stream = on();
        stream.push(&"x".repeat(ROOM - frame::AROUND - 4));
        stream.push(&"long");
        stream.push(&"");
        assert_eq!(stream.dropped(), 2);
        lines(&mut stream);
        stream.push(&"end");
        assert_eq!(lines(&mut stream), ["dropped 2", "end"]);
    }
}
