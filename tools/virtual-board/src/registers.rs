//! Registers as data: a table says which exist, what they hold after reset and which of their bits are modelled.
//!
//! An access beside the table, or a one written to a bit that is not modelled, is an error and not a guess: the image
//! would do something on silicon that the board here knows nothing about.

/// Why an access failed the run.
pub type Refusal = String;

/// One register.
pub struct Register {
    /// Offset from the base of its peripheral.
    pub offset: u32,
    /// Name in the reference manual.
    pub name: &'static str,
    /// Content after reset.
    pub reset: u32,
    /// Bits that may be written as one.
    pub bits: u32,
}

/// A row of a table.
pub const fn register(offset: u32, name: &'static str, reset: u32, bits: u32) -> Register {
    Register { offset, name, reset, bits }
}

/// The registers of one peripheral, as plain memory.
pub struct File {
    table: &'static [Register],
    values: Vec<u32>,
}

impl File {
    /// All registers of the table, as after reset.
    pub fn new(table: &'static [Register]) -> Self {
        Self { table, values: table.iter().map(|r| r.reset).collect() }
    }

    /// Back to the state after reset.
    pub fn reset(&mut self) {
        *self = Self::new(self.table);
    }

    fn row(&self, offset: u32) -> Result<usize, Refusal> {
        let place = self.table.iter().position(|r| r.offset == offset);
        place.ok_or_else(|| "no such register in the model".into())
    }

    /// What a register holds.
    ///
    /// # Errors
    /// No such register.
    pub fn read(&self, offset: u32) -> Result<u32, Refusal> {
        Ok(self.values[self.row(offset)?])
    }

    /// Writes a register.
    ///
    /// # Errors
    /// No such register, or bits that are not modelled.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Refusal> {
        let row = self.row(offset)?;
        let Register { name, bits, .. } = self.table[row];
        let strange = value & !bits & !self.values[row];
        if strange != 0 {
            return Err(format!("{name}: bits {strange:#010x} are not modelled"));
        }
        self.values[row] = value;
        Ok(())
    }

    /// What a register that the table has holds; for models, which know their tables.
    pub fn get(&self, offset: u32) -> u32 {
        self.read(offset).unwrap_or_default()
    }

    /// Sets a register that the table has, whatever the bits.
    pub fn set(&mut self, offset: u32, value: u32) {
        if let Ok(row) = self.row(offset) {
            self.values[row] = value;
        }
    }
}

/// Bits `at..at + width` of `value`.
pub const fn field(value: u32, at: u32, width: u32) -> u32 {
    (value >> at) & ((1 << width) - 1)
}

/// Bit `at` of `value`.
pub const fn bit(value: u32, at: u32) -> bool {
    field(value, at, 1) == 1
}
