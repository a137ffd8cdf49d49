//! The alpha flock: robots that settle at equal distances, follow a reference and avoid obstacles.
//! Start with [`acceleration`].
//!
//! Source: R. Olfati-Saber 2006, "Flocking for multi-agent dynamic systems: algorithms and theory",
//! IEEE TAC 51(3), algorithms 1 to 3 (section VII). See also [`crate::flock::action`] and
//! [`crate::flock::beta`].
//!
//! **Any size.** The law's constants (e, sigma_1) are made for a spacing of 7. So it is computed in
//! units of d / 7 metres and its acceleration scaled back. Time is not scaled (a gain c1 is in
//! 1/s^2), so settling time and step are independent of d, and speeds scale with d: at d = 0.5 m a
//! robot approaches at 1/14 of the paper's speed, and 5 units/s in the paper are 0.36 m/s.
//!
//! **Differences to the paper:**
//!
//! - Robots in one place separate by [`tie`], as strongly as one unit (d / 7) apart.
//! - A robot inside an obstacle, or exactly on its border, is pushed out along the normal as
//!   strongly as one unit in front of it; the paper's force points inwards there. A wall has no
//!   inside: a robot that has crossed it is pushed further.
//! - Values that are not a number contribute nothing.
//! - Robots of another flock ([`Nearby::is_stranger`]) push like those of the own flock, but
//!   neither pull nor pass on their velocity. The more of them are in the way, the more the pull of
//!   the reference turns to the right. Otherwise lattices interlock like combs.
//! - In a gap for one robot, two robots side by side stop forever, since those behind push them at
//!   each other. With [`Algorithm::ThreeInTurn`] the robot nearer to the reference goes first: the
//!   pull of the reference on the other robot, and the velocity that it demands, fade from full at
//!   a distance of d to zero at 0.8 d, as long as the reference is ahead. Robots behind do not hold
//!   the first back. So a crowd before a gap waits in a queue and does not push.
//!
//! **Delayed beacons.** The known state of a neighbour is as old as the delay plus up to a beacon
//! period. A stiff lattice then oscillates until it breaks: at a delay of 0.1 s gains of (10, 6.3)
//! leave pieces that never settle. [`LatticeParams::stable_for`] reduces the gains as far as
//! required; [`LatticeParams::oldest_news_s`] returns the age that given gains tolerate.
//!
//! **Limits.** Repulsion is bounded and vanishes at contact: robots that approach at more than
//! about 2 d per second pass through each other. The law knows points, not bodies: choose d well
//! above two radii, 0.6 d above one, and add a safety layer.

#[cfg(feature = "agent")]
mod law;
mod reference;
#[cfg(feature = "agent")]
mod settings;

#[cfg(all(test, feature = "micromath"))]
mod tests;

#[cfg(feature = "agent")]
pub use law::LatticeGuidance;
#[cfg(feature = "agent")]
pub use settings::{GAMMA_OF_TWO, LatticeSettings};

use crate::body::Body;
use crate::flock::action::{PhiAlpha, PhiBeta, SPACING, SigmaNorm, sigma_1, sigma_norm, sigmoid_shift};
use crate::flock::beta::beta_agent;
use crate::geom::Vec3;
use crate::neighbor::{Nearby, tie};
use crate::obstacle::Obstacle;
use crate::parameters::row;
use crate::scalar::{Scalar, cast};
pub use reference::ReferenceMotion;
use serde::{Deserialize, Serialize};

/// The active terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Algorithm {
    /// Only the other robots: the group breaks up unless it starts as one.
    One,
    /// Also the reference, with a pull that grows with distance without bound.
    Two,
    /// Also obstacles; the pull of the reference is bounded.
    #[default]
    Three,
    /// Like [`Algorithm::Three`], but no robot pushes one nearer to the reference.
    ThreeInTurn,
}

/// The two gains of one type of agent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gain<S> {
    /// On positions (c1), 1/s^2 in the paper's units; at least 0.
    pub position: S,
    /// On velocities (c2), 1/s; at least 0.
    pub velocity: S,
}

impl<S: Scalar> Gain<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Gain<T> {
        Gain { position: cast(self.position), velocity: cast(self.velocity) }
    }

    /// 1 and 1: algorithm 1 as in the paper.
    #[must_use]
    pub fn one() -> Self {
        Self { position: S::ONE, velocity: S::ONE }
    }

    /// c2 = 2 sqrt(c1): critical damping, as in the paper's simulations.
    #[must_use]
    pub fn critical(position: S) -> Self {
        Self { position, velocity: S::TWO * position.sqrt() }
    }

    fn is_sound(&self) -> bool {
        let fits = |gain: S| gain >= S::ZERO && gain.is_finite();
        fits(self.position) && fits(self.velocity)
    }
}

/// Parameters of the alpha flock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LatticeParams<S> {
    /// The active terms.
    pub algorithm: Algorithm,
    /// Distance of neighbours in the lattice (d), metres; 0.01 to 100. Choose more than two radii
    /// plus the distance that a robot covers in half a second.
    pub spacing_m: S,
    /// Range of interaction over spacing (r / d); above 1, at most 4. A larger range forms groups
    /// more easily; from sqrt 3 on, second neighbours compress the lattice.
    pub range_ratio: S,
    /// Distance kept from obstacles over spacing (d' / d); above 0, at most 4. The larger, the
    /// wider the narrowest passage that robots still take.
    pub obstacle_ratio: S,
    /// Attraction (a of phi, 0 < a <= b): upper bound of phi_alpha.
    pub attraction: S,
    /// Repulsion (b of phi): -b is the lower bound of phi_alpha.
    pub repulsion: S,
    /// Gains between robots (c_alpha). Higher gains give a stiffer lattice and need a shorter step:
    /// (10, 6.3) works up to 0.05 s, (50, 14) up to 0.03 s; (10, 6.3) at 0.2 s breaks apart.
    pub alpha: Gain<S>,
    /// Gains of obstacles (c_beta). Well above the others, or robots behind push those in front:
    /// with (5, 50, 2) 150 robots in a narrow passage pass through each other.
    pub beta: Gain<S>,
    /// Gains of the reference (c_gamma). Higher gains gather faster and compress the lattice: in
    /// algorithm 2, 150 robots need c1_alpha above 25 c1_gamma for a deviation of 0.005 d^2. In
    /// algorithm 3 the pull on positions is bounded, and the paper has c1_alpha < c1_gamma <
    /// c1_beta. Then a static reference gathers a flock that obstacles have split: 150 robots with
    /// (60, 200, 80) behind ORCA with a horizon of 0.3 s. Below c1_alpha, parts stay apart. The
    /// flock passes the reference and moves at its velocity less sqrt(c1_gamma) / 2 in the
    /// paper's units: the slower, the better the parts behind catch up.
    pub gamma: Gain<S>,
}

impl<S: Scalar> LatticeParams<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> LatticeParams<T> {
        LatticeParams {
            algorithm: self.algorithm,
            spacing_m: cast(self.spacing_m),
            range_ratio: cast(self.range_ratio),
            obstacle_ratio: cast(self.obstacle_ratio),
            attraction: cast(self.attraction),
            repulsion: cast(self.repulsion),
            alpha: self.alpha.cast(),
            beta: self.beta.cast(),
            gamma: self.gamma.cast(),
        }
    }

    /// Algorithm 3 with the paper's ratios, critical damping, and gains of 10, 200 and 2 on
    /// positions: 150 robots pass the paper's two obstacle courses without contact.
    ///
    /// That is for a reference that moves or rests ([`ReferenceMotion`]). It is not the paper's
    /// order, c1_alpha < c1_gamma < c1_beta, which a static reference needs ([`Self::gamma`]): with
    /// (10, 200, 12) robots overlap on both courses without a safety layer, and the lattice of
    /// (60, 200, 80) tolerates only beacons less than half as old ([`Self::oldest_news_s`]).
    #[must_use]
    pub fn new(spacing_m: S) -> Self {
        Self {
            algorithm: Algorithm::Three,
            spacing_m,
            range_ratio: S::from_ratio(6, 5),
            obstacle_ratio: S::from_ratio(3, 5),
            attraction: S::from_i32(5),
            repulsion: S::from_i32(5),
            alpha: Gain::critical(S::from_i32(10)),
            beta: Gain::critical(S::from_i32(200)),
            gamma: Gain::critical(S::TWO),
        }
    }

    /// Whether all parameters are in the ranges stated; if not, [`acceleration`] is zero.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        Law::new(self).is_some()
    }

    /// Reduces the gains to those that are stable with beacons that are `delay_s` old and arrive
    /// `rate_hz` times per second.
    ///
    /// Stable gains are unchanged. Otherwise those of robots and reference (c_alpha, c_gamma)
    /// decrease in proportion, with the same damping ratio; those of obstacles, which a robot
    /// senses itself, do not. A delay that is not at least 0 counts as 0, a rate that is not above
    /// 0 as the slowest possible. Constant work.
    #[must_use]
    pub fn stable_for(mut self, delay_s: S, rate_hz: S) -> Self {
        let period = S::ONE.checked_div(rate_hz.max(S::ZERO)).unwrap_or(S::MAX);
        let news_s = delay_s.max(S::ZERO) + period;
        let bearable = self.oldest_news_s();
        if news_s > bearable {
            // sqrt(c1) falls with the age of beacons, and c2 = 2 sqrt(c1) with it.
            let softer = bearable.checked_div(news_s).unwrap_or(S::ZERO);
            for gain in [&mut self.alpha, &mut self.gamma] {
                gain.position = gain.position * softer * softer;
                gain.velocity *= softer;
            }
        }
        self
    }

    /// The age of a neighbour's state that these gains tolerate, seconds: its delay plus the time
    /// between two beacons. The largest number if nothing pulls.
    ///
    /// The bound is 1/5 of 1 / sqrt(c_alpha), the time in which the lattice responds. The fifth is
    /// measured (see the tests of this module): at delays of 0 to 0.25 s and steps of 0.04 to 0.2 s
    /// robots settle with it, and oscillate from 0.47 on.
    #[must_use]
    pub fn oldest_news_s(&self) -> S {
        let answer = self.alpha.position.max(S::ZERO).sqrt() * S::from_i32(5);
        S::ONE.checked_div(answer).unwrap_or(S::MAX)
    }

    /// Range of interaction r, metres: neighbours farther away are ignored.
    #[must_use]
    pub fn range_m(&self) -> S {
        self.spacing_m * self.range_ratio
    }
}

crate::parameters! {
    impl[S: Scalar] LatticeParams<S>, where is_sound {
        row("spacing_m", "LAT_SPACING_M", "m", [0.01, 100.0], "distance of neighbours in the lattice (d)")
            .needed() => spacing_m,
        row("range_ratio", "LAT_RANGE", "", [1.001, 4.0], "range of interaction over spacing") => range_ratio,
        row("obstacle_ratio", "LAT_OBSTACLE", "", [0.001, 4.0], "distance from obstacles over spacing")
            => obstacle_ratio,
        row("attraction", "LAT_A", "", [0.001, 1000.0], "bound of the attraction (a)") => attraction,
        row("repulsion", "LAT_B", "", [0.001, 1000.0], "bound of the repulsion (b), not less than a") => repulsion,
        row("c1_alpha", "LAT_C1_ALPHA", "1/s^2", [0.0, 1000.0], "robots among each other, on places")
            .depends("by the delay of the radio") => alpha.position,
        row("c2_alpha", "LAT_C2_ALPHA", "1/s", [0.0, 1000.0], "robots among each other, on velocities")
            .depends("2 sqrt(`c1_alpha`)") => alpha.velocity,
        row("c1_beta", "LAT_C1_BETA", "1/s^2", [0.0, 10_000.0], "obstacles, on places") => beta.position,
        row("c2_beta", "LAT_C2_BETA", "1/s", [0.0, 1000.0], "obstacles, on velocities")
            .depends("2 sqrt(`c1_beta`)") => beta.velocity,
        row("c1_gamma", "LAT_C1_GAMMA", "1/s^2", [0.0, 1000.0], "the reference, on places")
            .depends("by the delay of the radio") => gamma.position,
        row("c2_gamma", "LAT_C2_GAMMA", "1/s", [0.0, 1000.0], "the reference, on velocities")
            .depends("2 sqrt(`c1_gamma`)") => gamma.velocity,
    }
}

/// The point that the flock follows (the gamma-agent), moved by [`ReferenceMotion`].
///
/// The velocity of a static one need not be zero: it pulls the flock past a fixed point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reference<S> {
    /// Its position minus the own one (q_r - q), metres.
    pub offset_m: Vec3<S>,
    /// Its velocity (p_r), m/s.
    pub velocity_mps: Vec3<S>,
}

/// The acceleration of robot `body`, m/s^2 (u of the paper): u_alpha + u_beta + u_gamma.
///
/// With all z zero the result has z = 0. `nearby` may be in any order, and radii are ignored. The
/// result is finite for any input, zero for invalid parameters, and may exceed the capability of
/// the body: see [`Body::reach`]. O(nearby + obstacles): each takes two roots and a cosine, a
/// neighbour a third root in [`Algorithm::ThreeInTurn`].
#[must_use]
#[inline(never)]
pub fn acceleration<S: Scalar>(
    params: &LatticeParams<S>,
    body: &Body<S>,
    nearby: &[Nearby<S>],
    obstacles: &[Obstacle<S>],
    reference: Option<&Reference<S>>,
) -> Vec3<S> {
    let Some(law) = Law::new(params) else {
        return Vec3::ZERO;
    };
    let way = reference.and_then(|reference| reference.offset_m.normalized()).unwrap_or(Vec3::ZERO);
    let (mut sum, mut turn) = (Vec3::ZERO, S::ZERO);
    let mut add = |term: Vec3<S>| {
        let next = sum + term;
        if next.is_finite() {
            sum = next;
        }
    };
    let in_turn = reference.filter(|reference| {
        params.algorithm == Algorithm::ThreeInTurn && reference.offset_m.dot(reference.velocity_mps) >= S::ZERO
    });
    for other in nearby {
        let is_after = in_turn.is_some_and(|reference| !goes_first(other, body, reference));
        add(law.alpha(body, other, is_after));
        if other.is_stranger {
            turn += law.turn(way, other);
        }
    }
    if matches!(params.algorithm, Algorithm::Three | Algorithm::ThreeInTurn) {
        for obstacle in obstacles {
            add(law.beta(body, obstacle));
        }
    }
    if params.algorithm != Algorithm::One
        && let Some(reference) = reference
    {
        let share = in_turn.map_or(S::ONE, |reference| law.share(body, nearby, reference));
        add(law.gamma(body, reference, turn, share));
    }
    sum
}

struct Law<'a, S> {
    params: &'a LatticeParams<S>,
    /// 7 / d.
    units: S,
    metres: S,
    range_squared: S,
    obstacle_distance: S,
    phi_alpha: PhiAlpha<S>,
    phi_beta: PhiBeta<S>,
}

impl<'a, S: Scalar> Law<'a, S> {
    fn new(params: &'a LatticeParams<S>) -> Option<Self> {
        let spacing = S::from_i32(SPACING);
        let metres = params.spacing_m.checked_div(spacing)?;
        let (range_ratio, obstacle_ratio) = (params.range_ratio, params.obstacle_ratio);
        let is_sound = params.spacing_m >= S::from_ratio(1, 100)
            && params.spacing_m <= S::from_i32(100)
            && range_ratio > S::ONE
            && range_ratio <= S::from_i32(4)
            && obstacle_ratio > S::ZERO
            && obstacle_ratio <= S::from_i32(4)
            && [params.alpha, params.beta, params.gamma].iter().all(Gain::is_sound);
        let (a, b) = (params.attraction, params.repulsion);
        let c = sigmoid_shift(a, b).filter(|_| is_sound)?;
        let range = spacing * range_ratio;
        let range_squared = range * range;
        let obstacle_distance = spacing * obstacle_ratio;
        Some(Self {
            params,
            units: spacing.checked_div(params.spacing_m)?,
            metres,
            range_squared,
            obstacle_distance,
            phi_alpha: PhiAlpha {
                r_alpha: sigma_norm(range_squared).sigma,
                d_alpha: sigma_norm(spacing * spacing).sigma,
                a,
                b,
                c,
            },
            phi_beta: PhiBeta { d_beta: sigma_norm(obstacle_distance * obstacle_distance).sigma },
        })
    }

    /// c1 phi_alpha(||q_j - q_i||_sigma) n_ij + c2 a_ij (p_j - p_i), m/s^2. A neighbour that
    /// `is_after` does not hold back.
    fn alpha(&self, body: &Body<S>, other: &Nearby<S>, is_after: bool) -> Vec3<S> {
        let offset = other.offset_m * self.units;
        let squared = offset.norm_squared();
        // Fixed point saturates beyond the range.
        let is_near = squared < self.range_squared;
        if !is_near || other.id == body.id {
            return Vec3::ZERO;
        }
        let SigmaNorm { sigma, slope } = sigma_norm(squared);
        let adjacency = self.phi_alpha.adjacency(sigma);
        let n_ij = if other.offset_m == Vec3::ZERO {
            tie(other.id, body.id).extend(S::ZERO) * sigma_norm(S::ONE).slope
        } else {
            offset * slope
        };
        let (mut phi, mut gain) = (self.phi_alpha.at(sigma, adjacency), self.params.alpha.velocity * adjacency);
        if other.is_stranger {
            (phi, gain) = (phi.min(S::ZERO), S::ZERO);
        } else if is_after {
            phi = phi.min(S::ZERO);
        }
        let pull = self.params.alpha.position * phi;
        n_ij * (pull * self.metres) + drag(gain, other.velocity_mps - body.velocity_mps)
    }

    /// c1 phi_beta(||q^ - q||_sigma) n^ + c2 b (p^ - p), m/s^2.
    fn beta(&self, body: &Body<S>, obstacle: &Obstacle<S>) -> Vec3<S> {
        let own_velocity = body.velocity_mps;
        let known_velocity = if own_velocity.is_finite() { own_velocity } else { Vec3::ZERO };
        let Some(agent) = beta_agent(obstacle, known_velocity) else {
            return Vec3::ZERO;
        };
        let distance = agent.distance_m * self.units;
        let is_near = distance < self.obstacle_distance;
        if !is_near {
            return Vec3::ZERO;
        }
        let is_inside = agent.distance_m <= S::ZERO;
        let outside = if is_inside { S::ZERO } else { distance };
        let SigmaNorm { sigma, slope } = sigma_norm(outside * outside);
        let adjacency = self.phi_beta.adjacency(sigma);
        let length = if is_inside { sigma_norm(S::ONE).slope } else { outside * slope };
        let push = -(self.params.beta.position * self.phi_beta.at(sigma, adjacency)) * length;
        let gain = self.params.beta.velocity * adjacency;
        agent.normal * (push * self.metres) + drag(gain, agent.velocity_mps - known_velocity)
    }

    /// How much a stranger is in the `way` (a unit vector), 0 to 1; 0 from three spacings on.
    fn turn(&self, way: Vec3<S>, other: &Nearby<S>) -> S {
        let reach_m = self.params.spacing_m * S::from_i32(3);
        let distance = other.offset_m.norm();
        let nearness = S::ONE - distance.checked_div(reach_m).unwrap_or(S::ONE);
        let ahead = way.dot(other.offset_m).checked_div(distance).unwrap_or(S::ZERO);
        let is_in_the_way = nearness > S::ZERO && ahead > S::ZERO;
        if is_in_the_way { nearness * ahead } else { S::ZERO }
    }

    /// The share of the reference, 0 to 1: below 1 if a nearby robot of the flock goes first.
    fn share(&self, body: &Body<S>, nearby: &[Nearby<S>], reference: &Reference<S>) -> S {
        nearby.iter().filter(|other| goes_first(other, body, reference)).fold(S::ONE, |share, other| {
            let spacings = other.offset_m.norm().checked_div(self.params.spacing_m).unwrap_or(S::ONE);
            // Full at d, zero at 0.8 d: with zero at d / 2, pairs stopped at 0.9 d and jammed.
            share.min((spacings * S::from_i32(5) - S::from_i32(4)).max(S::ZERO))
        })
    }

    /// -c1 sigma_1(q - q_r) - c2 (p - p_r), in algorithm 2 without sigma_1; m/s^2. The pull is
    /// turned to the right by about `turn` of a quarter turn.
    fn gamma(&self, body: &Body<S>, reference: &Reference<S>, turn: S, share: S) -> Vec3<S> {
        let Gain { position, velocity } = self.params.gamma;
        let mut way = reference.offset_m;
        if turn > S::ZERO {
            let (turn, right) = (turn.min(S::ONE), Vec3::new(way.y, -way.x, S::ZERO));
            way = way * (S::ONE - turn) + right * turn;
        }
        let pull = if self.params.algorithm == Algorithm::Two {
            way * position
        } else {
            let distance = way.norm() * self.units;
            let direction = way.normalized().unwrap_or(Vec3::ZERO);
            direction * (position * sigma_1(distance) * self.metres)
        };
        let pull = if pull.is_finite() { pull } else { Vec3::ZERO };
        pull * share + drag(velocity, reference.velocity_mps * share - body.velocity_mps)
    }
}

/// Whether `other` is nearer to the reference, or as near with a smaller number.
fn goes_first<S: Scalar>(other: &Nearby<S>, body: &Body<S>, reference: &Reference<S>) -> bool {
    let (way, other_way) = (reference.offset_m, reference.offset_m - other.offset_m);
    let is_nearer = (other_way.length_key(), other.id) < (way.length_key(), body.id);
    is_nearer && !other.is_stranger && other.id != body.id
}

fn drag<S: Scalar>(gain: S, relative_mps: Vec3<S>) -> Vec3<S> {
    let term = relative_mps * gain;
    if term.is_finite() { term } else { Vec3::ZERO }
}
