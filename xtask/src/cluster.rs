//! `cargo xtask cluster`: sweeps on the engines that clusters have, Slurm and GNU parallel, from Debian's packages.
//!
//! Slurm's daemons run as the present user, without systemd, control groups or keys: one controller and one node with
//! two cores, on loopback, with all that they write in `target/cluster`.

use crate::apt::{Tools, unpacked};
use crate::files;
use crate::repo::{Repo, output_of, run as run_command};
use crate::session::Session;
use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

const SLURM: &str = "a sweep on Slurm";
const PARALLEL: &str = "a sweep on GNU parallel";
const TOOLS: Tools = Tools {
    packages: &["slurmctld", "slurmd", "slurm-client", "parallel"],
    programs: &[CONTROLLER, NODE, STEP, "sbatch", "squeue", "scontrol", "scancel", "parallel"],
};
const CONTROLLER: &str = "slurmctld-wlm";
const NODE: &str = "slurmd-wlm";
/// What the node starts each task with.
const STEP: &str = "slurmstepd-wlm";
/// Tasks of the array.
const TASKS: u64 = 20;
/// Runs of a task.
const RUNS_A_TASK: u64 = 4;
/// Longest time that a part of it may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// Runs of about a tenth of a second: a task can be killed between two of them.
const SCENARIO: &str = "name = 'swap'\nticks = 600\ntick_s = 0.05\n[radio]\nrange_m = 5\n[plane]\nradius_m = 0.15\n\
    max_speed_mps = 0.5\n[plane.robots.circle]\ncount = 24\nradius_m = 3\nnoise_m = 0.05\n";
const PLAN: &str = "name = 'swap-loss'\nscenario = 'swap.toml'\nseeds = 10\n\
    measures = ['arrived', 'arrival_last_seconds', 'least_gap_m', 'packets.lost']\n\
    [axes]\nradio.loss = { from = 0, to = 0.7, step = 0.1 }\n";

/// Makes both engines ready and has each do a sweep; the rows must be those of this machine alone.
pub fn run(s: &mut Session) {
    let ready = s.staya("debug").ok_or_else(|| String::from("the program was not built"));
    let ready = ready.and_then(|staya| prepare(&s.repo).map(|()| staya));
    let mut sweep = ready.clone().map(|_| None);
    if let Ok(staya) = ready {
        s.report.step("a sweep on this machine, to compare with", || {
            sweep = Ok(Some(Sweep::new(&s.repo, staya)?));
            Ok(())
        });
    }
    for (name, engine) in [(SLURM, on_slurm as fn(&Sweep<'_>) -> Result<(), String>), (PARALLEL, on_parallel)] {
        match &sweep {
            Ok(Some(sweep)) => drop(s.report.step(name, || engine(sweep))),
            Ok(None) => s.report.skip(name, "there is nothing to compare with"),
            Err(reason) => s.report.skip(name, reason),
        }
    }
}

/// Makes sure that both are there: unpacks them on Debian. The error says why they are not.
fn prepare(repo: &Repo) -> Result<(), String> {
    // Slurm's clients want a configuration before they say anything.
    let question = format!("{CONTROLLER} -V && {NODE} -V && command -v sbatch && parallel --version");
    TOOLS.prepare(repo, || output_of(repo.command("sh").args(["-c", &question])).is_some())
}

/// A plan, and what one machine makes of it.
struct Sweep<'a> {
    repo: &'a Repo,
    /// Where everything is; empty at first.
    folder: PathBuf,
    staya: PathBuf,
}

impl<'a> Sweep<'a> {
    fn new(repo: &'a Repo, staya: PathBuf) -> Result<Self, String> {
        let folder = repo.target.join("cluster");
        files::make_empty(&folder)?;
        files::write(&folder.join("swap.toml"), SCENARIO)?;
        files::write(&folder.join("plan.toml"), PLAN)?;
        let this = Self { repo, folder, staya };
        run_command(&mut this.sweep(&["plan.toml", "--out", "alone", "--quiet"]))?;
        Ok(this)
    }

    /// `staya sweep` in the folder.
    fn sweep(&self, arguments: &[&str]) -> Command {
        let mut command = self.repo.command(&self.staya);
        command.arg("sweep").args(arguments).current_dir(&self.folder);
        command
    }

    /// Writes what the command prints to a file.
    fn script(&self, name: &str, arguments: &[&str]) -> Result<PathBuf, String> {
        let text = output_of(&mut self.sweep(arguments)).ok_or_else(|| format!("no script {name}"))?;
        let path = self.folder.join(name);
        files::write(&path, text + "\n")?;
        Ok(path)
    }

    /// Rows of a shard so far.
    fn rows(&self, out: &str, task: u64) -> u64 {
        let file = self.folder.join(out).join(format!("shards/{task}-of-{TASKS}.csv"));
        fs::read(file).map_or(0, |text| text.iter().filter(|&&byte| byte == b'\n').count().saturating_sub(1) as u64)
    }

    /// Merges, and compares every file byte for byte.
    fn compare(&self, out: &str) -> Result<(), String> {
        run_command(&mut self.sweep(&["merge", "plan.toml", "--out", out, "--quiet"]))?;
        let plot = "plots/arrived-over-radio.loss.png";
        for name in ["rows.csv", "aggregates.csv", plot] {
            let [alone, here] = ["alone", out].map(|out| files::bytes(&self.folder.join(out).join(name)));
            if alone? != here? {
                return Err(format!("{out}/{name} is not that of one machine"));
            }
        }
        println!("{out}: rows, aggregates and picture are byte for byte those of one machine");
        Ok(())
    }
}

/// Slurm's daemons, ended with this.
struct Daemons<'a> {
    repo: &'a Repo,
    children: Vec<Child>,
}

impl Daemons<'_> {
    fn start(&mut self, command: &mut Command, log: &Path) -> Result<(), String> {
        let log = fs::File::create(log).map_err(|error| format!("{}: {error}", log.display()))?;
        let error = log.try_clone().map_err(|error| error.to_string())?;
        let child = command.stdout(log).stderr(error).spawn().map_err(|error| format!("cannot start: {error}"))?;
        self.children.push(child);
        Ok(())
    }
}

impl Drop for Daemons<'_> {
    fn drop(&mut self) {
        for child in self.children.iter_mut().rev() {
            // Asked first, so that it ends what it has started.
            let asked = output_of(self.repo.command("kill").arg(child.id().to_string())).is_some();
            let is_over = asked && within(Duration::from_secs(5), || child.try_wait().ok().flatten()).is_some();
            if !is_over {
                let _ = child.kill();
                let _ = child.wait();
            }
        }
    }
}

/// Asks until there is an answer, at most so long.
fn within<T>(time: Duration, mut ask: impl FnMut() -> Option<T>) -> Option<T> {
    let since = Instant::now();
    loop {
        if let Some(answer) = ask() {
            return Some(answer);
        }
        if since.elapsed() > time {
            return None;
        }
        sleep(Duration::from_millis(20));
    }
}

/// Writes Slurm's configuration.
fn configure(sweep: &Sweep<'_>) -> Result<PathBuf, String> {
    let folder = sweep.folder.join("slurm");
    ["state", "spool"].iter().try_for_each(|name| files::make(&folder.join(name)))?;
    let said = |program: &str, argument: &str| {
        output_of(sweep.repo.command(program).arg(argument)).ok_or_else(|| format!("{program} {argument} says nothing"))
    };
    let (user, host) = (said("id", "-un")?, said("uname", "-n")?);
    let host = host.split('.').next().unwrap_or_default();
    // Both are held until both are known, so that they differ.
    let ports =
        [(); 2].map(|()| TcpListener::bind("127.0.0.1:0").and_then(|port| Ok((port.local_addr()?.port(), port))));
    let [Ok((controller, _first)), Ok((node, _second))] = ports else {
        return Err(String::from("there is no free port on loopback"));
    };
    let place = folder.display();
    let plugins = unpacked(sweep.repo, "slurm-wlm");
    let plugins = plugins.map_or(String::new(), |plugins| format!("PluginDir={}\n", plugins.display()));
    let text = format!(
        "ClusterName=staya\n\
         SlurmctldHost={host}(127.0.0.1)\n\
         SlurmctldPort={controller}\n\
         SlurmdPort={node}\n\
         CommunicationParameters=NoInAddrAny\n\
         AuthType=auth/none\n\
         CredType=cred/none\n\
         SlurmUser={user}\n\
         SlurmdUser={user}\n\
         StateSaveLocation={place}/state\n\
         SlurmdSpoolDir={place}/spool\n\
         SlurmctldPidFile={place}/controller.pid\n\
         SlurmdPidFile={place}/node.pid\n\
         SlurmctldLogFile={place}/controller.log\n\
         SlurmdLogFile={place}/node.log\n\
         {plugins}\
         ProctrackType=proctrack/linuxproc\n\
         TaskPlugin=task/none\n\
         JobAcctGatherType=jobacct_gather/none\n\
         SwitchType=switch/none\n\
         MpiDefault=none\n\
         SelectType=select/cons_tres\n\
         SelectTypeParameters=CR_Core\n\
         ReturnToService=2\n\
         SlurmdParameters=config_overrides\n\
         SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0\n\
         NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN\n\
         PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP\n"
    );
    let file = folder.join("slurm.conf");
    files::write(&file, text)?;
    Ok(file)
}

/// An array of tasks, one of which is killed between two runs and put back into the queue.
fn on_slurm(sweep: &Sweep<'_>) -> Result<(), String> {
    let configuration = configure(sweep)?;
    let folder = sweep.folder.join("slurm");
    let slurm = |program: &str, arguments: &[&str]| {
        let mut command = sweep.repo.command(program);
        command.args(arguments).env("SLURM_CONF", &configuration).current_dir(&sweep.folder);
        command
    };
    let mut daemons = Daemons { repo: sweep.repo, children: Vec::new() };
    daemons.start(&mut slurm(CONTROLLER, &["-D", "-i"]), &folder.join("controller.out"))?;
    let step = sweep.repo.tools().join(STEP);
    let (with_step, step) = (step.is_file(), step.display().to_string());
    let node: &[&str] = if with_step { &["-D", "-d", &step] } else { &["-D"] };
    daemons.start(&mut slurm(NODE, node), &folder.join("node.out"))?;
    let is_idle = || output_of(&mut slurm("scontrol", &["show", "node"])).filter(|said| said.contains("State=IDLE"));
    within(PATIENCE, is_idle).ok_or_else(|| format!("the node does not come up; see {}", folder.display()))?;
    let tasks = TASKS.to_string();
    let script = sweep.script("job.sh", &["slurm", "plan.toml", "--out", "slurm-out", "--tasks", &tasks])?;
    let submitted = output_of(&mut slurm("sbatch", &["--parsable", &script.display().to_string()]));
    let job = submitted.ok_or("sbatch does not take the job")?;
    println!("job {job}: {TASKS} tasks");
    let killed = within(PATIENCE, || kill_one(sweep)).ok_or("no task could be caught between two runs")?;
    let (task, rows) = killed;
    println!("task {task} was killed after {rows} of {RUNS_A_TASK} runs, and is put back into the queue");
    let name = format!("{job}_{task}");
    let is_failed =
        || output_of(&mut slurm("scontrol", &["show", "job", &name])).filter(|said| said.contains("JobState=FAILED"));
    within(PATIENCE, is_failed).ok_or("Slurm has not noticed that the task is dead")?;
    let requeue = || output_of(&mut slurm("scontrol", &["requeue", &name]));
    within(PATIENCE, requeue).ok_or("the task cannot be put back into the queue")?;
    // Slurm would let it wait for two minutes.
    let at_once = || output_of(&mut slurm("scontrol", &["update", &format!("JobId={name}"), "StartTime=now"]));
    within(PATIENCE, at_once).ok_or("the task cannot be told to begin")?;
    let is_over = || output_of(&mut slurm("squeue", &["--noheader"])).filter(String::is_empty);
    within(PATIENCE, is_over).ok_or_else(|| {
        let said = output_of(&mut slurm("squeue", &[])).unwrap_or_default();
        format!("the tasks do not come to an end: {said}")
    })?;
    let said = output_of(&mut slurm("scontrol", &["show", "job", &name])).unwrap_or_default();
    if !(said.contains("Restarts=1") && said.contains("JobState=COMPLETED")) {
        return Err(format!("task {task} was not done again: {said}"));
    }
    drop(daemons);
    sweep.compare("slurm-out")
}

/// Kills a task that has done some of its runs and not all. Returns its number, and how many it had done.
fn kill_one(sweep: &Sweep<'_>) -> Option<(u64, u64)> {
    let under_way = |task: &u64| (1..RUNS_A_TASK - 1).contains(&sweep.rows("slurm-out", *task));
    let task = (1..=TASKS).find(under_way)?;
    let shard = format!("{task}/{TASKS}");
    let ours = sweep.staya.display().to_string();
    let pid = fs::read_dir("/proc").ok()?.flatten().find_map(|entry| {
        let line = fs::read(entry.path().join("cmdline")).ok()?;
        let line = String::from_utf8_lossy(&line);
        let words: Vec<&str> = line.split('\0').collect();
        let is_it = words.first() == Some(&ours.as_str()) && words.contains(&shard.as_str());
        is_it.then(|| entry.file_name().to_string_lossy().into_owned())
    })?;
    output_of(sweep.repo.command("kill").args(["-KILL", &pid]))?;
    let rows = sweep.rows("slurm-out", task);
    (rows < RUNS_A_TASK).then_some((task, rows))
}

/// Jobs on this machine, and on another host that is this machine too.
fn on_parallel(sweep: &Sweep<'_>) -> Result<(), String> {
    let options = [
        "plan.toml",
        "--out",
        "parallel-out",
        "--tasks",
        "7",
        "--at-once",
        "1",
        "--host",
        ":",
        "--host",
        "1/elsewhere",
    ];
    let script = sweep.script("parallel.sh", &[&["parallel"], &options[..]].concat())?;
    // In place of ssh: a shell gets what ssh would have given to one there, the words joined by spaces.
    let ssh = sweep.folder.join("ssh");
    let log = sweep.folder.join("hosts.log");
    let text = format!(
        "#!/bin/sh\nfor word; do [ \"$word\" = elsewhere ] && break; shift; done\n\
        echo \"$1\" >> '{}'\nshift\nexec sh -c \"$*\"\n",
        log.display()
    );
    files::write(&ssh, text)?;
    output_of(sweep.repo.command("chmod").arg("+x").arg(&ssh)).ok_or("chmod fails")?;
    let mut command = sweep.repo.command("sh");
    run_command(command.arg(script).current_dir(&sweep.folder).env("PARALLEL_SSH", &ssh).env("HOME", &sweep.folder))?;
    let hosts = fs::read_to_string(&log).unwrap_or_default();
    if !hosts.lines().any(|line| line == "elsewhere") {
        return Err(String::from("no job went to the other host"));
    }
    sweep.compare("parallel-out")
}
