use super::*;
use std::fs;

fn tick(tick: u32) -> TickRow {
    TickRow {
        tick,
        time_s: f64::from(tick) * 0.1,
        formation_error_per_agent: 1.5,
        graph_distance: f64::NAN,
        packets: PacketCounts { sent: 6, delivered: 20, lost: 9, damaged: 2, rejected: 1, ..PacketCounts::default() },
    }
}

fn robot(id: u32, x: i16) -> RobotRow {
    RobotRow {
        id,
        motion: Motion {
            cell: Cell::new(x, -1),
            position_m: [f64::from(x) + 0.5, -0.5, 0.0],
            velocity_mps: [1.0, 0.0, 0.0],
        },
        mode: Mode::Cruise,
        leader: id - 1,
        target: Cell::new(9, 9),
        target_m: (id == 1).then_some([2.5, -3.0, 0.0]),
        wait: (x == 2).then_some(Wait::Robots),
        formation_error_cells: f32::NAN,
        radius_m: (id == 1).then_some(0.25),
        has_cells: id > 1,
    }
}

fn run(recorder: &mut Recorder, ticks: u32, robots: u32) {
    for t in 0..ticks {
        let rows = (1..=robots).map(|id| robot(id, t as i16));
        recorder.tick(&tick(t), rows).unwrap();
    }
}

fn read(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.ends_with('\n'));
    let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let mut lines = text.lines().map(split);
    let header = lines.next().unwrap();
    let lines: Vec<_> = lines.collect();
    assert!(lines.iter().all(|line| line.len() == header.len()));
    (header, lines)
}

#[test]
fn csv_files_have_the_columns_of_their_schema() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("made/by/the/recorder");
    let mut recorder = Recorder::new(&out, Options::default()).unwrap();
    run(&mut recorder, 3, 2);
    recorder.finish().unwrap();

    let (header, lines) = read(&out.join("trace.csv"));
    assert_eq!(lines.len(), 6);
    assert_eq!(lines[3].join(","), "1,0.1,2,1,-1,1.5,-0.5,0,1,0,0,cruise,1,9,9,,,,,,", "an unknown value is empty");
    assert_eq!(lines[2].join(","), "1,0.1,1,,,1.5,-0.5,0,1,0,0,cruise,0,,,,,2.5,-3,0,0.25", "without cells");
    assert_eq!(lines[5][16], "robots");
    let (series_header, series) = read(&out.join("series.csv"));
    assert_eq!(series[2].join(","), "2,0.2,1.5,,6,20,9,2,1");
    for (name, header) in [("trace", header), ("series", series_header)] {
        let text = fs::read_to_string(out.join(format!("{name}.schema.json"))).unwrap();
        let schema: serde_json::Value = serde_json::from_str(&text).unwrap();
        let names: Vec<_> =
            schema["columns"].as_array().unwrap().iter().map(|column| column["name"].as_str().unwrap()).collect();
        assert_eq!(names, header);
    }
}

#[test]
fn a_run_without_ticks_leaves_headers_and_an_empty_history() {
    let dir = tempfile::tempdir().unwrap();
    let recorder = Recorder::new(dir.path(), Options::default()).unwrap();
    let history = recorder.finish().unwrap();
    assert!(history.frames().is_empty() && history.series().is_empty());
    assert_eq!(read(&dir.path().join("trace.csv")).1.len(), 0);
}

#[test]
fn the_trace_interval_is_given_or_follows_the_number_of_robots() {
    for (every, robots, expected) in [(4, 1, 3), (0, 1, 10), (0, 1000, 10_000), (0, 1001, 5005)] {
        let dir = tempfile::tempdir().unwrap();
        let options = Options { trace_every: every, ..Options::default() };
        let mut recorder = Recorder::new(dir.path(), options).unwrap();
        run(&mut recorder, 10, robots);
        recorder.finish().unwrap();
        assert_eq!(read(&dir.path().join("trace.csv")).1.len(), expected);
        assert_eq!(read(&dir.path().join("series.csv")).1.len(), 10);
    }
}

#[test]
fn a_dropped_recorder_leaves_complete_ticks() {
    let dir = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::new(dir.path(), Options::default()).unwrap();
    run(&mut recorder, 500, 7);
    let (_, lines) = read(&dir.path().join("trace.csv"));
    assert!(!lines.is_empty() && lines.len() % 7 == 0);
    drop(recorder);
    assert_eq!(read(&dir.path().join("trace.csv")).1.len(), 3500);
}

#[test]
fn the_history_is_thinned_but_keeps_the_first_and_last_frame() {
    for max in [0, 1, 39, 40, 41] {
        let mut recorder = Recorder::in_memory(Options { history_samples: max, ..Options::default() });
        run(&mut recorder, 1000, 4);
        let history = recorder.finish().unwrap();
        let ticks: Vec<_> = history.frames().iter().map(|frame| frame.tick).collect();
        assert_eq!((ticks[0], *ticks.last().unwrap()), (0, 999));
        assert!(ticks.len() <= (max / 4).max(1) + 1, "{max}: {ticks:?}");
        assert!(ticks.len() >= max / 8, "{max}: {ticks:?}");
        let steps: Vec<_> = ticks[..ticks.len() - 1].windows(2).map(|t| t[1] - t[0]).collect();
        assert!(steps.windows(2).all(|pair| pair[0] == pair[1]), "{max}: {ticks:?}");
    }
}

#[test]
fn the_series_merges_neighbours_without_losing_packets() {
    let mut recorder = Recorder::in_memory(Options::default());
    run(&mut recorder, 50_000, 0);
    let history = recorder.finish().unwrap();
    let points = history.series();
    assert!((8000..=16_384).contains(&points.len()));
    assert_eq!(points.iter().map(|point| point.ticks).sum::<u32>(), 50_000);
    assert_eq!(points.iter().map(|point| point.packets.sent).sum::<u64>(), 300_000);
    assert_eq!(history.totals().delivered, 1_000_000);
    assert!(points.iter().all(|point| (point.formation_error_per_agent - 1.5).abs() < 1e-12));
    assert!(points.iter().all(|point| point.graph_distance.is_nan()));
}

#[test]
fn a_missing_error_does_not_affect_merged_neighbours() {
    let mut point = SeriesPoint::from(&tick(0));
    point.merge(&SeriesPoint {
        graph_distance: 4.0,
        formation_error_per_agent: f64::NAN,
        ..SeriesPoint::from(&tick(1))
    });
    assert_eq!((point.graph_distance, point.formation_error_per_agent), (4.0, 1.5));
}

#[test]
fn a_directory_in_place_of_a_file_is_named_in_the_error() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    fs::write(&file, "not a directory").unwrap();
    let error = Recorder::new(file.join("out"), Options::default()).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("file/out") && text.contains("in the way"), "{text}");

    fs::create_dir(dir.path().join("trace.csv")).unwrap();
    let text = Recorder::new(dir.path(), Options::default()).unwrap_err().to_string();
    assert!(text.contains("trace.csv") && text.contains("in the way"), "{text}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_error_names_the_file() {
    let dir = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/dev/full", dir.path().join("trace.csv")).unwrap();
    let text = Recorder::new(dir.path(), Options::default()).unwrap_err().to_string();
    assert!(text.contains("trace.csv") && text.contains("free some space"), "{text}");
}

#[test]
fn a_failed_atomic_write_leaves_only_the_old_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("picture");
    fs::create_dir(&path).unwrap();
    fs::write(path.join("old"), "old").unwrap();
    let error = write_atomically(&path, b"new").unwrap_err();
    assert_eq!(error.path(), path);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);

    let file = dir.path().join("file");
    write_atomically(&file, b"1").unwrap();
    write_atomically(&file, b"2").unwrap();
    assert_eq!(fs::read(&file).unwrap(), b"2");
}

#[test]
fn the_summary_is_json_with_fields_in_order() {
    let dir = tempfile::tempdir().unwrap();
    write_summary(dir.path(), &tick(0).packets).unwrap();
    let text = fs::read_to_string(dir.path().join("summary.json")).unwrap();
    assert!(text.starts_with("{\n  \"sent\": 6,\n  \"delivered\": 20,"), "{text}");
}
