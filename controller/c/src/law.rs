//! The laws of this build, as one type. A digest contains only the law inside.

use crate::Number;
use serde::Serialize;
use staya_controller::agent::{AnyLaw, External};
use staya_controller::laws;

/// The largest search; 0 without laws over cells.
pub(crate) const CELLS: usize = if cfg!(feature = "grid") { staya_controller::agent::CELLS } else { 0 };
pub(crate) const VISITS: usize = match (cfg!(feature = "grid"), cfg!(feature = "small")) {
    (false, _) => 0,
    (_, true) => 32,
    _ => staya_controller::agent::VISITS,
};
pub(crate) const LEARNED: usize =
    if cfg!(feature = "small") || !cfg!(feature = "grid") { 0 } else { staya_controller::agent::LEARNED };

type Listed = AnyLaw<Number, CELLS, VISITS, LEARNED>;

/// The scratch memory of any law.
pub(crate) type Workspace = <Listed as staya_controller::agent::Law<Number>>::Workspace;

laws! {
    /// A law of the controller's list, or that of the caller.
    #[expect(missing_docs, reason = "each variant's type says it")]
    #[allow(clippy::large_enum_variant, reason = "it has no heap")]
    #[derive(Clone, Debug, Serialize)]
    #[serde(untagged)]
    pub enum Law[] of Number, in Workspace, [] for [] {
        Listed(Listed),
        External(External<Number>),
    }
}
