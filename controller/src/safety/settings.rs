//! Settings of the safety layers.

use super::{AnyHalfPlanes, FlySafety, OrcaSafety, PushOutSafety, Safety, Unguarded};
use crate::law::{Around, Contradiction, Settings};
use crate::neighbor::StalenessInflation;
use crate::orca::{AvoidParams, InSpace};
use crate::parameters::{Parameters, Value, choice, row, switch, worded};
use crate::push_out::{Evasion, Model, PushOutParams};
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// [`Settings`] from which a safety layer of scalar type `S` with at most `K` half-planes is made.
pub trait MakesLayer<S: Scalar, const K: usize>: Settings {
    /// The layer.
    type Layer: Safety<S>;

    /// Creates the layer.
    fn layer(&self) -> Self::Layer;
}

/// Settings of [`Unguarded`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UnguardedSettings;

impl Settings for UnguardedSettings {
    const NAME: &'static str = "none";
    const WHAT: &'static str = "no layer; for laws that avoid collisions themselves";

    fn tables(&mut self, _: &mut dyn FnMut(&mut dyn Parameters)) {}

    fn adapt(&mut self, _: &dyn Fn(&str) -> bool, _: &Around) -> Result<(), Contradiction> {
        Ok(())
    }
}

impl<S: Scalar, const K: usize> MakesLayer<S, K> for UnguardedSettings {
    type Layer = Unguarded;

    fn layer(&self) -> Unguarded {
        Unguarded
    }
}

/// Settings of [`OrcaSafety`] in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OrcaSettings {
    /// Parameters of the avoider.
    pub params: AvoidParams<f32>,
    /// Growth of the balls of silent robots.
    pub inflation: StalenessInflation<f32>,
}

crate::parameters! {
    impl[] OrcaSettings {
        row("inflation_mps", "ORCA_GROWTH_MPS", "m/s", [0.0, 1000.0], "growth rate of the ball around a silent robot")
            .depends("the highest speed of any robot") => inflation.growth_mps,
        row("inflation_m", "ORCA_GROWTH_M", "m", [0.0, 1000.0], "largest growth of the ball around a lost robot")
            .depends("the radius") => inflation.max_m,
    }
}

impl OrcaSettings {
    /// Sets the values that are not given, `usual` among them.
    fn complete(
        &mut self,
        usual: AvoidParams<f32>,
        is_given: &dyn Fn(&str) -> bool,
        around: &Around,
    ) -> Result<(), Contradiction> {
        if !is_given("horizon_s") {
            self.params.horizon_s = usual.horizon_s.max(around.brake_s);
        } else if self.params.horizon_s < around.brake_s {
            let what = "less than 2 (max_speed_mps / max_acceleration_mps2 + lag_s)";
            let wrong = Contradiction::new("horizon_s", what, "give more, or leave it out");
            return Err(Contradiction { least: Some(around.brake_s), ..wrong });
        }
        if !is_given("inflation_mps") {
            self.inflation.growth_mps = around.fastest_mps;
        }
        if !is_given("inflation_m") {
            self.inflation.max_m = around.radius_m;
        }
        Ok(())
    }

    fn make<S: Scalar, const K: usize>(&self, source: AnyHalfPlanes) -> OrcaSafety<S, K, AnyHalfPlanes> {
        OrcaSafety::with_source(self.params.cast(), self.inflation.cast(), source)
    }
}

impl Settings for OrcaSettings {
    const NAME: &'static str = "orca";
    const WHAT: &'static str = "optimal reciprocal collision avoidance in the plane (ORCA)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
    }

    /// A flock has the longest look-ahead: its members move together, and have no places of their
    /// own that they could be late at.
    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        let usual = match around.has_goal {
            true => AvoidParams::for_body(around.radius_m, around.max_speed_mps),
            false => AvoidParams::default(),
        };
        self.complete(usual, is_given, around)
    }
}

impl<S: Scalar, const K: usize> MakesLayer<S, K> for OrcaSettings {
    type Layer = OrcaSafety<S, K, AnyHalfPlanes>;

    fn layer(&self) -> Self::Layer {
        self.make(AnyHalfPlanes::Analytic)
    }
}

/// Settings of [`OrcaSafety`] with half-planes from a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TableSettings(pub OrcaSettings);

impl Settings for TableSettings {
    const NAME: &'static str = "template_2k";
    const SECTION: &'static str = OrcaSettings::NAME;
    const WHAT: &'static str =
        "ORCA with half-planes from a table of 2 KiB, for parts without FPU (A. Tolok and others, FVM)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.0.tables(visit);
    }

    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        self.0.adapt(is_given, around)
    }
}

#[cfg(feature = "list_table")]
impl<S: Scalar, const K: usize> MakesLayer<S, K> for TableSettings {
    type Layer = OrcaSafety<S, K, AnyHalfPlanes>;

    fn layer(&self) -> Self::Layer {
        self.0.make(AnyHalfPlanes::Template2k)
    }
}

/// Settings of [`FlySafety`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FlySettings {
    /// The settings that it has in common with ORCA in the plane.
    pub orca: OrcaSettings,
    /// Ratio of the vertical to the horizontal distance between robots.
    pub downwash: f32,
}

crate::parameters! {
    impl[] FlySettings {
        row("downwash", "ORCA_DOWNWASH", "", [1.0, 10.0], "in space: ratio of the vertical to the horizontal separation")
            => downwash,
    }
}

impl Default for FlySettings {
    fn default() -> Self {
        Self { orca: OrcaSettings::default(), downwash: 1.0 }
    }
}

impl Settings for FlySettings {
    const NAME: &'static str = "fly";
    const SECTION: &'static str = OrcaSettings::NAME;
    const WHAT: &'static str = "ORCA in space, for flying robots, with downwash";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.orca.tables(visit);
        visit(self);
    }

    /// Flyers jam in a downwash with a shorter look-ahead.
    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        self.orca.complete(AvoidParams::default(), is_given, around)
    }
}

impl<S: Scalar, const K: usize> MakesLayer<S, K> for FlySettings {
    type Layer = FlySafety<S, K>;

    fn layer(&self) -> Self::Layer {
        let OrcaSettings { params, inflation } = &self.orca;
        FlySafety::with_source(params.cast(), inflation.cast(), InSpace { downwash: cast(self.downwash) })
    }
}

/// Settings of [`PushOutSafety`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PushOutSettings {
    /// Parameters of the layer.
    pub params: PushOutParams<f32>,
}

worded!(Model);

/// Whether only the nearest robot is evaded.
impl Value for Evasion {
    fn number(self) -> f32 {
        (self == Self::Single).number()
    }

    fn nearest(number: f32) -> Self {
        if Value::nearest(number) { Self::Single } else { Self::Multiple }
    }
}

crate::parameters! {
    impl[] PushOutSettings {
        choice("model", "PUSH_MODEL", Model::WORDS, "a step that leads too near slides along the border, or turns")
            => params.model,
        switch("single", "PUSH_SINGLE", "whether only the nearest robot in the way is avoided") => params.evasion,
    }
}

impl Default for PushOutSettings {
    /// With a least distance of one metre.
    fn default() -> Self {
        Self { params: PushOutParams::new(1.0) }
    }
}

impl Settings for PushOutSettings {
    const NAME: &'static str = "push_out";
    const WHAT: &'static str = "steps that lead too near to the present places of others end beside them (PAV)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
    }

    fn adapt(&mut self, _: &dyn Fn(&str) -> bool, _: &Around) -> Result<(), Contradiction> {
        Ok(())
    }
}

impl<S: Scalar, const K: usize> MakesLayer<S, K> for PushOutSettings {
    type Layer = PushOutSafety<S>;

    fn layer(&self) -> Self::Layer {
        PushOutSafety::new(self.params.cast())
    }
}
