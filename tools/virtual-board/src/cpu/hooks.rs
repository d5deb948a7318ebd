//! How the emulator is set up: its memory, the peripherals, and what is looked at before each block of instructions.

use unicorn_engine::unicorn_const::{HookType, MemType, Permission, uc_error};
use unicorn_engine::{RegisterARM, Unicorn};

use super::machine::{Machine, Stop};
use super::{RAM, RAM_SIZE};
use crate::chip::PERIPHERALS;
use crate::image::{FLASH, FLASH_SIZE, Image};

/// The emulator.
pub(super) type Emulator<'a> = Unicorn<'a, Machine>;

/// Values that return from an exception when they are jumped to.
pub(super) const EXCEPTION_RETURN: u32 = 0xFFFF_FF00;
/// The page of them, which must exist.
const RETURN_PAGE: u64 = 0xFFFF_F000;

/// Instructions that sleep, and the one that wakes.
const WFE: u16 = 0xBF20;
const WFI: u16 = 0xBF30;
const SEV: u16 = 0xBF40;

/// Gives the emulator its memory, peripherals and hooks.
pub(super) fn set_up(emulator: &mut Emulator<'static>, image: &Image) -> Result<(), uc_error> {
    map_memory(emulator, image)?;
    map_peripherals(emulator)?;
    add_hooks(emulator, image)
}

fn map_memory(emulator: &mut Emulator<'_>, image: &Image) -> Result<(), uc_error> {
    let code = Permission::READ | Permission::EXEC;
    for base in [0, FLASH] {
        emulator.mem_map(base.into(), FLASH_SIZE, code)?;
        emulator.mem_write(base.into(), &image.flash)?;
    }
    emulator.mem_map(RAM.into(), RAM_SIZE, Permission::ALL)?;
    emulator.mem_map(RETURN_PAGE, 0x1000, code)?;
    emulator.mem_write(RETURN_PAGE, &[0x00, 0xBF].repeat(0x800))
}

fn map_peripherals(emulator: &mut Emulator<'static>) -> Result<(), uc_error> {
    for (base, size) in PERIPHERALS {
        let read = move |emulator: &mut Emulator<'_>, offset: u64, size: usize| -> u64 {
            let machine = emulator.get_data_mut();
            let address = base + offset as u32;
            match machine.chip.read(address, size, machine.now) {
                Ok(value) => {
                    if machine.chip.scs.nvic.any() {
                        machine.deadline = machine.now;
                    }
                    value.into()
                }
                Err(why) => {
                    machine.refuse(format!("read of {address:#010x}: {why}"));
                    0
                }
            }
        };
        let write = move |emulator: &mut Emulator<'_>, offset: u64, size: usize, value: u64| {
            let machine = emulator.get_data_mut();
            let address = base + offset as u32;
            if let Err(why) = machine.chip.write(address, size, value as u32, machine.now) {
                machine.refuse(format!("write of {value:#x} to {address:#010x}: {why}"));
            }
            machine.reschedule();
        };
        emulator.mmio_map(base.into(), size as usize, Some(read), Some(write))?;
    }
    Ok(())
}

fn add_hooks(emulator: &mut Emulator<'static>, image: &Image) -> Result<(), uc_error> {
    emulator.add_block_hook(0, u64::from(u32::MAX), block)?;
    emulator.add_intr_hook(|emulator, number| {
        emulator.get_data_mut().stop.get_or_insert(Stop::Trap(number));
        let _ = emulator.emu_stop();
    })?;
    let absent = HookType::MEM_UNMAPPED | HookType::MEM_PROT;
    emulator.add_mem_hook(absent, 0, u64::from(u32::MAX), |emulator, kind, address, _, _| {
        let fetch = matches!(kind, MemType::FETCH_UNMAPPED | MemType::FETCH_PROT);
        emulator.get_data_mut().faulted.get_or_insert((address as u32, fetch));
        false
    })?;
    for (i, half) in image.flash.chunks_exact(2).enumerate() {
        let at = u64::from(FLASH) + 2 * i as u64;
        match u16::from_le_bytes([half[0], half[1]]) {
            SEV => {
                emulator.add_code_hook(at, at, |emulator, _, _| emulator.get_data_mut().event = true)?;
            }
            code @ (WFE | WFI) => {
                let for_event = code == WFE;
                emulator.add_code_hook(at, at, move |emulator, address, _| {
                    let stop = Stop::Sleep { at: address as u32, for_event };
                    emulator.get_data_mut().stop.get_or_insert(stop);
                    let _ = emulator.emu_stop();
                })?;
            }
            _ => {}
        }
    }
    Ok(())
}

/// Before each block of instructions.
fn block(emulator: &mut Emulator<'_>, address: u64, size: u32) {
    let address = address as u32;
    let machine = emulator.get_data_mut();
    if address >= EXCEPTION_RETURN {
        machine.stop.get_or_insert(Stop::Return(address | 1));
        let _ = emulator.emu_stop();
        return;
    }
    if machine.now >= machine.deadline {
        machine.chip.advance(machine.now);
        let until = machine.until;
        machine.deadline = machine.chip.next_event(machine.now).min(until);
        let leave = machine.must_stop() || machine.now >= until;
        if leave || interrupted(emulator) {
            emulator.get_data_mut().stop.get_or_insert(Stop::Before(address));
            let _ = emulator.emu_stop();
            return;
        }
    }
    let machine = emulator.get_data_mut();
    if size == 2 && machine.last == address {
        // One instruction that jumps to itself: nothing but the chip can change anything.
        machine.now = machine.chip.next_event(machine.now).min(machine.until).max(machine.now);
    }
    machine.last = address;
    let count = machine.count(address, size);
    machine.instructions += count;
    machine.now += count * machine.cycle;
}

/// Whether an exception is to be taken now. One that is masked is looked for again at each block.
fn interrupted(emulator: &mut Emulator<'_>) -> bool {
    if !emulator.get_data().chip.scs.nvic.any() {
        return false;
    }
    let primask = emulator.reg_read(RegisterARM::PRIMASK).unwrap_or(0) & 1 == 1;
    let basepri = emulator.reg_read(RegisterARM::BASEPRI).unwrap_or(0) as u8;
    let machine = emulator.get_data_mut();
    let due = machine.chip.scs.nvic.takeable(primask, basepri).is_some();
    if !due {
        machine.deadline = machine.now;
    }
    due
}
