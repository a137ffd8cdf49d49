//! Descriptors of the messages, from .proto files with one statement a line, of which this module
//! reads the parts that they use.

use super::proto::Bytes;

pub const FIGURES: &str = include_str!("figures.schema.json");
const FILES: [(&str, &str); 3] = [
    ("google/protobuf/timestamp.proto", include_str!("timestamp.proto")),
    ("google/protobuf/duration.proto", include_str!("duration.proto")),
    ("staya/foxglove.proto", include_str!("foxglove.proto")),
];

/// A `FileDescriptorSet`.
pub fn descriptors() -> Vec<u8> {
    let mut set = Bytes::default();
    for (name, text) in FILES {
        set.message(1, |out| file(name, text, out));
    }
    set.0
}

fn file(name: &str, text: &str, out: &mut Bytes) {
    out.text(1, name);
    let statements = text.lines().filter(|line| !line.starts_with("//"));
    let mut statements = statements.map(|line| {
        let words = line.split([' ', ';', '=', '"', '{']).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>()
    });
    while let Some(statement) = statements.next() {
        match statement[..] {
            ["package", package] => out.text(2, package),
            ["import", path] => out.text(3, path),
            ["message", name] => out.message(4, |out| message(name, &mut statements, out)),
            _ => {}
        }
    }
    out.text(12, "proto3");
}

/// Reads to the end of the message. Its enumerations come before their use.
fn message<'a>(name: &str, statements: &mut impl Iterator<Item = Vec<&'a str>>, out: &mut Bytes) {
    out.text(1, name);
    let (mut names, mut enums) = (Vec::new(), Bytes::default());
    while let Some(statement) = statements.next() {
        let (label, kind, name, number) = match statement[..] {
            ["repeated", kind, name, number] => (3, kind, name, number),
            [kind, name, number] => (1, kind, name, number),
            ["enum", name] => {
                names.push(name);
                enums.message(4, |out| enumeration(name, statements, out));
                continue;
            }
            _ => break,
        };
        out.message(2, |out| {
            out.text(1, name);
            out.int(3, number.parse().unwrap_or_default());
            out.int(4, label);
            let plain = match kind {
                "double" => Some(1),
                "int64" => Some(3),
                "int32" => Some(5),
                "fixed32" => Some(7),
                "bool" => Some(8),
                "string" => Some(9),
                "bytes" => Some(12),
                _ => None,
            };
            let is_enum = kind.rsplit('.').next().is_some_and(|last| names.contains(&last));
            out.int(5, plain.unwrap_or(if is_enum { 14 } else { 11 }));
            if plain.is_none() {
                out.text(6, &format!(".{kind}"));
            }
        });
    }
    out.0.extend(enums.0);
}

fn enumeration<'a>(name: &str, statements: &mut impl Iterator<Item = Vec<&'a str>>, out: &mut Bytes) {
    out.text(1, name);
    for statement in statements {
        let [value, number] = statement[..] else { return };
        out.message(2, |out| {
            out.text(1, value);
            out.int(2, number.parse().unwrap_or_default());
        });
    }
}
