use super::*;
use staya_mavlink::wire::decode;

fn places(graph: &Graph) -> Vec<(i16, i16)> {
    graph.places.iter().map(|place| (place.x, place.y)).collect()
}

#[test]
fn shapes_are_what_their_names_say() {
    let of = |shape: Shape, count| places(&shape.graph(count, 3).expect("room"));
    assert_eq!(of(Shape::Line, 5), [(0, 0), (0, 3), (0, -3), (0, 6), (0, -6)]);
    assert_eq!(of(Shape::Column, 3), [(0, 0), (-3, 0), (-6, 0)]);
    assert_eq!(of(Shape::Wedge, 5), [(0, 0), (-3, 3), (-3, -3), (-6, 6), (-6, -6)]);
    assert_eq!(of(Shape::Grid, 5), [(0, 0), (0, -3), (0, -6), (-3, 0), (-3, -3)]);
    assert_eq!(of(Shape::Circle, 4), [(0, 0), (-2, 2), (-4, 0), (-2, -2)]);
    assert_eq!(of(Shape::Circle, 1), [(0, 0)]);
}

/// Every robot of every shape hears all parts of a template with its own place, and neighbours at the places that they have.
#[test]
fn every_shape_of_every_number_is_told_consistently() {
    for (name, shape) in Shape::NAMES {
        for count in [1, 2, 3, 6, 25, 254] {
            let graph = shape.graph(count, 3).expect(name);
            let order = Order { heading: Dir::Stay, goal: Some(Cell::new(7, -8)), boot: 9, version: 4 };
            let mut heard = vec![Vec::new(); count];
            let mut goals = 0;
            for frame in orders(&graph, &order).expect(name) {
                let frame = decode(&frame).expect("a sound frame");
                assert_eq!((frame.header.sender.0, frame.header.boot), (255, 9));
                match frame.message {
                    Message::Template(part) => heard[part.to.0 as usize - 1].push(part),
                    Message::Goal(goal) => {
                        goals += 1;
                        assert_eq!((goal.target, goal.version), (Cell::new(7, -8), 4));
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
    let graph = Shape::Column.graph(2, 3).expect("room");
    let order = Order { heading: Dir::North, goal: None, boot: 0, version: 0 };
    let frames = orders(&graph, &order).expect("room");
    let Message::Template(part) = decode(&frames[1]).expect("sound").message else {
        panic!("a template");
    };
    assert_eq!((part.to.0, part.offset), (2, Cell::new(0, -3)));
}

#[test]
fn a_file_is_read_and_what_is_wrong_with_it_is_said() {
    let text = "places = [[0, 0], [-3, 3], [-3, -3]]\nedges = [[1, 2], [3, 1], [1, 3]]";
    let graph = Graph::parse(text).expect("a formation");
    assert_eq!((graph.robots(), graph.edges.as_slice()), (3, &[(0, 1), (0, 2)][..]));
    for (text, piece) in [
        ("places = [[1, 0]]\nedges = []", "first place is not [0, 0]"),
        ("places = []\nedges = []", "first place"),
        ("places = [[0, 0], [3, 0]]\nedges = [[1, 3]]", "[1, 3] joins no two robots"),
        ("places = [[0, 0], [3, 0]]\nedges = [[0, 1]]", "numbers from 1 to 2"),
        ("places = [[0, 0], [3, 0]]\nedges = []", "robot 1 to robot 2"),
        ("places = [[0, 0], [0, 0]]\nedges = [[1, 2]]", "robots 1 and 2 would share a cell"),
        ("places = [[0, 0], [40000, 0]]\nedges = [[1, 2]]", "robot 2 would be off any map"),
        ("places = [[0, 0]]\nedge = []", "unknown field `edge`"),
    ] {
        let error = Graph::parse(text).expect_err(text).to_string();
        assert!(error.contains(piece), "{text}: {error}");
    }
    let star: Vec<_> = (2..=10).map(|other| format!("[1, {other}]")).collect();
    let places: Vec<_> = (0..10).map(|x| format!("[{x}, 0]")).collect();
    let graph = Graph::parse(&format!("places = [{}]\nedges = [{}]", places.join(","), star.join(",")));
    let order = Order { heading: Dir::East, goal: None, boot: 0, version: 0 };
    assert_eq!(orders(&graph.expect("a formation"), &order), Err(GraphError::Neighbors(1)));
    assert_eq!(Shape::Line.graph(255, 3), Err(GraphError::Count(255)));
    assert_eq!(Shape::Line.graph(0, 3), Err(GraphError::Count(0)));
    assert_eq!(Shape::Column.graph(254, 100), Err(GraphError::Far(101)));
    // 45 degrees bring cells that touch together.
    let graph = Shape::Grid.graph(9, 1).expect("room");
    let order = Order { heading: Dir::NorthEast, ..order };
    assert!(matches!(orders(&graph, &order), Err(GraphError::Shared(..))));
}
