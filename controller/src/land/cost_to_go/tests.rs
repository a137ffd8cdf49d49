use super::*;
use crate::cost::Gain;
use crate::grid::{Norm, UNIT};
use proptest::collection::vec;
use proptest::prelude::*;
use std::string::ToString as _;
use std::vec;
use std::vec::Vec;

const HEADER: Header =
    Header { nodes: [3, 2], cells: [9, 5], origin: Cell::new(-2, 3), goal: Cell::new(6, 7), unit: 256 * UNIT };

fn written(header: &Header, count: impl FnMut(u8, u8) -> u16) -> Vec<u8> {
    let mut bytes = vec![0xAA; header.length() + 5];
    let length = header.write(&mut bytes, count).expect("in range");
    bytes.truncate(length);
    bytes
}

/// Node (x, y) has 100 y + x ticks.
fn table() -> Vec<u8> {
    written(&HEADER, |x, y| 100 * u16::from(y) + u16::from(x))
}

#[test]
fn a_table_has_its_nodes_and_blends_between_them() {
    let bytes = table();
    assert_eq!((bytes.len(), &bytes[..6]), (HEADER_LEN + 9, &b"CTG\x01\x03\x02"[..]));
    let table = CostToGo::from_bytes(&bytes[..]).expect("sound");
    assert_eq!(*table.header(), HEADER);
    let ticks = |x, y| table.at(Cell::new(x, y)) as f64 / f64::from(256 * UNIT);
    // Nodes are four cells apart.
    assert_eq!([ticks(-2, 3), ticks(2, 3), ticks(6, 3), ticks(-2, 7), ticks(6, 7)], [0.0, 1.0, 2.0, 100.0, 102.0]);
    assert_eq!([ticks(0, 3), ticks(-1, 4), ticks(3, 6)], [0.5, 25.25, 76.25]);
    // Off the map, the nearest cell on it counts.
    assert_eq!([ticks(-20, -3), ticks(i16::MAX, i16::MAX), ticks(i16::MIN, 7)], [0.0, 102.0, 100.0]);
}

#[test]
fn nodes_keep_twelve_bits() {
    let header = Header { nodes: [5, 3], cells: [5, 3], origin: Cell::default(), goal: Cell::default(), unit: 1 };
    let value = |x: u8, y: u8| (4095 - 273 * u16::from(x) - 819 * u16::from(y)) ^ u16::from(x & 1);
    let bytes = written(&header, value);
    let table = CostToGo::from_bytes(bytes).expect("sound");
    for (x, y) in (0..3).flat_map(|y| (0..5).map(move |x| (x, y))) {
        assert_eq!(table.at(Cell::new(x.into(), y.into())), value(x, y).into(), "{x} {y}");
    }
    let most = written(&header, |_, _| u16::MAX);
    assert_eq!(CostToGo::from_bytes(most).expect("sound").at(Cell::new(2, 2)), MOST.into());
}

#[test]
fn prices_are_travel_times_weighed_by_a0() {
    let table = CostToGo::from_bytes(table()).expect("sound");
    let price = |a0: Gain, cell| {
        let gains = Gains { a0, a3: Gain::from_int(3), norm: Norm::Euclidean };
        let mut price = 0;
        table.look(&gains, HEADER.goal, &mut |outlook| price = outlook.price(cell, 12345));
        price
    };
    assert!(table.is_whole());
    let cell = Cell::new(-2, 7);
    assert_eq!(
        [price(Gain::ONE, cell), price(Gain::from_sixteenths(40), cell)],
        [Gain::ONE.of(7000), Gain::ONE.of(17500)]
    );
    let far = CostToGo::from_bytes(written(&Header { unit: u32::MAX, ..HEADER }, |_, _| MOST)).expect("sound");
    let mut price = 0;
    let gains = Gains { a0: Gain::from_int(4095), a3: Gain::ONE, norm: Norm::Euclidean };
    far.look(&gains, HEADER.goal, &mut |outlook| price = outlook.price(cell, 0));
    assert_eq!(price, EXCLUDED - 1);
}

#[test]
fn what_is_no_table_is_refused_with_its_reason() {
    let sound = table();
    let refused = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = sound.clone();
        change(&mut bytes);
        CostToGo::from_bytes(bytes).expect_err("refused")
    };
    assert_eq!(refused(&|bytes| bytes.clear()), TableError::NotATable);
    assert_eq!(refused(&|bytes| bytes[1] = b'x'), TableError::NotATable);
    assert_eq!(refused(&|bytes| bytes[3] = 2), TableError::Version(2));
    assert_eq!(refused(&|bytes| bytes.truncate(20)), TableError::Length { needed: HEADER_LEN, found: 20 });
    assert_eq!(refused(&|bytes| bytes[4] = 1), TableError::Field(4));
    assert_eq!(refused(&|bytes| bytes[7] = 0x80), TableError::Field(6));
    assert_eq!(refused(&|bytes| bytes[14] = 7), TableError::Field(14));
    assert_eq!(refused(&|bytes| bytes[18..22].fill(0)), TableError::Field(18));
    assert_eq!(refused(&|bytes| bytes.push(0)), TableError::Length { needed: 35, found: 36 });
    for at in (HEADER_LEN..sound.len()).chain([10, 19, 22]) {
        assert_eq!(refused(&|bytes| bytes[at] ^= 1), TableError::Damaged, "{at}");
    }
    assert!(TableError::Damaged.to_string().contains("staya terrain model"));
    for header in [Header { nodes: [1, 2], ..HEADER }, Header { unit: 0, ..HEADER }, Header { cells: [1, 5], ..HEADER }]
    {
        assert_eq!(header.write(&mut [0; 99], |_, _| 0), None, "{header:?}");
    }
    assert_eq!(HEADER.write(&mut [0; 34], |_, _| 0), None, "a byte short");
}

#[cfg(all(feature = "host", feature = "wire"))]
#[test]
fn a_state_keeps_the_table_and_its_digest_ignores_it() {
    let table = CostToGo::<Vec<u8>>::from_bytes(table()).expect("sound");
    let mut state = [0; 64];
    let state = postcard::to_slice(&table, &mut state).expect("fits");
    assert_eq!(postcard::from_bytes::<CostToGo<Vec<u8>>>(state).expect("sound"), table);
    let other = CostToGo::from_bytes(written(&HEADER, |_, _| 7)).expect("sound");
    assert_eq!(crate::digest::digest(&table), crate::digest::digest(&other));
    state[30] ^= 1;
    assert!(postcard::from_bytes::<CostToGo<Vec<u8>>>(state).is_err());
}

proptest! {
    #[test]
    fn any_bytes_are_a_table_or_refused_and_any_cell_has_a_price(
        bytes in vec(any::<u8>(), 0..80),
        head in any::<bool>(),
        (columns, rows, cells, origin) in (any::<u8>(), 2..9_u8, any::<[u16; 2]>(), any::<(i16, i16)>()),
        (goal, unit, x, y) in (any::<(i16, i16)>(), any::<u32>(), any::<i16>(), any::<i16>()),
    ) {
        let mut bytes = bytes;
        if head && bytes.len() > 4 {
            bytes[..4].copy_from_slice(b"CTG\x01");
        }
        prop_assert!(CostToGo::from_bytes(&bytes[..]).is_err(), "a checksum by chance");
        let (origin, goal) = (Cell::new(origin.0, origin.1), Cell::new(goal.0, goal.1));
        let header = Header { nodes: [columns, rows], cells, origin, goal, unit };
        let mut bytes = vec![0; header.length()];
        if header.write(&mut bytes, |x, y| u16::from(x) * 255 + u16::from(y)).is_some() {
            let table = CostToGo::from_bytes(bytes).expect("written");
            prop_assert!(table.at(Cell::new(x, y)) <= u64::from(unit) * u64::from(MOST));
        }
    }
}
