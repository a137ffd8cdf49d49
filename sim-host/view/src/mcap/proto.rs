//! The part of Protocol Buffers that MCAP needs: encoded fields, and descriptors of messages.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Double,
    Int64,
    Int32,
    Fixed32,
    Bool,
    Text,
    Bytes,
    /// Another message, by its full name.
    Message(&'static str),
    /// An enumeration, by its full name.
    Enum(&'static str),
}

#[derive(Clone, Copy, Debug)]
pub struct Field {
    pub name: &'static str,
    pub number: u32,
    pub kind: Kind,
    pub repeated: bool,
}

pub const fn one(name: &'static str, number: u32, kind: Kind) -> Field {
    Field { name, number, kind, repeated: false }
}

pub const fn many(name: &'static str, number: u32, kind: Kind) -> Field {
    Field { name, number, kind, repeated: true }
}

#[derive(Clone, Copy, Debug)]
pub struct Type {
    pub name: &'static str,
    pub fields: &'static [Field],
    /// Nested enumerations: name, and values from 0.
    pub enums: &'static [(&'static str, &'static [&'static str])],
}

#[derive(Clone, Copy, Debug)]
pub struct File {
    pub name: &'static str,
    pub package: &'static str,
    pub imports: &'static [&'static str],
    pub types: &'static [Type],
}

#[derive(Clone, Debug, Default)]
pub struct Bytes(pub Vec<u8>);

impl Bytes {
    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    fn tag(&mut self, number: u32, wire: u64) {
        self.varint(u64::from(number) << 3 | wire);
    }

    pub fn int(&mut self, number: u32, value: u64) {
        self.tag(number, 0);
        self.varint(value);
    }

    pub fn double(&mut self, number: u32, value: f64) {
        self.tag(number, 1);
        self.0.extend(value.to_le_bytes());
    }

    pub fn fixed32(&mut self, number: u32, value: u32) {
        self.tag(number, 5);
        self.0.extend(value.to_le_bytes());
    }

    pub fn bytes(&mut self, number: u32, value: &[u8]) {
        self.tag(number, 2);
        self.varint(value.len() as u64);
        self.0.extend_from_slice(value);
    }

    pub fn text(&mut self, number: u32, value: &str) {
        self.bytes(number, value.as_bytes());
    }

    pub fn message(&mut self, number: u32, fill: impl FnOnce(&mut Self)) {
        let mut inside = Self::default();
        fill(&mut inside);
        self.bytes(number, &inside.0);
    }
}

/// Describes these files to readers.
pub fn descriptor_set(files: &[&File]) -> Vec<u8> {
    let mut set = Bytes::default();
    for file in files {
        set.message(1, |out| {
            out.text(1, file.name);
            out.text(2, file.package);
            file.imports.iter().for_each(|import| out.text(3, import));
            for kind in file.types {
                out.message(4, |out| describe(kind, out));
            }
            out.text(12, "proto3");
        });
    }
    set.0
}

fn describe(kind: &Type, out: &mut Bytes) {
    out.text(1, kind.name);
    for field in kind.fields {
        out.message(2, |out| {
            out.text(1, field.name);
            out.int(3, field.number.into());
            out.int(4, if field.repeated { 3 } else { 1 });
            let (number, name) = match field.kind {
                Kind::Double => (1, None),
                Kind::Int64 => (3, None),
                Kind::Int32 => (5, None),
                Kind::Fixed32 => (7, None),
                Kind::Bool => (8, None),
                Kind::Text => (9, None),
                Kind::Message(name) => (11, Some(name)),
                Kind::Bytes => (12, None),
                Kind::Enum(name) => (14, Some(name)),
            };
            out.int(5, number);
            if let Some(name) = name {
                out.text(6, &format!(".{name}"));
            }
        });
    }
    for (name, values) in kind.enums {
        out.message(4, |out| {
            out.text(1, name);
            for (number, value) in (0..).zip(*values) {
                out.message(2, |out| {
                    out.text(1, value);
                    out.int(2, number);
                });
            }
        });
    }
}
