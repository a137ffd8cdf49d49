use super::*;
use gif::{ColorOutput, DecodeOptions};
use staya_sim::engine::simulate;
use staya_sim::record::{Options, Recorder};
use staya_sim::scenario::Overrides;
use std::ops::ControlFlow;
use std::path::PathBuf;

fn run(name: &str, ticks: u32) -> (Scenario, History) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name);
    let scenario = Scenario::load(&path, &Overrides { ticks: Some(ticks), seed: None }).unwrap();
    let mut recorder = Recorder::in_memory(Options::default());
    simulate(&scenario, |moment, robots| {
        recorder.tick(moment.row, robots).unwrap();
        ControlFlow::Continue(())
    })
    .unwrap();
    (scenario, recorder.finish().unwrap())
}

#[test]
fn runs_on_the_grid_in_the_plane_and_on_land_become_pictures_that_move() {
    for name in ["figure-5.toml", "mixed.toml", "twenty-discs.toml", "downwash.toml"] {
        let (scenario, history) = run(name, 30);
        let look = Look { width: 200, seconds: 1 };
        let bytes = of_run(&scenario, &history, look).unwrap();
        if name == "mixed.toml" {
            assert_eq!(bytes, of_run(&scenario, &history, look).unwrap(), "identical each time");
        }
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::Indexed);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        assert_eq!(decoder.width(), 200, "{name}");
        assert!((126..=266).contains(&decoder.height()));
        let mut frames = 0;
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert!(frames > 0 || (frame.width, frame.left) == (200, 0));
            assert!(frame.delay >= 5);
            frames += 1;
        }
        assert_eq!(frames, 20, "{name}");
    }
}

/// Columns and rows of saturated pixels, as an extent.
fn coloured(picture: &Pixmap) -> [[f64; 2]; 2] {
    let width = picture.width() as usize;
    let pixels = picture.pixels().iter().enumerate();
    let found = pixels.filter(|(_, pixel)| pixel.red().abs_diff(pixel.blue()) > 90);
    crate::canvas::extent(found.map(|(at, _)| [at % width, at / width].map(|c| c as f64)))
}

#[test]
fn flyers_above_each_other_are_apart_in_the_picture() {
    let (mut scenario, history) = run("downwash.toml", 2);
    let last = &history.frames()[1];
    let in_space = coloured(&Frames::new(&scenario, &history, 300).unwrap().next(last).unwrap());
    // The ratio of height to width of two rings one above the other; from above it is 1.
    let ratio = |[low, high]: [[f64; 2]; 2]| (high[1] - low[1]) / (high[0] - low[0]);
    let setup = scenario.plane_mut().unwrap();
    for start in &mut setup.starts {
        start.position_m[2] = 0.0;
        start.places.iter_mut().for_each(|place| place.position_m[2] = 0.0);
    }
    let from_above = coloured(&Frames::new(&scenario, &history, 300).unwrap().next(last).unwrap());
    assert!((ratio(from_above) - 1.0).abs() < 0.1, "{from_above:?}");
    assert!((ratio(in_space) - 1.0).abs() > 0.1, "{in_space:?}");
}

#[test]
fn what_has_changed_is_all_that_is_kept() {
    let (before, mut now) = (vec![0; 12], vec![0; 12]);
    assert_eq!(changed(None, &now, 4, 3), [0, 0, 4, 3]);
    assert_eq!(changed(Some(&before), &now, 4, 3), [0, 0, 1, 1]);
    (now[5], now[10]) = (7, 8);
    let part = changed(Some(&before), &now, 4, 3);
    assert_eq!(part, [1, 1, 2, 2]);
    assert_eq!(cut(Some(&before), &now, 4, part), [7, CLEAR, CLEAR, 8]);
}

#[test]
fn frames_are_chosen_evenly_with_first_and_last() {
    let of = |items, most| evenly(items, most).collect::<Vec<_>>();
    assert_eq!(of(101, 5), [0, 25, 50, 75, 100]);
    assert_eq!(of(101, 1), [0, 100]);
    assert_eq!(of(101, 1000).len(), 101);
    assert_eq!((of(0, 5), of(1, 5)), (vec![], vec![0]));
}
