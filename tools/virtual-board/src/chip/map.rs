//! The memory map: which peripheral answers at which address, and which bit gives it its clock.

use crate::flash;
use crate::registers::{Register, register};

/// A peripheral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Block {
    Tim1,
    Tim2,
    Tim5,
    Usart2,
    Adc1,
    Checksum,
    Gpio(usize),
    Clocks,
    Power,
    Flash,
    FlashMemory,
    Watchdog,
    Exti,
    Syscfg,
    Scs,
    Cycles,
    Debug,
}

/// Where a peripheral is, how large, and which bit of which enable register (from RCC_AHB1ENR) gives it its clock.
pub(super) struct Place {
    pub(super) base: u32,
    pub(super) size: u32,
    pub(super) block: Block,
    pub(super) clock: Option<(u32, u32)>,
}

const fn place(base: u32, size: u32, block: Block, clock: Option<(u32, u32)>) -> Place {
    Place { base, size, block, clock }
}

const AHB1: u32 = 0x00;
const APB1: u32 = 0x10;
pub(super) const APB2: u32 = 0x14;

/// The memory map.
pub(super) static MAP: [Place; 21] = [
    place(0x4000_0000, 0x400, Block::Tim2, Some((APB1, 0))),
    place(0x4000_0C00, 0x400, Block::Tim5, Some((APB1, 3))),
    place(0x4000_3000, 0x400, Block::Watchdog, None),
    place(0x4000_4400, 0x400, Block::Usart2, Some((APB1, 17))),
    place(0x4000_7000, 0x400, Block::Power, Some((APB1, 28))),
    place(0x4001_0000, 0x400, Block::Tim1, Some((APB2, 0))),
    place(0x4001_2000, 0x400, Block::Adc1, Some((APB2, 8))),
    place(0x4001_3800, 0x400, Block::Syscfg, Some((APB2, 14))),
    place(0x4001_3C00, 0x400, Block::Exti, None),
    place(0x4002_0000, 0x400, Block::Gpio(0), Some((AHB1, 0))),
    place(0x4002_0400, 0x400, Block::Gpio(1), Some((AHB1, 1))),
    place(0x4002_0800, 0x400, Block::Gpio(2), Some((AHB1, 2))),
    place(0x4002_0C00, 0x400, Block::Gpio(3), Some((AHB1, 3))),
    place(0x4002_1000, 0x400, Block::Gpio(4), Some((AHB1, 4))),
    place(0x4002_3000, 0x400, Block::Checksum, Some((AHB1, 12))),
    place(0x4002_3800, 0x400, Block::Clocks, None),
    place(0x4002_3C00, 0x400, Block::Flash, None),
    place(flash::BASE, 2 * flash::SECTOR as u32, Block::FlashMemory, None),
    place(0xE000_1000, 0x1000, Block::Cycles, None),
    place(0xE000_E000, 0x1000, Block::Scs, None),
    place(0xE004_2000, 0x400, Block::Debug, None),
];

/// Regions of peripherals and of nothing known: an access there that the map does not have fails the run, while
/// elsewhere it is a bus fault of the program.
pub const PERIPHERALS: [(u32, u32); 5] = [
    (0x1FFF_0000, 0x8000),
    (0x4000_0000, 0x8_0000),
    (0x5000_0000, 0x4_0000),
    (0xE000_0000, 0x10_0000),
    (flash::BASE, 2 * flash::SECTOR as u32),
];

pub(super) static DEBUG_TABLE: [Register; 4] = [
    register(0x00, "IDCODE", 0x1000_6431, 0),
    register(0x04, "CR", 0, 0xE7),
    register(0x08, "APB1_FZ", 0, 0x00E0_1C0F),
    register(0x0C, "APB2_FZ", 0, 0x0007_0001),
];
