use super::*;

fn in_plane(rest: &str) -> Scenario {
    let text = format!("name = \"t\"\nticks = 400\ntick_s = 0.1\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n{rest}");
    let scenario = Scenario::parse(&text, Path::new("t.toml"), &Overrides::default());
    scenario.unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn met_by(speed_mps: f64, rest: &str) -> Scenario {
    in_plane(&format!(
        "[plane.robots]\nlist = [{{ start_m = [-4, 0], goal_m = [4, 0] }}]\n\
         [[plane.intruder]]\nstart_m = [8, 0.1]\nvelocity_mps = [-{speed_mps}, 0]\nradius_m = 0.5\n{rest}"
    ))
}

fn outcome(scenario: &Scenario) -> Outcome {
    simulate(scenario, |_, _| ControlFlow::Continue(())).expect("robots in the plane are placed")
}

#[test]
fn robots_avoid_an_intruder_with_beacons() {
    for speed_mps in [0.5, 1.0, 2.0] {
        let outcome = outcome(&met_by(speed_mps, ""));
        let clearance = outcome.clearance.expect("bodies have sizes");
        assert_eq!((outcome.arrived, clearance.intruder_overlaps), (1, 0), "{speed_mps} m/s: {clearance:?}");
        assert!((0.0..0.2).contains(&clearance.intruders_m), "{speed_mps} m/s: {clearance:?}");
    }
}

#[test]
fn a_silent_intruder_is_grazed_when_seen_and_hit_when_unseen() {
    let silent = "heard = false\n";
    let seen = outcome(&met_by(0.5, silent));
    let clearance = seen.clearance.expect("bodies have sizes");
    assert_eq!((seen.arrived, seen.packets.delivered), (1, 0));
    // The robot sees its position but not its speed: overlap is at most its motion in one tick.
    assert!(clearance.intruders_m > -0.5 * 0.1, "{clearance:?}");
    let mut blind = met_by(0.5, silent);
    blind.plane_mut().expect("a plane").general.sight_m = 0.0;
    let unseen = outcome(&blind);
    let clearance = unseen.clearance.expect("bodies have sizes");
    assert!(clearance.intruders_m < -1.5 * 0.5 * 0.1 && clearance.intruder_overlaps > 5, "{clearance:?}");
    assert_eq!((seen.collisions, unseen.collisions), (0, 0));
}

#[test]
fn robots_of_many_sizes_and_speeds_swap_without_overlap() {
    let mut text = String::from("[plane.robots]\nlist = [\n");
    for index in 0..12 {
        let angle = f64::from(index) * std::f64::consts::PI / 6.0;
        let [x, y] = [libm::cos(angle) * 5.0, libm::sin(angle) * 5.0];
        let (radius_m, speed_mps) = (0.1 + 0.05 * f64::from(index % 5), 0.5 + 0.25 * f64::from(index % 3));
        text += &format!(
            "{{ start_m = [{x}, {y}], goal_m = [{}, {}], radius_m = {radius_m}, max_speed_mps = {speed_mps} }},\n",
            -x, -y
        );
    }
    let scenario = in_plane(&(text + "]\n"));
    let mut fastest = [0.0; 12];
    let outcome = simulate(&scenario, |_, robots| {
        for (fastest, robot) in fastest.iter_mut().zip(robots) {
            let [x, y, _] = robot.motion.velocity_mps;
            *fastest = f64::max(*fastest, libm::hypot(x, y));
        }
        ControlFlow::Continue(())
    });
    let outcome = outcome.expect("robots in the plane are placed");
    assert_eq!((outcome.arrived, outcome.collisions), (12, 0), "{:?}", outcome.clearance);
    for (index, fastest) in fastest.iter().enumerate() {
        let limit = 0.5 + 0.25 * (index % 3) as f64;
        assert!((limit - 1e-6..limit + 1e-6).contains(fastest), "robot {}: {fastest} of {limit}", index + 1);
    }
}

#[test]
fn ids_of_intruders_with_beacons_must_fit_the_format() {
    let text = "name = \"t\"\nticks = 9\ntick_s = 0.1\n[radio]\nformat = \"mavlink\"\n[plane]\nradius_m = 0.2\n\
                max_speed_mps = 1\n[plane.robots]\ncircle = { count = 254, radius_m = 99 }\n[[plane.intruder]]\n\
                start_m = [0, 0]\nvelocity_mps = [1, 0]\nradius_m = 1\n";
    let parse = |text: &str| Scenario::parse(text, Path::new("t.toml"), &Overrides::default());
    let error = parse(text).expect_err("there is no system 255").to_string();
    assert!(error.starts_with("t.toml:5:10: radio.format: robot 255 has no number in mavlink"), "{error}");
    parse(&format!("{text}heard = false\n")).expect("a silent intruder needs no number");
}

/// Balls on two rings swap places; counts those within `looked_for` above or below another.
fn washed(own_downwash: f64, looked_for: f64) -> (Outcome, usize) {
    let mut list = String::new();
    for index in 0..12 {
        let angle = f64::from(index / 2) * std::f64::consts::PI / 3.0;
        let [x, y, z] = [libm::cos(angle) * 3.0, libm::sin(angle) * 3.0, if index % 2 == 0 { 2.0 } else { 4.5 }];
        list += &format!("{{ start_m = [{x}, {y}, {z}], goal_m = [{}, {}, {}] }},\n", -x, -y, 6.5 - z);
    }
    let scenario = in_plane(&format!(
        "safety = \"fly\"\norca = {{ downwash = {own_downwash} }}\n[plane.robots]\nlist = [\n{list}]\n"
    ));
    let mut count = 0;
    let outcome = simulate(&scenario, |_, robots| {
        let places: Vec<_> = robots.map(|robot| robot.motion.position_m).collect();
        for (index, one) in places.iter().enumerate() {
            count += places[..index]
                .iter()
                .filter(|other| {
                    let [x, y, z] = [0, 1, 2].map(|axis| one[axis] - other[axis]);
                    (x * x + y * y + z * z / looked_for / looked_for).sqrt() < 0.4
                })
                .count();
        }
        ControlFlow::Continue(())
    });
    (outcome.expect("robots in space are placed"), count)
}

#[test]
fn flying_robots_avoid_downwash() {
    let (guarded, count) = washed(3.0, 3.0);
    let clearance = guarded.clearance.expect("bodies have sizes");
    assert_eq!((guarded.arrived, guarded.collisions), (12, 0), "{clearance:?}");
    assert_eq!((count, clearance.washed), (0, 0));
    let (unguarded, count) = washed(1.0, 3.0);
    assert_eq!((unguarded.arrived, unguarded.collisions), (12, 0));
    assert!(count > 5, "{count}");
}
