//! Laws and layers by name: rows as in the tables, and steps as those of Rust.

use super::{Memory, TICK_US, nothing, setup, shows, waypoint};
use crate::agent::*;
use crate::chosen::*;
use crate::law::{CELLS, LEARNED, VISITS, Workspace};
use crate::row::StayaParameter;
use crate::setup::{STAYA_LAW_VALUES, STAYA_LAYER_VALUES, StayaSetup};
use crate::status::StayaStatus;
use crate::{HALF_PLANES, NEIGHBORS, Number};
use core::ffi::{CStr, c_char};
use core::mem::MaybeUninit;
use staya_controller::agent::{
    Agent, AnyLaw, AnySafety, AnySurroundings, Around, CellState, InCell, InCells, InPlane, Inputs, KinematicState,
    LawSettings, LayerSettings, Motion, OnGrid, Outputs, Task, Waypoint,
};
use staya_controller::geom::{Position, Vec2};
use staya_controller::grid::{Cell, Norm, Window};
use staya_controller::parameters::{Absent, Parameter, Parameters};
use staya_controller::scalar::cast;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::Postcard;
use std::ffi::CString;
use std::path::Path;
use std::{env, fs};

type Names = &'static [(&'static str, &'static str)];
type Choose = unsafe extern "C" fn(*mut StayaSetup, *const c_char) -> StayaStatus;
type RowAt = unsafe extern "C" fn(*const StayaSetup, u32, *mut StayaParameter) -> StayaStatus;
type KindAt = unsafe extern "C" fn(u32, *mut StayaKind) -> StayaStatus;
type Tables = fn(&str, &mut dyn FnMut(&mut dyn Parameters)) -> &'static str;

/// Laws, then layers: their names, and the functions of C and Rust that know them.
const BOTH: [(Names, Choose, KindAt, RowAt, Tables); 2] = [
    (LawSettings::ALL, staya_choose_law, staya_law, staya_law_row, |name, visit| {
        let mut law = LawSettings::by_name(name).unwrap();
        law.tables(visit);
        law.section()
    }),
    (LayerSettings::ALL, staya_choose_layer, staya_layer, staya_layer_row, |name, visit| {
        let mut layer = LayerSettings::by_name(name).unwrap();
        layer.tables(visit);
        layer.section()
    }),
];

fn string(text: &str) -> CString {
    CString::new(text).unwrap()
}

fn shown(text: &[c_char]) -> &str {
    // SAFETY: texts end with a zero.
    unsafe { CStr::from_ptr(text.as_ptr()) }.to_str().unwrap()
}

fn set(setup: &mut StayaSetup, row: &str, value: f32) -> StayaStatus {
    // SAFETY: all pointers are valid.
    unsafe { staya_set(setup, string(row).as_ptr(), value) }
}

fn set_word(setup: &mut StayaSetup, row: &str, word: &str) -> StayaStatus {
    // SAFETY: all pointers are valid.
    unsafe { staya_set_word(setup, string(row).as_ptr(), string(word).as_ptr()) }
}

fn chosen(id: u32, choose: Choose, name: &str) -> StayaSetup {
    let mut setup = setup(id);
    // SAFETY: all pointers are valid.
    assert_eq!(unsafe { choose(&mut setup, string(name).as_ptr()) }, StayaStatus::Ok, "{name}");
    setup
}

fn explained(setup: &StayaSetup) -> [String; 4] {
    let mut fault = MaybeUninit::uninit();
    // SAFETY: all pointers are valid.
    let fault: StayaFault = unsafe {
        assert_eq!(staya_explain(setup, fault.as_mut_ptr()), StayaStatus::Ok);
        fault.assume_init()
    };
    [fault.status.to_string(), shown(&fault.row).into(), shown(&fault.what).into(), shown(&fault.remedy).into()]
}

/// The rows of a law or layer, each with its default.
fn rows(tables: Tables, name: &str) -> Vec<(Parameter, f32)> {
    let mut all = Vec::new();
    tables(name, &mut |table| {
        all.extend(table.table().iter().enumerate().map(|(index, row)| (*row, table.get(index).unwrap())));
    });
    all
}

fn listed(setup: &StayaSetup, at: RowAt) -> Vec<StayaParameter> {
    let mut row = MaybeUninit::uninit();
    // SAFETY: written if the status says so.
    let one = |index| unsafe { (at(setup, index, row.as_mut_ptr()) == StayaStatus::Ok).then(|| row.assume_init()) };
    (0..).map_while(one).collect()
}

#[test]
fn laws_and_layers_and_their_rows_are_listed_as_in_the_tables() {
    for (number, (names, choose, kind_at, row_at, tables)) in BOTH.into_iter().enumerate() {
        let mut kind = MaybeUninit::<StayaKind>::uninit();
        // SAFETY: written if the status says so.
        let kinds: Vec<_> = (0..)
            .map_while(|index| unsafe {
                (kind_at(index, kind.as_mut_ptr()) == StayaStatus::Ok).then(|| kind.assume_init())
            })
            .collect();
        let external =
            (number == 0).then_some(("external", "your own: `staya_decide` gives the decision of each step"));
        let all: Vec<_> = names.iter().copied().chain(external).collect();
        let texts: Vec<_> = kinds.iter().map(|kind| (shown(&kind.name), shown(&kind.text))).collect();
        assert_eq!(texts, all);
        for (name, _) in names {
            let listed = listed(&chosen(1, choose, name), row_at);
            let all = rows(tables, name);
            assert!(all.len() <= [STAYA_LAW_VALUES, STAYA_LAYER_VALUES][number], "{name} has {} rows", all.len());
            let given: Vec<_> = all.iter().filter(|(row, _)| !matches!(row.absent, Absent::OfBody(_))).collect();
            assert_eq!(listed.len(), given.len(), "{name}");
            for (shows, (row, usual)) in listed.iter().zip(given) {
                let [title, unit, text] = [&shows.name[..], &shows.unit, &shows.text].map(shown);
                assert_eq!((title, unit, text), (row.name, row.unit, row.what));
                assert_eq!(([shows.least, shows.greatest], shown(&shows.words)), (row.range, &*row.words.join(" ")));
                assert_eq!(shows.value.is_nan(), row.absent != Absent::Default, "{title}");
                assert!(shows.value.is_nan() || shows.value == *usual, "{title}");
            }
        }
    }
}

#[test]
fn each_row_takes_its_range_and_nothing_else() {
    for (names, choose, _, row_at, tables) in BOTH {
        for (name, _) in names {
            let mut setup = chosen(1, choose, name);
            for (row, _) in rows(tables, name) {
                let Parameter { name: title, range: [least, greatest], words, .. } = row;
                if matches!(row.absent, Absent::OfBody(_)) {
                    assert_eq!(set(&mut setup, title, least), StayaStatus::Row, "{title}");
                    continue;
                }
                let value = |setup: &StayaSetup| {
                    let rows = listed(setup, row_at);
                    rows.iter().find(|shows| shown(&shows.name) == title).unwrap().value
                };
                for inside in [least, greatest, least + (greatest - least) / 2.0] {
                    assert_eq!(set(&mut setup, title, inside), StayaStatus::Ok, "{title} = {inside}");
                    assert_eq!(value(&setup), inside, "{title}");
                }
                let path = format!("{}.{title}", tables(name, &mut |_| {}));
                assert_eq!(set(&mut setup, &path, greatest), StayaStatus::Ok, "{path}");
                for outside in [least.next_down(), greatest.next_up(), f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                    assert_eq!(set(&mut setup, title, outside), StayaStatus::Range, "{title} = {outside}");
                }
                assert_eq!((set_word(&mut setup, title, "nothing"), value(&setup)), (StayaStatus::Range, greatest));
                for (number, word) in (0u8..).zip(words) {
                    assert_eq!(set_word(&mut setup, &path, word), StayaStatus::Ok, "{path} = {word}");
                    assert_eq!(value(&setup), f32::from(number));
                }
                for unknown in [format!("other.{title}"), format!("{title}."), format!("{title}s"), String::new()] {
                    assert_eq!(set(&mut setup, &unknown, greatest), StayaStatus::Row, "{unknown}");
                }
            }
            // SAFETY: all pointers are valid.
            assert_eq!(unsafe { choose(&mut setup, string(name).as_ptr()) }, StayaStatus::Ok);
            let again = listed(&setup, row_at);
            let fresh = listed(&chosen(1, choose, name), row_at);
            assert_eq!(format!("{again:?}"), format!("{fresh:?}"), "{name}: a choice forgets values");
            let before = format!("{setup:?}");
            // SAFETY: all pointers are valid.
            assert_eq!(unsafe { choose(&mut setup, c"Orca".as_ptr()) }, StayaStatus::Law);
            assert_eq!(format!("{setup:?}"), before);
        }
    }
}

type Twin = Agent<Number, AnyLaw<Number, CELLS, VISITS, LEARNED>, NEIGHBORS, AnySafety<Number, HALF_PLANES>, Postcard>;

/// Values as a caller of C or Rust gives them.
type Values = Vec<(&'static str, f32)>;

/// As an agent in C is made from its setup.
fn twin(setup: &StayaSetup, law: (&str, &Values), layer: (&str, &Values)) -> Option<(Twin, LawSettings)> {
    let mut settings = LawSettings::by_name(law.0)?;
    let around = Around {
        radius_m: 0.1,
        max_speed_mps: 0.5,
        fastest_mps: 0.5,
        brake_s: 0.0,
        has_goal: settings.goals().are_own(),
        cruise_mps: (setup.on_grid == 0).then_some(0.5),
        tolerance_m: 0.05,
        delay_s: 0.0,
        rate_hz: 20.0,
        seed: 5,
        radius: 5,
        norm: Norm::Euclidean,
        corner_cutting: false,
    };
    let store = |table: &mut dyn Parameters, values: &Values| {
        for (row, value) in values {
            if let Some(index) = table.index(row) {
                assert!(table.store(index, *value, false));
            }
        }
    };
    let given = |values: &Values, row: &str| values.iter().any(|(name, _)| *name == row);
    settings.tables(&mut |table| store(table, law.1));
    settings.adapt(&|row| given(law.1, row), &around).ok()?;
    let mut safety = LayerSettings::by_name(layer.0)?;
    safety.tables(&mut |table| store(table, layer.1));
    safety.adapt(&|row| given(layer.1, row), &around).ok()?;
    let agent = Agent::new(&setup.config().unwrap(), settings.law(()), safety.layer(), Postcard);
    Some((agent, settings))
}

const SIDE: u16 = 11;

/// Steps two robots in C and two in Rust; all receive the same frames. Returns whether the setup
/// was accepted.
fn twins_agree(law: (&str, &Values), layer: (&str, &Values), on_grid: u8) -> bool {
    let case = format!("{law:?} {layer:?} {on_grid}");
    let (mut memories, mut twins) = (Vec::new(), Vec::new());
    for id in [1, 2] {
        let mut setup = StayaSetup { on_grid, common_seed: 5, seed: 9, ..chosen(id, staya_choose_law, law.0) };
        // SAFETY: all pointers are valid.
        assert_eq!(unsafe { staya_choose_layer(&mut setup, string(layer.0).as_ptr()) }, StayaStatus::Ok);
        for ((name, values), (.., tables)) in [law, layer].into_iter().zip(BOTH) {
            for (row, value) in values {
                let path = format!("{}.{row}", tables(name, &mut |_| {}));
                assert_eq!(set(&mut setup, &path, *value), StayaStatus::Ok, "{case}: {path}");
            }
        }
        let mut memory = Memory::new();
        let (agent, twin) = (memory.agent(&setup), twin(&setup, law, layer));
        assert_eq!(
            agent.err(),
            twin.is_none().then_some(StayaStatus::Contradiction),
            "{case}: {:?}",
            explained(&setup)
        );
        assert_eq!(explained(&setup)[0] == "0", twin.is_some(), "{case}");
        let (Ok(agent), Some((mut twin, settings))) = (agent, twin) else { return false };
        let to = Waypoint::fixed(Position::from_mm([5000, 0, 0]));
        let task = match settings.motion() {
            Motion::Velocities => Task::Waypoints([(0, to)].into_iter().collect()),
            Motion::Cells => Task::Cell(Cell::new(30, 28)),
        };
        // SAFETY: there is an agent.
        let status = unsafe {
            match settings.motion() {
                Motion::Velocities => staya_assign_waypoint(agent, 0, &waypoint(5000)),
                Motion::Cells => staya_assign_cell(agent, 30, 28),
            }
        };
        assert_eq!(status == StayaStatus::Ok, twin.assign(&task).is_ok(), "{case}");
        twins.push((twin, settings.motion()));
        memories.push(memory);
    }
    let land: Vec<u8> = (0..121u32).map(|cell| (cell.wrapping_mul(2_654_435_761) >> 30) as u8 + 1).collect();
    let (mut workspace, mut said) = (Workspace::default(), vec![Vec::new(); 2]);
    for step in 0..12u32 {
        let heard = said.concat();
        for (place, (memory, (twin, motion))) in (0..).zip(memories.iter_mut().zip(&mut twins)) {
            let agent: *mut StayaAgent = (&raw mut **memory).cast();
            let (mut inputs, mut out) = nothing();
            let (cell, origin) = (Cell::new(20 + place, 20), Cell::new(15 + place, 15));
            inputs.position_mm = [i32::from(place) * 300 + step as i32 * 20, 0, 0];
            (inputs.now_us, inputs.max_speed_mps) = (step * TICK_US as u32, 0.5);
            (inputs.cell, inputs.window_origin, inputs.cell_m) = (cell.into(), origin.into(), 1.0);
            (inputs.window_width, inputs.window_height, inputs.window) = (SIDE, SIDE, land.as_ptr());
            (inputs.inbox, inputs.inbox_bytes) = (heard.as_ptr(), heard.len());
            // SAFETY: all pointers are valid.
            assert_eq!(unsafe { staya_step(agent, &inputs, &mut out) }, StayaStatus::Ok);
            let position = Position::from_mm(inputs.position_mm);
            let plane = InPlane { max_speed_mps: cast(0.5), obstacles: &[] };
            let grid = OnGrid {
                cell: CellState { cell, busy: Duration::ZERO },
                window: Window::new(&land, origin, SIDE, SIDE),
            };
            let in_cell = InCell { offset_m: Vec2::new(cast(0.0), cast(0.0)), cell_m: cast(1.0) };
            let own = Inputs {
                state: KinematicState { position, ..KinematicState::default() },
                surroundings: match (motion, on_grid) {
                    (Motion::Velocities, _) => AnySurroundings::InPlane(plane),
                    (Motion::Cells, 0) => AnySurroundings::InCells(InCells { grid, plane, in_cell }),
                    (Motion::Cells, _) => AnySurroundings::OnGrid(grid),
                },
                inbox: &heard,
            };
            let mut own_out = Outputs::default();
            let now = Instant::from_micros(inputs.now_us);
            twin.hear_into(&own, now, &mut own_out);
            twin.act_into(&own, now, &mut workspace, &mut own_out);
            shows(&out, &own_out, twin.mode(), &format!("{case}: step {step} of {place}"));
            said[place as usize] = own_out.outbox.to_vec();
        }
    }
    for (memory, (twin, _)) in memories.iter().zip(&twins) {
        let mut digest = 0;
        // SAFETY: there is an agent.
        assert_eq!(unsafe { staya_digest((&raw const **memory).cast(), &mut digest) }, StayaStatus::Ok);
        assert_eq!((digest, twin.neighbors().len()), (twin.digest(), 1), "{case}");
    }
    true
}

/// The rows that must be given, all one.
fn needed(tables: Tables, name: &str) -> Values {
    let all = rows(tables, name).into_iter();
    all.filter(|(row, _)| row.absent == Absent::Needed).map(|(row, _)| (row.name, 1.0)).collect()
}

/// The needed values, and then also another one of each row.
fn variants(tables: Tables, name: &str) -> Vec<Values> {
    let usual = needed(tables, name);
    let mut all = vec![usual.clone()];
    for (row, value) in rows(tables, name) {
        if matches!(row.absent, Absent::OfBody(_)) {
            continue;
        }
        let [least, greatest] = row.range;
        let other = match row.words.len() {
            0 if value.is_finite() => (value * 1.5 + 0.25).min(greatest).max(least),
            0 => 1.0,
            _ if value == 0.0 => 1.0,
            _ => 0.0,
        };
        let others = usual.iter().copied().filter(|(name, _)| *name != row.name);
        all.push(others.chain([(row.name, other)]).collect());
    }
    all
}

#[test]
fn each_law_and_layer_by_name_equals_that_of_rust() {
    let [laws, layers] = BOTH.map(|(_, _, _, _, tables)| tables);
    let (mut accepted, mut all) = (0, 0);
    for (name, _) in LawSettings::ALL {
        let motion = LawSettings::by_name(name).unwrap().motion();
        for on_grid in if motion == Motion::Cells { 0..2 } else { 0..1 } {
            let made: Vec<_> = variants(laws, name)
                .iter()
                .map(|values| twins_agree((name, values), ("none", &Vec::new()), on_grid))
                .collect();
            assert!(made[0], "{name}");
            all += made.len();
            accepted += made.into_iter().filter(|is| *is).count();
        }
    }
    for (name, _) in LayerSettings::ALL {
        for values in variants(layers, name) {
            assert!(twins_agree(("waypoint", &Vec::new()), (name, &values), 0), "{name} {values:?}");
        }
    }
    assert!(accepted * 10 >= all * 9, "only {accepted} of {all} laws are accepted");
}

fn refused(setup: &StayaSetup, status: StayaStatus, row: &str) {
    let [number, place, what, remedy] = explained(setup);
    assert_eq!((number, &*place), ((status as i32).to_string(), row));
    assert!(what.len() > 5 && remedy.len() > 5, "{what}: {remedy}");
    assert_eq!(Memory::new().agent(setup).unwrap_err(), status);
}

#[test]
fn a_law_or_layer_without_its_feature_does_not_exist() {
    let all = [
        (cfg!(feature = "flocks"), 0, "lattice goal_flock boids"),
        (cfg!(feature = "grid"), 0, "route formation"),
        (cfg!(feature = "space"), 1, "fly"),
        (cfg!(feature = "push-out"), 1, "push_out"),
        (cfg!(feature = "table"), 1, "template_2k"),
    ];
    for (is_there, half, names) in all {
        for name in names.split(' ') {
            let (mut setup, choose) = (setup(1), BOTH[half].1);
            // SAFETY: all pointers are valid.
            let status = unsafe { choose(&mut setup, string(name).as_ptr()) };
            assert_eq!(status, if is_there { StayaStatus::Ok } else { StayaStatus::Law }, "{name}");
        }
    }
}

#[test]
fn faults_of_a_setup_name_row_and_remedy() {
    assert_eq!(explained(&setup(1)), ["0", "", "", ""]);
    refused(&StayaSetup { speed_mps: 0.0, ..setup(1) }, StayaStatus::Number, "speed_mps");
    refused(&StayaSetup { tolerance_m: f32::NAN, ..setup(1) }, StayaStatus::Number, "tolerance_m");
    refused(&StayaSetup { on_grid: 1, ..setup(1) }, StayaStatus::Contradiction, "on_grid");
    refused(&StayaSetup { protocol: 63, ..chosen(1, staya_choose_law, "external") }, StayaStatus::Choice, "protocol");
    #[cfg(feature = "grid")]
    for sight_cells in [0, 6] {
        let route = StayaSetup { sight_cells, ..chosen(1, staya_choose_law, "route") };
        refused(&route, StayaStatus::Search, "sight_cells");
    }
    assert_eq!(Memory::new().agent(&StayaSetup { law: 200, ..setup(1) }).unwrap_err(), StayaStatus::Law);
}

#[cfg(all(feature = "flocks", feature = "push-out"))]
#[test]
fn faults_of_values_name_row_and_remedy() {
    let mut push_out = chosen(1, staya_choose_layer, "push_out");
    refused(&push_out, StayaStatus::Needed, "push_out.min_distance_m");
    // A caller who writes into private fields.
    push_out.layer_values[0] = -1.0;
    refused(&push_out, StayaStatus::Range, "push_out.min_distance_m");

    let mut both = chosen(1, staya_choose_law, "goal_flock");
    // SAFETY: all pointers are valid.
    assert_eq!(unsafe { staya_choose_layer(&mut both, c"push_out".as_ptr()) }, StayaStatus::Ok);
    assert_eq!(set(&mut both, "min_distance_m", 0.5), StayaStatus::Ok);
    assert_eq!((both.law_values.iter().chain(&both.layer_values)).filter(|value| **value == 0.5).count(), 2);
    assert_eq!(set(&mut both, "push_out.min_distance_m", 0.25), StayaStatus::Ok);
    assert_eq!((both.law_values.iter().chain(&both.layer_values)).filter(|value| **value == 0.5).count(), 1);
    assert_eq!(explained(&both)[0], "0");
    assert_eq!(set(&mut both, "neighborhood_m", 0.75), StayaStatus::Ok);
    refused(&both, StayaStatus::Contradiction, "goal_flock.neighborhood_m");
}

/// Every text that C shows fits: texts are not cut off.
#[test]
fn texts_are_complete() {
    for (names, _, _, _, tables) in BOTH {
        for (name, what) in names {
            assert!(name.len() < 20 && what.len() < 108, "{name}: {}", what.len());
            for (row, _) in rows(tables, name) {
                assert!(row.words.join(" ").len() < 64 && name.len() + row.name.len() < 35, "{}", row.name);
            }
        }
    }
}

/// The tolerance of a body is a field of a setup and a row of the goal flock.
const OF_BOTH: &str = "tolerance_m";

/// Rows have one home, the controller's tables: neither their names nor their numbers stand in
/// header or sources.
#[test]
fn no_row_stands_in_header_or_sources() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![here.join("include/staya.h")];
    for folder in ["src", "src/setup", "src/alone"] {
        let all = fs::read_dir(here.join(folder)).unwrap().map(|entry| entry.unwrap().path());
        files.extend(all.filter(|file| file.extension().is_some_and(|rs| rs == "rs") && !file.ends_with("tests.rs")));
    }
    assert!(files.len() > 15);
    let mut names = Vec::new();
    for (all, _, _, _, tables) in BOTH {
        let rows = all.iter().flat_map(|(name, _)| rows(tables, name));
        names.extend(rows.filter(|(row, _)| !matches!(row.absent, Absent::OfBody(_))).map(|(row, _)| row.name));
    }
    let is_inside = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut found = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for name in names.iter().filter(|name| **name != OF_BOTH) {
            // A word of everyday language is a row as a field or in quotes only.
            let is_word = name.chars().all(char::is_alphabetic);
            let stands = text.match_indices(name).any(|(at, _)| {
                let (before, after) = (&text[..at], &text[at + name.len()..]);
                let is_whole = !before.ends_with(is_inside) && !after.starts_with(is_inside);
                let is_field = before.ends_with(['.', '"']) || before.ends_with("pub ") || after.starts_with(';');
                is_whole && (is_field || !is_word)
            });
            found.extend(stands.then(|| format!("{}: {name}", file.display())));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}
