//! The line console on the serial port. Stop keys are looked for as the bytes come in, not when their line has its turn:
//! a long answer, or a command that waits for its tick, delays no stop. The stream shares the way out with the answers, a frame or a line at
//! a time.

use core::sync::atomic::Ordering;

use embassy_futures::join::join3;
use embassy_futures::select::{Either, select};
use embassy_stm32::usart::{BufferedUartRx, BufferedUartTx};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::mutex::Mutex;
use embassy_sync::pipe::Pipe;
use embassy_time::Timer;
use embedded_io_async::{Read, Write};
use firmware_logic::console::board::ConsoleBoard;
use firmware_logic::console::{ANSWER, Console, line};
use firmware_logic::stream::codes::Codes;
use firmware_logic::stream::frame::{self, Reader, Step};
use firmware_logic::task_watchdog::Task;
use heapless::spsc::Producer;
use static_cell::ConstStaticCell;

use crate::hardware::serial;
use crate::hardware::settings_flash::SettingsFlash;
use crate::link::{self, check_in};
use crate::shared::{Shared, stop};

/// The board, as the console reaches it.
type Reached = ConsoleBoard<&'static Shared, SettingsFlash>;

/// Longest frame that comes: codes, and no more.
const FRAME: usize = 80;

/// An answer on its way to the terminal.
type Answer = heapless::String<ANSWER>;

/// Bytes that wait for their turn. Those that find no room are lost, as on a line error: the line that lacks them is most
/// likely no command.
type Waiting = Pipe<NoopRawMutex, 256>;

/// The way out: whoever has it sends what must not be parted.
type Out = Mutex<NoopRawMutex, BufferedUartTx<'static>>;

static ANSWER_TEXT: ConstStaticCell<Answer> = ConstStaticCell::new(Answer::new());

/// Reads bytes, answers lines.
#[embassy_executor::task]
pub(crate) async fn console(
    tx: BufferedUartTx<'static>,
    rx: BufferedUartRx<'static>,
    shared: &'static Shared,
    board: Reached,
    mut codes: Producer<'static, Codes>,
) {
    let (waiting, out) = (Waiting::new(), Out::new(tx));
    join3(listen(rx, &waiting, &mut codes), answer(&out, &waiting, board), stream(&out, shared)).await;
}

/// Takes bytes in as they come, and stops at once where one is a stop key. The driver (embassy-stm32 0.6.0) wakes the reader when
/// the line falls idle, and misses that when it happens while it reads the byte before: a stop key would wait for the next
/// key. So the reader also comes by itself.
async fn listen(mut rx: BufferedUartRx<'static>, waiting: &Waiting, codes: &mut Producer<'static, Codes>) {
    let mut bytes = [0; 16];
    let mut frames = Reader::<FRAME>::default();
    loop {
        // A line error (noise, overrun) loses bytes.
        if let Either::First(Ok(n)) = select(rx.read(&mut bytes), Timer::after_millis(20)).await {
            let mut came = bytes.get(..n).unwrap_or_default();
            if let Some(key) = came.iter().rposition(|byte| line::is_stop_key(*byte)) {
                stop();
                // What was typed before a stop must not be carried out after it.
                waiting.clear();
                frames = Reader::default();
                came = came.get(key..).unwrap_or_default();
            }
            for &byte in came {
                match frames.push(byte) {
                    Step::Text(byte) => keep(waiting, byte),
                    // Codes that find no room are late: nothing has taken those before them.
                    Step::Line(line) => {
                        let _ = Codes::parse(line).map(|came| codes.enqueue(came));
                    }
                    Step::Broken | Step::Nothing => {}
                }
            }
        }
    }
}

/// Keeps a byte for its turn, if there is room.
fn keep(waiting: &Waiting, byte: u8) {
    let _ = waiting.try_write(&[byte]);
}

/// Answers the lines. Bytes are taken one by one, so that all others still wait where a stop clears them.
async fn answer(out: &Out, waiting: &Waiting, mut board: Reached) {
    let mut console = Console::default();
    let answer = ANSWER_TEXT.take();
    let mut byte = [0; 1];
    loop {
        check_in(Task::Console);
        match select(waiting.read(&mut byte), Timer::after_millis(100)).await {
            Either::First(_) => {
                let [byte] = byte;
                console.push(byte, &mut board, answer).await;
                print(out, answer).await;
            }
            Either::Second(()) => board.settle().await,
        }
        // Before what it has ended.
        if link::PRESSED.swap(false, Ordering::Relaxed) {
            console.pressed(answer);
        }
        console.follow(&board, answer);
        print(out, answer).await;
    }
}

/// Sends the answer, with the line ends that terminals want, and empties it.
async fn print(out: &Out, answer: &mut Answer) {
    for line in answer.split_inclusive('\n') {
        check_in(Task::Console); // a whole `get` takes 0.3 s on the wire
        let (text, end) = line.strip_suffix('\n').map_or((line, ""), |text| (text, "\r\n"));
        let mut tx = out.lock().await;
        send(&mut tx, text.as_bytes()).await;
        send(&mut tx, end.as_bytes()).await;
    }
    answer.clear();
}

/// Sends the frames of the stream.
async fn stream(out: &Out, shared: &Shared) {
    let mut bytes = [0; 64];
    loop {
        let mut n = shared.take_streamed(&mut bytes).await;
        let mut tx = out.lock().await;
        loop {
            let piece = bytes.get(..n).unwrap_or_default();
            send(&mut tx, piece).await;
            if piece.last() == Some(&frame::END) {
                break;
            }
            n = shared.take_streamed(&mut bytes).await;
        }
    }
}

/// Sends bytes. A piece is taken whole or, for want of room, not at all; the driver (embassy-stm32 0.6.0) then never wakes
/// the writer, who has to come back by itself.
async fn send(tx: &mut BufferedUartTx<'static>, bytes: &[u8]) {
    for piece in bytes.chunks(serial::SENDING / 2) {
        while let Either::Second(()) = select(tx.write(piece), Timer::after_millis(5)).await {}
    }
}
