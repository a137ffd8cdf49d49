use super::super::ranges::{micros, tick};
use super::*;

#[test]
fn multiples_of_a_tick_convert_exactly() {
    for tick_s in [0.1, 0.05, 0.3, 1.0, 0.007, 60.0] {
        for number in [0_u32, 1, 3, 7, 1001, 70_000] {
            let micros = u64::from(number) * u64::from(micros(tick_s));
            assert_eq!(tick(micros as f64 / 1e6, tick_s), number, "{tick_s} {number}");
        }
    }
    assert_eq!(tick(0.15, 0.1), 2);
}

#[test]
fn invalid_interventions_are_refused_with_a_remedy() {
    let robots = [Robot { id: RobotId(3), start: Default::default(), goal: Default::default() }];
    let polygon = |points_m| Intervention::Solid { solid: Shape::Polygon { points_m } };
    let wrong = [
        Intervention::Goal { robot: Some(2), place_m: [0.0; 3] },
        Intervention::Goal { robot: Some(3), place_m: [f64::NAN, 0.0, 0.0] },
        Intervention::Parameter { robot: None, name: "share".into(), value: 2.0 },
        Intervention::Down { robot: 3, for_s: Some(-1.0) },
        Intervention::Radio { loss: Some(1.5), range_m: None },
        Intervention::Radio { loss: None, range_m: Some(f64::NAN) },
        polygon(vec![[0.0; 2]; 2]),
        polygon(vec![[f64::INFINITY, 0.0]; 3]),
        Intervention::Solid { solid: Shape::Circle { center_m: [0.0; 2], radius_m: 0.0 } },
        Intervention::Move { index: 0, by_m: [f64::NAN, 0.0] },
    ];
    for intervention in wrong {
        let refusal = intervention.check(&robots).unwrap_err();
        assert!(!refusal.remedy.is_empty(), "{intervention:?}");
    }
    assert_eq!(Intervention::Goal { robot: Some(3), place_m: [1.0; 3] }.check(&robots), Ok(()));
}

#[test]
fn an_unlimited_range_is_written() {
    let what = Intervention::Radio { loss: None, range_m: Some(f64::INFINITY) };
    let text = with_interventions("", 1_000_000, &[(3, what)]);
    assert_eq!(text, "\n\n[[intervention]]\nat_s = 3.000000\ndo = { kind = \"radio\", range_m = inf }\n");
}
