//! Formation templates in parts, over a radio that loses, duplicates and reorders them.

use arbitrary::{Result, Unstructured};
use heapless::Vec as Bounded;
use staya_controller::agent::{Grid, GridOrder, Protocol as _, TEMPLATE_PART, TemplateAssembler, TemplatePart};
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, TemplateEntry};
use staya_controller::wire::{Content as _, Header, MAX_FRAME_LEN, Message, decode, encode};

const F: usize = 7;
const TO: RobotId = RobotId(3);
const HEADER: Header = Header { boot: 0, sender: RobotId(1), sequence: 0 };
/// In versions; the assembler distinguishes 127.
const LATE: usize = 60;

/// Parts of a commander's templates arrive in any order, repeatedly or never; or arbitrary parts.
pub fn templates(bytes: &[u8]) {
    let mut choice = Unstructured::new(bytes);
    let _ = match choice.arbitrary() {
        Ok(true) => from_one_commander(&mut choice),
        _ => from_any_sender(&mut choice),
    };
}

fn from_one_commander(choice: &mut Unstructured<'_>) -> Result<()> {
    let mut version: u8 = choice.arbitrary()?;
    let mut sent: Vec<(Template<F>, Vec<TemplatePart>)> = Vec::new();
    let mut assembler = TemplateAssembler::<F>::new();
    let mut newest = None;
    let mut there = Vec::new();
    while !choice.is_empty() {
        if sent.is_empty() || choice.ratio(1_u8, 6_u8)? {
            let template = template(choice)?;
            version = version.wrapping_add(1);
            let Template { slot, offset, entries } = &template;
            let parts: Vec<_> =
                TemplatePart::split(version, *slot, *offset, entries).expect("a small template").map(carried).collect();
            assert_eq!(parts.len(), entries.len().div_ceil(TEMPLATE_PART).max(1));
            sent.push((template, parts));
        }
        let last = sent.len() - 1;
        let which = choice.int_in_range(last.saturating_sub(LATE)..=last)?;
        let (template, parts) = &sent[which];
        let part = choice.choose_index(parts.len())?;
        let whole = assembler.put(&parts[part]).expect("a part as it was sent is sound");
        if newest < Some(which) {
            newest = Some(which);
            there = vec![false; parts.len()];
        }
        let mut completes = false;
        if newest == Some(which) {
            completes = !there[part];
            there[part] = true;
            completes &= there.iter().all(|there| *there);
        }
        assert_eq!(whole.as_ref(), completes.then_some(template));
    }
    Ok(())
}

/// A refused part changes nothing. A completed template consists of parts of one version.
fn from_any_sender(choice: &mut Unstructured<'_>) -> Result<()> {
    let mut assembler = TemplateAssembler::<F>::new();
    let mut seen: Vec<TemplatePart> = Vec::new();
    while !choice.is_empty() {
        let mut entries = Bounded::new();
        for _ in 0..choice.int_in_range(0..=TEMPLATE_PART)? {
            let _ = entries.push(entry(choice, 0)?);
        }
        let mut part = TemplatePart {
            version: choice.arbitrary()?,
            part: choice.arbitrary()?,
            parts: choice.arbitrary()?,
            slot: choice.int_in_range(0..=1)?,
            offset: Cell::default(),
            entries,
        };
        if choice.arbitrary()? {
            part.version &= 3;
            part.part &= 3;
            part.parts &= 3;
        }
        let part = carried(part);
        let before = assembler.clone();
        let answer = assembler.put(&part);
        if answer.is_err() {
            assert_eq!(assembler, before);
        }
        let version = part.version;
        seen.push(part);
        let Ok(Some(whole)) = answer else { continue };
        for (at, chunk) in whole.entries.chunks(TEMPLATE_PART).enumerate() {
            let came = |part: &TemplatePart| {
                part.version == version
                    && part.slot == whole.slot
                    && usize::from(part.part) == at
                    && part.entries == *chunk
            };
            assert!(seen.iter().any(came));
        }
        for part in seen.iter().filter(|part| part.version == version) {
            assert!(!matches!(assembler.put(part), Ok(Some(_))));
        }
    }
    Ok(())
}

fn template(choice: &mut Unstructured<'_>) -> Result<Template<F>> {
    let mut entries = Bounded::new();
    for _ in 0..choice.int_in_range(0..=F)? {
        let _ = entries.push(entry(choice, 1)?);
    }
    Ok(Template { slot: choice.arbitrary()?, offset: Cell::new(choice.arbitrary()?, choice.arbitrary()?), entries })
}

fn entry(choice: &mut Unstructured<'_>, least_hops: u8) -> Result<TemplateEntry> {
    Ok(TemplateEntry {
        offset: Cell::new(choice.arbitrary::<i8>()?.into(), 0),
        id: RobotId(choice.arbitrary::<u8>()?.into()),
        hops: choice.int_in_range(least_hops..=3)?,
    })
}

/// The part after its way through a frame.
fn carried(part: TemplatePart) -> TemplatePart {
    let mut out = Bounded::<u8, MAX_FRAME_LEN>::new();
    let version = part.version;
    let sent = GridOrder::Template { part, is_restarted: false };
    let message = Grid::order(TO, version, &sent).expect("a part fits an order");
    encode(HEADER, &message, &mut out).expect("every message fits");
    let frame = decode(&out[..out.len() - 1]).expect("a sent frame is intact");
    assert_eq!(frame.message, message);
    let Message::Order(order) = frame.message else { panic!("received {message:?}") };
    let received = GridOrder::decode(Grid::ID, order.protocol, &order.content);
    assert_eq!(received, Some(sent));
    let Some(GridOrder::Template { part, .. }) = received else { panic!("received {received:?}") };
    part
}
