use super::*;
use staya_controller::wire::{Addressed, Content as _};
use staya_mavlink::wire::decode;

/// The addressee, the number and the order in a frame.
fn ordered(message: Message) -> (RobotId, u8, GridOrder) {
    let Message::Order(Addressed { to, number, protocol, content }) = message else {
        panic!("{message:?}");
    };
    (to, number, GridOrder::decode(Grid::ID, protocol, &content).expect("an order on the grid"))
}

fn places(graph: &Graph) -> Vec<(i16, i16)> {
    graph.places.iter().map(|place| (place.x, place.y)).collect()
}

#[test]
fn shapes_have_their_expected_places() {
    let of = |shape: Shape, count| places(&shape.graph(count, 3).expect("room"));
    assert_eq!(of(Shape::Line, 5), [(0, 0), (0, 3), (0, -3), (0, 6), (0, -6)]);
    assert_eq!(of(Shape::Column, 3), [(0, 0), (-3, 0), (-6, 0)]);
    assert_eq!(of(Shape::Wedge, 5), [(0, 0), (-3, 3), (-3, -3), (-6, 6), (-6, -6)]);
    assert_eq!(of(Shape::Grid, 5), [(0, 0), (0, -3), (0, -6), (-3, 0), (-3, -3)]);
    assert_eq!(of(Shape::Circle, 4), [(0, 0), (-2, 2), (-4, 0), (-2, -2)]);
    assert_eq!(of(Shape::Circle, 1), [(0, 0)]);
}

#[test]
fn orders_of_every_shape_and_size_are_consistent() {
    for (name, shape) in Shape::NAMES {
        for count in [1, 2, 3, 6, 25, 254] {
            let graph = shape.graph(count, 3).expect(name);
            let order = Order { goal: Some(Cell::new(7, -8)), to_all: true, boot: 9, version: 4 };
            let robots: Vec<u8> = (1..=count as u8).collect();
            let mut heard = vec![Vec::new(); count];
            let mut goals = 0;
            for frame in orders(&graph, &robots, &order).expect(name) {
                let frame = decode(&frame).expect("a sound frame");
                assert_eq!((frame.header.sender.0, frame.header.boot), (255, 9));
                match ordered(frame.message) {
                    (to, 4, GridOrder::Template { part, .. }) => heard[to.0 as usize - 1].push(part),
                    (RobotId::NONE, 4, GridOrder::FormationGoal(target)) => {
                        goals += 1;
                        assert_eq!(target, Cell::new(7, -8));
                    }
                    other => panic!("{other:?}"),
                }
            }
            assert_eq!(goals, 1);
            for (own, parts) in heard.iter().enumerate() {
                assert_eq!(parts.len(), usize::from(parts[0].parts), "{name} {count} {own}");
                assert_eq!(parts[0].offset, graph.places[own]);
                let entries: Vec<_> = parts.iter().flat_map(|part| &part.entries).collect();
                assert!(count == 1 || !entries.is_empty(), "{name} {count} {own}");
                for entry in entries {
                    let there = graph.places[entry.id.0 as usize - 1];
                    assert_eq!(entry.offset, there - graph.places[own], "{name} {count} {own}");
                }
            }
        }
    }
}

#[test]
fn a_heading_turns_the_shape() {
    let graph = Shape::Column.graph(2, 3).and_then(|graph| graph.turned(Dir::North)).expect("room");
    let order = Order { goal: None, to_all: true, boot: 0, version: 0 };
    let frames = orders(&graph, &[1, 2], &order).expect("room");
    let (to, _, GridOrder::Template { part, .. }) = ordered(decode(&frames[1]).expect("sound").message) else {
        panic!("a template");
    };
    assert_eq!((to.0, part.offset), (2, Cell::new(0, -3)));
}

#[test]
fn a_file_parses_and_its_errors_are_reported() {
    let text = "places = [[0, 0], [-3, 3], [-3, -3]]\nedges = [[1, 2], [3, 1], [1, 3]]";
    let graph = Graph::parse(text, Path::new("v.toml")).expect("a formation");
    assert_eq!((graph.robots(), graph.edges.as_slice()), (3, &[(0, 1), (0, 2)][..]));
    for (text, piece) in [
        ("places = [[1, 0]]\nedges = []", "first place is not [0, 0]"),
        ("places = []\nedges = []", "first place"),
        ("places = [[0, 0], [3, 0]]\nedges = [[1, 3]]", "[1, 3] does not connect two robots"),
        ("places = [[0, 0], [3, 0]]\nedges = [[0, 1]]", "numbers from 1 to 2"),
        ("places = [[0, 0], [3, 0]]\nedges = []", "robot 2 is not connected to robot 1"),
        ("places = [[0, 0], [0, 0]]\nedges = [[1, 2]]", "places 1 and 2 would share a cell"),
        ("places = [[0, 0], [40000, 0]]\nedges = [[1, 2]]", "robot 2 would be off any map"),
        ("places = [[0, 0]]\nedge = []", "v.toml:2:1: edge: unknown field `edge`"),
    ] {
        let error = format!("{:#}", Graph::parse(text, Path::new("v.toml")).expect_err(text));
        assert!(error.starts_with("v.toml:") && error.contains(piece), "{text}: {error}");
    }
    let star: Vec<_> = (2..=10).map(|other| format!("[1, {other}]")).collect();
    let places: Vec<_> = (0..10).map(|x| format!("[{x}, 0]")).collect();
    let graph =
        Graph::parse(&format!("places = [{}]\nedges = [{}]", places.join(","), star.join(",")), Path::new("v.toml"));
    let order = Order { goal: None, to_all: true, boot: 0, version: 0 };
    let ten: Vec<u8> = (1..=10).collect();
    // A turn by 45 degrees moves touching cells together.
    let turned = Shape::Grid.graph(9, 1).and_then(|graph| graph.turned(Dir::NorthEast));
    for (error, piece) in [
        (orders(&graph.expect("a formation"), &ten, &order).expect_err("nine neighbours"), "robot 1 has more than 8"),
        (Shape::Line.graph(255, 3).expect_err("too many"), "255 robots is not possible; give 1 to 254"),
        (Shape::Line.graph(0, 3).expect_err("none"), "0 robots is not possible"),
        (Shape::Column.graph(254, 100).expect_err("far"), "robot 101 would be off any map"),
        (turned.expect_err("one cell"), "would share a cell; give a larger spacing, or another heading"),
    ] {
        assert!(error.to_string().contains(piece), "{piece}: {error}");
    }
}

#[test]
fn nearest_places_have_shorter_paths_without_crossings() {
    use staya_controller::rand::Rng;
    let squared = |[x, y]: [f64; 2]| x * x + y * y;
    for (name, shape) in Shape::NAMES {
        for (seed, count) in [(1, 2), (2, 6), (3, 12), (4, 40), (5, 100)] {
            let graph = shape.graph(count, 3).and_then(|graph| graph.turned(Dir::North)).expect(name);
            let mut rng = Rng::keyed(seed, 1, 0, 0);
            let mut draw = || f64::from(rng.below(100_000)) / 500.0;
            let at: Vec<_> = (0..count).map(|_| [draw(), draw()]).collect();
            let near = graph.nearest(&at);
            let mut sorted = [places(&near), places(&graph)];
            sorted.iter_mut().for_each(|places| places.sort_unstable());
            assert_eq!(sorted[0], sorted[1], "{name}: the same places");
            let to = |graph: &Graph, robot: usize| [graph.places[robot].x, graph.places[robot].y].map(f64::from);
            for a in 0..count {
                for b in 0..a {
                    // Robots do not meet if their paths keep the direction between them.
                    let (pa, pb) = (to(&near, a), to(&near, b));
                    let off = [at[a][0] - at[b][0], at[a][1] - at[b][1]];
                    let dot = off[0] * (pa[0] - pb[0]) + off[1] * (pa[1] - pb[1]);
                    assert!(dot > -0.1, "{name} {count}: {a} and {b} by {dot}");
                }
            }
            for robot in 1..count as u16 {
                assert!(near.edges.iter().any(|&(_, larger)| larger == robot), "{name} {count}: {robot}");
            }
            let robots: Vec<u8> = (1..=count as u8).map(|robot| robot * 2).collect();
            let order = Order { goal: Some(Cell::new(50, 60)), to_all: false, boot: 0, version: 0 };
            let frames = orders(&near, &robots, &order).expect(name);
            let goals: Vec<_> = frames
                .iter()
                .filter_map(|frame| match ordered(decode(frame).expect("sound").message) {
                    (to, _, GridOrder::FormationGoal(target)) => Some((to.0 as u8, target)),
                    _ => None,
                })
                .collect();
            let front = Cell::new(50, 60) + near.places[0];
            assert_eq!(goals, robots.iter().map(|&robot| (robot, front)).collect::<Vec<_>>());
            let total = |graph: &Graph| -> f64 {
                let middle = |of: &dyn Fn(usize) -> [f64; 2]| {
                    [0, 1].map(|axis| (0..count).map(|robot| of(robot)[axis]).sum::<f64>() / count as f64)
                };
                let (here, there) = (middle(&|robot| at[robot]), middle(&|robot| to(graph, robot)));
                let way = |robot: usize| {
                    [0, 1].map(|axis| at[robot][axis] - here[axis] - to(graph, robot)[axis] + there[axis])
                };
                (0..count).map(|robot| squared(way(robot))).sum()
            };
            assert!(total(&near) <= total(&graph), "{name} {count}");
        }
    }
}

#[test]
fn offset_and_scale_of_positions_do_not_change_the_assignment() {
    let graph = Shape::Wedge.graph(5, 3).expect("room");
    let at = [[0.0, 9.0], [-7.0, 2.0], [4.0, 1.0], [1.0, -5.0], [3.0, 8.0]];
    let near = graph.nearest(&at);
    assert_ne!(near.places, graph.places);
    let moved = at.map(|[x, y]| [7e8 + 90.0 * x, -3e8 + 90.0 * y]);
    assert_eq!(graph.nearest(&moved), near);
    assert_eq!(graph.nearest(&[[1.0, 2.0]; 5]).robots(), 5);
}

/// For each pair of shapes: total path length in cells, and pairs of robots that come within a cell
/// of each other on straight paths. `--nocapture` prints a table.
#[test]
fn changes_between_shapes_have_shorter_paths_with_nearest_places() {
    for count in [6, 12, 40] {
        let (mut ways, mut meetings) = ([0.0, 0.0], [0, 0]);
        for (from_name, from) in Shape::NAMES {
            for (to_name, to) in Shape::NAMES.into_iter().filter(|(name, _)| *name != from_name) {
                let graph = |shape: Shape| shape.graph(count, 3).expect("room");
                let (from, to) = (graph(from), graph(to));
                let at: Vec<_> = from.places.iter().map(|place| [place.x, place.y].map(f64::from)).collect();
                for (order, goal) in [&to, &to.nearest(&at)].into_iter().enumerate() {
                    let there: Vec<_> = goal.places.iter().map(|place| [place.x, place.y].map(f64::from)).collect();
                    let middle = |of: &[[f64; 2]]| {
                        [0, 1].map(|axis| of.iter().map(|at| at[axis]).sum::<f64>() / of.len() as f64)
                    };
                    let (here, gone) = (middle(&at), middle(&there));
                    let way = |robot: usize| {
                        [0, 1].map(|axis| there[robot][axis] - gone[axis] - at[robot][axis] + here[axis])
                    };
                    ways[order] += (0..count).map(|robot| libm::hypot(way(robot)[0], way(robot)[1])).sum::<f64>();
                    for (a, b) in (0..count).flat_map(|a| (0..a).map(move |b| (a, b))) {
                        let off = [0, 1].map(|axis| at[a][axis] - at[b][axis]);
                        let turn = [0, 1].map(|axis| way(a)[axis] - way(b)[axis]);
                        let length = turn[0] * turn[0] + turn[1] * turn[1];
                        let when = if length > 0.0 { -(off[0] * turn[0] + off[1] * turn[1]) / length } else { 0.0 };
                        let when = when.clamp(0.0, 1.0);
                        let [x, y] = [0, 1].map(|axis| off[axis] + when * turn[axis]);
                        meetings[order] += usize::from(libm::hypot(x, y) < 1.0);
                    }
                    assert!(order == 0 || ways[1] <= ways[0] + 1e-9, "{count}: {from_name} to {to_name}");
                }
            }
        }
        println!("| {count} | {:.0} | {:.0} | {} | {} |", ways[0] / 20.0, ways[1] / 20.0, meetings[0], meetings[1]);
        assert!(ways[1] < 0.85 * ways[0] && meetings[0] > 0 && meetings[1] == 0, "{count}: {ways:?} {meetings:?}");
    }
}
