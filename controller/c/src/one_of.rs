//! Enums of types that implement one trait.

/// Defines an enum that is serialised as the value inside, and a macro that does one thing with
/// the value of any variant.
macro_rules! one_of {
    ($d:tt $each:ident: $(#[$about:meta])* $any:ident { $($(#[$cfg:meta])* $variant:ident($inside:ty),)+ }) => {
        $(#[$about])*
        #[derive(Clone, Debug)]
        pub enum $any {
            $($(#[$cfg])* $variant($inside),)+
        }

        macro_rules! $each {
            ($d any:expr, $d inside:ident => $d action:expr) => {
                match $d any {
                    $($(#[$cfg])* $any::$variant($d inside) => $d action,)+
                }
            };
        }

        impl serde::Serialize for $any {
            fn serialize<Z: serde::Serializer>(&self, to: Z) -> Result<Z::Ok, Z::Error> {
                $each!(self, inside => inside.serialize(to))
            }
        }
    };
}
pub(crate) use one_of;
