//! All devices of a run, in parallel. Each has a reader thread; everything else runs in the
//! caller's. Each wait has a timeout.

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

/// Bytes from a device; empty at the end of the stream.
struct Arrival {
    index: usize,
    at_us: u64,
    bytes: Vec<u8>,
}

/// All devices of a run. Emulators end when it is dropped.
pub struct Fleet {
    units: Vec<Unit>,
    arrivals: Receiver<Arrival>,
    // Kept, so that the channel never closes.
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
    /// Starts all devices and configures their robots. Emulators end with the calling thread.
    ///
    /// # Errors
    /// The first device that cannot be opened, does not answer or refuses its configuration.
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

    /// Like [`Fleet::start`], over channels that are already open.
    ///
    /// # Errors
    /// Those of [`Fleet::start`], except for opening.
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
            let is_reading = Arc::clone(&fleet.readers);
            std::thread::Builder::new()
                .name(format!("robot {}", robot.0))
                .spawn(move || read(reader, index, epoch, &sender, &is_reading))
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

    /// Number of devices. Indices are those of the configurations.
    #[must_use]
    pub fn len(&self) -> usize {
        self.units.len()
    }

    /// Whether the fleet has no device.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.units.is_empty()
    }

    /// Process ids of the emulators.
    #[must_use]
    pub fn processes(&self) -> Vec<u32> {
        self.units.iter().filter_map(Unit::process).collect()
    }

    /// Requests a step from device `index` and steps its shadow, without waiting for the device.
    /// Inputs beyond its capacities are cut by
    /// [`Capacities::fit`](staya_link::capacities::Capacities::fit) for both. Errors are returned
    /// by [`Fleet::collect`]; an `index` out of range is ignored.
    pub fn send(&mut self, index: usize, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>) {
        let now_us = self.now_us();
        if let Some(unit) = self.units.get_mut(index) {
            unit.send(tick, now, inputs, now_us);
        }
    }

    /// Assigns another robot, or the same one in its initial state, to device `index` and waits
    /// until it is configured. A device that ran another robot gets a new boot number, so that its
    /// packets do not count as repeated. Errors come by [`Fleet::collect`]; an `index` out of range
    /// is ignored.
    pub fn assign(&mut self, index: usize, setup: Setup, task: Option<Task>) {
        let now_us = self.now_us();
        if let Some(unit) = self.units.get_mut(index) {
            unit.assign(setup, task, now_us);
            self.settle();
        }
    }

    /// Whether the robot of device `index` is down in the next step because of a reset.
    #[must_use]
    pub fn is_down(&self, index: usize) -> bool {
        self.units.get(index).is_some_and(Unit::is_down)
    }

    /// Waits for all devices, within the timeouts of the [`Options`], and returns one answer for
    /// each step requested since the last call, in the order of the devices. A device that
    /// restarted by itself is configured again first.
    pub fn collect(&mut self) -> Vec<Answer> {
        self.settle();
        self.units.iter_mut().filter_map(Unit::answer).collect()
    }

    /// Statistics of the devices so far.
    #[must_use]
    pub fn statistics(&self) -> Vec<Statistics> {
        self.units.iter().map(Unit::statistics).collect()
    }

    /// Cost of the last steps on each device, in the order of the devices. O(devices).
    pub fn loads(&self) -> impl Iterator<Item = Load> {
        self.units.iter().map(Unit::load)
    }

    fn now_us(&self) -> u64 {
        micros(self.epoch.elapsed())
    }

    fn settle(&mut self) {
        loop {
            let now_us = self.now_us();
            let mut next_us = None;
            for unit in &mut self.units {
                let due_us = unit.advance(now_us);
                if !unit.is_settled() {
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

fn read(
    mut reader: Box<dyn Read + Send>,
    index: usize,
    epoch: std::time::Instant,
    sender: &Sender<Arrival>,
    is_reading: &AtomicBool,
) {
    let mut buffer = [0; 2048];
    while is_reading.load(Ordering::Relaxed) {
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
