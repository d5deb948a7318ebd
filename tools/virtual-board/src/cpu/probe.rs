//! What a debug probe does to the core: reads and writes memory, moves the program counter, stops at addresses.

use unicorn_engine::RegisterARM;
use unicorn_engine::unicorn_const::HookType;

use super::hooks::Emulator;
use super::machine::Stop;
use super::{Cpu, State, told};

impl Cpu {
    /// Reads a word of memory, as a debug probe does.
    ///
    /// # Errors
    /// There is no memory.
    pub fn word(&self, address: u32) -> anyhow::Result<u32> {
        let mut bytes = [0; 4];
        self.emulator.mem_read(address.into(), &mut bytes).map_err(told)?;
        Ok(u32::from_le_bytes(bytes))
    }

    /// Reads memory, as a debug probe does.
    ///
    /// # Errors
    /// There is no memory.
    pub fn bytes(&self, address: u32, size: usize) -> anyhow::Result<Vec<u8>> {
        self.emulator.mem_read_as_vec(address.into(), size).map_err(told)
    }

    /// Writes a word of memory, as a debug probe does.
    ///
    /// # Errors
    /// There is no memory.
    pub fn set_word(&mut self, address: u32, value: u32) -> anyhow::Result<()> {
        self.emulator.mem_write(address.into(), &value.to_le_bytes()).map_err(told)
    }

    /// Writes memory, as a debug probe does.
    ///
    /// # Errors
    /// There is no memory.
    pub fn set_bytes(&mut self, address: u32, bytes: &[u8]) -> anyhow::Result<()> {
        self.emulator.mem_write(address.into(), bytes).map_err(told)
    }

    /// From now on, bits of a word of memory stay as they are, whatever is written.
    ///
    /// # Errors
    /// There is no memory.
    pub fn stick(&mut self, address: u32, bits: u32) -> anyhow::Result<()> {
        let stuck = self.word(address)? & bits;
        let word = u64::from(address & !3);
        let put_back = move |emulator: &mut Emulator<'_>, _, _, _, _| {
            let mut bytes = [0; 4];
            let read = emulator.mem_read(word, &mut bytes);
            let value = u32::from_le_bytes(bytes) & !bits | stuck;
            read.and_then(|()| emulator.mem_write(word, &value.to_le_bytes())).is_ok()
        };
        self.emulator.add_mem_hook(HookType::MEM_READ, word, word + 3, put_back).map_err(told)?;
        self.emulator.ctl_flush_tb().map_err(told) // translated code knows only the hooks of its time
    }

    /// The next instruction to be executed.
    pub fn pc(&self) -> u32 {
        self.pc
    }

    /// Has the core go on somewhere else, awake: a program counter gone wild.
    pub fn jump(&mut self, address: u32) {
        self.pc = address & !1;
        self.state = State::Running;
        self.machine().passing = None;
    }

    /// As [`Self::jump`], with the first argument of a function.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn call(&mut self, address: u32, argument: u32) -> anyhow::Result<()> {
        self.jump(address);
        self.set_register(RegisterARM::R0, argument)
    }

    /// Answers a semihosting call, and lets the program go on.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn answer(&mut self, result: u32) -> anyhow::Result<()> {
        self.jump(self.pc + 2);
        self.set_register(RegisterARM::R0, result)
    }

    /// Where the function that is about to begin will return to.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn link(&self) -> anyhow::Result<u32> {
        self.register(RegisterARM::LR)
    }

    /// Stops each run just before the instruction at this address, until it is no longer watched.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn watch(&mut self, address: u32) -> anyhow::Result<()> {
        let address = address & !1;
        let at = u64::from(address);
        let hook = self.emulator.add_code_hook(at, at, |emulator, address, _| {
            let machine = emulator.get_data_mut();
            if machine.passing.take() != Some(address as u32) {
                machine.stop.get_or_insert(Stop::Watched(address as u32));
                let _ = emulator.emu_stop();
            }
        });
        self.watched.push((address, hook.map_err(told)?));
        self.forget_translation(address)
    }

    /// Stops watching all addresses.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn unwatch(&mut self) -> anyhow::Result<()> {
        for (address, hook) in std::mem::take(&mut self.watched) {
            self.emulator.remove_hook(hook).map_err(told)?;
            self.forget_translation(address)?;
        }
        self.machine().passing = None;
        Ok(())
    }

    /// Code that has been translated knows only the hooks of that time. Forgetting all of it takes a second, so it is
    /// the block that begins here: where a function begins.
    fn forget_translation(&mut self, address: u32) -> anyhow::Result<()> {
        let address = u64::from(address);
        self.emulator.ctl_remove_cache(address, address + 2).map_err(told)
    }
}
