//! The part of a program that a function needs: the code and the constants that can be reached from
//! it.
//!
//! From the relocations that `bench` is linked with (`--emit-relocs`): each says which function
//! refers to what. Calls through pointers are followed where the pointer is stored. Constants
//! without a name reach up to the next thing with a reference to it.

use super::{Row, Table};
use crate::prelude::*;
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, RelocationFlags, SymbolKind, elf};
use std::collections::{BTreeMap, BTreeSet};

/// The references between functions and constants of a program.
pub struct Program {
    /// Functions and constants by their address: bytes, and whether it is code.
    things: BTreeMap<u64, (u64, bool)>,
    /// Functions by name.
    names: Vec<(String, u64)>,
    /// Targets of references, by their places.
    references: BTreeMap<u64, u64>,
}

impl Program {
    /// Reads an ELF file that was linked with its relocations.
    pub fn read(bytes: &[u8]) -> Result<Self> {
        let file = object::File::parse(bytes)?;
        let mut program = Self { things: BTreeMap::new(), names: Vec::new(), references: BTreeMap::new() };
        let is_thumb = file.architecture() == object::Architecture::Arm;
        // The lowest bit of a Thumb function's address says that it is one.
        let plain = |address: u64| if is_thumb { address & !1 } else { address };
        for symbol in file.symbols() {
            let is_code = symbol.kind() == SymbolKind::Text;
            let is_named = is_code || symbol.kind() == SymbolKind::Data;
            if is_named && symbol.size() > 0 {
                let address = if is_code { plain(symbol.address()) } else { symbol.address() };
                program.things.insert(address, (symbol.size(), is_code));
                if let (true, Ok(name)) = (is_code, symbol.name()) {
                    program.names.push((format!("{:#}", rustc_demangle::demangle(name)), address));
                }
            }
        }
        let mut constants = BTreeSet::new();
        for section in file.sections() {
            let Ok(data) = section.data() else { continue };
            let start = section.address();
            let mut halves = BTreeMap::new();
            for (place, relocation) in section.relocations() {
                let at = |offset: u64| {
                    let from = usize::try_from(place.checked_sub(start)? + offset).ok()?;
                    Some(u16::from_le_bytes(data.get(from..from + 2)?.try_into().ok()?))
                };
                let object::RelocationTarget::Symbol(index) = relocation.target() else { continue };
                let Ok(symbol) = file.symbol_by_index(index) else { continue };
                let RelocationFlags::Elf { r_type } = relocation.flags() else { continue };
                let is_section = symbol.kind() == SymbolKind::Section;
                let target = match r_type {
                    // The linker has written the sum of symbol and addend there.
                    elf::R_ARM_ABS32 if is_thumb => {
                        at(0).zip(at(2)).map(|(low, high)| u64::from(low) | u64::from(high) << 16)
                    }
                    elf::R_ARM_THM_MOVW_ABS_NC if is_thumb && is_section => {
                        if let Some((register, half)) = at(0).zip(at(2)).map(move_wide) {
                            halves.insert(register, half);
                        }
                        None
                    }
                    elf::R_ARM_THM_MOVT_ABS if is_thumb && is_section => {
                        let high = at(0).zip(at(2)).map(move_wide);
                        high.and_then(|(register, high)| Some(halves.get(&register)? | high << 16))
                    }
                    _ => Some(symbol.address().wrapping_add_signed(relocation.addend())),
                };
                if let Some(target) = target {
                    program.references.insert(place, target);
                    constants.insert(target);
                }
            }
        }
        // Constants without a name end where the next thing begins.
        for section in file.sections().filter(|section| section.name() == Ok(".rodata")) {
            let end = section.address() + section.size();
            constants.extend(program.things.range(section.address()..end).map(|(at, _)| *at));
            let inside: Vec<u64> = constants.range(section.address()..end).copied().collect();
            for (index, at) in inside.iter().enumerate() {
                let next = inside.get(index + 1).copied().unwrap_or(end);
                program.things.entry(*at).or_insert((next - at, false));
            }
        }
        Ok(program)
    }

    /// The flash that each step of an agent in `bench` needs, of those with most neighbours.
    pub fn steps(&self) -> Table {
        let neighbors = |step: &str| step.rsplit(", ").next().and_then(|number| number.parse::<u32>().ok());
        let mut rows: Table = self.needs("step").collect();
        let most = rows.keys().map(|step| neighbors(step)).max();
        rows.retain(|step, _| Some(neighbors(step)) == most);
        rows
    }

    /// The flash that one frame of each wire format needs.
    pub fn formats(&self) -> Table {
        let needs = |way| self.needs(way).map(move |(format, needs)| (format!("{way}, {format}"), needs));
        ["decode", "encode"].into_iter().flat_map(needs).collect()
    }

    /// The types of each function of `bench` by this name, without paths, and the machine code and
    /// constants that it needs.
    fn needs(&self, function: &str) -> impl Iterator<Item = (String, Row)> {
        let start = format!("bench::program::{function}::<");
        self.names.iter().filter_map(move |(name, at)| {
            let types = name.strip_prefix(&start)?.strip_suffix('>')?;
            let [text, rodata] = self.reach(*at);
            Some((without_paths(types), Row::from([("text", text), ("rodata", rodata)])))
        })
    }

    /// Bytes of machine code and of constants that are reached from the function at `root`.
    fn reach(&self, root: u64) -> [u64; 2] {
        let mut seen = BTreeSet::new();
        let mut open = vec![root];
        let (mut text, mut rodata) = (0, 0);
        while let Some(target) = open.pop() {
            let Some((at, size, is_code)) = self.thing(target).filter(|(at, ..)| seen.insert(*at)) else { continue };
            *(if is_code { &mut text } else { &mut rodata }) += size;
            open.extend(self.references.range(at..at + size).map(|(_, target)| *target));
        }
        [text, rodata]
    }

    /// The thing that an address lies in.
    fn thing(&self, address: u64) -> Option<(u64, u64, bool)> {
        let (at, (size, is_code)) = self.things.range(..=address).next_back()?;
        (address < at + size).then_some((*at, *size, *is_code))
    }
}

/// `a::b::C<d::E>` as `C<E>`.
fn without_paths(name: &str) -> String {
    let mut short = String::new();
    for c in name.chars() {
        if c == ':' {
            let end = short.rfind(|c: char| !c.is_alphanumeric() && c != '_');
            short.truncate(end.map_or(0, |end| end + 1));
        } else {
            short.push(c);
        }
    }
    short
}

/// Register and immediate of MOVW and MOVT (encoding T3 and T1).
fn move_wide((first, second): (u16, u16)) -> (u16, u64) {
    let immediate = (first & 0xF) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF;
    (second >> 8 & 0xF, immediate.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_reached_counts_once_and_nothing_else_counts() {
        let things = [(0, (10, true)), (10, (20, true)), (30, (5, true)), (100, (8, false))];
        let references = [(4, 10), (12, 103), (14, 0), (16, 100), (18, 5000)];
        let program = Program {
            things: things.into_iter().collect(),
            names: vec![(String::from("bench::program::encode::<a::F>"), 0)],
            references: references.into_iter().collect(),
        };
        assert_eq!(program.formats()["encode, F"], Row::from([("text", 30), ("rodata", 8)]));
        assert_eq!(program.reach(30), [5, 0]);
        assert_eq!(program.reach(50), [0, 0]);
    }

    #[test]
    fn behaviours_are_named_without_their_paths() {
        assert_eq!(without_paths("f32, a::b::C<d::E_f, 3>, g::H, 16"), "f32, C<E_f, 3>, H, 16");
    }

    #[test]
    fn halves_of_an_address_are_read_from_their_instructions() {
        // movw r0, #0x1234 and movt r7, #0xABCD
        assert_eq!(move_wide((0xF241, 0x2034)), (0, 0x1234));
        assert_eq!(move_wide((0xF6CA, 0x37CD)), (7, 0xABCD));
    }
}
