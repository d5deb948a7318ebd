//! The cache of the data bus. It holds lines of the flash; an erasure does not tell it, a programmed word does (RM0383,
//! 3.5.2 and 3.6.4).

/// Bytes of a line.
const LINE: usize = 16;
/// Lines that the chip has.
const LINES: usize = 8;

/// The cache. Constants of the program evict lines on silicon, which is not modelled: here a line stays for longer.
pub struct Cache {
    lines: Vec<(usize, [u8; LINE])>,
    /// How many lines it has. With more than the chip's none is evicted by chance.
    pub size: usize,
    /// Reads that gave what the flash no longer holds.
    pub stale_reads: u32,
}

impl Default for Cache {
    fn default() -> Self {
        Self { lines: Vec::new(), size: LINES, stale_reads: 0 }
    }
}

impl Cache {
    /// Forgets all lines.
    pub fn flush(&mut self) {
        self.lines.clear();
    }

    /// Reads a word by way of the cache.
    pub fn read(&mut self, place: usize, content: &[u8]) -> u32 {
        let begin = place / LINE * LINE;
        let fresh: [u8; LINE] = std::array::from_fn(|i| content.get(begin + i).copied().unwrap_or(0xFF));
        let cached = self.lines.iter().position(|(at, _)| *at == begin).map(|i| self.lines.remove(i));
        let line = cached.unwrap_or((begin, fresh));
        self.stale_reads += u32::from(line.1 != fresh);
        if self.lines.len() >= self.size {
            self.lines.remove(0);
        }
        self.lines.push(line);
        let at = place - begin;
        u32::from_le_bytes([line.1[at], line.1[at + 1], line.1[at + 2], line.1[at + 3]])
    }

    /// Takes over bytes that have been programmed.
    pub fn program(&mut self, place: usize, bytes: &[u8]) {
        for (at, line) in &mut self.lines {
            for (i, byte) in bytes.iter().enumerate() {
                if let Some(cached) = (place + i).checked_sub(*at).and_then(|i| line.get_mut(i)) {
                    *cached &= byte;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stays_until_it_is_flushed_or_evicted() {
        let mut cache = Cache::default();
        let mut content = vec![0xFF; 1024];
        assert_eq!(cache.read(4, &content), u32::MAX);
        cache.program(4, &[0x34, 0x12]);
        content[4..6].copy_from_slice(&[0x34, 0x12]);
        assert_eq!(cache.read(4, &content), 0xFFFF_1234);
        content.fill(0xFF); // erased
        assert_eq!(cache.read(4, &content), 0xFFFF_1234);
        assert_eq!(cache.stale_reads, 1);
        cache.flush();
        assert_eq!(cache.read(4, &content), u32::MAX);
        content.fill(0);
        (1..=8).for_each(|i| assert_eq!(cache.read(i * LINE, &content), 0));
        assert_eq!(cache.read(4, &content), 0, "the ninth line has evicted it");
    }
}
