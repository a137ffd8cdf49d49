//! Measures of an alpha flock (R. Olfati-Saber 2006, OLF, sections VII and VIII).

use super::{Kind, Probe};
use staya_controller::agent::LawSettings;
use staya_plot::{Chart, Panels, Series};
use staya_sim::engine::{Moment, Outcome};
use staya_sim::metrics::flock::{AlphaLimits, EnergyMeter, FlockMeasure, FlockMeter, alpha_flocking, crossings, gaps};
use staya_sim::nearby::Space;
use staya_sim::record::RobotRow;
use staya_sim::scenario::{PlaneSetup, Scenario};
use staya_sim::world::plane::Solid;
use std::f64::consts::{PI, SQRT_2};
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "flock",
    measures: &[
        ("alpha_from", "tick from which alpha-flocking holds (e0 = 0.2, e1 = 0.005, e2 = 0.001); empty: it does not"),
        ("connected_from", "tick from which all robots are connected; empty: they end apart"),
        ("most_parts", "largest number of connected parts at any time"),
        ("parts", "connected parts of the flock at the end; links are up to 1.2 spacings long"),
        ("connectivity", "relative connectivity C at the end"),
        ("radius_m", "cohesion radius R at the end"),
        ("deviation_energy", "E~ at the end"),
        ("velocity_mismatch", "K~ at the end, (m/s)^2"),
        ("hamiltonian", "structural Hamiltonian H per robot at the end, in the paper's units"),
        ("hamiltonian_rise", "largest rise of H in a tick over what it loses in all"),
        ("least_pair_over_d", "least distance of two centres after 2 s in spacings; empty: none came within one"),
        ("inside", "robots whose centre was ever in an obstacle"),
        ("past", "robots east of all balls at the end"),
        ("crossings", "pairs of links that cross at the end; empty: in space"),
        ("crossed_until", "last tick at which links crossed; empty: never, or in space"),
        ("colliding_pairs", "pairs that may collide by the paper's bound on H: the least k with H(0) < (k + 1) psi(0)"),
    ],
    new: |scenario| Box::new(Flock { state: scenario.plane().and_then(|plane| State::new(scenario, plane)) }),
};

/// From then on distances of pairs count: random starts may nearly coincide.
const SETTLED_S: f64 = 2.0;
/// Most points of a curve.
const POINTS: usize = 400;

/// `None` if the robots are not an alpha flock.
struct Flock {
    state: Option<State>,
}

struct State {
    spacing_m: f64,
    /// The spacing over that of the paper, 7 units.
    unit_m: f64,
    lattice_radius_m: f64,
    tick_s: f64,
    solids: Vec<Solid>,
    meter: FlockMeter<3>,
    energy: Option<EnergyMeter<3>>,
    trace: Vec<Option<FlockMeasure>>,
    energies: Vec<f64>,
    least_pair_m: f64,
    was_inside: Vec<bool>,
    past: Option<usize>,
    crossings: Option<usize>,
    crossed_until: Option<usize>,
}

impl State {
    fn new(scenario: &Scenario, plane: &PlaneSetup) -> Option<Self> {
        let Some(LawSettings::Lattice(lattice)) = plane.group(0).law.built_in() else { return None };
        let params = &lattice.params;
        let robots = scenario.robots.len();
        let spacing_m = f64::from(params.spacing_m);
        let is_flat = plane.starts.iter().all(|start| start.position_m[2] == 0.0);
        let n = robots as f64;
        // Of a perfect lattice's disc or ball.
        let radius = if is_flat {
            libm::sqrt(n * libm::sqrt(3.0) / (2.0 * PI))
        } else {
            libm::cbrt(3.0 * n / (4.0 * PI * SQRT_2))
        };
        Some(Self {
            spacing_m,
            unit_m: spacing_m / 7.0,
            lattice_radius_m: spacing_m * radius,
            tick_s: scenario.tick_s(),
            solids: plane.solids.clone(),
            meter: FlockMeter::new(spacing_m, 1.2 * spacing_m, plane.space()),
            energy: EnergyMeter::new(&params.cast()),
            trace: Vec::new(),
            energies: Vec::new(),
            least_pair_m: f64::INFINITY,
            was_inside: vec![false; robots],
            past: None,
            crossings: None,
            crossed_until: None,
        })
    }

    fn look(&mut self, moment: &Moment<'_>, places_m: &[[f64; 3]], velocities_mps: &[[f64; 3]]) {
        self.trace.push(self.meter.look(places_m, velocities_mps));
        self.crossings = crossings(places_m, self.meter.edges());
        if self.crossings.is_some_and(|count| count > 0) {
            self.crossed_until = Some(self.trace.len() - 1);
        }
        let energy = self.energy.as_mut().and_then(|meter| meter.look(places_m, velocities_mps));
        self.energies.push(energy.map_or(f64::NAN, |energy| energy.hamiltonian() / places_m.len() as f64));
        if moment.row.time_s >= SETTLED_S {
            let none = vec![0.0; places_m.len()];
            let least = gaps(places_m, &none, &[], self.spacing_m, Space::OPEN).between_robots_m;
            self.least_pair_m = self.least_pair_m.min(least.unwrap_or(f64::INFINITY));
        }
        for (place, was_inside) in places_m.iter().zip(&mut self.was_inside) {
            *was_inside |= self.solids.iter().any(|solid| solid.distance_m(*place) < 0.0);
        }
        let ends = self.solids.iter().filter_map(|solid| match solid {
            Solid::Ball { center_m, radius_m } => Some(center_m[0] + radius_m),
            Solid::Wall(_) | Solid::Plane { .. } => None,
        });
        self.past = ends.reduce(f64::max).map(|x| places_m.iter().filter(|place| place[0] > x).count());
    }

    fn values(&self) -> Vec<Option<f64>> {
        let mut limits = AlphaLimits::paper(2.0 * self.lattice_radius_m);
        // In (m/s)^2, from the paper's units.
        limits.velocity_mismatch *= self.unit_m * self.unit_m;
        let end = self.trace.last().copied().flatten();
        let is_apart = |measure: &Option<FlockMeasure>| measure.is_none_or(|measure| measure.components > 1);
        let connected = self.trace.iter().rposition(is_apart).map_or(0, |last| last + 1);
        let most = self.trace.iter().flatten().map(|measure| measure.components).max();
        let count = |number: usize| number as f64;
        vec![
            alpha_flocking(&self.trace, &limits).alpha_flocking.map(count),
            (connected < self.trace.len()).then_some(count(connected)),
            most.map(count),
            end.map(|end| count(end.components)),
            end.map(|end| end.connectivity),
            end.map(|end| end.radius_m),
            end.map(|end| end.deviation_energy),
            end.map(|end| end.velocity_mismatch),
            self.energies.last().copied().filter(|energy| energy.is_finite()),
            Some(rise(&self.energies)).filter(|rise| rise.is_finite()),
            self.least_pair_m.is_finite().then_some(self.least_pair_m / self.spacing_m),
            Some(count(self.was_inside.iter().filter(|was| **was).count())),
            self.past.map(count),
            self.crossings.map(count),
            self.crossed_until.map(count),
            self.colliding_pairs(),
        ]
    }
}

impl State {
    fn colliding_pairs(&self) -> Option<f64> {
        let start = self.energies.first().filter(|energy| energy.is_finite())? * self.was_inside.len() as f64;
        Some(libm::floor(start / self.energy.as_ref()?.collision()))
    }

    /// Ticks that are reported, at most about [`POINTS`].
    fn ticks(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.trace.len()).step_by(self.trace.len().div_ceil(POINTS).max(1))
    }
}

fn rise(energies: &[f64]) -> f64 {
    let rise = energies.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    let lost = energies.first().zip(energies.last()).map_or(0.0, |(first, last)| first - last);
    if rise > 0.0 && lost > 0.0 { rise / lost } else { rise }
}

impl Probe for Flock {
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

    /// C, R, E~, K~ and H over time (figure 12).
    fn charts(&self, title: &str) -> Option<Panels> {
        let state = self.state.as_ref()?;
        let curve = |name: &str, label: &str, value: &dyn Fn(usize) -> Option<f64>| {
            let points = state.ticks().filter_map(|tick| Some([tick as f64, value(tick)?]));
            Chart::new(name, "iteration", label).size(560.0, 300.0).with(Series::line("", points))
        };
        let of = |value: fn(&FlockMeasure) -> f64| move |tick: usize| state.trace[tick].as_ref().map(value);
        let charts = [
            curve("Relative connectivity", "C", &of(|m| m.connectivity)),
            curve("Cohesion radius", "R (m)", &of(|m| m.radius_m)),
            curve("Deviation energy", "log10 E~", &of(|m| libm::log10(m.deviation_energy))),
            curve("Velocity mismatch", "log10 K~", &of(|m| libm::log10(m.velocity_mismatch))),
            curve("Structural Hamiltonian", "log10 H / n", &|tick| Some(libm::log10(state.energies[tick]))),
        ];
        Some(charts.into_iter().fold(Panels::new(title).columns(2), Panels::with))
    }

    fn table(&self) -> Option<String> {
        let state = self.state.as_ref()?;
        let mut text = "iteration,time_s,connectivity,components,radius_m,deviation_energy,velocity_mismatch_m2ps2,\
            polarisation,hamiltonian_per_robot\n"
            .to_owned();
        for tick in state.ticks() {
            let Some(m) = &state.trace[tick] else { continue };
            let shape = format!("{},{},{},{}", m.connectivity, m.components, m.radius_m, m.deviation_energy);
            let motion = format!("{},{},{}", m.velocity_mismatch, m.polarisation, state.energies[tick]);
            text += &format!("{tick},{},{shape},{motion}\n", tick as f64 * state.tick_s);
        }
        Some(text)
    }
}
