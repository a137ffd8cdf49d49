//! A scenario in progress: [`Run`].

use crate::pool;
use crate::trace::Trace;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::MutexExt as _;
use pyo3::types::{PyBytes, PyDict};
use serde::{Deserialize, Serialize};
use staya_controller::agent::Wish;
use staya_controller::geom::Vec3;
use staya_controller::time::Duration as Valid;
use staya_record::page;
use staya_record::recording::RunRecorder;
use staya_sim::engine::{Engine, Moment, operated};
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Intervention, Overrides, Scenario, Setting, named, with_interventions, with_settings};
use staya_sim::summary::Summary;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

create_exception!(
    staya._staya,
    ScenarioError,
    PyValueError,
    "An unreadable or invalid scenario, with file, line, field and remedy."
);

/// Signals such as Ctrl-C are checked after this time without the interpreter lock.
const SLICE: Duration = Duration::from_millis(50);
/// A speed above that of any body.
const FAST_MPS: f64 = 1e6;
/// Commanded velocities are sent again in each tick.
const VALID: Valid = Valid::from_millis(60_000);

/// A scenario in progress. Calls from several threads are serialised.
#[pyclass(frozen, module = "staya._staya")]
pub struct Run {
    inner: Mutex<Inner>,
}

struct Inner {
    scenario: Scenario,
    /// File of the scenario, to which its names of files are relative.
    path: PathBuf,
    text: String,
    engine: Engine,
    tick: u32,
    done: Vec<(u32, Intervention)>,
    /// Commanded velocities, m/s; `None` for robots with their own law, empty before a command.
    wishes: Vec<Option<Vec3<f32>>>,
    recorder: Option<RunRecorder<Vec<u8>>>,
    trace: Option<Trace>,
    wall_seconds: f64,
}

impl Inner {
    /// Sends the commanded velocities, if there are any. O(robots).
    fn command(&mut self) -> PyResult<()> {
        for (index, wish) in self.wishes.iter().enumerate() {
            let wish = wish.map_or(Wish::Own, |velocity_mps| Wish::Velocity { velocity_mps, valid: VALID });
            let is_own = wish == Wish::Own;
            if !self.engine.command(index, wish) && !is_own && self.engine.observation(index).is_up {
                let number = self.scenario.robots[index].id;
                return Err(PyValueError::new_err(format!(
                    "robot {number} moves from cell to cell and accepts no velocity; give a scenario with [plane]"
                )));
            }
        }
        Ok(())
    }

    fn advance(&mut self) -> PyResult<()> {
        let began = Instant::now();
        self.command()?;
        self.engine.step();
        self.tick += 1;
        self.wall_seconds += began.elapsed().as_secs_f64();
        if let Some(trace) = &mut self.trace {
            trace.take(&self.engine);
        }
        self.record()
    }

    fn record(&mut self) -> PyResult<()> {
        let (Some(recorder), engine) = (&mut self.recorder, &self.engine) else {
            return Ok(());
        };
        let mut done = Ok(());
        engine.show(&mut |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
            done = recorder.tick(moment, robots);
        });
        done.map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }

    fn is_over(&self) -> bool {
        self.engine.is_over() || self.tick >= self.scenario.ticks
    }

    fn summary(&self) -> Summary {
        let mut summary = Summary::new(&self.scenario, &self.engine.outcome(), Vec::new());
        summary.wall_seconds = self.wall_seconds;
        summary
    }
}

/// A run as bytes, for pickling.
#[derive(Serialize, Deserialize)]
struct State {
    path: String,
    text: String,
    seed: u64,
    ticks: u32,
    tick: u32,
    /// JSON, since postcard cannot read tables with a kind.
    done: String,
    wishes: Vec<Option<[f32; 3]>>,
    wall_seconds: f64,
    engine: Vec<u8>,
}

#[derive(Deserialize)]
struct Said {
    order: Intervention,
}

pub(crate) fn scenario_error(error: &impl ToString) -> PyErr {
    ScenarioError::new_err(error.to_string().replace("(by --set)", "(by an argument)"))
}

#[pymethods]
impl Run {
    /// Creates a scenario before its first tick from the text of the file `path`, with a law and a
    /// safety layer by name, and overrides `settings` (`FIELD=VALUE`). With `record` every n-th
    /// tick is recorded.
    #[new]
    #[expect(clippy::too_many_arguments, reason = "Python gives them by name")]
    fn new(
        py: Python<'_>,
        text: &str,
        path: PathBuf,
        seed: Option<u64>,
        ticks: Option<u32>,
        law: Option<&str>,
        safety: Option<&str>,
        settings: Vec<String>,
        record: Option<u32>,
    ) -> PyResult<Self> {
        let settings: Result<Vec<Setting>, _> = settings.iter().map(|setting| setting.parse()).collect();
        let settings = settings.map_err(ScenarioError::new_err)?;
        pool::detached(py, || {
            let overrides = Overrides { seed, ticks };
            let settings = named(text, &path, law, safety, settings).map_err(|e| scenario_error(&e))?;
            let scenario = Scenario::parse_with(text, &path, &overrides, &settings).map_err(|e| scenario_error(&e))?;
            let text = match settings.is_empty() {
                true => text.to_owned(),
                false => with_settings(text, &path, &settings).map_err(|e| scenario_error(&e))?,
            };
            let engine = operated(&scenario).map_err(|error| ScenarioError::new_err(error.to_string()))?;
            let recorder =
                record.map(|every| RunRecorder::new(Vec::new(), Path::new(&scenario.name), &scenario, every));
            let recorder = recorder.transpose().map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
            let mut inner = Inner {
                scenario,
                path,
                text,
                engine,
                tick: 0,
                done: Vec::new(),
                wishes: Vec::new(),
                recorder,
                trace: None,
                wall_seconds: 0.0,
            };
            inner.record()?;
            Ok(Self { inner: Mutex::new(inner) })
        })?
    }

    /// The state, with which [`Run::restored`] makes a copy.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let inner = self.lock(py);
        if inner.recorder.is_some() {
            let what = "a simulation that records a page cannot be copied; leave record out, or save its page";
            return Err(PyTypeError::new_err(what));
        }
        let mut engine = Vec::new();
        inner.engine.save(&mut engine).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        let Inner { scenario, text, tick, done, wishes, wall_seconds, .. } = &*inner;
        let path = inner.path.to_str().ok_or_else(|| PyValueError::new_err("its path is not UTF-8; rename it"))?;
        let wishes = wishes.iter().map(|wish| wish.map(|wish| [wish.x, wish.y, wish.z])).collect();
        let state = State {
            path: path.to_owned(),
            text: text.clone(),
            seed: scenario.seed,
            ticks: scenario.ticks,
            tick: *tick,
            done: serde_json::to_string(done).map_err(|error| PyRuntimeError::new_err(error.to_string()))?,
            wishes,
            wall_seconds: *wall_seconds,
            engine,
        };
        let bytes = postcard::to_stdvec(&state).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// A run from the bytes of [`Run::state`], also of another process with this version.
    #[staticmethod]
    fn restored(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let unfit = |error: &dyn std::fmt::Display| {
            PyValueError::new_err(format!("this is not a simulation of this version: {error}; run it again"))
        };
        let State { path, text, seed, ticks, tick, done, wishes, wall_seconds, engine: state } =
            postcard::from_bytes(bytes).map_err(|error| unfit(&error))?;
        pool::detached(py, || {
            let (path, overrides) = (PathBuf::from(path), Overrides { seed: Some(seed), ticks: Some(ticks) });
            let scenario = Scenario::parse(&text, &path, &overrides).map_err(|error| scenario_error(&error))?;
            let mut engine = operated(&scenario).map_err(|error| unfit(&error))?;
            engine.restore(&state).map_err(|error| unfit(&error))?;
            let done = serde_json::from_str(&done).map_err(|error| unfit(&error))?;
            let wishes = wishes.into_iter().map(|wish| wish.map(|[x, y, z]| Vec3::new(x, y, z))).collect();
            let (recorder, trace) = (None, None);
            let inner = Inner { scenario, path, text, engine, tick, done, wishes, recorder, trace, wall_seconds };
            Ok(Self { inner: Mutex::new(inner) })
        })?
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        Ok((py.get_type::<Self>().getattr("restored")?, (self.state(py)?,)))
    }

    fn step(&self, py: Python<'_>, ticks: u32) -> PyResult<()> {
        let mut left = ticks;
        self.in_slices(py, |inner| {
            if left > 0 {
                left -= 1;
                inner.advance()?;
            }
            Ok(left > 0)
        })
    }

    fn run(&self, py: Python<'_>, until: Option<u32>) -> PyResult<()> {
        self.in_slices(py, |inner| {
            let is_running = !inner.is_over() && until.is_none_or(|until| inner.tick < until);
            if is_running {
                inner.advance()?;
            }
            Ok(is_running)
        })
    }

    /// Starts to collect columns; see [`Trace::new`].
    fn begin_trace(&self, py: Python<'_>, every: u32) {
        let mut inner = self.lock(py);
        let mut trace = Trace::new(every, inner.scenario.robots.len());
        trace.take(&inner.engine);
        inner.trace = Some(trace);
    }

    /// Returns the columns of the trace and of the series, by name.
    fn end_trace<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut inner = self.lock(py);
        let mut trace = inner.trace.take().ok_or_else(|| PyRuntimeError::new_err("no trace was started"))?;
        trace.finish(&inner.engine);
        drop(inner);
        trace.columns(py)
    }

    #[getter]
    fn tick(&self, py: Python<'_>) -> u32 {
        self.lock(py).tick
    }

    #[getter]
    fn ticks(&self, py: Python<'_>) -> u32 {
        self.lock(py).scenario.ticks
    }

    #[getter]
    fn tick_s(&self, py: Python<'_>) -> f64 {
        self.lock(py).scenario.tick_s()
    }

    #[getter]
    fn name(&self, py: Python<'_>) -> String {
        self.lock(py).scenario.name.clone()
    }

    #[getter]
    fn seed(&self, py: Python<'_>) -> u64 {
        self.lock(py).scenario.seed
    }

    #[getter]
    fn records(&self, py: Python<'_>) -> bool {
        self.lock(py).recorder.is_some()
    }

    #[getter]
    fn is_over(&self, py: Python<'_>) -> bool {
        self.lock(py).is_over()
    }

    #[getter]
    fn trace_hash(&self, py: Python<'_>) -> String {
        let mut hash = 0;
        self.lock(py).engine.show(&mut |moment, _| hash = moment.trace_hash);
        format!("{hash:016x}")
    }

    fn ids<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        let inner = self.lock(py);
        PyArray1::from_iter(py, inner.scenario.robots.iter().map(|robot| robot.id.0))
    }

    /// Radius, m, and highest speed, m/s, of each robot in the plane.
    fn bodies<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        let inner = self.lock(py);
        let plane = inner.scenario.plane()?;
        let groups = (0..inner.scenario.robots.len()).map(|index| plane.group(index));
        Some(rows(py, groups.map(|group| [group.radius_m, group.abilities.max_speed_mps])))
    }

    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let inner = self.lock(py);
        rows(py, inner.robots().map(|index| inner.engine.observation(index).motion.position_m))
    }

    fn velocities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let inner = self.lock(py);
        rows(py, inner.robots().map(|index| inner.engine.observation(index).motion.velocity_mps))
    }

    fn goals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let inner = self.lock(py);
        rows(py, inner.robots().map(|index| inner.engine.goal_m(index).unwrap_or([f64::NAN; 3])))
    }

    fn modes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        let inner = self.lock(py);
        PyArray1::from_iter(py, inner.robots().map(|index| inner.engine.observation(index).status.mode as u8))
    }

    fn is_up<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let inner = self.lock(py);
        PyArray1::from_iter(py, inner.robots().map(|index| inner.engine.observation(index).is_up))
    }

    fn neighbors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        let inner = self.lock(py);
        PyArray1::from_iter(py, inner.robots().map(|index| inner.engine.observation(index).neighbors as u32))
    }

    /// Sets the preferred velocities of robots whose mask is true; others follow their own law.
    fn wish(
        &self,
        py: Python<'_>,
        velocities_mps: PyReadonlyArray2<'_, f64>,
        mask: PyReadonlyArray1<'_, bool>,
    ) -> PyResult<()> {
        let mut inner = self.lock(py);
        let wishes = velocities_mps.as_slice()?.chunks_exact(3).zip(mask.as_slice()?);
        let wishes = wishes.map(|(row, mask)| {
            let [x, y, z] = [row[0], row[1], row[2]].map(|component| component.clamp(-FAST_MPS, FAST_MPS) as f32);
            mask.then_some(Vec3::new(x, y, z))
        });
        inner.wishes = wishes.collect();
        let told = inner.command();
        if told.is_err() {
            inner.wishes.clear();
        }
        told
    }

    #[getter]
    fn has_wishes(&self, py: Python<'_>) -> bool {
        !self.lock(py).wishes.is_empty()
    }

    /// Does the intervention in the table `order = { kind = "goal", ... }` before the next tick.
    fn intervene(&self, py: Python<'_>, table: &str) -> PyResult<()> {
        let said = toml::from_str::<Said>(table);
        let order = said.map_err(|error| PyValueError::new_err(error.message().to_owned()))?.order;
        let mut guard = self.lock(py);
        let inner = &mut *guard;
        inner
            .engine
            .intervene(&order)
            .map_err(|refusal| PyValueError::new_err(format!("{}: {refusal}", refusal.field)))?;
        if let Some(recorder) = &mut inner.recorder {
            recorder.note(&order);
        }
        inner.done.push((inner.tick, order));
        Ok(())
    }

    fn summary(&self, py: Python<'_>) -> PyResult<String> {
        serde_json::to_string(&self.lock(py).summary()).map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }

    /// The scenario with all orders, but without commanded velocities, for `staya run`.
    fn scenario_text(&self, py: Python<'_>) -> PyResult<String> {
        let inner = self.lock(py);
        let Scenario { seed, ticks, tick_us, .. } = inner.scenario;
        let last =
            [format!("seed={seed}"), format!("ticks={}", ticks.max(inner.tick).max(inner.scenario.last_event()))];
        let settings: Result<Vec<Setting>, String> = last.iter().map(|setting| setting.parse()).collect();
        let settings = settings.map_err(ScenarioError::new_err)?;
        let path = Path::new(&inner.scenario.name);
        let text = with_settings(&inner.text, path, &settings).map_err(|error| scenario_error(&error))?;
        Ok(with_interventions(&text, tick_us, &inner.done))
    }

    fn page(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let inner = self.lock(py);
        let Some(recorder) = inner.recorder.clone() else {
            return Ok(None);
        };
        let failed = |error: &dyn std::error::Error| PyRuntimeError::new_err(error.to_string());
        let recording = recorder.finish(&inner.summary()).map_err(|error| failed(&error))?;
        page::with_recording(&recording).map(Some).map_err(|error| failed(&error))
    }
}

impl Inner {
    fn robots(&self) -> std::ops::Range<usize> {
        0..self.scenario.robots.len()
    }
}

impl Run {
    fn lock(&self, py: Python<'_>) -> MutexGuard<'_, Inner> {
        self.inner.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// Without the interpreter lock, until `act` returns false. Signals are checked regularly.
    fn in_slices(&self, py: Python<'_>, mut act: impl FnMut(&mut Inner) -> PyResult<bool> + Send) -> PyResult<()> {
        loop {
            let is_running = pool::detached(py, || {
                let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
                let end = Instant::now() + SLICE;
                while act(&mut inner)? {
                    if Instant::now() >= end {
                        return Ok::<_, PyErr>(true);
                    }
                }
                Ok(false)
            })??;
            py.check_signals()?;
            if !is_running {
                return Ok(());
            }
        }
    }
}

pub(crate) fn rows<'py, const D: usize>(
    py: Python<'py>,
    rows: impl Iterator<Item = [f64; D]>,
) -> Bound<'py, PyArray2<f64>> {
    let values: Vec<f64> = rows.flatten().collect();
    let array = numpy::ndarray::Array2::from_shape_vec([values.len() / D, D], values);
    PyArray2::from_owned_array(py, array.unwrap_or_default())
}
