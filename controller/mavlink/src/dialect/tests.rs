use super::messages::{FieldInfo, encoded_len};
use super::{HEARTBEAT_DATA, MavMessage};
use mavlink_core::MavlinkVersion::{V1, V2};
use mavlink_core::{Message as _, MessageData as _, calculate_crc};
use proptest::prelude::*;
use std::string::String;
use std::vec::Vec;

const XML: [&str; 3] = [
    include_str!("../../messages/common.xml"),
    include_str!("../../messages/ardupilotmega.xml"),
    include_str!("../../messages/staya.xml"),
];

/// A message as its XML file has it.
struct XmlMessage<'a> {
    id: u32,
    name: &'a str,
    fields: Vec<FieldInfo>,
    extensions: Vec<FieldInfo>,
}

fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let value = tag.split_once(&std::format!(" {name}=\"")).and_then(|(_, rest)| rest.split_once('"'));
    value.unwrap_or_else(|| panic!("no {name} in <{tag}")).0
}

fn field(tag: &'static str) -> FieldInfo {
    let (type_name, count) = match attribute(tag, "type").split_once('[') {
        Some((element, count)) => (element, count.trim_end_matches(']').parse().unwrap()),
        None => (attribute(tag, "type"), 0),
    };
    // A number with its own way to be filled in.
    let type_name = type_name.trim_end_matches("_mavlink_version");
    FieldInfo {
        name: attribute(tag, "name"),
        type_name,
        count,
        len: element_len(type_name) * usize::from(count.max(1)),
    }
}

fn element_len(type_name: &str) -> usize {
    match type_name {
        "char" | "uint8_t" | "int8_t" => 1,
        "uint16_t" | "int16_t" => 2,
        "uint32_t" | "int32_t" | "float" => 4,
        "uint64_t" | "int64_t" => 8,
        _ => panic!("unknown type {type_name}"),
    }
}

fn message(element: &'static str) -> XmlMessage<'static> {
    let (base, extensions) = element.split_once("<extensions/>").unwrap_or((element, ""));
    let fields = |text: &'static str| text.split("<field").skip(1).map(field).collect::<Vec<_>>();
    let (mut fields, extensions) = (fields(base), fields(extensions));
    fields.sort_by_key(|field| core::cmp::Reverse(element_len(field.type_name)));
    XmlMessage { id: attribute(element, "id").parse().unwrap(), name: attribute(element, "name"), fields, extensions }
}

/// All messages of the XML files.
fn messages() -> impl Iterator<Item = XmlMessage<'static>> {
    XML.iter().flat_map(|xml| xml.split("<message").filter(|element| element.starts_with(' '))).map(message)
}

#[test]
fn table_equals_its_xml_files() {
    let mut messages: Vec<_> = messages().collect();
    messages.sort_by_key(|message| message.id);
    let ids: Vec<_> = messages.iter().map(|message| message.id).collect();
    assert_eq!(MavMessage::all_ids(), ids);
    for (xml, (name, fields, extensions)) in messages.iter().zip(MavMessage::TABLE) {
        assert_eq!((xml.name, &xml.fields[..], &xml.extensions[..]), (*name, *fields, *extensions));
    }
}

#[test]
fn crc_extra_is_that_of_the_xml_files() {
    for XmlMessage { id, name, fields, .. } in messages() {
        let mut bytes = std::format!("{name} ").into_bytes();
        for FieldInfo { type_name, name, count, .. } in fields {
            bytes.extend(std::format!("{type_name} {name} ").bytes());
            bytes.extend((count > 0).then_some(count));
        }
        let (last, before) = bytes.split_last().unwrap();
        let crc = calculate_crc(before, *last);
        assert_eq!(u16::from(MavMessage::extra_crc(id)), (crc & 0xFF) ^ (crc >> 8), "{name}");
    }
}

#[test]
fn names_and_ids_belong_together() {
    for (name, id) in MavMessage::all_messages() {
        assert_eq!(MavMessage::message_id_from_name(name), Some(*id));
        let message = MavMessage::default_message_from_id(*id).unwrap();
        assert_eq!((message.message_name(), message.message_id()), (*name, *id));
    }
    assert_eq!(MavMessage::message_id_from_name("NOTHING"), None);
    assert!(MavMessage::default_message_from_id(3).is_none() && MavMessage::parse(V2, 3, &[]).is_err());
}

#[test]
fn every_field_target_system_is_an_address() {
    for ((_, fields, extensions), id) in MavMessage::TABLE.iter().zip(MavMessage::all_ids()) {
        let has = |names: &[&str]| fields.iter().chain(*extensions).any(|field| names.contains(&field.name));
        let mut message = MavMessage::default_message_from_id(*id).unwrap();
        assert_eq!(
            message.target_system_id_mut().map(|system| *system = 7).is_some(),
            has(&["target_system", "target"])
        );
        assert_eq!(
            message.target_component_id_mut().map(|component| *component = 9).is_some(),
            has(&["target_component"])
        );
        assert_eq!(message.target_system_id().unwrap_or(7), 7);
        assert_eq!(message.target_component_id().unwrap_or(9), 9);
    }
}

#[test]
#[should_panic(expected = "the buffer is too small")]
fn a_short_buffer_is_a_mistake_of_the_caller() {
    HEARTBEAT_DATA::DEFAULT.ser(V2, &mut [0; HEARTBEAT_DATA::ENCODED_LEN - 1]);
}

proptest! {
    #[test]
    fn any_payload_survives_decoding_and_encoding(
        index in 0..MavMessage::TABLE.len(),
        sent in prop::collection::vec(prop_oneof![Just(0), any::<u8>()], 0..=255),
    ) {
        let (id, (name, fields, extensions)) = (MavMessage::all_ids()[index], MavMessage::TABLE[index]);
        let message = MavMessage::parse(V2, id, &sent).unwrap();
        let mut whole = sent;
        whole.resize(encoded_len(fields) + encoded_len(extensions), 0);
        let mut bytes = [0xAA; 255];
        let len = message.ser(V1, &mut bytes);
        prop_assert_eq!(&bytes[..len], &whole[..encoded_len(fields)], "{}", String::from(name));
        let len = message.ser(V2, &mut bytes);
        let zeros = whole.iter().rev().take_while(|byte| **byte == 0).count();
        prop_assert_eq!(&bytes[..len], &whole[..(whole.len() - zeros).max(1)], "{}", String::from(name));
    }
}
