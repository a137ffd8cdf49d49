//! Measures tables in flash: queries and half-planes of functional voxel models, whole steps of an
//! agent under heavy load, and routes by a table of costs to go. Prints `case scalar calls median
//! max`: instructions (on a board: clock cycles).
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_are_printed!();

#[cfg(target_os = "none")]
mod program {
    use core::hint::black_box;
    use heapless::Vec;
    use serde::Serialize;
    use staya_cases::{Probe, worst_orca};
    use staya_controller::agent::{Agent, Inputs, Law, Outputs, Safety};
    use staya_controller::geom::Vec2;
    use staya_controller::grid::{Cell, Window};
    use staya_controller::land::{CostToGo, FarLand};
    use staya_controller::orca::{Analytic, HalfSpaces, MovingBall, Params, VoxelTable2k};
    use staya_controller::rand::Rng;
    use staya_controller::route::{CostField, RouteParams, Router};
    #[cfg(part = "stm32f405")]
    use staya_controller::scalar::Fast32;
    use staya_controller::scalar::{Q16, Scalar};
    use staya_controller::time::Instant;
    use staya_controller::wire::Wire;
    use staya_firmware::runtime::{self, Start};
    use staya_voxel::{Model, VoxelNeighbor, obstacles};

    /// `staya voxel build room --resolution 33 --depth 8` and `--depth 16`.
    const ROOMS: [(&str, &[u8]); 2] =
        [("8", include_bytes!("../../models/room-8.fvm")), ("16", include_bytes!("../../models/room-16.fvm"))];
    /// `staya voxel build neighbor --resolution 17` with the same depths.
    const PAIRS: [(&str, &[u8]); 2] =
        [("8", include_bytes!("../../models/neighbor-8.fvm")), ("16", include_bytes!("../../models/neighbor-16.fvm"))];
    /// `staya terrain model` of `staya terrain generate --seed 1`, with `--goal 98,98`.
    const FAR: &[u8] = include_bytes!("../../models/far.ctg");
    const CALLS: u32 = 256;
    const NEIGHBORS: usize = if cfg!(part = "nrf51") { 8 } else { 16 };
    const HALF_PLANES: usize = 2 * NEIGHBORS;

    struct Meter {
        ticks: Vec<u32, { CALLS as usize }>,
        empty: u32,
    }

    impl Meter {
        fn new() -> Self {
            let before = runtime::ticks();
            Self { ticks: Vec::new(), empty: runtime::ticks().wrapping_sub(before) }
        }

        #[inline(always)]
        fn measure<T>(&mut self, work: impl FnOnce() -> T) -> T {
            let before = runtime::ticks();
            let out = work();
            let ticks = runtime::ticks().wrapping_sub(before).saturating_sub(self.empty);
            let _ = self.ticks.push(ticks);
            out
        }
    }

    impl<S: Scalar> Probe<S> for Meter {
        fn step<G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(
            &mut self,
            agent: &mut Agent<S, G, N, A, W>,
            inputs: &Inputs<'_, S, G::Surroundings<'_>>,
            now: Instant,
            workspace: &mut G::Workspace,
            out: &mut Outputs<S>,
        ) {
            *out = self.measure(|| agent.step(inputs, now, workspace));
        }
    }

    pub fn run() -> ! {
        let start = &runtime::start();
        #[cfg(not(part = "nrf51"))]
        all::<f32>(&Table { scalar: "f32", start });
        #[cfg(part = "stm32f405")]
        all::<Fast32>(&Table { scalar: "Fast32", start });
        all::<Q16>(&Table { scalar: "Q16", start });
        far(&Table { scalar: "integer", start });
        runtime::exit(0)
    }

    struct Table<'a> {
        scalar: &'static str,
        start: &'a Start,
    }

    fn row(case: &str, [source, depth]: [&str; 2], table: &Table<'_>, mut meter: Meter) {
        let Table { scalar, start } = *table;
        let per_second = if start.emulated { 1_000_000_000 } else { u64::from(start.clock_hz) };
        let count = |ticks: u32| u64::from(ticks) * per_second / u64::from(start.tick_hz);
        meter.ticks.sort_unstable();
        let median = meter.ticks.get(meter.ticks.len() / 2).copied().unwrap_or(0);
        let most = meter.ticks.last().copied().unwrap_or(0);
        let calls = meter.ticks.len();
        runtime::print(format_args!("{case}_{source}{depth} {scalar} {calls} {} {}\n", count(median), count(most)));
    }

    #[inline(never)]
    fn all<S: Scalar>(table: &Table<'_>) {
        for (depth, bytes) in ROOMS {
            let Ok(model) = Model::<S, 2>::from_bytes(black_box(bytes)) else { continue };
            readings(&model, depth, table);
        }
        neighbor::<S, _>("formula", "", table, Analytic);
        neighbor::<S, _>("table_2k", "", table, VoxelTable2k);
        step::<S, _>("formula", "", table, Analytic);
        step::<S, _>("table_2k", "", table, VoxelTable2k);
        for (depth, bytes) in PAIRS {
            let Ok(model) = Model::<S, 3>::from_bytes(black_box(bytes)) else { continue };
            neighbor::<S, _>("model_", depth, table, VoxelNeighbor::new(model));
            step::<S, _>("model_", depth, table, VoxelNeighbor::new(model));
        }
    }

    #[inline(never)]
    fn far(table: &Table<'_>) {
        let Ok(costs) = CostToGo::from_bytes(black_box(FAR)) else { return };
        let (mut query, mut straight, mut by_table) = (Meter::new(), Meter::new(), Meter::new());
        let mut rng = Rng::new(1);
        let (goal, params) = (costs.header().goal, RouteParams::default());
        let mut field = CostField::<169>::new();
        let mut router = Router::<64>::new();
        for _ in 0..CALLS {
            let mut along = || 5 + rng.below(80) as i16;
            let here = Cell::new(along(), along());
            black_box(query.measure(|| black_box(&costs).at(black_box(here))));
            let mut cells = [0_u8; 121];
            for class in &mut cells {
                *class = 1 + rng.below(9) as u8;
            }
            let Some(window) = Window::new(&cells, here - Cell::new(5, 5), 11, 11) else { continue };
            for (meter, land) in [(&mut straight, None), (&mut by_table, Some(&costs as &dyn FarLand))] {
                router.forget_route();
                let ends = (here, goal);
                black_box(meter.measure(|| router.weights_over(&params, &mut field, &window, ends, [], land).ok()));
            }
        }
        row("costs_to_go", ["at", ""], table, query);
        row("route", ["straight", ""], table, straight);
        row("route", ["by_costs_to_go", ""], table, by_table);
    }

    fn about<S: Scalar>(rng: &mut Rng, milli: i32) -> S {
        S::from_milli(rng.below(2 * milli.unsigned_abs() + 1) as i32 - milli)
    }

    #[inline(never)]
    fn readings<S: Scalar>(model: &Model<'_, S, 2>, depth: &str, table: &Table<'_>) {
        let (mut nearest, mut blend, mut around) = (Meter::new(), Meter::new(), Meter::new());
        let mut rng = Rng::new(1);
        for _ in 0..CALLS {
            let at = [about::<S>(&mut rng, 3900), about::<S>(&mut rng, 2900)];
            black_box(nearest.measure(|| black_box(model).nearest(black_box(at))));
            black_box(blend.measure(|| black_box(model).blend(black_box(at))));
            let place = Vec2::new(at[0], at[1]);
            black_box(around.measure(|| obstacles(black_box(model), black_box(place), S::from_milli(300))));
        }
        row("room", ["nearest_", depth], table, nearest);
        row("room", ["blend_", depth], table, blend);
        row("room", ["obstacles_", depth], table, around);
    }

    #[inline(never)]
    fn neighbor<S: Scalar, P: HalfSpaces<S, Velocity = Vec2<S>>>(case: &str, of: &str, table: &Table<'_>, source: P) {
        let mut meter = Meter::new();
        let mut rng = Rng::new(1);
        let params = Params { horizon_s: S::TWO, separation_s: S::from_milli(50), share: S::HALF };
        while !meter.ticks.is_full() {
            let mut vector = |milli| Vec2::new(about::<S>(&mut rng, milli), about::<S>(&mut rng, milli));
            let radii_m = S::from_milli(400);
            let (offset_m, velocity_mps, own) = (vector(2000), vector(1000), vector(1000));
            if offset_m.norm() > radii_m {
                let ball = MovingBall { offset_m, velocity_mps, radii_m, tie: Vec2::ZERO };
                let ask = || black_box(&source).half_space(black_box(own), black_box(&ball), black_box(&params));
                black_box(meter.measure(ask));
            }
        }
        row("neighbor", [case, of], table, meter);
    }

    #[inline(never)]
    fn step<S: Scalar, P: HalfSpaces<S> + Serialize>(case: &str, of: &str, table: &Table<'_>, source: P) {
        let mut meter = Meter::new();
        let _ = worst_orca::<S, _, _, NEIGHBORS, HALF_PLANES>(source, &mut meter);
        row("step", [case, of], table, meter);
    }
}
