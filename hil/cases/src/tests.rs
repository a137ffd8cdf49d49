//! The swarms do their tasks, so that equal hashes mean more than idle robots.

use super::*;
use staya_controller::scalar::Q16;
use std::string::String;

fn run<S: Scalar>(case: Case) -> Summary {
    case.run::<S, _>(&mut Unmeasured)
}

fn each(check: impl Fn(&str, Summary), cases: &[Case]) {
    for case in cases {
        check(&std::format!("{} f32", case.name()), run::<f32>(*case));
        check(&std::format!("{} Q16", case.name()), run::<Q16>(*case));
    }
}

#[test]
fn robots_with_goals_arrive_and_never_touch() {
    let cases = [
        (Case::Route, 4),
        (Case::Formation, 4),
        (Case::FormationReflexive, 4),
        (Case::Packets, 4),
        (Case::RouteInPlane, 3),
        (Case::OrcaAnalytic, 5),
        (Case::OrcaTemplate2k, 5),
        (Case::Doorway, 4),
        (Case::Fly, 5),
        (Case::PushOut, 3),
        (Case::GoalFlock, 5),
        (Case::Negotiation, 8),
    ];
    let mut faults = String::new();
    for (case, robots) in cases {
        for (scalar, summary) in [("f32", run::<f32>(case)), ("Q16", run::<Q16>(case))] {
            if (summary.arrived, summary.overlaps) != (robots, 0) {
                faults += &std::format!("{} {scalar}: {summary:?}\n", case.name());
            }
        }
    }
    assert!(faults.is_empty(), "{faults}");
}

#[test]
fn alpha_flock_forms_its_lattice_and_boids_stay_together() {
    each(
        |name, summary| {
            let [nearest, farthest] = summary.apart_mm;
            // A row would be 4 m long.
            assert!((800..1100).contains(&nearest), "{name}: {summary:?}");
            assert!(farthest < 2600 && summary.overlaps == 0, "{name}: {summary:?}");
        },
        &[Case::Lattice],
    );
    // Without alignment they would separate by 35 m in 40 s.
    each(|name, summary| assert!(summary.apart_mm[1] < 12_000, "{name}: {summary:?}"), &[Case::Boids]);
}

#[test]
fn only_a_faulty_radio_loses_frames() {
    each(|name, summary| assert!(summary.rejected > 50, "{name}: {summary:?}"), &[Case::Packets]);
    each(
        |name, summary| assert_eq!(summary.rejected, 0, "{name}"),
        &[Case::Formation, Case::OrcaAnalytic, Case::Boids],
    );
}

#[test]
fn packets_in_mavlink_and_postcard_lead_to_the_same_commands() {
    fn check<S: Scalar>(number: &'static str) {
        let postcard = run::<S>(Case::Packets);
        in_mavlink::<S>(number, &mut |name, _, mavlink| {
            assert!(mavlink.arrived == 4 && mavlink.rejected > 50, "{name}: {mavlink:?}");
            assert_eq!((mavlink.commands, mavlink.digest), (postcard.commands, postcard.digest), "{name} {number}");
            assert_ne!(mavlink.bytes, postcard.bytes, "{name} {number}");
        });
    }
    check::<f32>("f32");
    check::<Q16>("Q16");
}
