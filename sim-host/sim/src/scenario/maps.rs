//! `[maps]`: exchange of terrain maps between robots.

use super::params::FormationLaw;
use super::source::Source;
use super::{PlaneSetup, ScenarioError, ScenarioFile};
use crate::{defaults, table};
use staya_controller::agent::RouteSetup;
use staya_controller::land::MapParams;
use staya_controller::route::{ExitRule, Replan};
use staya_controller::time::Duration;

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

pub(super) fn sharing(
    source: &Source<'_>,
    file: &ScenarioFile,
    route: &RouteSetup,
    plane: Option<&PlaneSetup>,
) -> Result<Option<MapParams>, ScenarioError> {
    let mut params = MapParams::default();
    if let Some(seconds) = file.maps.forget_after_s {
        params.forget_after = Duration::from_micros((seconds * 1e6) as i32);
    }
    if !file.maps.share {
        let what = "no robot shares a map";
        let is_alone = file.maps.forget_after_s.is_some();
        return if is_alone {
            Err(source.error("maps.forget_after_s", what, "give maps.share = true, or leave it out"))
        } else {
            Ok(None)
        };
    }
    let refused = |what: &str, remedy: &str| Err(source.error("maps.share", what, remedy));
    if plane.is_some_and(|plane| !plane.kinds().any(|group| group.guidance.kind().is_on_grid())) {
        return refused("no robot plans on the map", "give a guidance \"route\" or \"formation\", or leave it out");
    }
    if route.params.exit == ExitRule::Ray {
        return refused("route.exit = \"ray\" ignores the land beyond the window", "give exit = \"best\"");
    }
    if route.replan == Replan::UntilChanged {
        return refused("route.replan = \"until_changed\" plans routes in the window only", "give \"each_cell\"");
    }
    if file.scouting.is_some() {
        return refused("robots that have a map ([scouting]) plan by that one", "leave one of the two out");
    }
    if file.formation.law == Some(FormationLaw::Paper) {
        return refused("the paper's law knows the window alone", "give formation.law = \"staya\", or leave it out");
    }
    Ok(Some(params))
}
