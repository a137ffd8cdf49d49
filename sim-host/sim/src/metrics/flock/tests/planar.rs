use super::super::*;
use super::{crowd, lattice};
use proptest::prelude::*;

fn links(places: &[[f64; 2]], range_m: f64) -> Vec<(u32, u32)> {
    let mut meter = FlockMeter::new(7.0, range_m, Space::OPEN);
    meter.look(places, &vec![[0.0; 2]; places.len()]).expect("robots");
    meter.edges().to_vec()
}

#[test]
fn a_lattice_is_planar_and_a_square_with_diagonals_is_not() {
    let places = lattice(7.0);
    assert_eq!(crossings(&places, &links(&places, 8.4)), Some(0));
    let square = [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [0.0, 5.0]];
    assert_eq!(crossings(&square, &links(&square, 8.4)), Some(1));
    // Without its diagonals the links only share ends.
    assert_eq!(crossings(&square, &links(&square, 6.0)), Some(0));
    assert_eq!(crossings(&[[1.0, 1.0]; 3], &[(0, 1), (1, 2)]), Some(0));
}

#[test]
fn links_in_space_have_no_crossings() {
    let square = [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [5.0, 5.0, 0.0], [0.0, 5.0, 0.0]];
    let diagonals = [(0, 2), (1, 3)];
    assert_eq!(crossings(&square, &diagonals), Some(1));
    assert_eq!(crossings(&square.map(|[x, y, _]| [x, y, 1.0]), &diagonals), None);
}

/// Whether two links cross, by the parameters of their point in common.
fn meet([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let (u, v, w) = (minus(b, a), minus(d, c), minus(c, a));
    let area = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let inside = |share: f64| share > 1e-9 && share < 1.0 - 1e-9;
    inside(area(w, v) / area(u, v)) && inside(area(w, u) / area(u, v))
}

proptest! {
    #[test]
    fn crossings_are_those_of_all_pairs_of_links(crowd in crowd()) {
        let places: Vec<_> = crowd.into_iter().map(|(place, _)| place).collect();
        let links = links(&places, 8.4);
        let ends = |(a, b): (u32, u32)| [places[a as usize], places[b as usize]];
        let pairs = (0..links.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let expected = pairs.filter(|(i, j)| {
            let (first, second) = (links[*i], links[*j]);
            let is_apart = ![second.0, second.1].iter().any(|end| [first.0, first.1].contains(end));
            is_apart && meet(ends(first), ends(second))
        });
        prop_assert_eq!(crossings(&places, &links), Some(expected.count()));
    }
}
