//! All devices of a run, in parallel. Read [`Fleet::send`] and [`Fleet::collect`] first.
//!
//! One thread per device reads; everything else happens in the caller's thread. Nothing waits longer than its limit, and each
//! error names the robot, the device, what it was asked for and how long that was waited for.

use crate::answer::{Answer, Cause, FleetError};
use crate::channel::Channel;
use crate::config::{DeviceConfig, Options};
use crate::device::Device;
use crate::line::micros;
use crate::statistics::{Load, Statistics};
use crate::unit::Unit;
use staya_controller::agent::{AnyInputs, Setup, Task};
use staya_controller::time::Instant;
use std::io::{ErrorKind, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// Bytes of a device; none: its end.
struct Arrival {
    index: usize,
    at_us: u64,
    bytes: Vec<u8>,
}

/// All devices of a run. Dropping it ends the emulators.
pub struct Fleet {
    units: Vec<Unit>,
    arrivals: Receiver<Arrival>,
    // Kept, so that the receiver never finds itself alone.
    _sender: Sender<Arrival>,
    epoch: std::time::Instant,
    stop: Arc<AtomicBool>,
    readers: Arc<AtomicBool>,
}

impl std::fmt::Debug for Fleet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Fleet").field("devices", &self.units.len()).finish_non_exhaustive()
    }
}

impl Fleet {
    /// Starts all devices and makes each of them its robot. Call it from a thread that outlives the fleet: emulators die with the
    /// thread that started them.
    ///
    /// # Errors
    /// The first device that cannot be opened, does not answer or refuses.
    pub fn start(configs: Vec<DeviceConfig>, options: Options) -> Result<Self, FleetError> {
        let mut lines = Vec::new();
        for config in configs {
            let robot = config.setup.agent.id;
            let opened = open(&config, &options).map_err(|cause| FleetError {
                robot,
                device: config.device.clone(),
                cause: Box::new(cause),
            })?;
            lines.push((config, opened));
        }
        Self::over(lines, options)
    }

    /// The same over lines that are there already.
    ///
    /// # Errors
    /// Those of [`Fleet::start`] but for opening.
    pub fn over(lines: Vec<(DeviceConfig, Channel)>, options: Options) -> Result<Self, FleetError> {
        let (sender, arrivals) = channel();
        let mut fleet = Self {
            units: Vec::new(),
            arrivals,
            _sender: sender.clone(),
            epoch: std::time::Instant::now(),
            stop: Arc::clone(&options.stop),
            readers: Arc::new(AtomicBool::new(true)),
        };
        for (index, (config, mut channel)) in lines.into_iter().enumerate() {
            let (robot, device) = (config.setup.agent.id, config.device.clone());
            let reader = std::mem::replace(&mut channel.read, Box::new(std::io::empty()));
            let (sender, epoch) = (sender.clone(), fleet.epoch);
            let goes_on = Arc::clone(&fleet.readers);
            std::thread::Builder::new()
                .name(format!("robot {}", robot.0))
                .spawn(move || read(reader, index, epoch, &sender, &goes_on))
                .map_err(|error| FleetError { robot, device, cause: Box::new(Cause::Thread(error)) })?;
            let now_us = fleet.now_us();
            fleet.units.push(Unit::new(config, channel, &options, now_us));
        }
        fleet.settle();
        for unit in &mut fleet.units {
            if let Some(Answer::Failed(error)) = unit.answer() {
                return Err(error);
            }
        }
        Ok(fleet)
    }

    /// How many devices there are; numbers below are those of the configs.
    #[must_use]
    pub fn len(&self) -> usize {
        self.units.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.units.is_empty()
    }

    /// The process ids of the emulators.
    #[must_use]
    pub fn processes(&self) -> Vec<u32> {
        self.units.iter().filter_map(Unit::process).collect()
    }

    /// Asks device number `index` for a step and returns at once; its shadow has stepped then. Inputs beyond its capacities are
    /// cut as [`Capacities::fit`](staya_link::capacities::Capacities::fit) says, for both alike, and counted.
    ///
    /// What is wrong shows in [`Fleet::collect`]. A number that there is none of is ignored.
    pub fn send(&mut self, index: usize, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>) {
        let now_us = self.now_us();
        if let Some(unit) = self.units.get_mut(index) {
            unit.send(tick, now, inputs, now_us);
        }
    }

    /// Makes device number `index` another robot, or the same one just started, and waits until it is. A device that has been another
    /// robot before gets a boot number of its own in any case, so that nobody takes its packets for old ones.
    ///
    /// What is wrong shows in [`Fleet::collect`]. A number that there is none of is ignored.
    pub fn assign(&mut self, index: usize, setup: Setup, task: Option<Task>) {
        let now_us = self.now_us();
        if let Some(unit) = self.units.get_mut(index) {
            unit.assign(setup, task, now_us);
            self.settle();
        }
    }

    /// Whether the robot of device number `index` stands in the next step, because its device was reset.
    #[must_use]
    pub fn is_down(&self, index: usize) -> bool {
        self.units.get(index).is_some_and(Unit::is_down)
    }

    /// Waits for all devices, at most for the limits of the [`Options`]; an answer for each that was asked since the last call, in their order:
    /// one for each device, if all were asked. A device that has started anew by itself is made its robot again before this returns.
    pub fn collect(&mut self) -> Vec<Answer> {
        self.settle();
        self.units.iter_mut().filter_map(Unit::answer).collect()
    }

    /// What is known of the devices so far.
    #[must_use]
    pub fn statistics(&self) -> Vec<Statistics> {
        self.units.iter().map(Unit::statistics).collect()
    }

    /// What the last steps cost each device, in the order in which they were started. O(devices).
    pub fn loads(&self) -> impl Iterator<Item = Load> {
        self.units.iter().map(Unit::load)
    }

    fn now_us(&self) -> u64 {
        micros(self.epoch.elapsed())
    }

    /// Works until no device is busy.
    fn settle(&mut self) {
        loop {
            let now_us = self.now_us();
            let mut next_us = None;
            for unit in &mut self.units {
                let due_us = unit.advance(now_us);
                if !unit.is_settled() {
                    // Without a time of its own there is more to do at once.
                    let due_us = due_us.unwrap_or(now_us);
                    next_us = Some(next_us.map_or(due_us, |next: u64| next.min(due_us)));
                }
            }
            let Some(next_us) = next_us else { return };
            if self.stop.load(Ordering::Relaxed) {
                for unit in &mut self.units {
                    unit.fail(Cause::Stopped);
                }
                return;
            }
            // Looks at the flag now and then.
            let patience = next_us.saturating_sub(self.now_us()).min(100_000);
            match self.arrivals.recv_timeout(Duration::from_micros(patience)) {
                Ok(first) => {
                    let rest: Vec<Arrival> = self.arrivals.try_iter().collect();
                    for arrival in std::iter::once(first).chain(rest) {
                        if let Some(unit) = self.units.get_mut(arrival.index) {
                            unit.arrived(&arrival.bytes, arrival.at_us);
                        }
                    }
                }
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {}
            }
        }
    }
}

impl Drop for Fleet {
    fn drop(&mut self) {
        self.readers.store(false, Ordering::Relaxed);
    }
}

fn open(config: &DeviceConfig, options: &Options) -> Result<Channel, Cause> {
    let device: Device = config.device.parse()?;
    let robot = config.setup.agent.id.0;
    let log = options.logs.as_ref().map(|folder| folder.join(format!("robot-{robot}.log")));
    Ok(Channel::open(&device, &options.firmware, log.as_deref())?)
}

/// Reads until the device or the fleet ends.
fn read(
    mut reader: Box<dyn Read + Send>,
    index: usize,
    epoch: std::time::Instant,
    sender: &Sender<Arrival>,
    goes_on: &AtomicBool,
) {
    let mut buffer = [0; 2048];
    while goes_on.load(Ordering::Relaxed) {
        let bytes = match reader.read(&mut buffer) {
            Ok(count) => buffer.get(..count).unwrap_or(&[]).to_vec(),
            Err(error) => match error.kind() {
                ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => continue,
                _ => Vec::new(),
            },
        };
        let is_over = bytes.is_empty();
        let at_us = micros(epoch.elapsed());
        let arrival = Arrival { index, at_us, bytes };
        if sender.send(arrival).is_err() || is_over {
            return;
        }
    }
}
