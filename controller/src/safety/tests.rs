use super::*;
use crate::geom::Vec2;
use crate::grid::Norm;
use crate::law::Around;
use crate::orca::{AvoidParams, InSpace};
use crate::parameters::Value;
use crate::push_out::{Evasion, Model, PushOutParams};
use crate::robot::{Mode, RobotId};
use std::vec::Vec;

const INFLATION: StalenessInflation<f64> = StalenessInflation { growth_mps: 0.5, max_m: 0.25 };

fn east(x: f64) -> Vec3<f64> {
    Vec3::new(x, 0.0, 0.0)
}

fn body() -> Body<f64> {
    Body {
        id: RobotId(1),
        velocity_mps: Vec3::ZERO,
        radius_m: 0.15,
        max_speed_mps: 10.0,
        max_acceleration_mps2: f64::MAX,
        step_s: 0.0625,
    }
}

fn input<'a>(body: Body<f64>, wish_mps: Vec3<f64>, nearby: &'a [Nearby<f64>]) -> SafetyInput<'a, f64> {
    SafetyInput { body, wish_mps, way_m: Some(wish_mps * 9.0), nearby, obstacles: &[] }
}

#[test]
fn a_robot_is_hindered_below_a_quarter_of_its_possible_progress() {
    let hindered = |body: Body<f64>, wish, safe: f64| is_hindered(&input(body, east(wish), &[]), east(safe));
    assert!(hindered(body(), 4.0, 0.99) && hindered(body(), 4.0, 0.0) && hindered(body(), 4.0, -4.0));
    assert!(!hindered(body(), 4.0, 1.0) && !hindered(body(), 4.0, 4.0));
    // Half of a tenth of the top speed counts as arrived.
    assert!(hindered(body(), 1.0, 0.0) && !hindered(body(), 0.99, 0.0));
    // Beyond the top speed, the top speed is possible.
    assert!(hindered(body(), 40.0, 2.49) && !hindered(body(), 40.0, 2.5));
    // With inertia only a change of 1 m/s is possible.
    let heavy = |own: f64| Body { velocity_mps: east(own), max_acceleration_mps2: 16.0, ..body() };
    assert!(hindered(heavy(1.0), 8.0, 0.49) && !hindered(heavy(1.0), 8.0, 0.5));
    // Nothing that it can reach is progress.
    assert!(!hindered(heavy(-1.0), 8.0, -1.0) && !hindered(heavy(-4.0), 8.0, -5.0));
    assert!(!hindered(body(), f64::NAN, 0.0));
}

#[test]
fn without_a_layer_the_wish_is_the_result() {
    let wish = Vec3::new(0.5, -1.5, 2.5);
    let other = [nearby(0.2)];
    assert_eq!(Unguarded.keep_clear(&input(body(), wish, &other), &mut Rng::new(1)), wish);
    assert_eq!(Safety::<f64>::inflation(&Unguarded), None);
    assert_eq!(Safety::<f64>::downwash(&Unguarded), 1.0);
    assert!(!Safety::<f64>::waits_for_turn(&Unguarded));
}

fn nearby(x: f64) -> Nearby<f64> {
    Nearby {
        id: RobotId(2),
        offset_m: Vec3::new(x, 0.1, 0.0),
        velocity_mps: east(-1.0),
        radius_m: 0.15,
        gives_way: true,
        mode: Mode::Cruise,
        is_stranger: false,
    }
}

fn push_out() -> PushOutSafety<f64> {
    PushOutSafety::new(PushOutParams { model: Model::Radial, evasion: Evasion::Multiple, min_distance_m: 0.5 })
}

type Orca<P = AnyHalfPlanes> = OrcaSafety<f64, 8, P>;

fn all() -> [AnySafety<f64, 8>; 5] {
    let params = AvoidParams::default();
    [
        AnySafety::None(Unguarded),
        AnySafety::Orca(OrcaSafety::with_source(params, INFLATION, AnyHalfPlanes::Analytic)),
        AnySafety::Template2k(OrcaSafety::with_source(params, INFLATION, AnyHalfPlanes::Template2k)),
        AnySafety::Fly(OrcaSafety::with_source(params, INFLATION, InSpace { downwash: 2.5 })),
        AnySafety::PushOut(push_out()),
    ]
}

fn names(safety: &mut dyn Safety<f64>) -> Vec<&'static str> {
    let mut names = Vec::new();
    safety.parameters(&mut |table| names.extend(table.table().iter().map(|row| row.name)));
    names
}

#[test]
fn a_layer_chosen_at_run_time_acts_as_the_layer_itself() {
    let [mut none, mut plane, mut table, mut fly, mut push] = all();
    let mut layers: [(&mut AnySafety<f64, 8>, &mut dyn Safety<f64>); 5] = [
        (&mut none, &mut Unguarded),
        (&mut plane, &mut OrcaSafety::<f64, 8>::new(AvoidParams::default(), INFLATION)),
        (&mut table, &mut Orca::with_source(AvoidParams::default(), INFLATION, AnyHalfPlanes::Template2k)),
        (&mut fly, &mut Orca::with_source(AvoidParams::default(), INFLATION, InSpace { downwash: 2.5 })),
        (&mut push, &mut push_out()),
    ];
    let mut results = Vec::new();
    for (any, one) in &mut layers {
        let other = [nearby(0.52)];
        let seen = input(Body { velocity_mps: east(0.9), ..body() }, Vec3::new(1.0, 0.0, 0.125), &other);
        let got = any.keep_clear(&seen, &mut Rng::new(1));
        assert_eq!(got, one.keep_clear(&seen, &mut Rng::new(1)));
        assert_eq!((any.inflation(), any.downwash()), (one.inflation(), one.downwash()));
        assert_eq!(any.waits_for_turn(), one.waits_for_turn());
        assert_eq!(names(*any), names(*one));
        results.push(got);
    }
    assert!(results[1..].iter().all(|one| *one != results[0]), "{results:?}");
    assert_eq!([0, 1, 2].map(|at| results[at].z), [0.125; 3], "layers in the plane keep the height of the wish");
}

#[test]
fn the_settings_of_a_layer_name_its_parameters() {
    assert_eq!(LayerSettings::ALL.len(), all().len());
    for (name, _) in LayerSettings::ALL {
        let mut settings = LayerSettings::by_name(name).unwrap();
        let mut rows = Vec::new();
        settings.tables(&mut |table| rows.extend(table.table().iter().map(|row| row.name)));
        let own = names(&mut settings.layer::<f64, 8>());
        assert!(own.iter().all(|row| rows.contains(row)), "{name}: {own:?}, not {rows:?}");
        assert_eq!(settings.flies(), rows.contains(&"downwash"), "{name}");
        assert_eq!(settings.orca().is_some(), rows.contains(&"horizon_s"), "{name}");
        assert_eq!((settings.is_none(), own.is_empty()), (rows.is_empty(), rows.is_empty()), "{name}");
    }
}

#[test]
fn push_out_keeps_a_wish_that_leads_near_no_robot() {
    let wish = Vec3::new(0.5, -1.5, 2.5);
    assert_eq!(push_out().keep_clear(&input(body(), wish, &[]), &mut Rng::new(1)), wish);
}

#[test]
fn only_layers_that_predict_have_balls_that_grow() {
    let grows = all().map(|safety| safety.inflation());
    assert_eq!(grows, [None, Some(INFLATION), Some(INFLATION), Some(INFLATION), None]);
    assert_eq!(all().map(|safety| safety.downwash()), [1.0, 1.0, 1.0, 2.5, 1.0]);
    let in_space = FlySafety::<f64, 8>::in_space(AvoidParams::default(), INFLATION);
    assert_eq!((in_space.downwash(), in_space.inflation()), (1.0, Some(INFLATION)));
    let tables = all().map(|mut safety| names(&mut safety).len());
    assert!(tables[0] == 0 && tables[1..].iter().all(|&rows| rows > 0), "{tables:?}");
}

#[test]
fn a_robot_waits_for_its_turn_at_a_door_in_the_plane_only() {
    let wall = |y: f64| Obstacle::Wall([Vec2::new(0.6, y), Vec2::new(0.6, y * 20.0)]);
    let walls = [wall(0.2), wall(-0.2)];
    // A robot with a smaller id stands equally far behind the door.
    let other = [Nearby { id: RobotId(1), offset_m: east(1.2), velocity_mps: Vec3::ZERO, ..nearby(0.0) }];
    let waits = all().map(|mut safety| {
        let own = Body { id: RobotId(5), max_speed_mps: 0.5, step_s: 0.05, ..body() };
        let seen =
            SafetyInput { body: own, wish_mps: east(0.5), way_m: Some(east(4.0)), nearby: &other, obstacles: &walls };
        let before = safety.waits_for_turn();
        let _ = safety.keep_clear(&seen, &mut Rng::new(1));
        (before, safety.waits_for_turn())
    });
    let [none, plane, table, fly, push] = waits;
    assert_eq!([plane, table], [(false, true); 2]);
    assert_eq!([none, fly, push], [(false, false); 3]);
}

/// A body with a look-ahead of 0.74 s if each robot has a goal.
fn around(brake_s: f32, has_goal: bool) -> Around {
    Around {
        radius_m: 0.2,
        max_speed_mps: 1.0,
        fastest_mps: 1.5,
        brake_s,
        has_goal,
        cruise_mps: Some(1.0),
        tolerance_m: 0.1,
        delay_s: 0.1,
        rate_hz: 10.0,
        seed: 1,
        radius: 5,
        norm: Norm::default(),
        corner_cutting: false,
    }
}

#[test]
fn values_that_are_not_given_follow_the_body() {
    let longest = AvoidParams::<f32>::default().horizon_s;
    let adapted = |name: &str, brake_s, has_goal| {
        let mut layer = LayerSettings::by_name(name).unwrap();
        layer.adapt(&|_| false, &around(brake_s, has_goal)).unwrap();
        let OrcaSettings { params, inflation } = layer.orca().unwrap();
        assert_eq!((inflation.growth_mps, inflation.max_m), (1.5, 0.2), "{name}");
        params.horizon_s
    };
    for name in ["orca", "template_2k"] {
        assert!((adapted(name, 0.7, true) - 0.74).abs() < 1e-6, "half a second and 1.2 radii");
        assert_eq!([adapted(name, 0.9, true), adapted(name, 0.9, false)], [0.9, longest], "{name}");
    }
    assert_eq!([adapted("fly", 0.7, true), adapted("fly", 99.0, true)], [longest, 99.0]);
    assert_eq!(AvoidParams::for_body(9.0_f32, 1.0).horizon_s, longest, "large bodies");
}

#[test]
fn a_given_look_ahead_in_which_the_body_cannot_brake_is_a_contradiction() {
    for name in ["orca", "template_2k", "fly"] {
        let adapted = |horizon_s: f32| {
            let mut layer = LayerSettings::by_name(name).unwrap();
            let orca = layer.orca_mut().unwrap();
            (orca.params.horizon_s, orca.inflation) = (horizon_s, INFLATION.cast());
            let answer = layer.adapt(&|_| true, &around(0.9, true));
            assert_eq!(
                layer.orca().map(|orca| (orca.params.horizon_s, orca.inflation)),
                Some((horizon_s, INFLATION.cast()))
            );
            answer.err().map(|wrong| (wrong.row, wrong.least))
        };
        let wanted = [Some(("horizon_s", Some(0.9))), None, None];
        assert_eq!([0.89, 0.9, 0.91].map(adapted), wanted, "{name}");
    }
}

#[test]
fn a_switch_chooses_whether_only_the_nearest_robot_is_evaded() {
    assert_eq!([1.0, 0.0].map(<Evasion as Value>::nearest), [Evasion::Single, Evasion::Multiple]);
    assert_eq!([Evasion::Single, Evasion::Multiple].map(Value::number), [1.0, 0.0]);
}
