//! The macro [`messages`], and the trait of the types of fields.

use crc::{CRC_16_MCRF4XX, Crc, Table};
use mavlink_core::types::CharArray;

/// The checksum of frames and of the definitions of messages.
pub(crate) static CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_MCRF4XX);

/// The type of a field. On the wire, numbers are little-endian and arrays have no length.
pub(super) trait Field: Sized {
    /// Name in XML files, and so in the checksum; of an array, that of its elements.
    const TYPE: &'static str;
    /// Number of elements of an array, 0 for a single number.
    const COUNT: u8 = 0;
    /// Length on the wire in bytes.
    const LEN: usize = size_of::<Self>();
    /// The default value.
    const ZERO: Self;
    /// Removes a value from the front of `bytes`; [`Self::ZERO`] if they are too short.
    fn take(bytes: &mut &[u8]) -> Self;
    /// Writes the value to the front of `bytes` and removes that part; nothing if it is too short.
    fn put(&self, bytes: &mut &mut [u8]);
}

macro_rules! numbers {
    ($($number:ident $name:literal,)*) => { $(
        impl Field for $number {
            const TYPE: &'static str = $name;
            const ZERO: Self = 0 as Self;

            fn take(bytes: &mut &[u8]) -> Self {
                let Some((value, rest)) = bytes.split_first_chunk() else { return Self::ZERO };
                *bytes = rest;
                Self::from_le_bytes(*value)
            }

            fn put(&self, bytes: &mut &mut [u8]) {
                if let Some((place, rest)) = core::mem::take(bytes).split_first_chunk_mut() {
                    *place = self.to_le_bytes();
                    *bytes = rest;
                }
            }
        }
    )* };
}

numbers! {
    u8 "uint8_t", u16 "uint16_t", u32 "uint32_t", u64 "uint64_t",
    i8 "int8_t", i16 "int16_t", i32 "int32_t", i64 "int64_t", f32 "float",
}

impl<T: Field + Copy, const N: usize> Field for [T; N] {
    const TYPE: &'static str = T::TYPE;
    const COUNT: u8 = N as u8;
    const ZERO: Self = [T::ZERO; N];

    fn take(bytes: &mut &[u8]) -> Self {
        core::array::from_fn(|_| T::take(bytes))
    }

    fn put(&self, bytes: &mut &mut [u8]) {
        for value in self {
            value.put(bytes);
        }
    }
}

impl<const N: usize> Field for CharArray<N> {
    const TYPE: &'static str = "char";
    const COUNT: u8 = N as u8;
    const LEN: usize = N;
    const ZERO: Self = Self::new([0; N]);

    fn take(bytes: &mut &[u8]) -> Self {
        Self::new(Field::take(bytes))
    }

    fn put(&self, bytes: &mut &mut [u8]) {
        (**self).put(bytes);
    }
}

/// A field as its XML file has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FieldInfo {
    pub(super) name: &'static str,
    pub(super) type_name: &'static str,
    pub(super) count: u8,
    pub(super) len: usize,
}

impl FieldInfo {
    pub(super) const fn new<T: Field>(name: &'static str) -> Self {
        Self { name, type_name: T::TYPE, count: T::COUNT, len: T::LEN }
    }
}

/// The length of `fields` on the wire in bytes.
#[expect(clippy::arithmetic_side_effects, reason = "evaluated by the compiler only")]
pub(super) const fn encoded_len(fields: &[FieldInfo]) -> usize {
    match fields {
        [field, rest @ ..] => field.len + encoded_len(rest),
        [] => 0,
    }
}

/// `CRC_EXTRA` of a message: the checksum of its name and of all fields but extensions, in wire
/// order, so that frames of another definition do not pass.
pub(super) const fn extra_crc(name: &str, fields: &[FieldInfo]) -> u8 {
    let mut digest = CRC.digest();
    digest.update(name.as_bytes());
    digest.update(b" ");
    let mut rest = fields;
    while let [field, behind @ ..] = rest {
        digest.update(field.type_name.as_bytes());
        digest.update(b" ");
        digest.update(field.name.as_bytes());
        digest.update(b" ");
        if field.count > 0 {
            digest.update(&[field.count]);
        }
        rest = behind;
    }
    let [low, high] = digest.finalize().to_le_bytes();
    low ^ high
}

/// Defines messages by a table, with the names that `mavlink-bindgen` gives:
///
/// ```text
/// ID NAME(NAME_DATA) { field: type, field("name in XML"): type, ... } + { extension: type, ... }
/// ```
///
/// Fields stand in wire order: numbers by falling length, otherwise in the order of the XML file;
/// extensions follow in the order of the XML file. Messages stand in the order of ids.
///
/// Each message becomes a struct `NAME_DATA` with `DEFAULT`, `ENCODED_LEN` (with extensions) and
/// [`mavlink_core::MessageData`], and a variant of `MavMessage`, which implements
/// [`mavlink_core::Message`]. Length and `CRC_EXTRA` are computed from the table.
macro_rules! messages {
    ($(
        $(#[$doc:meta])*
        $id:literal $name:ident($data:ident) {
            $($field:ident $(($wire_name:literal))?: $type:ty,)*
        } $(+ {
            $($extension:ident: $extension_type:ty,)*
        })?
    )*) => {
        $(
            $(#[$doc])*
            #[doc = concat!("MAVLink message ", stringify!($id), ", `", stringify!($name), "`.")]
            #[derive(Debug, Clone, PartialEq)]
            pub struct $data {
                $(pub $field: $type,)*
                $($(pub $extension: $extension_type,)*)?
            }

            impl $data {
                pub const ENCODED_LEN: usize = encoded_len(Self::FIELDS) + encoded_len(Self::EXTENSIONS);
                pub const DEFAULT: Self = Self {
                    $($field: Field::ZERO,)*
                    $($($extension: Field::ZERO,)*)?
                };
                const FIELDS: &[FieldInfo] = &[$(FieldInfo::new::<$type>(wire_name!($field $($wire_name)?)),)*];
                const EXTENSIONS: &[FieldInfo] =
                    &[$($(FieldInfo::new::<$extension_type>(stringify!($extension)),)*)?];
            }

            impl Default for $data {
                fn default() -> Self {
                    Self::DEFAULT
                }
            }

            impl MessageData for $data {
                type Message = MavMessage;
                const ID: u32 = $id;
                const NAME: &'static str = stringify!($name);
                const EXTRA_CRC: u8 = extra_crc(Self::NAME, Self::FIELDS);
                const ENCODED_LEN: usize = Self::ENCODED_LEN;

                fn deser(_: MavlinkVersion, payload: &[u8]) -> Result<Self, ParserError> {
                    // A sender omits zeros at the end.
                    let mut padded = [0; Self::ENCODED_LEN];
                    let whole = payload.first_chunk().unwrap_or_else(|| {
                        padded.iter_mut().zip(payload).for_each(|(byte, sent)| *byte = *sent);
                        &padded
                    });
                    let mut rest = whole.as_slice();
                    Ok(Self {
                        $($field: Field::take(&mut rest),)*
                        $($($extension: Field::take(&mut rest),)*)?
                    })
                }

                fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
                    // As the trait demands. Callers here have room for any payload.
                    assert!(bytes.len() >= Self::ENCODED_LEN, "the buffer is too small");
                    let mut rest = &mut *bytes;
                    $(self.$field.put(&mut rest);)*
                    if let MavlinkVersion::V1 = version {
                        return const { encoded_len(Self::FIELDS) };
                    }
                    $($(self.$extension.put(&mut rest);)*)?
                    remove_trailing_zeroes(bytes.get(..Self::ENCODED_LEN).unwrap_or_default())
                }
            }
        )*

        /// Any message of the dialect.
        #[derive(Clone, PartialEq, Debug)]
        #[repr(u32)]
        pub enum MavMessage {
            $($(#[$doc])* $name($data),)*
        }

        impl MavMessage {
            /// The ids of all messages, in order.
            pub const fn all_ids() -> &'static [u32] {
                &[$($id,)*]
            }

            /// Names and ids of all messages, in order of ids.
            pub const fn all_messages() -> &'static [(&'static str, u32)] {
                &[$((stringify!($name), $id),)*]
            }

            /// Name, fields and extensions of each message.
            #[cfg(test)]
            const TABLE: &[(&'static str, &[FieldInfo], &[FieldInfo])] =
                &[$((stringify!($name), $data::FIELDS, $data::EXTENSIONS),)*];
        }

        impl Message for MavMessage {
            fn parse(version: MavlinkVersion, id: u32, payload: &[u8]) -> Result<Self, ParserError> {
                match id {
                    $($id => $data::deser(version, payload).map(Self::$name),)*
                    _ => Err(ParserError::UnknownMessage { id }),
                }
            }

            fn message_name(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => stringify!($name),)*
                }
            }

            fn message_id(&self) -> u32 {
                match self {
                    $(Self::$name(_) => $id,)*
                }
            }

            fn message_id_from_name(name: &str) -> Option<u32> {
                match name {
                    $(stringify!($name) => Some($id),)*
                    _ => None,
                }
            }

            fn default_message_from_id(id: u32) -> Option<Self> {
                match id {
                    $($id => Some(Self::$name($data::DEFAULT)),)*
                    _ => None,
                }
            }

            fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
                match self {
                    $(Self::$name(data) => data.ser(version, bytes),)*
                }
            }

            fn extra_crc(id: u32) -> u8 {
                match id {
                    $($id => $data::EXTRA_CRC,)*
                    _ => 0,
                }
            }

            fn target_system_id(&self) -> Option<u8> {
                match self {
                    $(Self::$name(_data) => target_system!(() _data $($field)* $($($extension)*)?),)*
                }
            }

            fn target_system_id_mut(&mut self) -> Option<&mut u8> {
                match self {
                    $(Self::$name(_data) => target_system!((&mut) _data $($field)* $($($extension)*)?),)*
                }
            }

            fn target_component_id(&self) -> Option<u8> {
                match self {
                    $(Self::$name(_data) => target_component!(() _data $($field)* $($($extension)*)?),)*
                }
            }

            fn target_component_id_mut(&mut self) -> Option<&mut u8> {
                match self {
                    $(Self::$name(_data) => target_component!((&mut) _data $($field)* $($($extension)*)?),)*
                }
            }
        }
    };
}

/// The name of a field in its XML file; given separately if it is a keyword in Rust.
macro_rules! wire_name {
    ($field:ident) => {
        stringify!($field)
    };
    ($field:ident $name:literal) => {
        $name
    };
}

/// The addressed system, `None` without such a field: `target_system!((&mut) data fields...)`.
macro_rules! target_system {
    (($($by:tt)*) $data:ident) => { None };
    (($($by:tt)*) $data:ident target_system $($rest:ident)*) => { Some($($by)* $data.target_system) };
    (($($by:tt)*) $data:ident target $($rest:ident)*) => { Some($($by)* $data.target) };
    ($by:tt $data:ident $other:ident $($rest:ident)*) => { target_system!($by $data $($rest)*) };
}

/// The addressed component, as [`target_system`].
macro_rules! target_component {
    (($($by:tt)*) $data:ident) => { None };
    (($($by:tt)*) $data:ident target_component $($rest:ident)*) => { Some($($by)* $data.target_component) };
    ($by:tt $data:ident $other:ident $($rest:ident)*) => { target_component!($by $data $($rest)*) };
}
