use super::*;
use proptest::prelude::*;

type Points<R, const D: usize> = Vec<[R; D]>;

fn answers<R: Real, const D: usize>(
    search: &mut dyn Search<R, D>,
    points: &[[R; D]],
    queries: &[Query<R, D>],
) -> Vec<Vec<Found<R, D>>> {
    search.rebuild(points);
    let mut found = Vec::new();
    let answer = |query| {
        search.within(query, &mut found);
        found.clone()
    };
    queries.iter().map(answer).collect()
}

fn agree<R: Real, const D: usize>(
    space: Space<R, D>,
    sides: &[R],
    points: &[[R; D]],
    queries: &[Query<R, D>],
) -> Result<(), TestCaseError> {
    let expected = answers(&mut AllPairs::new(space), points, queries);
    for &side in sides {
        let mut cells = Cells::new(space, side);
        prop_assert_eq!(&expected, &answers(&mut cells, points, queries));
        prop_assert!(answers(&mut cells, &points[..points.len() / 2], queries).len() == queries.len());
        prop_assert_eq!(&expected, &answers(&mut cells, points, queries));
    }
    Ok(())
}

fn query<R: Real, const D: usize>(at: [R; D], radius: R, most: usize) -> Query<R, D> {
    Query { at, radius, most, except: None }
}

fn indices<R, const D: usize>(found: &[Found<R, D>]) -> Vec<u32> {
    found.iter().map(|point| point.index).collect()
}

#[test]
fn results_are_sorted_by_distance_and_index() {
    let points = [[3.0, 0.0], [0.0, 1.0], [1.0, 0.0], [0.0, 0.0], [-1.0, 0.0]];
    let mut cells = Cells::new(Space::OPEN, 1.0);
    let within = |radius, most| query([0.0, 0.0], radius, most);
    let mut except = within(1.0, 9);
    except.except = Some(3);
    let queries = [
        within(3.0, 9),
        within(1.0, 2),
        within(2.999, 9),
        within(0.0, 9),
        within(-3.0, 9),
        within(f64::NAN, 9),
        within(3.0, 0),
        except,
    ];
    let expected: [&[u32]; 8] = [&[3, 1, 2, 4, 0], &[3, 1], &[3, 1, 2, 4], &[3], &[], &[], &[], &[1, 2, 4]];
    for (found, expected) in answers(&mut cells, &points, &queries).iter().zip(expected) {
        assert_eq!(indices(found), expected);
    }
    let found = &answers(&mut cells, &points, &queries)[0];
    assert_eq!((found[4].distance_squared, found[4].offset), (9.0, [3.0, 0.0]));
}

#[test]
fn a_torus_has_no_border() {
    let space = Space::torus([10.0_f32, 4.0]).expect("sides above 0");
    let points = [[9.5, 2.0], [0.5, 2.0], [0.0, 3.9], [5.0, 0.0], [-0.5, 6.0]];
    let queries = [query([0.0, 2.0], 0.5, 9), query([20.0, 0.0], 0.2, 9)];
    let mut cells = Cells::new(space, 1.0);
    let found = answers(&mut cells, &points, &queries);
    assert_eq!(indices(&found[0]), [0, 1, 4]);
    assert_eq!(found[0][0].offset, [-0.5, 0.0]);
    assert_eq!(indices(&found[1]), [2]);
    agree(space, &[1.0, 0.3], &points, &queries).expect("the same");
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(Space::torus([1.0, bad]).is_none());
    }
}

#[test]
fn non_finite_points_and_queries_find_nothing() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let mut points = vec![[1.0, 1.0], [2.0, 1.0]];
    points.extend(bad.map(|bad| [bad, 1.0]));
    points.extend(bad.map(|bad| [1.0, bad]));
    let mut queries: Vec<_> = bad.iter().map(|&bad| query([1.0, bad], 5.0, 9)).collect();
    queries.push(query([1.0, 1.0], f64::INFINITY, 9));
    queries.push(query([1.0, 1.0], 1e300, 9));
    for space in [Space::OPEN, Space::torus([7.0, 7.0]).expect("sound")] {
        agree(space, &[1.0, 0.0, f64::NAN], &points, &queries).expect("the same");
        let found = answers(&mut AllPairs::new(space), &points, &queries);
        assert!(found[..3].iter().all(Vec::is_empty));
        assert_eq!(indices(&found[3]), [0, 1]);
    }
}

#[test]
fn no_point_and_one_point_are_valid() {
    let queries = [query([0.5, 0.5, 0.5], 1.0, 3)];
    for space in [Space::OPEN, Space::torus([2.0; 3]).expect("sound")] {
        agree(space, &[1.0], &[], &queries).expect("the same");
        agree(space, &[1.0], &[[0.0; 3]], &queries).expect("the same");
    }
}

#[test]
fn distant_points_do_not_cost_memory() {
    let mut points: Points<f64, 2> = (0..1000).map(|i| [f64::from(i % 32), f64::from(i / 32)]).collect();
    points.push([1e9, -1e9]);
    let mut cells = Cells::new(Space::OPEN, 1.0);
    cells.rebuild(&points);
    assert!(cells.cells() <= 4096);
    let queries = [query([1e9, -1e9], 1.0, 9), query([5.0, 5.0], 1.0, 9)];
    agree(Space::OPEN, &[1.0], &points, &queries).expect("the same");
}

#[test]
fn the_order_by_cell_contains_every_point_once() {
    let points: Points<f32, 2> = (0..100).map(|i| [(i * 37 % 100) as f32, 0.0]).collect();
    let mut cells = Cells::new(Space::OPEN, 5.0);
    cells.rebuild(&points);
    let mut order = cells.order().to_vec();
    assert!(order.windows(2).any(|pair| pair[0] > pair[1]));
    order.sort_unstable();
    assert!(order.iter().copied().eq(0..100));
}

/// Mostly on a coarse grid, so that points coincide and radii are met exactly.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => (-8_i32..=24).prop_map(|steps| f64::from(steps) / 2.0),
        2 => -4.0_f64..12.0,
    ]
}

fn crowd<const D: usize>() -> impl Strategy<Value = Vec<[f64; D]>> {
    proptest::collection::vec(proptest::array::uniform::<_, D>(coordinate()), 0..150)
}

fn questions<const D: usize>() -> impl Strategy<Value = Vec<Query<f64, D>>> {
    let radius = prop_oneof![(0_i32..=16).prop_map(|steps| f64::from(steps) / 2.0), 0.0_f64..12.0];
    let one = (
        proptest::array::uniform::<_, D>(coordinate()),
        radius,
        prop_oneof![0_usize..12, Just(40), Just(usize::MAX)],
        proptest::option::of(0_u32..150),
    );
    let one = one.prop_map(|(at, radius, most, except)| Query { at, radius, most, except });
    proptest::collection::vec(one, 1..8)
}

fn to_f32<const D: usize>(query: &Query<f64, D>) -> Query<f32, D> {
    Query { at: query.at.map(|c| c as f32), radius: query.radius as f32, most: query.most, except: query.except }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn searches_agree_in_the_open(points in crowd::<2>(), queries in questions::<2>(), side in 0.1_f64..9.0) {
        agree(Space::OPEN, &[side, 1.0], &points, &queries)?;
    }

    #[test]
    fn searches_agree_on_a_torus(
        points in crowd::<2>(), queries in questions::<2>(), side in 0.1_f64..9.0,
        period in (1_u32..24, 1_u32..24),
    ) {
        let period = [f64::from(period.0) / 2.0, f64::from(period.1) / 2.0];
        let space = Space::torus(period).expect("above 0");
        agree(space, &[side, 1.0], &points, &queries)?;
    }

    #[test]
    fn searches_agree_in_space(points in crowd::<3>(), queries in questions::<3>(), side in 0.5_f64..9.0) {
        agree(Space::OPEN, &[side], &points, &queries)?;
        agree(Space::torus([8.0, 9.5, 4.0]).expect("above 0"), &[side], &points, &queries)?;
    }

    #[test]
    fn searches_agree_in_single_precision(
        points in crowd::<2>(), queries in questions::<2>(), side in 0.1_f32..9.0, far in -1e4_f64..1e4,
    ) {
        let mut points: Vec<[f32; 2]> = points.iter().map(|at| at.map(|c| (c + far) as f32)).collect();
        points.push([(-3.0 * far) as f32; 2]);
        let queries: Vec<_> = queries
            .iter()
            .map(|query| to_f32(&Query { at: query.at.map(|c| c + far), ..*query }))
            .collect();
        agree(Space::OPEN, &[side], &points, &queries)?;
        agree(Space::torus([7.1, 8.3]).expect("above 0"), &[side], &points, &queries)?;
    }
}
