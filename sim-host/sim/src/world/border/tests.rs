use super::*;
use crate::terrain::Terrain;
use crate::world::MoveRules;
use proptest::prelude::*;
use staya_controller::rand::Rng;

struct Crowd {
    whole: World,
    parts: Vec<World>,
    here: Vec<Vec<u32>>,
}

impl Crowd {
    fn new(
        side: u16,
        walls: &[(i16, i16)],
        bodies: usize,
        seed: u64,
        owner: impl Fn(Cell) -> usize,
        (ranks, crossing): (usize, bool),
    ) -> Self {
        let mut terrain = Terrain::flat(side, side);
        for &(x, y) in walls {
            terrain.set(Cell::new(x, y), 0);
        }
        let mut draws = Rng::new(seed);
        let cells = (0..side as i16).flat_map(|y| (0..side as i16).map(move |x| Cell::new(x, y)));
        let mut free: Vec<_> = cells.filter(|&cell| terrain.is_passable(cell)).collect();
        let mut starts = Vec::new();
        for id in 1..=bodies.min(free.len()) as u32 {
            let at = draws.below(free.len() as u32) as usize;
            starts.push((RobotId(id), free.swap_remove(at)));
        }
        let here: Vec<Vec<u32>> = (0..ranks)
            .map(|rank| (0..).zip(&starts).filter(|(_, (_, cell))| owner(*cell) == rank).map(|(at, _)| at).collect())
            .collect();
        let whole =
            World::new(terrain, MoveRules { crossing, ..MoveRules::default() }, seed, starts).expect("free cells");
        let part = |here: &Vec<u32>| {
            let mut part = whole.clone();
            part.keep(here);
            part
        };
        Self { parts: here.iter().map(part).collect(), here, whole }
    }

    fn advance(&mut self, tick: u32, commands: &[Command<f32>]) -> usize {
        self.whole.advance(tick, commands);
        let told: Vec<Vec<_>> =
            self.here.iter().map(|here| here.iter().map(|&at| commands[at as usize].clone()).collect()).collect();
        let bounds: Vec<_> =
            self.parts.iter().map(|part| CellBounds::around(part.bodies().iter().map(|body| body.cell))).collect();
        let mut contests = Vec::new();
        for rank in 0..self.parts.len() {
            let mut beside = Vec::new();
            for other in (0..self.parts.len()).filter(|&other| other != rank) {
                if let Some(bounds) = &bounds[rank] {
                    beside.extend(self.parts[other].near(tick, bounds, DEPTH, Some(&told[other])));
                }
            }
            contests.push(self.parts[rank].contest(tick, &told[rank], bounds[rank].as_ref(), beside));
        }
        for round in 1.. {
            let open: u64 = contests.iter_mut().zip(&mut self.parts).map(|(contest, part)| contest.round(part)).sum();
            let results: Vec<_> = contests.iter().filter(|_| open == 0).map(Contest::result).collect();
            if open == 0 && !(results.iter().any(|[moved, _]| *moved) && results.iter().any(|[_, refused]| *refused)) {
                contests.into_iter().zip(&mut self.parts).for_each(|(contest, part)| contest.finish(part));
                return round;
            }
            assert!(round < 1000, "each round settles a robot");
            for (rank, bounds) in bounds.iter().enumerate() {
                let Some(bounds) = bounds else { continue };
                for other in (0..contests.len()).filter(|&other| other != rank) {
                    let settled = contests[other].settled(bounds);
                    contests[rank].hear(&settled);
                }
            }
            contests.iter_mut().for_each(Contest::tell);
            if open == 0 {
                contests.iter_mut().for_each(Contest::retry);
            }
        }
        unreachable!("the loop returns")
    }

    fn check(&mut self, tick: u32) {
        for (part, here) in self.parts.iter().zip(&self.here) {
            for (body, &at) in part.bodies().iter().zip(here) {
                assert_eq!(*body, self.whole.bodies()[at as usize], "tick {tick}");
            }
            assert!(part.is_sound(), "tick {tick}");
        }
        assert_eq!(self.collisions(tick), self.whole.count_collisions(tick), "tick {tick}");
    }
}

impl Crowd {
    fn collisions(&mut self, tick: u32) -> u64 {
        let mut count = self.parts.iter_mut().map(|part| part.count_collisions(tick)).sum();
        for part in &self.parts {
            if let Some(bounds) = CellBounds::around(part.bodies().iter().map(|body| body.cell)) {
                let others = self.parts.iter().filter(|other| !std::ptr::eq(*other, part));
                let beside: Vec<_> = others.flat_map(|other| other.near(tick, &bounds, 1, None)).collect();
                count += part.count_collisions_beside(tick, &beside);
            }
        }
        count
    }
}

fn wishes(draws: &mut Rng, bodies: usize) -> Vec<Command<f32>> {
    let wish = |draws: &mut Rng| {
        let count = draws.below(9);
        Command::Move((0..count).map(|_| Dir::from_index(draws.below(9) as u8)).collect())
    };
    (0..bodies).map(|_| if draws.below(8) == 0 { Command::Hold } else { wish(draws) }).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_dense_crowd_moves_identically_for_any_partition(
        side in 4_u16..40,
        fill in 1_usize..100,
        seed: u64,
        ranks in 1_usize..6,
        mixed: bool,
        crossing: bool,
        walls in prop::collection::vec((0_i16..40, 0_i16..40), 0..40),
    ) {
        let bodies = usize::from(side) * usize::from(side) * fill / 100;
        let walls: Vec<_> = walls.into_iter().filter(|&(x, y)| x < side as i16 && y < side as i16).collect();
        let owner = |cell: Cell| match mixed {
            true => Rng::keyed(seed, 1, cell.x as u32, cell.y as u32).below(ranks as u32) as usize,
            false => usize::from(cell.x.cast_unsigned()) * ranks / usize::from(side),
        };
        let mut crowd = Crowd::new(side, &walls, bodies, seed, owner, (ranks, crossing));
        let mut draws = Rng::new(!seed);
        for tick in 0..6 {
            let commands = wishes(&mut draws, crowd.whole.bodies().len());
            crowd.advance(tick, &commands);
            crowd.check(tick);
        }
    }
}

#[test]
fn a_chain_across_borders_takes_several_rounds() {
    // A gapless row of bodies that want to go east: each move depends on all before it.
    let side = 40;
    let walls: Vec<_> = (1..side).flat_map(|y| (0..side).map(move |x| (x, y))).collect();
    let strips = |cell: Cell| usize::from(cell.x.cast_unsigned()) / 2 % 2;
    let mut most = 0;
    for seed in 0..20 {
        let mut crowd = Crowd::new(side as u16, &walls, 36, seed, strips, (2, false));
        for tick in 0..4 {
            let commands = vec![Command::Move([Dir::East].into_iter().collect()); 36];
            most = most.max(crowd.advance(tick, &commands));
            crowd.check(tick);
        }
    }
    assert!(most >= 1, "{most}");
}

#[test]
fn two_bodies_in_one_cell_are_counted_once_over_all_ranks() {
    let mut crowd = Crowd::new(9, &[], 20, 3, |cell| usize::from(cell.x >= 4), (2, false));
    let shared = crowd.parts[0].bodies()[0].cell;
    crowd.parts[1].bodies[0].cell = shared;
    assert_eq!(crowd.collisions(0), 1);
}
