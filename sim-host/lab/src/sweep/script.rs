//! Scripts that run a sweep with Slurm or GNU parallel. Each task makes the missing runs of a
//! shard; a restarted task loses at most the run in progress.

use crate::error::SweepError;
use crate::sweep::plan::Plan;
use std::fmt::Write as _;
use std::path::Path;

/// Slurm's default (`MaxArraySize = 1001`).
const MOST: u32 = 1000;

/// Common inputs of scripts.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// Path of the program on the hosts.
    pub program: &'a str,
    /// Path of the plan on the hosts.
    pub plan: &'a Path,
    /// Folder of the results, on a disk shared by all hosts.
    pub out: &'a Path,
    /// Number of shards.
    pub tasks: u32,
    /// Most parallel tasks; `None`: the number of cores.
    pub at_once: Option<u32>,
}

impl Job<'_> {
    fn check(&self, plan: &Plan, most: u32) -> Result<(), SweepError> {
        let remedy = if u64::from(self.tasks) > plan.runs() {
            format!("the plan has {} runs; give at most as many", plan.runs())
        } else {
            format!("give 1 to {most}; each does several runs")
        };
        if (1..=most).contains(&self.tasks) && u64::from(self.tasks) <= plan.runs() {
            return Ok(());
        }
        Err(SweepError::new("--tasks", format!("{} tasks", self.tasks), remedy))
    }

    fn command(&self, shard: &str) -> String {
        let Self { program, plan, out, .. } = self;
        let [program, plan, out] =
            [program.to_string(), plan.display().to_string(), out.display().to_string()].map(|text| quoted(&text));
        format!("{program} sweep {plan} --out {out} --shard {shard} --threads 1 --resume --quiet")
    }

    fn merging(&self) -> String {
        let Self { program, plan, out, .. } = self;
        let [plan, out] = [plan, out].map(|path| quoted(&path.display().to_string()));
        format!("{} sweep merge {plan} --out {out}", quoted(program))
    }
}

fn quoted(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@%".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

/// Creates a job for `sbatch`: an array with one core per task, which may be requeued at any time.
///
/// # Errors
/// More tasks than runs, or than Slurm accepts.
pub fn slurm(plan: &Plan, job: &Job<'_>, minutes: Option<u32>) -> Result<String, SweepError> {
    job.check(plan, MOST)?;
    let Job { tasks, at_once, .. } = job;
    let mut text = String::from("#!/bin/sh\n");
    let mut option = |option: String| writeln!(text, "#SBATCH --{option}").unwrap_or_default();
    option(format!("job-name={}", plan.name));
    option(format!("array=1-{tasks}{}", at_once.map_or(String::new(), |most| format!("%{most}"))));
    option(String::from("ntasks=1"));
    option(String::from("cpus-per-task=1"));
    option(String::from("requeue"));
    option(String::from("open-mode=append"));
    option(format!("output={}-%A_%a.log", plan.name));
    if let Some(minutes) = minutes {
        option(format!("time={minutes}"));
    }
    let runs = plan.runs();
    let task = job.command(&format!("\"$SLURM_ARRAY_TASK_ID\"/{tasks}"));
    let _ = write!(
        text,
        "# {runs} runs of plan {} ({}) in {tasks} tasks. A task does what is missing of its part, so it can be killed, put back\n\
         # into the queue and submitted again; when all are done:\n\
         #   {}\n\
         exec {task}\n",
        plan.name,
        plan.fingerprint(),
        job.merging(),
    );
    Ok(text)
}

/// Creates a script in which GNU parallel runs the shards here, or on hosts reachable by ssh.
///
/// # Errors
/// More tasks than runs.
pub fn parallel(plan: &Plan, job: &Job<'_>, hosts: &[String]) -> Result<String, SweepError> {
    job.check(plan, u32::MAX)?;
    let Job { tasks, at_once, .. } = job;
    let mut command = String::from("parallel --will-cite --halt soon,fail=20% --retries 3");
    if let Some(most) = at_once {
        let _ = write!(command, " --jobs {most}");
    }
    for host in hosts {
        let _ = write!(command, " --sshlogin {}", quoted(host));
    }
    let task = quoted(&job.command(&format!("{{}}/{tasks}")));
    let runs = plan.runs();
    Ok(format!(
        "#!/bin/sh\n\
         # {runs} runs of plan {} ({}) in {tasks} jobs. A job does what is missing of its part: run this again after whatever\n\
         # went wrong. Hosts find program, plan and folder by the same names.\n\
         set -e\n\
         seq {tasks} | {command} {task}\n\
         {}\n",
        plan.name,
        plan.fingerprint(),
        job.merging(),
    ))
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn quoted_text_is_one_shell_word() {
        assert_eq!(quoted("/a/b-c.toml"), "/a/b-c.toml");
        assert_eq!(quoted("my plan.toml"), "'my plan.toml'");
        assert_eq!(quoted("it's $HOME"), "'it'\\''s $HOME'");
        assert_eq!(quoted(""), "''");
    }
}
