use crate::devices::{Log, OnDevices};
use crate::firmware::{self, Made, Program};
use crate::mixed::{Mixed, Others};
use crate::options::{DeviceArgs, emulated};
use crate::pace::Pace;
use crate::summary::Summary;
use crate::swarm::{MakeRobot, Swarm};
use anyhow::{Context as _, Result, bail};
use clap::Args;
use staya_console::{Ended, Global, Progress, ScenarioArgs, Stop, WatchArgs, print, print_json};
use staya_controller::scalar::NumberFormat;
use staya_numbers::{added_law, in_f32, robot, unavailable, unsuitable};
use staya_runner::{Options, Shadow};
use staya_sim::engine::{ExternalController, Moment, Outcome, Watch, simulate_with};
use staya_sim::expected::Expected;
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use staya_sim::shown::Shown as _;
use staya_view::watch::{About, DeviceFigures, Insight, Watcher};
use std::ops::ControlFlow;
use std::time::Instant;

/// Run some robots of a scenario as firmware, on emulated microcontrollers or boards.
///
/// The other robots run in this process. Each robot on a device also has a shadow here: the run
/// ends at the first step whose results differ in any bit, and prints that step. Exit code 1 if a
/// step differs or a device stops answering.
#[derive(Args, Clone, Debug)]
pub struct HilArgs {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArgs,
    #[command(flatten)]
    pub(crate) devices: DeviceArgs,
    #[command(flatten)]
    pub(crate) page: WatchArgs,
}

impl HilArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// The scenario is invalid, devices or firmware are missing, or a device fails or differs from
    /// its shadow.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        run(&self.scenario.load()?, &self.devices, &self.page, global)
    }
}

/// Runs a scenario with Staya's guidance laws, with some robots on devices, and prints its summary.
///
/// # Errors
/// Missing devices, firmware or firmware features, or a device that fails or differs from its
/// shadow.
pub fn run(scenario: &Scenario, devices: &DeviceArgs, page: &WatchArgs, global: &Global) -> Result<Ended> {
    if let Some(law) = added_law(scenario) {
        bail!("law = \"{}\" is not available in firmware; give another law, or run without devices", law.name());
    }
    drive(&Ours, scenario, devices, page, global)
}

struct Ours;

impl Swarm for Ours {
    fn program(&self) -> Program {
        let says = concat!("lockstep ", env!("CARGO_PKG_VERSION"));
        Program { name: "staya", says: says.into(), made: Made::InRepository }
    }

    fn shadows(&self) -> Option<Vec<Shadow>> {
        None
    }

    fn robot_in(&self, numbers: NumberFormat) -> Result<MakeRobot> {
        Ok(Box::new(move || robot(numbers)))
    }

    fn law(&self) -> Box<dyn Fn(usize) -> Vec<u8> + Send> {
        Box::new(|_| Vec::new())
    }

    fn simulate(
        &self,
        scenario: &Scenario,
        external: Option<Box<dyn ExternalController>>,
        watch: &mut Watch<'_>,
    ) -> Result<Outcome> {
        Ok(simulate_with(scenario, external, watch)?)
    }
}

pub(crate) fn drive(
    swarm: &impl Swarm,
    scenario: &Scenario,
    devices: &DeviceArgs,
    page: &WatchArgs,
    global: &Global,
) -> Result<Ended> {
    let plan = devices.plan(scenario)?;
    if let Some((what, remedy)) = unsuitable(scenario) {
        match plan.devices.is_empty() {
            true => bail!(unavailable(what, remedy, scenario.laws.numbers)),
            false => bail!("{what} is not available on devices; {remedy}, or run without devices"),
        }
    }
    let program = swarm.program();
    let folder = firmware::find(&emulated(&plan), devices.firmware.as_deref(), &program)?;
    let mut options = Options::new(folder);
    options.program = Some(program.says);
    if let Some(shadows) = swarm.shadows() {
        options.shadows = shadows;
    }
    if let Some(folder) = &devices.logs {
        std::fs::create_dir_all(folder).with_context(|| format!("{}", folder.shown()))?;
        options.logs = Some(folder.clone());
    }
    let stop = Stop::on_ctrl_c()?;
    options.stop = stop.flag();
    let (on_devices, log) = OnDevices::new(plan, options, swarm.law());
    let others = Others::of(swarm, scenario)?;
    let has_devices = !on_devices.robots().is_empty();
    let by = Watched { devices, page, global, stop: &stop };
    let summary = simulate(swarm, &in_f32(scenario), (on_devices, others.as_ref()), &log, by)?;
    if global.json {
        print_json(&summary)?;
    } else if !has_devices || !summary.devices.is_empty() {
        print(&summary.table()?)?;
    }
    match summary.trouble {
        Some(trouble) => bail!("{}", trouble.trim_end()),
        None => Ok(Ended::by(&stop)),
    }
}

struct Watched<'a> {
    devices: &'a DeviceArgs,
    page: &'a WatchArgs,
    global: &'a Global,
    stop: &'a Stop,
}

/// Runs with devices and, if that finished, without them.
fn simulate(
    swarm: &impl Swarm,
    scenario: &Scenario,
    (on_devices, others): (OnDevices, Option<&Others<'_>>),
    log: &Log,
    by: Watched<'_>,
) -> Result<Summary> {
    let began = Instant::now();
    let stop = by.stop;
    let mut progress = Progress::new(&scenario.name, scenario.ticks.into(), by.global);
    let count = scenario.robots.len();
    let mut pace = by.devices.real_time.then(|| Pace::new(scenario.tick_s()));
    let mut page = Watcher::by_options(by.page, scenario)?;
    let mut expected = Expected::new(scenario.ticks);
    let mut watch = |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
        let mut robots = robots.inspect(|robot| expected.see(robot));
        if let Some(page) = &mut page
            && page.is_due()
        {
            page.show(moment, &mut robots, log);
        } else {
            robots.for_each(drop);
        }
        progress.of(expected.ticks(moment.row.tick).into());
        progress.set(moment.row.tick.into(), || format!("ticks, {} of {count} robots arrived", moment.arrived));
        if stop.is_requested() || log.trouble().is_some() {
            return ControlFlow::Break(());
        }
        if let Some(pace) = &mut pace {
            pace.wait(moment.row.tick, stop);
        }
        ControlFlow::Continue(())
    };
    let external = Mixed::new(on_devices, others);
    let (here, has_devices) = (external.trouble(), external.has_devices());
    let outcome = swarm.simulate(scenario, Some(Box::new(external)), &mut watch)?;
    progress.finish();
    let trouble = log.trouble().or_else(|| here.and_then(|here| here.get()));
    let interrupted = stop.is_requested();
    let wall_seconds = began.elapsed().as_secs_f64();
    let without = if has_devices && trouble.is_none() && !interrupted {
        let external = others.map(|others| Box::new(others.except(&[])) as Box<dyn ExternalController>);
        Some(swarm.simulate(scenario, external, &mut |_, _| ControlFlow::Continue(()))?)
    } else {
        None
    };
    let hash = |outcome: &Outcome| format!("{:016x}", outcome.trace_hash);
    Ok(Summary {
        scenario: scenario.name.clone(),
        seed: scenario.seed,
        robots: count,
        ticks: outcome.ticks,
        sim_seconds: outcome.seconds,
        wall_seconds,
        interrupted,
        arrived: outcome.arrived,
        collisions: outcome.collisions,
        trace_hash: hash(&outcome),
        numbers: others.map_or(NumberFormat::F32, Others::numbers),
        trace_hash_without_devices: without.as_ref().map(hash),
        real_time: pace.map(|pace| pace.report),
        trouble,
        devices: log.statistics(),
    })
}

impl Insight for Log {
    fn about(&self, index: usize) -> About {
        let device = self.load(index).map(|load| DeviceFigures {
            instructions: load.instructions,
            most_instructions: load.most_instructions,
            ticks: load.ticks,
            stack: load.stack_bytes,
            mismatches: load.mismatches,
            steps: load.steps,
            resets: load.resets,
        });
        About { device, ..About::default() }
    }
}
