//! A robot that sees only a window of 11 x 11 cells leaves a larger dead end, because it remembers
//! visited cells. Run it with `cargo run --example window_routing`.

use staya_controller::cost::Gain;
use staya_controller::grid::{BLOCKED, Cell, Window};
use staya_controller::route::{CostField, RouteParams, Router};

/// Map, north up: `.` takes one tick to cross, `:` three; `#` is blocked.
const LAND: [&str; 17] = [
    "................................................",
    "................................................",
    "..............####################..............",
    ".................................#..............",
    ".................................#.......::::...",
    ".................................#......::::::..",
    ".................................#......::::::..",
    ".................................#.......::::...",
    ".................................#..............",
    ".................................#..............",
    ".................................#..............",
    ".................................#..............",
    "..............####################..............",
    "................................................",
    ".......::::::...................................",
    "......:::::::...................................",
    "................................................",
];
const START: Cell = Cell::new(3, 8);
const GOAL: Cell = Cell::new(45, 8);
fn impassability(cell: Cell) -> u8 {
    let row = usize::try_from(LAND.len() as i16 - 1 - cell.y).ok();
    let row = row.and_then(|row| LAND.get(row));
    let column = usize::try_from(cell.x).ok();
    match row.zip(column).and_then(|(row, column)| row.as_bytes().get(column)) {
        Some(b'.') => 1,
        Some(b':') => 3,
        _ => BLOCKED,
    }
}

fn main() {
    // Parameters for mazes: a high cost for visited cells.
    let params = RouteParams { a2: Gain::from_int(30), ..RouteParams::default() };
    let side = 2 * u16::from(params.radius) + 1;
    // A search needs (side + 2)^2 cells of scratch memory.
    let mut router = Router::<256>::new();
    let mut field = CostField::<169>::new();
    let (mut cell, mut way, mut ticks) = (START, vec![START], 0);
    while cell != GOAL {
        let corner = cell - Cell::new(params.radius.into(), params.radius.into());
        let seen: Vec<u8> = (0..side * side)
            .map(|at| impassability(corner + Cell::new((at % side) as i16, (at / side) as i16)))
            .collect();
        let window = Window::new(&seen, corner, side, side).expect("side times side cells");
        router.observe(&params, cell, GOAL);
        // The last argument would list cells of other robots.
        let weights =
            router.weights(&params, &mut field, &window, cell, GOAL, []).expect("there is a way out");
        cell = cell + weights.best().expect("a move is open").offset();
        ticks += u32::from(impassability(cell));
        way.push(cell);
        assert!(way.len() < 1000, "it never arrives");
    }
    for (y, row) in (0..LAND.len() as i16).rev().zip(LAND) {
        let on_way = |(x, land)| if way.contains(&Cell::new(x, y)) { '*' } else { land };
        println!("{}", (0..).zip(row.chars()).map(on_way).collect::<String>());
    }
    println!("{} moves, {ticks} ticks", way.len() - 1);
    assert!(way.iter().all(|cell| impassability(*cell) != BLOCKED));
}
