use super::*;
use crate::agent::{Grid, GridOrder, OfAnotherLaw, Protocol};
use crate::wire::arbitrary::robot;
use crate::wire::{Content, MAX_ORDER};
use proptest::collection::vec;
use proptest::prelude::*;
use std::vec::Vec as StdVec;

const F: usize = 9;

type Assembler = TemplateAssembler<F>;

/// All fields identify it by `mark`.
fn template(mark: u8, len: usize) -> Template<F> {
    let entry =
        |k: usize| TemplateEntry { offset: Cell::new(k as i16, mark.into()), id: RobotId(k as u32), hops: 1 + k as u8 };
    Template { slot: mark, offset: Cell::new(-1, mark.into()), entries: (0..len).map(entry).collect() }
}

fn parts(version: u8, template: &Template<F>) -> StdVec<TemplatePart> {
    let Template { slot, offset, entries } = template;
    TemplatePart::split(version, *slot, *offset, entries).unwrap().collect()
}

fn put_all<'a>(assembler: &mut Assembler, parts: impl IntoIterator<Item = &'a TemplatePart>) -> StdVec<Template<F>> {
    parts.into_iter().filter_map(|part| assembler.put(part).unwrap()).collect()
}

#[test]
fn templates_of_every_size_survive_splitting() {
    for len in 0..=F {
        let sent = template(3, len);
        let parts = parts(1, &sent);
        assert_eq!(parts.len(), len.div_ceil(TEMPLATE_PART).max(1));
        assert!(parts.iter().all(|part| part.version == 1));
        let mut assembler = Assembler::new();
        let forth = put_all(&mut assembler, parts.iter());
        let mut assembler = Assembler::new();
        let back = put_all(&mut assembler, parts.iter().rev());
        assert_eq!([forth, back], [[sent.clone()], [sent]]);
    }
}

#[test]
fn split_refuses_templates_that_no_assembler_accepts() {
    let entry = TemplateEntry { hops: 1, ..NO_ENTRY };
    let split = |entries: &[TemplateEntry]| TemplatePart::split(0, 0, Cell::default(), entries).map(Iterator::count);
    assert_eq!(split(&[entry; MAX_TEMPLATE]), Ok(MAX_PARTS));
    assert_eq!(split(&[entry; MAX_TEMPLATE + 1]), Err(PartError::TooLarge));
    assert_eq!(split(&[entry, NO_ENTRY]), Err(PartError::NoHops));
}

#[test]
fn largest_template_is_reassembled() {
    let entries: StdVec<_> =
        (0..MAX_TEMPLATE).map(|k| TemplateEntry { offset: Cell::new(k as i16, 0), id: RobotId(1), hops: 1 }).collect();
    let mut assembler = TemplateAssembler::<MAX_TEMPLATE>::new();
    let split = TemplatePart::split(0, 0, Cell::default(), &entries).unwrap();
    let whole: StdVec<_> = split.filter_map(|part| assembler.put(&part).unwrap()).collect();
    assert_eq!(whole.len(), 1);
    assert_eq!(whole[0].entries[..], entries[..]);
}

#[test]
fn every_part_of_a_template_one_over_capacity_is_refused() {
    let sent = template(3, F);
    let parts = parts(1, &sent);
    let mut small = TemplateAssembler::<{ F - 1 }>::new();
    for part in &parts {
        assert_eq!(small.put(part), Err(PartError::TooLarge));
    }
    assert_eq!(small, TemplateAssembler::new());
}

#[test]
fn robot_without_neighbours_needs_no_capacity() {
    let parts = parts(1, &template(3, 0));
    let whole = TemplateAssembler::<0>::new().put(&parts[0]).unwrap().unwrap();
    assert_eq!(whole.slot, 3);
    assert!(whole.entries.is_empty());
}

#[test]
fn invalid_parts_return_their_error_and_change_nothing() {
    let sent = template(3, 5);
    let parts = parts(1, &sent);
    let mut assembler = Assembler::new();
    assembler.put(&parts[0]).unwrap();
    assembler.put(&parts[2]).unwrap();
    let before = assembler.clone();
    let mut refuses = |change: &dyn Fn(&mut TemplatePart), of: usize, error| {
        let mut part = parts[of].clone();
        change(&mut part);
        assert_eq!(assembler.put(&part), Err(error), "{part:?}");
        assert_eq!(assembler, before);
    };
    for version in [1, 2] {
        refuses(&|p| (p.version, p.part) = (version, 3), 1, PartError::Number);
        refuses(&|p| (p.version, p.parts) = (version, 1), 1, PartError::Number);
        refuses(&|p| (p.version, p.parts) = (version, 0), 1, PartError::Number);
        refuses(&|p| (p.version, p.part, p.parts) = (version, 0, 0), 1, PartError::Number);
        refuses(&|p| (p.version, p.part, p.parts) = (version, 255, 255), 1, PartError::Number);
        refuses(&|p| (p.version, p.parts) = (version, 255), 1, PartError::TooLarge);
        refuses(
            &|p| {
                p.version = version;
                p.entries.pop();
            },
            1,
            PartError::Length,
        );
        refuses(
            &|p| {
                p.version = version;
                p.entries.clear();
            },
            2,
            PartError::Length,
        );
        refuses(
            &|p| {
                p.version = version;
                p.entries[1].hops = 0;
            },
            1,
            PartError::NoHops,
        );
    }
    let contradiction = PartError::Contradiction;
    let entry = parts[0].entries[0];
    refuses(&|p| p.slot = 4, 1, contradiction);
    refuses(&|p| p.offset.x += 1, 1, contradiction);
    refuses(&|p| p.parts = 4, 1, contradiction);
    refuses(&|p| p.entries[0].id = RobotId(99), 0, contradiction);
    refuses(&|p| p.entries[0].hops = 9, 2, contradiction);
    refuses(&|p| p.entries.push(entry).unwrap(), 2, contradiction);
    assert_eq!(assembler.put(&parts[1]), Ok(Some(sent)));
}

#[test]
fn shorter_repeat_of_the_last_part_is_a_contradiction() {
    let parts = parts(1, &template(3, 4));
    let mut assembler = Assembler::new();
    assembler.put(&parts[1]).unwrap();
    let mut shorter = parts[1].clone();
    shorter.entries.pop();
    assert_eq!(assembler.put(&shorter), Err(PartError::Contradiction));
}

#[test]
fn newer_version_replaces_unfinished_and_finished_ones() {
    for finished in [false, true] {
        let (old, new) = (template(3, 6), template(4, 5));
        let old_parts = parts(255, &old);
        let mut assembler = Assembler::new();
        let taken = if finished { 3 } else { 2 };
        let whole = put_all(&mut assembler, &old_parts[..taken]);
        assert_eq!(whole.len(), usize::from(finished));
        let new_parts = parts(0, &new);
        assert_eq!(put_all(&mut assembler, &new_parts[..1]), []);
        assert_eq!(put_all(&mut assembler, &old_parts), []);
        assert_eq!(put_all(&mut assembler, &new_parts[1..]), [new]);
        assert_eq!(put_all(&mut assembler, &old_parts), []);
        assert_eq!(put_all(&mut assembler, &new_parts), []);
    }
}

fn order(part: &TemplatePart, is_restarted: bool) -> GridOrder {
    GridOrder::Template { part: part.clone(), is_restarted }
}

#[test]
fn any_version_is_accepted_from_a_restarted_sender() {
    let sent = template(3, 4);
    let mut assembler = Assembler::new();
    assert_eq!(put_all(&mut assembler, &parts(9, &sent)).len(), 1);
    let older = parts(8, &sent);
    for part in &older {
        assert_eq!(assembler.order(&order(part, false)), Ok(None));
    }
    assert_eq!(assembler.order(&order(&older[0], true)), Ok(None));
    assert_eq!(assembler.order(&order(&older[1], false)), Ok(Some(sent)));
}

#[test]
fn orders_that_are_not_parts_and_bad_parts_are_of_no_use() {
    let mut assembler = Assembler::new();
    assert_eq!(assembler.order(&GridOrder::Goal(Cell::default())), Err(OfAnotherLaw));
    let mut bad = parts(1, &template(3, 4))[0].clone();
    bad.parts = 0;
    assert_eq!(assembler.order(&order(&bad, false)), Err(OfAnotherLaw));
    assert_eq!(assembler, Assembler::new());
}

/// A third entry fits only if no robot has a large number.
#[test]
fn a_full_part_with_any_robots_fits_an_order() {
    let far = Cell::new(i16::MIN, i16::MAX);
    let entry = TemplateEntry { offset: far, id: RobotId(u32::MAX), hops: u8::MAX };
    let part = TemplatePart::split(255, 255, far, &[entry; TEMPLATE_PART]).unwrap().next().unwrap();
    let (_, bytes) = order(&part, true).encode::<MAX_ORDER>(Grid::ID).unwrap();
    assert_eq!(bytes.len(), 30);
    assert_eq!(GridOrder::decode(Grid::ID, Grid::ID, &bytes), Some(order(&part, false)));
    assert!(bytes.len() + 4 + 5 + 1 > MAX_ORDER);
}

#[test]
fn assembler_has_its_documented_size() {
    assert_eq!(size_of::<TemplateEntry>(), 12);
    assert_eq!(size_of::<TemplateAssembler<24>>(), 12 * 24 + 24);
}

fn cell() -> impl Strategy<Value = Cell> {
    any::<(i16, i16)>().prop_map(|(x, y)| Cell::new(x, y))
}

fn any_template() -> impl Strategy<Value = Template<F>> {
    let entry = (cell(), robot(), 1..=u8::MAX);
    let entry = entry.prop_map(|(offset, id, hops)| TemplateEntry { offset, id, hops });
    (any::<u8>(), cell(), vec(entry, 0..=F)).prop_map(|(slot, offset, entries)| Template {
        slot,
        offset,
        entries: entries.into_iter().collect(),
    })
}

proptest! {
    #[test]
    fn any_order_and_duplication_of_parts_gives_the_template_once(
        sent in any_template(), version: u8, order in vec(any::<prop::sample::Index>(), 0..40),
    ) {
        let parts = parts(version, &sent);
        let mut assembler = Assembler::new();
        let mut missing = (0..parts.len()).collect::<std::collections::BTreeSet<_>>();
        let drawn = order.iter().map(|index| index.index(parts.len()));
        for part in drawn.chain(0..parts.len()) {
            let completes = missing.remove(&part) && missing.is_empty();
            let whole = assembler.put(&parts[part]).unwrap();
            prop_assert_eq!(whole, completes.then(|| sent.clone()));
        }
    }

    #[test]
    fn any_mix_of_versions_returns_only_templates_that_were_sent(
        start: u8,
        sent in vec(any_template(), 1..100),
        order in vec((0..100_usize, any::<prop::sample::Index>()), 0..400),
    ) {
        let of = |count: usize| parts(start.wrapping_add(count as u8), &sent[count]);
        let mut assembler = Assembler::new();
        let (mut newest, mut finished) = (None, None);
        for (count, part) in order {
            let count = count % sent.len();
            let parts = of(count);
            let whole = assembler.put(&parts[part.index(parts.len())]).unwrap();
            newest = newest.max(Some(count));
            if let Some(whole) = whole {
                prop_assert_eq!(&whole, &sent[count]);
                prop_assert_eq!(newest, Some(count));
                prop_assert!(finished < Some(count));
                finished = Some(count);
            }
        }
        // The newest version gets through at the end.
        if let Some(count) = newest.filter(|_| newest != finished) {
            let whole = put_all(&mut assembler, &of(count));
            prop_assert_eq!(whole, [sent[count].clone()]);
        }
    }

    /// So few versions and numbers that they often collide.
    #[test]
    fn arbitrary_parts_never_panic_or_mix_versions(
        start: u8,
        stream in vec((0..3_u8, 0..5_u8, 0..5_u8, 0..2_u8, vec(0..3_u8, 0..=TEMPLATE_PART)), 0..60),
    ) {
        let mut assembler = Assembler::new();
        let mut seen = StdVec::new();
        for (ahead, part, parts, slot, hops) in stream {
            let version = start.wrapping_add(ahead);
            let entry = |hops| TemplateEntry {
                id: RobotId(ahead.into()),
                hops,
                ..NO_ENTRY
            };
            let part = TemplatePart {
                version,
                part,
                parts,
                slot,
                offset: Cell::default(),
                entries: hops.into_iter().map(entry).collect(),
            };
            let result = assembler.put(&part);
            seen.push(part);
            let Ok(Some(whole)) = result else { continue };
            prop_assert!(whole.entries.iter().all(|e| e.id == RobotId(ahead.into())));
            for (place, entry) in whole.entries.iter().enumerate() {
                let came = |part: &TemplatePart| {
                    part.version == version
                        && part.slot == whole.slot
                        && usize::from(part.part) == place / TEMPLATE_PART
                        && part.entries.get(place % TEMPLATE_PART) == Some(entry)
                };
                prop_assert!(seen.iter().any(came));
            }
        }
    }
}
