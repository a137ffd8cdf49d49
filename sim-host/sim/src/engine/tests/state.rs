use super::*;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

fn make(scenario: &Scenario) -> Engine {
    Engine::new(scenario, agents(scenario)).expect("robots can be placed")
}

fn seen(engine: &Engine, row: &TickRow) -> u64 {
    let mut hasher = DefaultHasher::new();
    format!("{:?}", engine.moment(row)).hash(&mut hasher);
    for robot in engine.rows() {
        format!("{robot:?}").hash(&mut hasher);
    }
    hasher.finish()
}

fn resumes(scenario: &Scenario, name: &str, ticks: u32, at: &[u32]) {
    let mut engine = make(scenario);
    engine.first_row();
    let (mut rows, mut saved) = (Vec::new(), Vec::new());
    for tick in 0..ticks {
        if at.contains(&tick) {
            let mut bytes = Vec::new();
            engine.save(&mut bytes).expect("all robots are here");
            saved.push((tick, bytes));
        }
        let row = engine.step();
        rows.push(seen(&engine, &row));
    }
    let whole = format!("{:?}", engine.outcome());
    for (tick, bytes) in saved {
        let mut engine = make(scenario);
        engine.restore(&bytes).unwrap_or_else(|error| panic!("{name} at {tick}: {error}"));
        let mut again = Vec::new();
        engine.save(&mut again).expect("all robots are here");
        assert!(again == bytes, "{name} at {tick}: saved twice, it is not the same");
        for expected in &rows[tick as usize..] {
            let row = engine.step();
            assert_eq!(seen(&engine, &row), *expected, "{name} saved at {tick}, at {}", row.tick);
        }
        assert_eq!(format!("{:?}", engine.outcome()), whole, "{name} saved at {tick}");
    }
}

fn moves(scenario: &Scenario, name: &str, tick: u32, ticks: u32) {
    let (mut one, mut other) = (make(scenario), make(scenario));
    for _ in 0..tick {
        one.step();
        other.step();
    }
    // Neither the order in which robots are restored nor occupied cells matter.
    let fresh = make(scenario);
    let mut bytes = Vec::new();
    for index in 0..one.robots.len() {
        bytes.clear();
        fresh.pack(index, &mut bytes);
        assert_eq!(other.unpack(index, &bytes), Ok(bytes.len()), "{name}");
    }
    for index in (0..one.robots.len()).rev() {
        bytes.clear();
        one.pack(index, &mut bytes);
        let length = bytes.len();
        bytes.extend_from_slice(b"bytes of another robot");
        assert_eq!(other.unpack(index, &bytes), Ok(length), "{name}");
    }
    for _ in tick..ticks {
        let (row, expected) = (other.step(), one.step());
        assert_eq!(seen(&other, &row), seen(&one, &expected), "{name} at {}", row.tick);
    }
    assert_eq!(format!("{:?}", other.outcome()), format!("{:?}", one.outcome()), "{name}");
}

fn everything(scenario: &Scenario, name: &str, work: usize) {
    let ticks = (work / scenario.robots.len()).clamp(20, 500) as u32;
    let ticks = ticks.min(scenario.ticks);
    let at = [1, ticks / 3, ticks - 2];
    resumes(scenario, name, ticks, &at);
    moves(scenario, name, ticks / 2, ticks);
}

fn every_scenario(work: usize, most: usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("it can be read").path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let scenario = Scenario::load(&path, &Overrides::default()).expect("a good scenario");
            if scenario.robots.len() <= most {
                everything(&scenario, &scenario.name, work);
                count += 1;
            }
        }
    }
    assert!(count > 20, "{count} scenarios");
}

#[test]
fn every_scenario_resumes_from_a_saved_state() {
    every_scenario(1_500, 200);
}

/// At most 2000 robots: `scenarios/scale-small.toml` has all features of `scale.toml`.
#[test]
#[ignore = "30,000 robots times ticks of each scenario: half a minute"]
fn every_scenario_resumes_for_a_long_time_from_a_saved_state() {
    every_scenario(30_000, 2_000);
}

const KEY: &str = "[authentication]\nkey = \"passphrase: of the tests\"\n";

#[test]
fn runs_with_radio_faults_resume_in_every_format() {
    let faults = [
        "delay_ms = 700\njitter_ms = 2500\n",
        "duplicate = 0.4\nreorder = 0.5\nreorder_ms = 1800\n",
        "loss = 0.3\nburst = { share = 0.3, mean_ms = 2000 }\nblackout_s = [[3, 6]]\n\
         [[radio.fault]]\nfrom = [1]\nloss = 0.6\nat_s = 1\nfor_s = 9\n",
        "bit_error_rate = 0.002\nbandwidth_bytes_per_s = 90\n",
    ];
    for (index, fault) in faults.into_iter().enumerate() {
        for format in ["postcard", "mavlink"] {
            let key = if index % 2 == 0 { KEY } else { "" };
            let rest =
                format!("[radio]\nformat = \"{format}\"\n{fault}{key}[[fault]]\nrobot = 2\nat_s = 2\ndown_s = 1.5\n");
            let scenario = scenario(TWO, &rest);
            resumes(&scenario, &rest, 30, &[3, 5, 9, 20]);
            moves(&scenario, &rest, 6, 30);
        }
    }
}

#[test]
fn runs_with_interventions_resume() {
    let on_grid = scenario(
        TWO,
        "[[intervention]]\nat_s = 1\ndo = { kind = \"cell\", cell = [9, 9], class = 0 }\n\
         [[intervention]]\nat_s = 2\ndo = { kind = \"goal\", robot = 1, place_m = [31, 31, 0] }\n\
         [[intervention]]\nat_s = 3\ndo = { kind = \"down\", robot = 2, for_s = 2 }\n\
         [[intervention]]\nat_s = 4\ndo = { kind = \"radio\", loss = 0.5, range_m = 7 }\n",
    );
    resumes(&on_grid, "grid", 40, &[1, 3, 5, 7, 8, 9, 12]);
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/six-discs.toml"))
        .expect("it is there");
    let text = format!(
        "{text}\n[[intervention]]\nat_s = 1\ndo = {{ kind = \"solid\", solid = {{ kind = \"circle\", center_m = [3, 4], radius_m = 0.4 }} }}\n\
         [[intervention]]\nat_s = 2\ndo = {{ kind = \"move\", index = 0, by_m = [0.3, 0.1] }}\n\
         [[intervention]]\nat_s = 3\ndo = {{ kind = \"goal\", robot = 1, place_m = [1, 1, 0] }}\n\
         [[intervention]]\nat_s = 4\ndo = {{ kind = \"parameter\", name = \"speed_mps\", value = 0.5 }}\n\
         [[intervention]]\nat_s = 5\ndo = {{ kind = \"down\", robot = 2, for_s = 1 }}\n"
    );
    let in_plane = Scenario::parse(&text, Path::new("t.toml"), &Overrides::default()).expect("a good scenario");
    let at = [5, 15, 25, 35, 45, 55, 65].map(|tenths| tenths * 100_000 / in_plane.tick_us);
    resumes(&in_plane, "plane", at[6] + 20, &at);
}

#[test]
fn runs_with_sensors_resume() {
    let text = "tick_s = 0.05\nname = \"t\"\nticks = 200\n[radio]\nloss = 0.5\n[plane]\nradius_m = 0.15\nmax_speed_mps = 0.5\n\
        [plane.sensing]\nrange_m = 3\nnoise_m = 0.05\nevery_ticks = 2\ndelay_ticks = 3\n\
        [plane.robots.circle]\ncount = 8\nradius_m = 1\n[[fault]]\nrobot = 2\nat_s = 1\ndown_s = 1\n";
    let scenario = Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).expect("a good scenario");
    resumes(&scenario, "eyes", 80, &[1, 2, 3, 4, 5, 21, 41, 50]);
}

/// A saved robot names its model only.
#[test]
fn runs_on_a_voxel_model_resume() {
    for (safety, which) in [("orca", "plane"), ("fly", "space")] {
        let model = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/neighbor.fvm");
        let text = format!(
            "tick_s = 0.05\nname = \"t\"\nticks = 200\n[plane]\nradius_m = 0.15\nmax_speed_mps = 0.5\n\
             safety = \"{safety}\"\norca.model = \"{model}\"\n[plane.robots.circle]\ncount = 8\nradius_m = 1\n\
             noise_m = 0.02\n[[fault]]\nrobot = 2\nat_s = 1\ndown_s = 1\n"
        );
        let run =
            |text: &str| Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).expect("a good scenario");
        let scenario = run(&text);
        resumes(&scenario, which, 80, &[1, 5, 21, 41, 50]);
        moves(&scenario, which, 30, 60);
        // The model is in use: robots move otherwise than by the formula.
        let end = |scenario: &Scenario| {
            let mut engine = make(scenario);
            let mut last = engine.first_row();
            (0..80).for_each(|_| last = engine.step());
            seen(&engine, &last)
        };
        let by_formula = run(&text.replace(&format!("orca.model = \"{model}\"\n"), ""));
        assert_ne!(end(&scenario), end(&by_formula), "{which}");
    }
}

#[test]
fn runs_with_changing_terrain_and_memory_resume() {
    let changes = "[[terrain.change]]\nat_s = 2\nevery_s = 4\nfor_s = 2\nclass = 0\nrectangle = { x = 4, y = 3, width = 6, height = 1 }\n\
        [[terrain.change]]\nevery_s = 1\ndrift = { share = 0.2, classes = 4 }\n\
        [scouting]\nradius = 8\nunknown = 0.5\nassumed = 3\n[[fault]]\nrobot = 2\nat_s = 3\ndown_s = 2\n";
    let on_grid = scenario(TWO, changes);
    resumes(&on_grid, "grid", 40, &[1, 4, 5, 7, 8, 9, 12]);
    moves(&on_grid, "grid", 9, 40);
    let by_table = scenario(TWO, &changes.replace("radius = 8", "model_bytes = 300"));
    resumes(&by_table, "table", 40, &[1, 5, 8, 12]);
    moves(&by_table, "table", 9, 40);
    let in_plane = "tick_s = 0.1\nname = \"t\"\nticks = 200\n[terrain]\nuniform = { width = 12, height = 6, classes = 2 }\n\
        [[terrain.change]]\nat_s = 2\nfor_s = 3\nclass = 0\nrectangle = { x = 2, y = 0, width = 4, height = 6 }\n\
        [plane]\nradius_m = 0.2\nmax_speed_mps = 1\nlaw = \"route\"\n[scouting]\nunknown = 0.5\n\
        [robots]\nlist = [{ start = [1, 2], goal = [10, 2] }, { start = [10, 3], goal = [1, 3] }]\n";
    let in_plane = Scenario::parse(in_plane, Path::new("t.toml"), &Overrides::default()).expect("a good scenario");
    resumes(&in_plane, "plane", 80, &[5, 19, 21, 25, 30, 49, 52]);
    moves(&in_plane, "plane", 30, 60);
}

#[test]
fn a_damaged_state_is_refused_or_harmless() {
    fn check(scenario: &Scenario, whole: &str) {
        let mut engine = make(scenario);
        for _ in 0..4 {
            engine.step();
        }
        let mut bytes = Vec::new();
        engine.save(&mut bytes).expect("all robots are here");
        for end in 0..bytes.len() {
            let error = make(scenario).restore(&bytes[..end]).expect_err(whole);
            assert!(error.at <= end, "{error}");
        }
        let mut refused = 0;
        for at in 0..bytes.len() {
            bytes[at] ^= 1 << (at % 8);
            refused += usize::from(make(scenario).restore(&bytes).is_err());
            bytes[at] ^= 1 << (at % 8);
        }
        // Checkpoints have a checksum; this tests the decoder without it.
        assert!(refused * 2 > bytes.len(), "{refused} of {}", bytes.len());
        assert!(make(scenario).restore(&bytes).is_ok());
        assert!(engine.restore(&bytes).expect_err(whole).to_string().contains("under way"));
    }
    let small = scenario(TWO, "[radio]\njitter_ms = 900\n");
    check(&small, "a part is not a state");
}

#[test]
fn a_state_of_another_scenario_is_refused() {
    fn check(scenario: &Scenario, seed: u64) {
        let (mut one, mut other) = (make(scenario), make(scenario));
        let mut bytes = Vec::new();
        one.pack(0, &mut bytes);
        let error = other.unpack(1, &bytes).expect_err("it is another robot").to_string();
        assert!(error.contains("robot 1, not robot 2"), "{error}");
        bytes.clear();
        one.roster.seed = seed;
        one.save(&mut bytes).expect("all robots are here");
        let error = other.restore(&bytes).expect_err("it has another seed").to_string();
        assert!(error.contains("2 robots and seed 99"), "{error}");
    }
    check(&scenario(TWO, ""), 99);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn any_small_run_resumes(
        robots in 2_u32..12,
        seed in 0_u64..1000,
        loss in 0.0_f64..0.6,
        jitter_ms in 0_u32..2000,
        range_m in 3.0_f64..60.0,
        at in 0_u32..40,
        plan in 0_usize..4,
    ) {
        let robots = format!("scattered = {{ count = {robots}, travel = 12 }}");
        let key = ["", KEY, "", KEY][plan];
        let format = ["postcard", "postcard", "mavlink", "mavlink"][plan];
        let rest = format!(
            "[radio]\nformat = \"{format}\"\nrange_m = {range_m}\nloss = {loss}\njitter_ms = {jitter_ms}\n{key}\
             [[fault]]\nrobot = 1\nat_s = 4\ndown_s = 3\n"
        );
        let mut scenario = scenario(&robots, &rest);
        scenario.seed = seed;
        resumes(&scenario, "random", 50, &[at]);
        moves(&scenario, "random", at, 50);
    }
}
