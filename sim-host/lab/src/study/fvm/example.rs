//! The paper's example: two robots, the half-plane of the first, and the region of collisions.

use super::{Parameters, Source, Values};
use staya_controller::geom::Vec2;
use staya_controller::orca::{Analytic, HalfPlane, HalfSpaces, MovingBall, Params, VelocityObstacle, VoxelTable2k};
use staya_controller::rand::Rng;
use staya_fvm::orca::pictures::Scene;
use staya_fvm::{Grid, Pair, System, Template, Templated, VelocityForm, build};
use staya_plot::canvas::{Anchor, Canvas, Stroke, Text};
use staya_plot::colour::{INK, MUTED, PALETTE, WHITE};
use staya_voxel::{Model, VoxelNeighbor, velocity_half_plane};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::{Path, PathBuf};

type V = Vec2<f64>;

const RELATIVE: u32 = 0x0046_0301;

/// The robots of the section "analytic representation".
pub const PAIR: Pair = Pair { places_m: [[2.0, -3.0], [-2.0, 3.0]], radii_m: [1.0, 1.0], horizon_s: 2.0 };
const OWN: V = Vec2 { x: 1.5, y: 1.0 };
const OTHER: V = Vec2 { x: 3.0, y: -1.5 };

pub const MEASURES: &[(&str, &str)] = &[
    ("change_mps", "length of the whole correction w of the example, m/s"),
    ("point_x", "point of the half-plane's border, m/s"),
    ("point_y", "its other coordinate"),
    ("off_mps", "distance of that point from the one of equation 14, m/s"),
    ("off_deg", "angle between the normal and that of equation 14, degrees"),
    ("closest_m", "least distance of the centres within tau, metres; at 2 m the robots touch"),
    ("closest_corrected_m", "that distance if A takes its part of the correction and B the rest"),
    ("agreement", "share of random pairs whose collision within the horizon equation 15 predicts"),
    ("agreement_printed", "the same of equations 1 to 4, 13 and 15 as printed"),
];

/// The correction by equation 14 and the line before it: out of the disc, away from its centre.
fn correction() -> V {
    let [[ax, ay], [bx, by]] = PAIR.places_m;
    let centre = V::new(bx - ax, by - ay) * (1.0 / PAIR.horizon_s);
    let off = OWN - OTHER - centre;
    let w = (PAIR.radii_m[0] + PAIR.radii_m[1]) / PAIR.horizon_s - off.norm();
    off * (w / off.norm())
}

pub fn measure(parameters: &Parameters, seed: u64) -> Result<Values, String> {
    let plane = half_plane(parameters)?;
    let (whole, share) = (correction(), parameters.share);
    let expected = OWN + whole * share;
    let normal = whole * (1.0 / whole.norm());
    let angle = libm::atan2(normal.det(plane.normal), normal.dot(plane.normal)).abs().to_degrees();
    Ok(vec![
        ("change_mps", (share > 0.0).then(|| whole_mps(&plane, share))),
        ("point_x", Some(plane.point.x)),
        ("point_y", Some(plane.point.y)),
        ("off_mps", Some((plane.point - expected).norm())),
        ("off_deg", Some(angle)),
        ("closest_m", Some(closest_m(OWN - OTHER))),
        (
            "closest_corrected_m",
            (share > 0.0).then(|| closest_m(OWN - OTHER + plane.normal * whole_mps(&plane, share))),
        ),
        ("agreement", Some(agreement(parameters, seed, predicted))),
        ("agreement_printed", Some(agreement(parameters, seed, printed))),
    ])
}

fn half_plane(parameters: &Parameters) -> Result<HalfPlane<f64>, String> {
    let [[ax, ay], [bx, by]] = PAIR.places_m;
    let other = MovingBall {
        offset_m: V::new(bx - ax, by - ay),
        velocity_mps: OTHER,
        radii_m: PAIR.radii_m[0] + PAIR.radii_m[1],
        tie: V::ZERO,
    };
    let share = parameters.share;
    let params = Params { horizon_s: PAIR.horizon_s, separation_s: PAIR.horizon_s, share };
    let plane = match parameters.source {
        Source::Formula => Analytic.half_space(OWN, &other, &params),
        Source::Table => VoxelTable2k.half_space(OWN, &other, &params),
        Source::Neighbor => {
            let bytes = neighbor_model(parameters)?;
            let model = Model::<f64, 3>::from_bytes(&bytes).map_err(|error| error.to_string())?;
            VoxelNeighbor::new(model).half_space(OWN, &other, &params)
        }
        Source::Distance | Source::RFunction => {
            let form = match parameters.source {
                Source::Distance => VelocityForm::Distance,
                _ => VelocityForm::RFunction(System::R1),
            };
            let bytes = obstacle_model(parameters, form)?;
            let model = Model::<f64, 2>::from_bytes(&bytes).map_err(|error| error.to_string())?;
            velocity_half_plane(&model, OWN, OWN - OTHER, share)
        }
    };
    plane.ok_or_else(|| "the source has no half-plane for the example".to_owned())
}

fn obstacle_model(parameters: &Parameters, form: VelocityForm) -> Result<Vec<u8>, String> {
    match Template::VelocityObstacle(PAIR, form).function().map_err(|error| error.to_string())? {
        Templated::Plane(function, extent) => {
            let grid = Grid { extent, nodes: [parameters.nodes; 2] };
            build(&function, &grid, parameters.depth).map_err(|error| error.to_string())
        }
        Templated::Space(..) => Err("an obstacle of two variables has three".to_owned()),
    }
}

/// The model of all pairs.
pub fn neighbor_model(parameters: &Parameters) -> Result<Vec<u8>, String> {
    match Template::Neighbor(VelocityForm::Distance).function().map_err(|error| error.to_string())? {
        Templated::Space(function, extent) => {
            let whole = parameters.nodes;
            let grid = Grid { extent, nodes: [whole, whole.div_ceil(2), whole.div_ceil(4)] };
            build(&function, &grid, parameters.depth).map_err(|error| error.to_string())
        }
        Templated::Plane(..) => Err("a model of three variables has two".to_owned()),
    }
}

/// The whole correction, of which A makes `share`, m/s.
fn whole_mps(plane: &HalfPlane<f64>, share: f64) -> f64 {
    plane.penetration(OWN) / share
}

/// The least distance of the centres within the horizon, on straight ways.
fn closest_m(relative: V) -> f64 {
    let [[ax, ay], [bx, by]] = PAIR.places_m;
    let offset = V::new(bx - ax, by - ay);
    let time_s = (offset.dot(relative) / relative.norm_squared().max(1e-12)).clamp(0.0, PAIR.horizon_s);
    (offset - relative * time_s).norm()
}

/// Pairs up to 5 m apart, with relative velocities up to 3 m/s along each axis. The least distance
/// on their straight ways decides whether they collide.
fn agreement(parameters: &Parameters, seed: u64, predicted: fn(V, f64, f64, V) -> bool) -> f64 {
    let (mut agree, horizon_s) = (0_u32, PAIR.horizon_s);
    for pair in 0..parameters.pairs {
        let mut rng = Rng::keyed(seed, RELATIVE, pair, 0);
        let mut number = |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
        let radii_m = number(0.2, 1.0);
        let (distance, angle) = (number(1.01 * radii_m, 5.0), number(0.0, TAU));
        let (sin, cos) = libm::sincos(angle);
        let offset = V::new(cos, sin) * distance;
        let relative = V::new(number(-3.0, 3.0), number(-3.0, 3.0));
        let closest_s = (offset.dot(relative) / relative.norm_squared().max(1e-12)).clamp(0.0, horizon_s);
        let collides = (offset - relative * closest_s).norm() < radii_m;
        agree += u32::from(predicted(offset, radii_m, horizon_s, relative) == collides);
    }
    f64::from(agree) / f64::from(parameters.pairs)
}

/// Equation 15 with the predicates of the controller.
fn predicted(offset: V, radii_m: f64, horizon_s: f64, relative: V) -> bool {
    VelocityObstacle::new(offset, radii_m, horizon_s).is_some_and(|obstacle| {
        let [pr1, pr2, pr3, pr4, disc] = obstacle.predicates(relative);
        (pr1 > 0.0 && pr2 > 0.0 && (pr3 > 0.0 || pr4 > 0.0)) || disc > 0.0
    })
}

/// Equations 1 to 4, 13 and 15 to the letter, `o` being the other robot's place.
fn printed(o: V, radii_m: f64, horizon_s: f64, v: V) -> bool {
    let alpha = libm::atan(o.y / o.x);
    let squared = o.norm_squared();
    let beta = libm::acos(libm::sqrt(squared - radii_m * radii_m) / libm::sqrt(squared));
    let tip = o * (1.0 / horizon_s);
    let pr1 = v.y - libm::tan(alpha + beta) * v.x;
    let pr2 = libm::tan(alpha - beta) * v.x - v.y;
    let pr3 = (v.y - tip.y) - libm::tan(FRAC_PI_2 + alpha - beta) * (v.x - tip.x);
    let pr4 = (v.y - tip.y) - libm::tan(FRAC_PI_2 + alpha + beta) * (v.x - tip.x);
    let disc =
        radii_m * radii_m / (horizon_s * horizon_s) - (v.x + tip.x) * (v.x + tip.x) - (v.y + tip.y) * (v.y + tip.y);
    (pr1 > 0.0 && pr2 > 0.0 && (pr3 > 0.0 || pr4 > 0.0)) || disc > 0.0
}

/// Figures 3 to 6, in a folder beside the other pictures.
pub fn draw(parameters: &Parameters, stem: &Path) -> Result<Vec<PathBuf>, String> {
    let [place_a, place_b] = PAIR.places_m;
    let scene = Scene {
        place_a,
        place_b,
        velocity_a: [OWN.x, OWN.y],
        velocity_b: [OTHER.x, OTHER.y],
        radii: PAIR.radii_m,
        horizon: PAIR.horizon_s,
        share: parameters.share,
    };
    let drawing = scene.drawing().map_err(|error| error.to_string())?;
    staya_sim::record::make_dir(stem).map_err(|error| error.to_string())?;
    let mut files = drawing.draw(stem).map_err(|error| error.to_string())?;
    files.extend(start(drawing.plane.point).write(&stem.join("start")).map_err(|error| error.to_string())?);
    Ok(files)
}

/// Figure 2: the places of the robots. Each also has its way within tau, and A the way with the
/// velocity that the half-plane gives it.
fn start(corrected: V) -> Canvas {
    const SCALE: f64 = 40.0;
    const HALF_M: f64 = 7.0;
    const TOP: f64 = 60.0;
    let at = |V { x, y }: V| [(x + HALF_M) * SCALE, TOP + (HALF_M - y) * SCALE];
    let title = "Initial places of the robots, and their ways within tau";
    let mut canvas = Canvas::new(2.0 * HALF_M * SCALE, TOP + 2.0 * HALF_M * SCALE, title);
    canvas.text(Text { bold: true, ..Text::new([16.0, 30.0], 15.0, Anchor::Start, title) });
    let axes = [[V::new(-HALF_M, 0.0), V::new(HALF_M, 0.0)], [V::new(0.0, -HALF_M), V::new(0.0, HALF_M)]];
    for ends in axes {
        canvas.line(ends.map(at).to_vec(), Stroke::new(MUTED, 0.8));
    }
    let robots = [("A", OWN, PALETTE[0], Some(corrected)), ("B", OTHER, PALETTE[1], None)];
    for ((name, velocity, colour, other), ([x, y], radius_m)) in
        robots.into_iter().zip(PAIR.places_m.into_iter().zip(PAIR.radii_m))
    {
        let place = V::new(x, y);
        let ways =
            [Some((velocity, Stroke::new(colour, 2.0))), other.map(|v| (v, Stroke::new(INK, 1.4).dashed(5.0, 4.0)))];
        for (velocity, stroke) in ways.into_iter().flatten() {
            let end = place + velocity * PAIR.horizon_s;
            canvas.line(vec![at(place), at(end)], stroke);
            canvas.circle(at(end), radius_m * SCALE, None, Some(stroke));
        }
        canvas.circle(at(place), radius_m * SCALE, Some(WHITE.towards(colour, 0.3)), Some(Stroke::new(colour, 1.6)));
        let text = format!("{name} ({x}, {y})");
        canvas.text(Text { halo: Some(WHITE), ..Text::new(at(place), 12.5, Anchor::Middle, text).centred() });
    }
    let below = "solid: with the initial velocities the robots overlap; dashed: A corrects its own";
    let foot = [HALF_M * SCALE, TOP + 2.0 * HALF_M * SCALE - 12.0];
    canvas.text(Text { halo: Some(WHITE), ..Text::new(foot, 12.5, Anchor::Middle, below) });
    canvas
}
