//! Energy and motion of an alpha flock by the theorems of R. Olfati-Saber 2006 (OLF): the energy
//! among obstacles (theorem 6 of the paper's section VII.E), the damping by obstacles (theorem 5),
//! the decomposition of motion (section IV), and stress elements (equations 43 and 44).
//!
//! The paper's terms are those of continuous time. A run has steps, so its energy may rise by their
//! error, which falls with them.

use super::{Kind, Probe};
use staya_controller::agent::LawSettings;
use staya_controller::body::Body;
use staya_controller::flock::action::{PhiAlpha, PhiBeta, SPACING, sigma_norm, sigmoid_shift};
use staya_controller::flock::beta::beta_agent;
use staya_controller::geom::Vec3;
use staya_controller::lattice::{Algorithm, Gain, LatticeParams, ReferenceMotion, acceleration};
use staya_controller::neighbor::Nearby;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::engine::{Moment, Outcome};
use staya_sim::metrics::flock::EnergyMeter;
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use staya_sim::world::plane::Solid;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "energy",
    measures: &[
        ("held", "share of ticks in which condition (60) of theorem 6 holds"),
        ("rise", "largest rise of the energy H in a tick, while (60) holds, over the largest fall of H"),
        ("rise_beyond", "the same while (60) does not hold"),
        ("rise_without", "the same as rise, of H without the potential of obstacles"),
        ("lost", "share of the energy above its least that is lost at the end"),
        ("obstacles", "largest potential of obstacles over the largest fall of H"),
        ("damping", "greatest power of the velocity term of obstacles on a robot, in the paper's units: at most 0"),
        ("least_damping", "the least such power"),
        ("center_off", "largest distance of the centroid from that of the translational dynamics, in spacings"),
        ("stress_off", "largest difference of the force by stress elements and by the law, over the largest force"),
        ("stress", "root mean square of the stress elements at the end"),
        ("first_stress", "the same at the start"),
        ("separating", "share of robots that move away from the weighted middle of their neighbours at the end"),
        ("first_separating", "the same at the start"),
    ],
    new: |scenario| Box::new(Probed { state: State::new(scenario) }),
};

/// Ticks between two comparisons of forces.
const COMPARED: u32 = 50;

/// `None` if the robots are not an alpha flock.
struct Probed {
    state: Option<State>,
}

struct State {
    params: LatticeParams<f64>,
    meter: EnergyMeter<3>,
    phi: PhiAlpha<f64>,
    phi_beta: PhiBeta<f64>,
    solids: Vec<Solid>,
    reference_mps: [f64; 3],
    /// Where the reference is at the start, and its motion.
    start_m: [f64; 3],
    moves: bool,
    tick_s: f64,
    last: Option<Total>,
    most: f64,
    least: f64,
    end: f64,
    held: u32,
    ticks: u32,
    rises: [f64; 3],
    obstacles: f64,
    powers: [f64; 2],
    center: Option<[[f64; 3]; 2]>,
    reference_m: [f64; 3],
    center_off_m: f64,
    stress_off: f64,
    stresses: Option<[Stress; 2]>,
}

/// The energy of a moment.
#[derive(Clone, Copy)]
struct Total {
    /// H = T + V.
    all: f64,
    obstacles: f64,
    /// Whether condition (60) holds.
    held: bool,
}

/// Stress elements of a moment.
#[derive(Clone, Copy)]
struct Stress {
    rms: f64,
    separating: f64,
}

impl State {
    fn new(scenario: &Scenario) -> Option<Self> {
        let plane = scenario.plane()?;
        let Some(LawSettings::Lattice(lattice)) = plane.group(0).law.built_in() else { return None };
        let params: LatticeParams<f64> = lattice.params.cast();
        let (d, ratio) = (f64::from(SPACING), |ratio: f64| f64::from(SPACING) * ratio);
        let sigma = |length: f64| sigma_norm(length * length).sigma;
        let (a, b) = (params.attraction, params.repulsion);
        let phi =
            PhiAlpha { r_alpha: sigma(ratio(params.range_ratio)), d_alpha: sigma(d), a, b, c: sigmoid_shift(a, b)? };
        let target = plane.starts.first().and_then(|start| start.places.first());
        Some(Self {
            meter: EnergyMeter::new(&params)?,
            phi,
            phi_beta: PhiBeta { d_beta: sigma(ratio(params.obstacle_ratio)) },
            solids: plane.solids.clone(),
            reference_mps: target.map_or([0.0; 3], |target| target.velocity_mps),
            start_m: target.map_or([0.0; 3], |target| target.position_m),
            moves: lattice.motion() == ReferenceMotion::Dynamic,
            tick_s: scenario.tick_s(),
            params,
            last: None,
            most: f64::NEG_INFINITY,
            least: f64::INFINITY,
            end: f64::NAN,
            held: 0,
            ticks: 0,
            rises: [0.0; 3],
            obstacles: 0.0,
            powers: [f64::NEG_INFINITY, f64::INFINITY],
            center: None,
            reference_m: [0.0; 3],
            center_off_m: 0.0,
            stress_off: 0.0,
            stresses: None,
        })
    }

    /// Kinetic energy, potentials and condition (60), for a static reference.
    fn total(&mut self, places_m: &[[f64; 3]], velocities_mps: &[[f64; 3]]) -> Option<Total> {
        let lattice = self.meter.look(places_m, velocities_mps)?.lattice;
        let square = self.meter.units() * self.meter.units();
        let kinetic: f64 = velocities_mps.iter().map(|v| square * dot(*v, *v) / 2.0).sum();
        let (mut obstacles, mut pull) = (0.0, 0.0);
        for place in places_m {
            obstacles += self.solids.iter().map(|solid| self.meter.obstacle(solid.distance_m(*place))).sum::<f64>();
            pull += self.meter.pull(minus(*place, self.reference_m));
        }
        let demanded = square * velocities_mps.iter().map(|v| dot(*v, self.reference_mps)).sum::<f64>() / 2.0;
        Some(Total { all: kinetic + lattice + obstacles + pull, obstacles, held: demanded <= kinetic })
    }

    /// Powers c2 b p (p^ - p) of the velocity terms of obstacles, in the paper's units.
    fn damp(&mut self, place_m: [f64; 3], velocity_mps: [f64; 3]) {
        let (at, velocity, units) = (vec(place_m), vec(velocity_mps), self.meter.units());
        for agent in self.solids.iter().filter_map(|solid| beta_agent(&solid.seen_from(place_m), velocity)) {
            let distance = (agent.distance_m * units).max(0.0);
            let z = sigma_norm(distance * distance).sigma;
            let gain = self.params.beta.velocity * self.phi_beta.adjacency(z);
            if gain > 0.0 && at.is_finite() {
                let power = gain * units * units * velocity.dot(agent.velocity_mps - velocity);
                self.powers = [self.powers[0].max(power), self.powers[1].min(power)];
            }
        }
    }

    /// Compares u_i = sum s_ij (q_j - q_i) with the law on robots at rest. O(n^2).
    fn stress(&mut self, places_m: &[[f64; 3]]) -> Stress {
        let params =
            LatticeParams { algorithm: Algorithm::One, alpha: Gain { position: 1.0, velocity: 0.0 }, ..self.params };
        let units = self.meter.units();
        let (mut squares, mut links, mut separating) = (0.0, 0_u32, 0_u32);
        let (mut off, mut largest) = (0.0_f64, 0.0_f64);
        for (robot, place) in places_m.iter().enumerate() {
            let near = places_m
                .iter()
                .enumerate()
                .filter(|(other, at)| *other != robot && length(minus(**at, *place)) < params.range_m());
            let nearby: Vec<Nearby<f64>> = near.map(|(other, at)| nearby(other, minus(*at, *place))).collect();
            let (mut sum, mut total) = (Vec3::ZERO, 0.0);
            for other in &nearby {
                let offset = other.offset_m * units;
                let z = sigma_norm(offset.norm_squared()).sigma;
                // The slope of the sigma norm is 1 / (1 + e ||z||_sigma), as in equation 43.
                let element = self.phi.at(z, self.phi.adjacency(z)) / (1.0 + z / 10.0);
                sum += offset * element;
                total += element;
                squares += element * element;
                links += 1;
            }
            separating += u32::from(total < 0.0);
            let law = acceleration(&params, &at_rest(robot), &nearby, &[], None) * units;
            off = off.max((law - sum).norm());
            largest = largest.max(law.norm());
        }
        if largest > 0.0 {
            self.stress_off = self.stress_off.max(off / largest);
        }
        let rms = libm::sqrt(squares / f64::from(links.max(1)));
        Stress { rms, separating: f64::from(separating) / places_m.len() as f64 }
    }

    /// The step of the translational dynamics from the last moment to this one: that of a robot
    /// with the pull of algorithm 2 alone.
    fn follow(&mut self, center_m: [f64; 3], center_mps: [f64; 3]) {
        let Gain { position, velocity } = self.params.gamma;
        let [place, speed] = self.center.unwrap_or([center_m, center_mps]);
        if self.center.is_none() {
            self.center = Some([place, speed]);
            return;
        }
        let next = std::array::from_fn(|axis| {
            let pull = position * (self.reference_m[axis] - place[axis]);
            speed[axis] + self.tick_s * (pull + velocity * (self.reference_mps[axis] - speed[axis]))
        });
        let place = std::array::from_fn(|axis: usize| place[axis] + self.tick_s * next[axis]);
        self.center = Some([place, next]);
        self.center_off_m = self.center_off_m.max(length(minus(place, center_m)));
    }

    fn look(&mut self, moment: &Moment<'_>, places_m: &[[f64; 3]], velocities_mps: &[[f64; 3]]) {
        self.follow(mean(places_m), mean(velocities_mps));
        let span_s = if self.moves { moment.row.time_s } else { 0.0 };
        self.reference_m = std::array::from_fn(|axis| self.start_m[axis] + span_s * self.reference_mps[axis]);
        for (place, velocity) in places_m.iter().zip(velocities_mps) {
            self.damp(*place, *velocity);
        }
        if moment.row.tick.is_multiple_of(COMPARED) {
            let stress = self.stress(places_m);
            self.stresses = Some([self.stresses.map_or(stress, |[first, _]| first), stress]);
        }
        let Some(now) = self.total(places_m, velocities_mps) else { return };
        self.most = self.most.max(now.all);
        self.least = self.least.min(now.all);
        self.end = now.all;
        self.obstacles = self.obstacles.max(now.obstacles);
        if let Some(last) = self.last.replace(now) {
            let rise = now.all - last.all;
            let without = rise - (now.obstacles - last.obstacles);
            let held = last.held && now.held;
            self.ticks += 1;
            self.held += u32::from(held);
            let rises = if held { [rise, 0.0, without] } else { [0.0, rise, 0.0] };
            self.rises.iter_mut().zip(rises).for_each(|(largest, rise)| *largest = largest.max(rise));
        }
    }

    fn values(&self) -> Vec<Option<f64>> {
        let fall = Some(self.most - self.least).filter(|fall| fall.is_finite() && *fall > 0.0);
        let over = |energy: f64| fall.map(|fall| energy / fall);
        let power = |power: f64| power.is_finite().then_some(power);
        let [first, last] = [0, 1].map(|moment| self.stresses.map(|stresses| stresses[moment]));
        vec![
            (self.ticks > 0).then(|| f64::from(self.held) / f64::from(self.ticks)),
            over(self.rises[0]),
            over(self.rises[1]),
            over(self.rises[2]),
            over(self.most - self.end),
            over(self.obstacles),
            power(self.powers[0]),
            power(self.powers[1]),
            Some(self.center_off_m / self.params.spacing_m).filter(|off| off.is_finite()),
            Some(self.stress_off),
            last.map(|stress| stress.rms),
            first.map(|stress| stress.rms),
            last.map(|stress| stress.separating),
            first.map(|stress| stress.separating),
        ]
    }
}

fn nearby(other: usize, offset_m: [f64; 3]) -> Nearby<f64> {
    Nearby {
        id: RobotId(other as u32 + 1),
        offset_m: vec(offset_m),
        velocity_mps: Vec3::ZERO,
        radius_m: 0.0,
        gives_way: true,
        mode: Mode::Cruise,
        is_stranger: false,
    }
}

fn at_rest(robot: usize) -> Body<f64> {
    Body {
        id: RobotId(robot as u32 + 1),
        velocity_mps: Vec3::ZERO,
        radius_m: 0.0,
        max_speed_mps: f64::MAX,
        max_acceleration_mps2: f64::MAX,
        step_s: 0.01,
    }
}

const fn vec([x, y, z]: [f64; 3]) -> Vec3<f64> {
    Vec3 { x, y, z }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn length(a: [f64; 3]) -> f64 {
    libm::sqrt(dot(a, a))
}

fn mean(vectors: &[[f64; 3]]) -> [f64; 3] {
    let sum = vectors.iter().fold([0.0; 3], |sum, vector| std::array::from_fn(|axis| sum[axis] + vector[axis]));
    sum.map(|c| c / vectors.len() as f64)
}

impl Probe for Probed {
    fn tick(&mut self, moment: &Moment<'_>, robots: &[RobotRow]) -> ControlFlow<()> {
        if let Some(state) = &mut self.state {
            let motion = |robot: &RobotRow| (robot.motion.position_m, robot.motion.velocity_mps);
            let (places_m, velocities_mps): (Vec<_>, Vec<_>) = robots.iter().map(motion).unzip();
            state.look(moment, &places_m, &velocities_mps);
        }
        ControlFlow::Continue(())
    }

    fn values(&self, _: &Scenario, _: &Outcome) -> Vec<Option<f64>> {
        self.state.as_ref().map_or(vec![None; KIND.measures.len()], State::values)
    }
}
