//! The ST-LINK's virtual COM port: USART2, 115200 8N1, by interrupt through two ring buffers.

use embassy_stm32::peripherals::USART2;
use embassy_stm32::usart::{BufferedInterruptHandler, BufferedUart, BufferedUartRx, BufferedUartTx, Config};
use embassy_stm32::{Peri, bind_interrupts, peripherals};
use static_cell::ConstStaticCell;

bind_interrupts!(struct Irqs {
    USART2 => BufferedInterruptHandler<peripherals::USART2>;
});

/// Bytes that wait to be sent, at most.
pub(crate) const SENDING: usize = 256;

static TX: ConstStaticCell<[u8; SENDING]> = ConstStaticCell::new([0; SENDING]);
static RX: ConstStaticCell<[u8; 128]> = ConstStaticCell::new([0; 128]);

/// Opens the port; `None` if the HAL refuses the settings, which are constant.
pub(crate) fn open(
    usart: Peri<'static, USART2>,
    rx: Peri<'static, peripherals::PA3>,
    tx: Peri<'static, peripherals::PA2>,
) -> Option<(BufferedUartTx<'static>, BufferedUartRx<'static>)> {
    let mut config = Config::default();
    config.baudrate = 115_200;
    let port = BufferedUart::new(usart, rx, tx, TX.take(), RX.take(), Irqs, config).ok()?;
    Some(port.split())
}
