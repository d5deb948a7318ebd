//! Modelled cycles of a stretch of code on a Cortex-M4F, from its disassembly.
//!
//! The numbers are those of the Cortex-M4 Technical Reference Manual (r0p1), tables 3-1 and 7-1, for memory without
//! wait states. Where the manual gives a range, the model takes: branch refill 2 (of 1 to 3), integer division 12
//! (of 2 to 12), one cycle for an instruction skipped in an IT block. An integer load costs 1 behind another load or
//! store and 2 elsewhere; one of the FPU always 2. An arithmetic result of the FPU that the very next instruction
//! consumes costs 1 more. Nothing that follows overlaps with a division, which real code may. It is a model: no claim
//! about a chip, its flash or its bus.

/// Cycles to refill the pipeline after a branch that is taken.
pub(crate) const REFILL: u32 = 2;

/// One instruction, as a disassembler prints it.
struct Instruction<'a> {
    mnemonic: &'a str,
    operands: &'a str,
}

/// Cycles of instructions that are executed one after the other; branches at the end count as not taken.
pub(crate) fn of_block<'a>(instructions: impl Iterator<Item = (&'a str, &'a str)>) -> u32 {
    let mut cycles = 0;
    let mut before: Option<Instruction> = None;
    for (mnemonic, operands) in instructions {
        let now = Instruction { mnemonic, operands };
        cycles += now.cycles(before.as_ref());
        before = Some(now);
    }
    cycles
}

impl Instruction<'_> {
    fn cycles(&self, before: Option<&Instruction>) -> u32 {
        self.own_cycles(before) + u32::from(before.is_some_and(|b| b.stalls(self)))
    }

    fn own_cycles(&self, before: Option<&Instruction>) -> u32 {
        let is = |names: &[&str]| names.iter().any(|name| self.mnemonic.starts_with(name));
        let double = self.operands.starts_with('d');
        if is(&["push", "pop", "ldm", "stm", "vpush", "vpop", "vldm", "vstm"]) {
            1 + self.listed_registers()
        } else if is(&["ldrd", "strd", "ldrexd"]) || (double && is(&["vldr", "vstr"])) {
            3
        } else if is(&["vldr", "vstr"]) {
            2
        } else if is(&["ldr"]) {
            if before.is_some_and(Instruction::is_single_access) { 1 } else { 2 }
        } else if is(&["vdiv", "vsqrt"]) {
            14
        } else if is(&["vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms"]) {
            3
        } else if is(&["udiv", "sdiv"]) {
            12
        } else if is(&["tbb", "tbh"]) || (double && is(&["vmov"])) {
            2
        } else {
            1
        }
    }

    fn is_single_access(&self) -> bool {
        let m = self.mnemonic;
        (m.starts_with("ldr") || m.starts_with("str")) && !m.starts_with("ldrd") && !m.starts_with("strd")
    }

    /// Whether `next` has to wait for the result of this instruction.
    fn stalls(&self, next: &Instruction) -> bool {
        let arithmetic =
            ["vadd", "vsub", "vmul", "vnmul", "vdiv", "vsqrt", "vmla", "vmls", "vfma", "vfms", "vcvt"];
        let Some(result) = self.operands.split(',').next().map(str::trim) else { return false };
        arithmetic.iter().any(|name| self.mnemonic.starts_with(name)) && next.reads(result)
    }

    fn reads(&self, register: &str) -> bool {
        if !self.mnemonic.starts_with('v') {
            return false;
        }
        // The first operand is a result, except where it is stored or compared. As an addend it may come late.
        let all = ["vstr", "vcmp", "vpush", "vstm"].iter().any(|name| self.mnemonic.starts_with(name));
        let sources =
            if all { self.operands } else { self.operands.split_once(',').map_or("", |(_, rest)| rest) };
        sources.split([',', ' ', '{', '}', '[', ']']).any(|word| word == register)
    }

    /// Words that a list such as `{r4, r5, s16-s19, d8}` moves.
    fn listed_registers(&self) -> u32 {
        let list = self.operands.split_once('{').map_or("", |(_, list)| list.trim_end_matches('}'));
        list.split(',')
            .map(|entry| {
                let entry = entry.trim();
                if entry.starts_with('d') { 2 } else { 1 }
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycles(code: &str) -> u32 {
        of_block(code.lines().map(|line| line.trim().split_once(' ').unwrap_or((line.trim(), ""))))
    }

    #[test]
    fn each_class_costs_what_the_manual_says() {
        for (code, wanted) in [
            ("adds r0, r0, #1", 1),
            ("push {r4, r5, r7, lr}", 5),
            ("vpush {d8, d9}", 5),
            ("ldr r0, [r1]", 2),
            ("ldr r0, [r1]\nldr r2, [r3]\nstr r0, [r2]", 4),
            ("ldrd r0, r1, [r2]", 3),
            ("vldr s0, [r0]\nvldr s1, [r0, #4]", 4),
            ("vldr d0, [r0]", 3),
            ("vdiv.f32 s0, s1, s2", 14),
            ("vmul.f32 s0, s1, s2\nvadd.f32 s3, s4, s5", 2),
            ("vmul.f32 s0, s1, s2\nvadd.f32 s3, s0, s5", 3),
            ("vmul.f32 s0, s1, s2\nvstr s0, [r0]", 4),
            ("vmul.f32 s1, s1, s2\nvadd.f32 s3, s11, s5", 2),
            ("vmla.f32 s0, s1, s2\nvmla.f32 s0, s3, s4", 6),
            ("udiv r0, r1, r2", 12),
            ("bl #0x8000000", 1),
        ] {
            assert_eq!(cycles(code), wanted, "{code}");
        }
    }
}
