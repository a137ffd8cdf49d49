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
    for name in ["figure-5.toml", "mixed.toml", "twenty-discs.toml"] {
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
        assert!((100..=240).contains(&decoder.height()));
        let mut frames = 0;
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert!(frames > 0 || (frame.width, frame.left) == (200, 0));
            assert!(frame.delay >= 5);
            frames += 1;
        }
        assert_eq!(frames, 20, "{name}");
    }
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
    let frames: Vec<_> = (0..101).map(|tick| Frame { tick, ..Frame::default() }).collect();
    let ticks = |most| choose(&frames, most).iter().map(|frame| frame.tick).collect::<Vec<_>>();
    assert_eq!(ticks(5), [0, 25, 50, 75, 100]);
    assert_eq!(ticks(1), [0, 100]);
    assert_eq!(ticks(1000).len(), 101);
    assert!(choose(&[], 5).is_empty());
}
