//! Checks whether a function of the core in the linked image can reach a panic.
//!
//! `Pipeline::step` is inlined into the main loop, so all functions of the core are checked. Every
//! branch of the Thumb code in the final image is followed. Calls through pointers cannot be
//! followed; functions that contain some are named.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use crate::Result;

/// Prefix of the core's function names.
const CORE: &str = "floe_core::";
/// A function of the core that must be in the image.
const STEP: &str = "floe_core::pipeline::Pipeline::take";
/// Part of the name of every function on the way to the panic handler.
const PANIC: &str = "core::panicking::";

/// A function of the image.
struct Function {
    name: String,
    calls: BTreeSet<u32>,
    indirect: bool,
}

/// Result of the check, as a sentence.
///
/// # Errors
/// A path from a function of the core to a panic, or an image that cannot be checked.
pub fn check(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let functions = functions(&bytes)?;
    let with = |wanted: &dyn Fn(&str) -> bool| -> Vec<u32> {
        functions.iter().filter(|(_, f)| wanted(&f.name)).map(|(&at, _)| at).collect()
    };
    let steps = with(&|name| name.starts_with(CORE));
    let panics = with(&|name| name.contains(PANIC));
    if with(&|name| name == STEP).is_empty() || panics.is_empty() {
        return Err(format!("{STEP} or {PANIC} has no symbol: nothing could be checked"));
    }
    // The search must find a panic from other functions of the image.
    let all: Vec<u32> = functions.keys().copied().collect();
    let callers = all.iter().filter(|&&f| !panics.contains(&f)).count();
    let may: usize = all.iter().filter(|&&f| way(&functions, f, &panics).is_some()).count();
    if may <= panics.len() {
        return Err(format!("none of {callers} functions reaches a panic: the walk is broken"));
    }
    let (mut reached, mut indirect) = (BTreeSet::new(), BTreeSet::new());
    for &step in &steps {
        if let Some(way) = way(&functions, step, &panics) {
            return Err(format!("the core can panic: {}", way.join(" -> ")));
        }
        for at in reachable(&functions, step) {
            reached.insert(at);
            indirect.extend(functions.get(&at).filter(|f| f.indirect).map(|f| f.name.clone()));
        }
    }
    let blind = match indirect.len() {
        0 => "none of them calls through a pointer".to_string(),
        _ => format!(
            "through a pointer call {}",
            indirect.into_iter().collect::<Vec<_>>().join(", ")
        ),
    };
    Ok(format!(
        "the core's {} functions reach {} and no panic; {may} of {} functions of the image do; {blind}",
        steps.len(),
        reached.len(),
        functions.len()
    ))
}

fn reachable(functions: &BTreeMap<u32, Function>, from: u32) -> BTreeSet<u32> {
    let (mut seen, mut waiting) = (BTreeSet::new(), vec![from]);
    while let Some(at) = waiting.pop() {
        if seen.insert(at) {
            waiting.extend(functions.get(&at).into_iter().flat_map(|f| &f.calls));
        }
    }
    seen
}

/// Names on the shortest path to one of `goals`.
fn way(functions: &BTreeMap<u32, Function>, from: u32, goals: &[u32]) -> Option<Vec<String>> {
    let mut before = BTreeMap::from([(from, from)]);
    let mut waiting = std::collections::VecDeque::from([from]);
    while let Some(at) = waiting.pop_front() {
        if goals.contains(&at) {
            let mut names = Vec::new();
            let mut step = at;
            while let Some(function) = functions.get(&step) {
                names.push(function.name.clone());
                match before.get(&step) {
                    Some(&earlier) if earlier != step => step = earlier,
                    _ => break,
                }
            }
            names.reverse();
            return Some(names);
        }
        for &next in functions.get(&at).into_iter().flat_map(|f| &f.calls) {
            before.entry(next).or_insert_with(|| {
                waiting.push_back(next);
                at
            });
        }
    }
    None
}

/// All functions, with the functions that each branches to.
fn functions(bytes: &[u8]) -> Result<BTreeMap<u32, Function>> {
    let elf = object::File::parse(bytes).map_err(|e| e.to_string())?;
    let mut places: BTreeMap<u32, (u32, String)> = BTreeMap::new();
    let mut data: BTreeMap<u32, bool> = BTreeMap::new();
    for symbol in elf.symbols() {
        let (name, at) = (symbol.name().unwrap_or(""), symbol.address() as u32 & !1);
        if name.starts_with("$d") || name.starts_with("$t") {
            data.insert(at, name.starts_with("$d"));
        } else if symbol.kind() == SymbolKind::Text && symbol.size() > 0 {
            // The compilers differ: `<type>::function` or `type::function`.
            let name = format!("{:#}", rustc_demangle::demangle(name)).replace(['<', '>'], "");
            places.insert(at, (at + symbol.size() as u32, name));
        }
    }
    let mut text = BTreeMap::new();
    for section in elf.sections().filter(|s| s.kind() == SectionKind::Text) {
        let content = section.data().map_err(|e| e.to_string())?;
        text.insert(section.address() as u32, content);
    }
    let starts: BTreeMap<u32, u32> = places.iter().map(|(&at, (end, _))| (at, *end)).collect();
    let mut functions = BTreeMap::new();
    for (&at, (end, name)) in &places {
        let Some((base, content)) = text.range(..=at).next_back() else { continue };
        let body = content.get((at - base) as usize..(*end - base) as usize).unwrap_or_default();
        let (targets, indirect) = branches(body, at, |place| {
            data.range(..=place).next_back().is_some_and(|(_, &is_data)| is_data)
        });
        let owner = |target: u32| {
            let (start, end) = starts.range(..=target).next_back()?;
            (target < *end).then_some(*start)
        };
        let calls = targets.into_iter().filter_map(owner).filter(|start| start != &at).collect();
        functions.insert(at, Function { name: name.clone(), calls, indirect });
    }
    Ok(functions)
}

/// Targets of the branches in Thumb code, and whether some are indirect (ARM DDI 0403, A7.7: B, BL,
/// CBZ, BLX).
fn branches(body: &[u8], at: u32, is_data: impl Fn(u32) -> bool) -> (BTreeSet<u32>, bool) {
    let half = |i: usize| -> Option<u32> {
        Some(u32::from(u16::from_le_bytes(body.get(i..i + 2)?.try_into().ok()?)))
    };
    let (mut targets, mut indirect, mut i) = (BTreeSet::new(), false, 0);
    while let Some(first) = half(i) {
        let place = at + i as u32;
        i += 2;
        if is_data(place) {
            continue;
        }
        let offset = if first >> 11 < 0b11101 {
            // BLX and BX to a register other than the return address.
            indirect |= first & 0xFF87 == 0x4780;
            indirect |= first & 0xFF87 == 0x4700 && first & 0x78 != 0x70;
            short(first)
        } else {
            let Some(second) = half(i) else { break };
            i += 2;
            long(first, second)
        };
        targets.extend(offset.map(|offset| place.wrapping_add(4).wrapping_add_signed(offset)));
    }
    (targets, indirect)
}

/// Offset of a 16-bit branch.
fn short(code: u32) -> Option<i32> {
    match code >> 12 {
        0b1101 if code >> 8 & 0xF < 0xE => Some(signed(code << 1 & 0x1FE, 9)),
        0b1110 if code >> 11 == 0b11100 => Some(signed(code << 1 & 0xFFE, 12)),
        _ => None,
    }
}

/// Offset of a 32-bit branch.
fn long(first: u32, second: u32) -> Option<i32> {
    if first >> 11 != 0b11110 || second >> 15 == 0 {
        return None;
    }
    let sign = first >> 10 & 1;
    let (j1, j2) = (second >> 13 & 1, second >> 11 & 1);
    let low = (second & 0x7FF) << 1;
    if second & 0x1000 != 0 {
        // BL, or B without a condition.
        let (i1, i2) = (1 ^ j1 ^ sign, 1 ^ j2 ^ sign);
        let bits = sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | low;
        return Some(signed(bits, 25));
    }
    let condition = first >> 6 & 0xF;
    let bits = sign << 20 | j2 << 19 | j1 << 18 | (first & 0x3F) << 12 | low;
    (condition < 0xE && second & 0x4000 == 0).then(|| signed(bits, 21))
}

/// Sign extension of the lowest bits.
fn signed(number: u32, bits: u32) -> i32 {
    (number << (32 - bits)) as i32 >> (32 - bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Assembled by hand from the tables of the manual.
    #[test]
    fn branches_go_where_the_processor_goes() {
        for (code, at, target) in [
            (&[0xFE, 0xE7][..], 0x100, 0x100),         // b .
            (&[0x00, 0xF0, 0x00, 0xF8], 0x100, 0x104), // bl .+4
            (&[0xFF, 0xF7, 0xFE, 0xFF], 0x100, 0x100), // bl .
            (&[0x00, 0xF0, 0x00, 0xB8], 0x100, 0x104), // b.w .+4
            (&[0x01, 0xD0], 0x100, 0x106),             // beq .+6
            (&[0x3F, 0xF4, 0xFE, 0xAF], 0x100, 0x100), // beq.w .
        ] {
            assert_eq!(branches(code, at, |_| false).0, BTreeSet::from([target]), "{code:x?}");
        }
        // blx r3; bx lr; mov.w r0, #1; as data.
        assert_eq!(branches(&[0x98, 0x47], 0, |_| false), (BTreeSet::new(), true));
        assert_eq!(branches(&[0x70, 0x47], 0, |_| false), (BTreeSet::new(), false));
        assert_eq!(branches(&[0x4F, 0xF0, 0x01, 0x00], 0, |_| false), (BTreeSet::new(), false));
        assert_eq!(branches(&[0xFE, 0xE7], 0, |_| true), (BTreeSet::new(), false));
    }
}
