//! From the listing of a disassembler to functions: how far each lowers the stack pointer, whom it calls, which addresses it
//! holds.

use std::collections::{BTreeMap, BTreeSet, HashMap};

/// What the listing says of a function.
#[derive(Debug, Default)]
pub(super) struct Function {
    /// Its name, demangled.
    pub(super) name: String,
    /// Bytes by which all of its instructions together lower the stack pointer: no less than its frame.
    pub(super) frame: u32,
    /// Addresses that it calls or jumps to.
    pub(super) calls: BTreeSet<u32>,
    /// Numbers that it holds, some of which are addresses of functions.
    pub(super) words: Vec<u32>,
}

/// The functions of a listing, by address.
pub(super) fn functions(listing: &str) -> Result<BTreeMap<u32, Function>, String> {
    let mut functions = BTreeMap::<u32, Function>::new();
    let mut halves = HashMap::new();
    let mut current = None;
    for line in listing.lines() {
        if let Some((address, name)) = header(line) {
            halves.clear();
            current = Some(functions.entry(address).or_default());
            current.iter_mut().for_each(|function| function.name = name.to_owned());
            continue;
        }
        let Some((instruction, function)) = line.split_once(":\t").zip(current.as_mut()) else { continue };
        if is_padding(instruction) {
            continue;
        }
        let (operation, operands) = instruction.1.split_once('\t').unwrap_or((instruction.1, ""));
        function.frame += lowered(operation.trim(), operands).ok_or(format!(
            "{}: `{operation} {operands}` changes the stack pointer in a way that is not understood",
            function.name
        ))?;
        function.calls.extend(destination(operation, operands));
        function.words.extend(constant(operation, operands, &mut halves));
    }
    Ok(functions)
}

/// What the linker fills gaps between functions with, 0xD4D4, reads as a branch by 84 bytes backwards.
fn is_padding((address, instruction): (&str, &str)) -> bool {
    let here = u32::from_str_radix(address.trim(), 16).ok();
    let target = instruction.split_once("bmi.n\t").and_then(|(_, operands)| destination("bmi.n", operands));
    here.zip(target).is_some_and(|(here, target)| target.wrapping_add(84) == here)
}

fn header(line: &str) -> Option<(u32, &str)> {
    let (address, name) = line.strip_suffix(">:")?.split_once(" <")?;
    Some((u32::from_str_radix(address, 16).ok()?, name))
}

/// Bytes by which an instruction lowers the stack pointer; `None` if nobody can tell.
fn lowered(operation: &str, operands: &str) -> Option<u32> {
    let (name, first) = (operation.split('.').next()?, operands.split(',').next()?.trim());
    match name {
        "push" => registers(operands, 4),
        "vpush" => registers(operands, if operands.contains("{d") { 8 } else { 4 }),
        "stmdb" if first == "sp!" => registers(operands.split_once(',')?.1, 4),
        "sub" | "subw" if first == "sp" => number(operands),
        "str" | "strd" if operands.contains("[sp, #-") && operands.contains("]!") => {
            operands.split_once("[sp, #-")?.1.split(']').next()?.parse().ok()
        }
        // The fault handler, which moves to a stack of its own.
        "mov" if first == "sp" => None,
        _ => Some(0),
    }
}

/// Bytes of a list of registers such as `{r4, r5, lr}` or `{d8-d11}`.
fn registers(list: &str, each: u32) -> Option<u32> {
    let inner = list.trim().strip_prefix('{')?.split('}').next()?;
    let count = |item: &str| match item.trim().split_once('-') {
        None => Some(1),
        Some((from, to)) => Some(to[1..].parse::<u32>().ok()? + 1 - from[1..].parse::<u32>().ok()?),
    };
    inner.split(',').map(count).sum::<Option<u32>>().map(|n| n * each)
}

/// The constant of `sp, #48` or `sp, sp, #512`; a register there is a frame whose size nobody knows.
fn number(operands: &str) -> Option<u32> {
    operands.split_once('#')?.1.split_whitespace().next()?.parse().ok()
}

/// Where a branch or a call goes that says so itself.
fn destination(operation: &str, operands: &str) -> Option<u32> {
    let target = operands.split(" <").next()?.split(',').next_back()?.trim();
    let branches = operation.starts_with('b') || operation.starts_with("cb");
    (branches && operands.contains(" <")).then(|| u32::from_str_radix(target, 16).ok())?
}

/// A word of a literal pool, or the two halves of an immediate once both are known.
fn constant(operation: &str, operands: &str, halves: &mut HashMap<String, u32>) -> Option<u32> {
    let register = operands.split(',').next()?.trim();
    match operation {
        ".word" => u32::from_str_radix(operands.trim().strip_prefix("0x")?.get(..8)?, 16).ok(),
        "movw" => {
            halves.insert(register.to_owned(), number(operands)?);
            None
        }
        "movt" => Some(halves.get(register)? | number(operands)? << 16),
        _ => None,
    }
}

/// All words of a dump of sections.
pub(super) fn words(dump: &str) -> Vec<u32> {
    let bytes = |line: &str| -> Option<Vec<u32>> {
        let line = line.strip_prefix(' ')?;
        let columns = line.split_once(' ')?.1.get(..35)?;
        let word = |text: &str| u32::from_str_radix(text, 16).ok().map(u32::swap_bytes);
        Some(columns.split_whitespace().filter(|text| text.len() == 8).filter_map(word).collect())
    };
    dump.lines().filter_map(bytes).flatten().collect()
}

/// The value of a symbol.
pub(super) fn symbol(table: &str, name: &str) -> Option<u32> {
    let line = table.lines().find(|line| line.split_whitespace().next_back() == Some(name))?;
    u32::from_str_radix(line.split_whitespace().next()?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LISTING: &str = "\
08000400 <outer>:
 8000400:\tpush\t{r4, r5, r7, lr}
 8000402:\tvpush\t{d8-d9}
 8000406:\tsub.w\tsp, sp, #512\t@ 0x200
 800040a:\tstr.w\tfp, [sp, #-4]!
 800040e:\tmovw\tr0, #1025\t@ 0x401
 8000412:\tmovt\tr0, #2048\t@ 0x800
 8000416:\tbl\t8000500 <inner>
 800041a:\tcbz\tr0, 8000420 <outer+0x20>
 8000420:\t.word\t0x08000501

08000500 <inner>:
 8000500:\tstmdb\tsp!, {r4, r5, r6, r7, r8, lr}
 8000504:\tb.w\t8000400 <outer>
 8000508:\tbmi.n\t80004b4 <outer+0xb4>
";

    #[test]
    fn frames_calls_and_addresses() {
        let found = functions(LISTING).unwrap();
        let outer = &found[&0x0800_0400];
        assert_eq!((outer.name.as_str(), outer.frame), ("outer", 16 + 16 + 512 + 4));
        assert_eq!(outer.calls, BTreeSet::from([0x0800_0420, 0x0800_0500]));
        assert_eq!(outer.words, [0x0800_0401, 0x0800_0501]);
        assert_eq!(found[&0x0800_0500].frame, 24);
        assert_eq!(found[&0x0800_0500].calls, BTreeSet::from([0x0800_0400]));
    }

    #[test]
    fn a_frame_of_unknown_size_is_refused() {
        let error = functions("08000400 <f>:\n 8000400:\tsub.w\tsp, sp, r4\n").unwrap_err();
        assert!(error.contains("sub.w sp, sp, r4"), "{error}");
    }

    #[test]
    fn words_of_a_dump_are_little_endian() {
        let dump =
            "Contents of section .rodata:\n 8016000 01040008 2e2f6162 63                   ........./abc\n";
        assert_eq!(words(dump), [0x0800_0401, 0x6261_2f2e]);
    }
}
