use super::*;

fn circle(count: u32, sensing: &str, radio: &str) -> Scenario {
    seeded(count, sensing, radio, 11)
}

fn seeded(count: u32, sensing: &str, radio: &str, seed: u64) -> Scenario {
    let radius_m = (f64::from(count) * 0.1).max(2.0);
    let text = format!(
        "name = \"t\"\nseed = {seed}\nticks = 1200\ntick_s = 0.05\n[radio]\nrange_m = 3\n{radio}\n[plane]\nradius_m = 0.15\n\
         max_speed_mps = 0.5\ntolerance_m = 0.02\n[plane.sensing]\nrange_m = 3\n{sensing}\n\
         [plane.robots.circle]\ncount = {count}\nradius_m = {radius_m}\nnoise_m = 0.1\n"
    );
    Scenario::parse(&text, Path::new("t.toml"), &Overrides::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn run(scenario: &Scenario) -> Outcome {
    simulate(scenario, |_, _| ControlFlow::Continue(())).expect("they can be placed")
}

#[test]
fn robots_swap_places_by_sensors_alone_without_collisions() {
    let outcome = run(&circle(12, "beacons = false", ""));
    assert_eq!((outcome.arrived, outcome.collisions, outcome.packets.sent), (12, 0, 0));
    let blind = run(&with_range(circle(12, "beacons = false", ""), 0.01));
    assert!(blind.collisions > 0);
}

fn with_range(mut scenario: Scenario, range_m: f64) -> Scenario {
    scenario.plane_mut().unwrap().sensing.as_mut().unwrap().range_m = range_m;
    scenario
}

#[test]
fn sensors_without_detections_do_not_change_the_run() {
    let blind = with_range(circle(8, "", "loss = 0.2"), 0.01);
    let mut without = blind.clone();
    without.plane_mut().unwrap().sensing = None;
    assert_eq!(run(&blind).trace_hash, run(&without).trace_hash);
}

#[test]
fn the_number_of_threads_makes_no_difference() {
    let scenario = circle(80, "beacons = false\nnoise_m = 0.05\nevery_ticks = 2\ndelay_ticks = 1", "");
    let scenario = Scenario { ticks: 60, ..scenario };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run(&scenario).trace_hash)
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn an_order_reaches_robots_without_beacons() {
    let text = "name = \"t\"\nticks = 400\ntick_s = 0.05\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n\
         [plane.sensing]\nrange_m = 3\nbeacons = false\n[[plane.robots.list]]\nstart_m = [0, 0]\ngoal_m = [5, 0]\n\
         [[plane.order]]\nat_s = 1\nplace_m = [0, 3]\n";
    let text = text.replacen("[[plane.robots.list]]", "[plane.robots]\n[[plane.robots.list]]", 1);
    let scenario = Scenario::parse(&text, Path::new("t.toml"), &Overrides::default());
    let mut last_m = [0.0; 3];
    let outcome = simulate(&scenario.unwrap_or_else(|error| panic!("{error}")), |_, rows| {
        last_m = rows.last().map_or(last_m, |row| row.motion.position_m);
        ControlFlow::Continue(())
    });
    assert_eq!(outcome.expect("room").packets.sent, 0);
    assert!(last_m[0].abs() < 0.05 && (last_m[1] - 3.0).abs() < 0.05, "{last_m:?}");
}

/// Root mean square error of the neighbours' positions in metres, and their mean number.
fn errors(sensing: &str, radio: &str, range_m: f64) -> (f64, f64) {
    let (mut squares, mut count, mut moments) = (0.0, 0.0, 0.0);
    for seed in 500..503 {
        let scenario = with_range(seeded(12, sensing, radio, seed), range_m);
        let mut engine = Engine::new(&scenario, agents(&scenario)).expect("room");
        for _ in 0..160 {
            let places: Vec<_> = engine.view().discs.iter().map(|disc| disc.position_m).collect();
            let tick = engine.tick;
            engine.step();
            for (own, computer) in places.iter().zip(&engine.computers) {
                let now = computer.clock.now(tick, RobotId(1), &engine.timing);
                let agent = computer.agent.as_ref().expect("it is here");
                let here = staya_controller::geom::Position::from_metres(*own).expect("a place");
                for known in super::super::inspect::known(agent.neighbors(), here, *own, now) {
                    let off =
                        |place: &[f64; 3]| libm::hypot(place[0] - known.position_m[0], place[1] - known.position_m[1]);
                    // An anonymous neighbour is compared with the nearest robot.
                    let error_m = match places.get((known.id.0 as usize).wrapping_sub(1)) {
                        Some(place) => off(place),
                        None => places.iter().map(off).fold(f64::INFINITY, f64::min),
                    };
                    (squares, count) = (squares + error_m * error_m, count + 1.0);
                }
                moments += 1.0;
            }
        }
    }
    (libm::sqrt(squares / count), count / moments)
}

#[test]
fn sensors_and_radio_together_are_better_than_either() {
    const SENSING: &str = "noise_m = 0.05\nocclusion = false";
    const RADIO: &str = "loss = 0.7\ndelay_ms = 200";
    let mut table = Vec::new();
    for (what, sensing, radio) in
        [("nameless", SENSING.to_owned(), RADIO), ("named", format!("{SENSING}\nnames = true"), RADIO)]
    {
        let heard = errors(&sensing, radio, 0.01);
        let seen = errors(&format!("{sensing}\nbeacons = false"), radio, 3.0);
        let both = errors(&sensing, radio, 3.0);
        println!("{what}: heard {heard:.4?}, seen {seen:.4?}, both {both:.4?} (m, neighbours)");
        table.push((heard.0, seen.0, both.0));
    }
    for (heard, seen, both) in table {
        assert!(both < heard && both < seen, "{heard} {seen} {both}");
    }
}
