//! Searches for the scene in which a step of an agent behind ORCA among sixteen robots takes most
//! instructions. Repeatable: the same arguments give the same scenes.
//!
//! Arguments (`-semihosting-config arg=...`): seed, number of scenes to try. Prints a line
//! `tried instructions` at each improvement, then the best scene as an expression.
//!
//! An evolutionary search: a child comes from two scenes of a small population, its changes are
//! random, and it replaces the cheapest scene if it is more expensive.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_are_printed!();

#[cfg(target_os = "none")]
mod program {
    use staya_firmware::runtime;
    #[cfg(part = "stm32f405")]
    use {
        heapless::Vec,
        staya_cases::{FOUND, Probe, Scene},
        staya_controller::agent::{Agent, Inputs, Law, Outputs, Safety},
        staya_controller::orca::Analytic,
        staya_controller::rand::Rng,
        staya_controller::scalar::Scalar,
        staya_controller::time::Instant,
        staya_controller::wire::Wire,
    };

    #[cfg(part = "stm32f405")]
    const PURPOSE: u32 = u32::from_be_bytes(*b"srch");
    /// Scenes that are kept at a time. More: slower, and ends less often at a local maximum.
    #[cfg(part = "stm32f405")]
    const POPULATION: usize = 24;
    /// Scenes without an improvement after which a new population begins.
    #[cfg(part = "stm32f405")]
    const PATIENCE: u32 = 3_000;

    /// Instructions of the longest step.
    #[cfg(part = "stm32f405")]
    struct Longest(u32);

    #[cfg(part = "stm32f405")]
    impl<S: Scalar> Probe<S> for Longest {
        fn step<G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(
            &mut self,
            agent: &mut Agent<S, G, N, A, W>,
            inputs: &Inputs<'_, S, G::Surroundings<'_>>,
            now: Instant,
            workspace: &mut G::Workspace,
            out: &mut Outputs<S>,
        ) {
            let before = runtime::ticks();
            agent.step_into(inputs, now, workspace, out);
            self.0 = self.0.max(runtime::ticks().wrapping_sub(before));
        }
    }

    #[cfg(part = "stm32f405")]
    #[inline(never)]
    fn cost(scene: &Scene) -> u32 {
        let mut longest = Longest(0);
        scene.play::<f32, _, _, 16, 32>(Analytic, &mut longest, |_, _| {});
        longest.0
    }

    #[cfg(part = "stm32f405")]
    type Population = Vec<(u32, Scene), POPULATION>;

    /// Two drawn scenes, the better one.
    #[cfg(part = "stm32f405")]
    fn parent(population: &Population, rng: &mut Rng) -> Scene {
        let mut draw = || population.get(rng.below(POPULATION as u32) as usize).copied().unwrap_or_default();
        let (one, other) = (draw(), draw());
        if one.0 > other.0 { one.1 } else { other.1 }
    }

    #[cfg(part = "stm32f405")]
    fn number(text: Option<Result<&str, core::str::Utf8Error>>) -> Option<u32> {
        text?.ok()?.parse().ok()
    }

    #[cfg(not(part = "stm32f405"))]
    pub fn run() -> ! {
        runtime::start();
        runtime::print(format_args!("the search runs on the stm32f405\n"));
        runtime::exit(2)
    }

    #[cfg(part = "stm32f405")]
    pub fn run() -> ! {
        let start = runtime::start();
        let instructions = |ticks: u32| u64::from(ticks) * 1_000_000_000 / u64::from(start.tick_hz);
        let arguments = semihosting::experimental::env::args::<128>();
        let mut arguments = arguments.iter().flat_map(|arguments| arguments);
        let (Some(seed), Some(tries)) = (number(arguments.next()), number(arguments.next())) else {
            runtime::print(format_args!("needs the arguments seed and number of scenes\n"));
            runtime::exit(2)
        };
        let mut rng = Rng::keyed(seed.into(), PURPOSE, 0, 0);
        let mut best = (0, Scene::default());
        let mut tried = 0;
        while tried < tries {
            let mut population = Population::new();
            let (mut most, mut since) = (0, 0);
            let mut known = FOUND.iter();
            while tried < tries && since < PATIENCE {
                let scene = if population.is_full() {
                    let (one, other) = (parent(&population, &mut rng), parent(&population, &mut rng));
                    let scene = if rng.below(2) == 0 { one.crossed(&other, &mut rng) } else { one };
                    scene.varied(&mut rng)
                } else {
                    // The first population begins with the known scenes.
                    let known = if best.0 == 0 { known.next().copied() } else { None };
                    known.unwrap_or_else(|| Scene::random(&mut rng))
                };
                let ticks = cost(&scene);
                (tried, since) = (tried + 1, since + 1);
                if ticks > most {
                    (most, since) = (ticks, 0);
                }
                if ticks > best.0 {
                    best = (ticks, scene);
                    runtime::print(format_args!("{tried} {}\n", instructions(ticks)));
                }
                if population.is_full() {
                    let cheapest = population.iter_mut().min_by_key(|(ticks, _)| *ticks);
                    if let Some(cheapest) = cheapest.filter(|(least, _)| ticks >= *least) {
                        *cheapest = (ticks, scene);
                    }
                } else {
                    let _ = population.push((ticks, scene));
                }
            }
        }
        runtime::print(format_args!("{}", best.1));
        runtime::exit(0)
    }
}
