//! The line console on the serial port.

use embassy_futures::select::{Either, select};
use embassy_stm32::usart::{BufferedUartRx, BufferedUartTx};
use embassy_time::Timer;
use embedded_io_async::{Read, Write};
use firmware_logic::checkin::Task;
use firmware_logic::console::{ANSWER, Console};
use static_cell::ConstStaticCell;

use crate::hardware::serial;
use crate::instrument::ConsoleBoard;
use crate::link::check_in;

/// An answer on its way to the terminal.
type Answer = heapless::String<ANSWER>;

static ANSWER_TEXT: ConstStaticCell<Answer> = ConstStaticCell::new(Answer::new());

/// Reads bytes, answers lines.
#[embassy_executor::task]
pub(crate) async fn console(
    mut tx: BufferedUartTx<'static>,
    mut rx: BufferedUartRx<'static>,
    mut board: ConsoleBoard,
) {
    let mut console = Console::default();
    let answer = ANSWER_TEXT.take();
    let mut bytes = [0; 16];
    loop {
        check_in(Task::Console);
        // A line error (noise, overrun) loses bytes; the line that lacks them is most likely no command.
        match select(rx.read(&mut bytes), Timer::after_millis(100)).await {
            Either::First(Ok(n)) => {
                for &byte in bytes.iter().take(n) {
                    console.push(byte, &mut board, answer).await;
                    print(&mut tx, answer).await;
                }
            }
            Either::First(Err(_)) => {}
            Either::Second(()) => board.settle().await,
        }
    }
}

/// Sends the answer, with the line ends that terminals want, and empties it.
async fn print(tx: &mut BufferedUartTx<'static>, answer: &mut Answer) {
    for line in answer.split_inclusive('\n') {
        check_in(Task::Console); // a whole `get` takes 0.3 s on the wire
        let (text, end) = line.strip_suffix('\n').map_or((line, ""), |text| (text, "\r\n"));
        send(tx, text).await;
        send(tx, end).await;
    }
    answer.clear();
}

/// Sends text. A piece is taken whole or, for want of room, not at all; the driver (embassy-stm32 0.6.0) then never wakes
/// the writer, who has to come back by itself.
async fn send(tx: &mut BufferedUartTx<'static>, text: &str) {
    for piece in text.as_bytes().chunks(serial::SENDING / 2) {
        while let Either::Second(()) = select(tx.write(piece), Timer::after_millis(5)).await {}
    }
}
