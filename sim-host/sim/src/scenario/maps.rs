//! `[maps]`: exchange of terrain maps between robots.

use super::law::LawSetup;
use super::source::Checked;
use super::{Draft, ranges::duration};
use crate::{defaults, table};
use staya_controller::land::MapParams;
use staya_controller::route::{ExitRule, Replan};

table! {
    /// `[maps]`: robots that plan on terrain exchange what they see of it.
    #[derive(Copy)]
    pub struct MapsTable {
        /// Whether maps are exchanged. Default: false.
        pub share: bool = false;
        /// How long received map entries are kept, seconds, 1 to 2100. Default: 600.
        pub forget_after_s: Option<f64>, 1.0..=2100.0, "s";
    }
}

defaults!(MapsTable);

pub(super) fn sharing(draft: &Draft<'_>, laws: &[&LawSetup]) -> Checked<Option<MapParams>> {
    let MapsTable { share, forget_after_s } = draft.file.maps;
    if !share {
        let (field, remedy) = ("maps.forget_after_s", "give maps.share = true, or leave it out");
        draft.require(forget_after_s.is_none(), field, "no robot shares a map", remedy)?;
        return Ok(None);
    }
    plans_far(draft, laws, "maps.share")?;
    let keeps_map = draft.file.scouting.as_ref().is_some_and(|scouting| scouting.model_bytes.is_none());
    let what = "robots that have a map ([scouting]) plan by that one";
    draft.require(!keeps_map, "maps.share", what, "leave one of the two out, or give scouting.model_bytes")?;
    let MapParams { forget_after } = MapParams::default();
    Ok(Some(MapParams { forget_after: forget_after_s.map_or(forget_after, duration) }))
}

/// Refuses laws that plan no way beyond their sight; `field` asks for one.
pub(super) fn plans_far(draft: &Draft<'_>, laws: &[&LawSetup], field: &str) -> Checked<()> {
    let routes = || laws.iter().filter_map(|law| law.route());
    for (fits, what, remedy) in [
        (
            routes().next().is_some(),
            "no robot plans on the map",
            "give a law \"route\" or \"formation\", or leave it out",
        ),
        (
            routes().all(|route| route.params.exit != ExitRule::Ray),
            "exit = \"ray\" ignores the land beyond the window",
            "give exit = \"best\"",
        ),
        (
            routes().all(|route| route.replan != Replan::UntilChanged),
            "replan = \"until_changed\" plans routes in the window only",
            "give \"each_cell\"",
        ),
        (
            !laws.iter().any(|law| matches!(law, LawSetup::Published(_))),
            "the paper's law knows the window alone",
            "give law = \"formation\", or leave it out",
        ),
    ] {
        draft.require(fits, field, what, remedy)?;
    }
    Ok(())
}
