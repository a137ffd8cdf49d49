use super::*;

fn small() -> Plan {
    Plan {
        boids: vec![1, 2, 60],
        steps: 12,
        most_by_all_pairs: 60,
        picture_steps: 40,
        picture_boids: 30,
        ..Plan::default()
    }
}

#[test]
fn all_searches_and_all_threads_give_the_same_trajectories() {
    let plan = small();
    let report = plan.measure().expect("a plan");
    assert_eq!(report.rows.len(), 3);
    assert!(report.equal);
    assert!(report.rows.iter().all(|row| row.timings.len() == 5));
    let hash = &report.rows[2].timings[0].hash;
    let mut flock = plan.flock(60);
    assert_ne!(&format!("{:016x}", flock.hash()), hash);
    let mut cells = Cells::new(flock.space, 33.0);
    for _ in 0..plan.steps {
        flock.step_in_parallel(&mut cells);
    }
    assert_eq!(&format!("{:016x}", flock.hash()), hash);
    assert!(report.rows[2].mean_neighbours > 1.0);
}

#[test]
fn flocks_match_their_recorded_hashes() {
    let mut flock = small().flock(60);
    let mut cells = Cells::new(flock.space, 150.0);
    (0..100).for_each(|_| flock.step(&mut cells));
    assert_eq!(format!("{:016x}", flock.hash()), "80d38a757c170a18");
}

#[test]
fn boids_align_and_stay_on_the_torus() {
    let plan = Plan { picture_steps: 600, ..small() };
    let report = plan.measure().expect("a plan");
    let steps: Vec<u32> = report.moments.iter().map(|moment| moment.step).collect();
    assert_eq!(steps, [0, 60, 600]);
    let order = |index: usize| report.moments[index].polarisation;
    assert!(order(0) < 0.4 && order(2) > 0.6, "{} {}", order(0), order(2));
    let (_, last) = &report.flocks[2];
    let [width, height] = last.sides();
    let is_inside = |&[x, y]: &[f32; 2]| (0.0..width).contains(&x) && (0.0..height).contains(&y);
    assert!(last.places().iter().all(is_inside));
    assert!((width / height - 4.0 / 3.0).abs() < 1e-5);
}

#[test]
fn all_pairs_are_skipped_above_the_limit_and_an_early_end_keeps_complete_rows() {
    let plan = Plan { most_by_all_pairs: 2, ..small() };
    let rows = plan.carry_out(|done| done < 2).expect("a plan");
    let report = plan.report(&rows);
    assert_eq!(plan.total(), 3);
    assert_eq!((report.rows.len(), report.moments.len()), (2, 0));
    let report = plan.measure().expect("a plan");
    let searches = |row: usize| report.rows[row].timings.len();
    assert_eq!([searches(0), searches(1), searches(2)], [5, 5, 3]);
    assert_eq!(report.rows[2].us_per_boid("all pairs"), None);
    assert!(report.equal);
}

#[test]
fn invalid_plans_are_refused() {
    let refused = |plan: Plan| plan.check().expect_err("refused").to_string();
    let none = Plan { boids: Vec::new(), ..small() };
    assert!(refused(none).contains("one or more"));
    let zero = Plan { boids: vec![3, 0], ..small() };
    assert!(refused(zero).contains("0 boids"));
    assert!(refused(Plan { steps: 0, ..small() }).contains("0 steps"));
    for value in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(refused(Plan { closest: value, ..small() }).contains("closest"));
    }
    for value in [-0.1, 3.2, f32::NAN] {
        assert!(refused(Plan { max_turn: value, ..small() }).contains("largest turn"));
        assert!(refused(Plan { max_turn_away: value, ..small() }).contains("largest turn away"));
    }
    let paper = Plan::default();
    paper.check().expect("the paper's");
    let values = [paper.area_per_boid, paper.speed, paper.crowded, paper.closest, paper.max_turn, paper.max_turn_away];
    assert_eq!(values, [24_000.0, 2.0, 30.0, 150.0, 0.05, 0.02]);
}

#[test]
fn pictures_are_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let report = small().measure().expect("a plan");
    let files = report.draw(dir.path()).expect("drawn");
    assert_eq!(files.len(), 4);
    assert!(files.iter().all(|file| file.is_file()));
}

#[test]
fn table_has_a_row_per_number_and_marks_skipped_searches() {
    let plan = Plan { boids: vec![4, 9], steps: 2, most_by_all_pairs: 5, picture_steps: 2, ..small() };
    let text = plan.measure().expect("a plan").to_string();
    assert_eq!(text.matches(" yes ").count(), 2);
    assert!(text.contains("only up to 5 boids") && text.contains("after 2 steps"));
    let second = text.lines().nth(3).expect("a line");
    assert!(second.split_whitespace().nth(3) == Some("-"), "{second}");
    assert!(second.split_whitespace().nth(4) == Some("-"), "{second}");
}
