//! The ST-LINK's virtual COM port: 115200 8N1, by interrupt through two ring buffers.

use embassy_stm32::Peri;
use embassy_stm32::usart::{BufferedUart, BufferedUartRx, BufferedUartTx, Config};
use firmware_logic::stream::BAUD;
use static_cell::ConstStaticCell;

use super::board::{ConsoleInterrupts, RxPin, TxPin, Usart};

/// Bytes that wait to be sent, at most.
pub(crate) const SENDING: usize = 256;

static TX: ConstStaticCell<[u8; SENDING]> = ConstStaticCell::new([0; SENDING]);
static RX: ConstStaticCell<[u8; 128]> = ConstStaticCell::new([0; 128]);

/// Opens the port; `None` if the HAL refuses the settings, which are constant.
pub(crate) fn open(
    usart: Peri<'static, Usart>,
    rx: Peri<'static, RxPin>,
    tx: Peri<'static, TxPin>,
) -> Option<(BufferedUartTx<'static>, BufferedUartRx<'static>)> {
    let mut config = Config::default();
    config.baudrate = BAUD;
    let port = BufferedUart::new(usart, rx, tx, TX.take(), RX.take(), ConsoleInterrupts, config).ok()?;
    Some(port.split())
}
