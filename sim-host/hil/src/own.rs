use crate::firmware::{Made, Program};
use crate::options::DeviceArgs;
use crate::run::{HilArgs, drive};
use crate::swarm::{MakeRobot, Swarm};
use anyhow::{Context as _, Result};
use clap::{CommandFactory as _, FromArgMatches as _};
use staya_console::{Ended, Global, WatchArgs};
use staya_controller::scalar::{Fast32, NumberFormat, Q16};
use staya_link::own::{LinkedLaw, OwnLarge, OwnSmall};
use staya_runner::Shadow;
use staya_sim::engine::{Engine, ExternalController, Outcome, OwnLaw, StartError, Watch, own_agents};
use staya_sim::scenario::Scenario;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// The package of a program and its firmware; [`package!`](crate::package) creates it.
#[derive(Clone, Copy, Debug)]
pub struct Package {
    /// Name.
    pub name: &'static str,
    /// Version.
    pub version: &'static str,
    /// Folder at the time of the build.
    pub folder: &'static str,
}

/// The [`Package`] that contains this invocation.
#[macro_export]
macro_rules! package {
    () => {
        $crate::Package {
            name: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            folder: env!("CARGO_MANIFEST_DIR"),
        }
    };
}

/// Robots with guidance law `G`. serde sends it to devices: new parameters need no new firmware.
pub struct Own<G> {
    package: Package,
    law: Arc<dyn Fn(usize) -> G + Send + Sync>,
    shadows: Vec<Shadow>,
}

impl<G> std::fmt::Debug for Own<G> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Own").field("package", &self.package).finish_non_exhaustive()
    }
}

impl<G: OwnLaw + LinkedLaw<f32>> Own<G> {
    /// Creates a swarm whose robot `i` in [`Scenario::robots`] follows `law(i)`, called at every
    /// start of a robot, as in [`simulate_own`](staya_sim::engine::simulate_own).
    #[must_use]
    pub fn new(package: Package, law: impl Fn(usize) -> G + Send + Sync + 'static) -> Self {
        Self { package, law: Arc::new(law), shadows: vec![|| Box::new(OwnLarge::<G>::new())] }
    }

    /// Also supports `numbers = "q16"`, and so the micro:bit; `law` must work with [`Q16`].
    #[must_use]
    pub fn in_fixed_point(mut self) -> Self
    where
        G: LinkedLaw<Q16>,
    {
        let both: [Shadow; 2] = [|| Box::new(OwnLarge::<G, Q16>::new()), || Box::new(OwnSmall::<G>::new())];
        self.shadows.extend(both);
        self
    }

    /// Also supports `numbers = "fast32"`; `law` must work with [`Fast32`].
    #[must_use]
    pub fn in_fast_floats(mut self) -> Self
    where
        G: LinkedLaw<Fast32>,
    {
        self.shadows.push(|| Box::new(OwnLarge::<G, Fast32>::new()));
        self
    }

    /// A complete program with the arguments of `staya hil`. Returns its exit code.
    #[must_use]
    pub fn main(self) -> ExitCode {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            hil: HilArgs,
            #[command(flatten)]
            global: Global,
        }
        let Package { name, version, .. } = self.package;
        let command = Line::command().name(name).version(version).after_help("");
        let line = Line::from_arg_matches(&command.get_matches()).unwrap_or_else(|error| error.exit());
        let hil = &line.hil;
        let run = || {
            line.global.begin()?;
            self.run(&hil.scenario.load()?, &hil.devices, &hil.page, &line.global)
        };
        staya_console::exit(name, run())
    }

    /// Runs a scenario and prints its summary.
    ///
    /// # Errors
    /// Missing devices or firmware, a device that fails or differs from its shadow, or a scenario
    /// that an own law cannot run.
    pub fn run(&self, scenario: &Scenario, devices: &DeviceArgs, page: &WatchArgs, global: &Global) -> Result<Ended> {
        drive(self, scenario, devices, page, global)
    }
}

impl<G: OwnLaw + LinkedLaw<f32>> Swarm for Own<G> {
    fn program(&self) -> Program {
        let Package { name, version, folder } = self.package;
        Program { name, says: format!("{name} {version}"), made: Made::InPackage(PathBuf::from(folder)) }
    }

    fn shadows(&self) -> Option<Vec<Shadow>> {
        Some(self.shadows.clone())
    }

    fn robot_in(&self, numbers: NumberFormat) -> Result<MakeRobot> {
        // The first of a format is the largest.
        let shadow = self.shadows.iter().copied().find(|shadow| shadow().number() == numbers);
        let shadow = shadow.with_context(|| {
            format!("the law of this program was not built for numbers = \"{numbers}\"; see Own::in_fixed_point and Own::in_fast_floats")
        })?;
        Ok(Box::new(shadow))
    }

    fn law(&self) -> Box<dyn Fn(usize) -> Vec<u8> + Send> {
        let law = Arc::clone(&self.law);
        Box::new(move |index| postcard::to_stdvec(&law(index)).unwrap_or_default())
    }

    fn simulate(
        &self,
        scenario: &Scenario,
        external: Option<Box<dyn ExternalController>>,
        watch: &mut Watch<'_>,
    ) -> Result<Outcome> {
        let law = Arc::clone(&self.law);
        let agents = own_agents(scenario, move |index| law(index)).map_err(StartError::from);
        let engine = agents.and_then(|agents| Ok(Engine::new(scenario, agents)?));
        let engine = engine.context("this law cannot run the scenario")?;
        let engine = match external {
            Some(controllers) => engine.with_external(scenario, controllers),
            None => engine,
        };
        Ok(engine.run(scenario.ticks, watch))
    }
}
