use super::{MidpointTree, MutualPairs, Quadtree, Tree};
use staya_controller::rand::Rng;
use staya_sim::nearby::{AllPairs, Found, Query, Search, Space};

type Points = Vec<[f64; 2]>;

fn answers(mut search: impl Search<f64, 2>, points: &Points, queries: &[Query<f64, 2>]) -> Vec<Vec<Found<f64, 2>>> {
    search.rebuild(points);
    let mut found = Vec::new();
    let answer = |query| {
        search.within(query, &mut found);
        found.clone()
    };
    queries.iter().map(answer).collect()
}

fn assert_agree(space: Space<f64, 2>, points: &Points, queries: &[Query<f64, 2>]) {
    let expected = answers(AllPairs::new(space), points, queries);
    assert_eq!(expected, answers(Tree::new(space), points, queries));
    assert_eq!(expected, answers(MidpointTree::new(space), points, queries));
    assert_eq!(expected, answers(Quadtree::new(space), points, queries));
    for radius in [0.0, 1.0, 5.0] {
        assert_eq!(expected, answers(MutualPairs::new(space, radius), points, queries), "{radius}");
    }
}

#[test]
fn searches_agree_with_the_reference() {
    let spaces = [Space::OPEN, Space::torus([8.0, 9.5]).expect("above 0"), Space::torus([3.5, 20.0]).expect("above 0")];
    for seed in 0..60 {
        let mut rng = Rng::keyed(seed, 1, 2, 3);
        // A coarse grid makes points coincide and distances equal to the radius.
        let mut coordinate = || match rng.below(2) {
            0 => f64::from(rng.below(33)) / 2.0 - 4.0,
            _ => f64::from(rng.below(16_000)) / 1000.0 - 4.0,
        };
        let count = [0, 1, 2, 40, 150][seed as usize % 5];
        let points: Points = (0..count).map(|_| [coordinate(), coordinate()]).collect();
        let query = |index: u32| Query {
            at: points.get(index as usize).copied().unwrap_or([0.5, 0.5]),
            radius: f64::from(index % 24) / 2.0,
            most: [0, 3, 40, usize::MAX][index as usize % 4],
            except: (!index.is_multiple_of(3)).then_some(index),
        };
        let queries: Vec<_> = (0..12).map(query).collect();
        for space in spaces {
            assert_agree(space, &points, &queries);
        }
    }
}

#[test]
fn points_that_are_not_finite_are_never_found() {
    let mut points = vec![[1.0, 1.0], [2.0, 1.0]];
    points.extend([f64::NAN, f64::INFINITY].map(|bad| [bad, 1.0]));
    let query = |at, radius| Query { at, radius, most: 9, except: None };
    let queries = [query([1.0, f64::NAN], 5.0), query([1.0, 1.0], f64::INFINITY), query([1.0, 1.0], 1e300)];
    assert_agree(Space::OPEN, &points, &queries);
    assert_agree(Space::torus([7.0, 7.0]).expect("above 0"), &points, &queries);
}

#[test]
fn midpoint_tree_supports_extremely_uneven_points() {
    // Each point is half as far as the previous one, so each cut separates a single point.
    let mut points: Points = (0..900).map(|i| [libm::exp2(-f64::from(i)), 1.0]).collect();
    points.extend(std::iter::repeat_n([0.25, 1.0], 50));
    let query = |at, radius, most| Query { at, radius, most, except: None };
    let queries = [query([0.25, 1.0], 0.01, 60), query([0.0, 1.0], 1e-9, 2000), query([1.0, 1.0], 2.0, 2000)];
    let found = answers(MidpointTree::new(Space::OPEN), &points, &queries);
    assert_eq!(found, answers(AllPairs::new(Space::OPEN), &points, &queries));
    assert_eq!(found[0].len(), 51);
}
