//! `cargo xtask mpi`: one world over ranks, with OpenMPI from Debian's packages: the trace hash of `staya run` on any number of them.
//!
//! What is not installed is unpacked into `target/tools` and run from there. Everything stays on this machine: ranks talk through shared
//! memory.

use crate::apt::{Tools, unpacked};
use crate::files;
use crate::repo::{Repo, output_of, run as run_command};
use crate::report::Report;
use crate::session::Session;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

mod scaling;

const HASHES: &str = "one hash on 1, 2, 3, 4 and 8 ranks";
const RESUMED: &str = "a checkpoint of three ranks goes on on two, and by one process";
const KILLED: &str = "a rank that is killed ends the run and leaves its records";
const WRONG: &str = "ranks that cannot share a scenario say why";
const MPI: Tools =
    Tools { packages: &["openmpi-bin", "libopenmpi-dev", "libclang1"], programs: &["mpirun.openmpi", "mpicc.openmpi"] };
/// Longest time that ranks may take to end.
const PATIENCE: Duration = Duration::from_secs(60);

/// A grid, the plane and attackers, each with every fault of a radio or nearly; small enough for eight ranks on two cores.
const SCENARIOS: [(&str, &str); 3] = [("grid", GRID), ("plane", PLANE), ("attacked", ATTACKED)];
const GRID: &str = "name = 'grid'\nticks = 120\n[terrain.natural]\nwidth = 40\nheight = 40\nobstacles = 100\n[radio]\nrange_m = 8\nloss = 0.1\n\
    delay_ms = 300\njitter_ms = 900\nduplicate = 0.1\nreorder = 0.1\nbit_error_rate = 0.0005\n\
    [robots.scattered]\ncount = 300\ntravel = 15\n";
const PLANE: &str = "name = 'plane'\nticks = 150\ntick_s = 0.1\n[radio]\nrange_m = 4\nloss = 0.2\ndelay_ms = 30\n\
    jitter_ms = 90\nduplicate = 0.1\nbandwidth_bytes_per_s = 600\n[plane]\nradius_m = 0.15\nmax_speed_mps = 0.5\n\
    [plane.robots.circle]\ncount = 60\nradius_m = 8\nnoise_m = 0.05\n";
const ATTACKED: &str = "scenarios/insider.toml";

/// The command that measures: an optimised build, on a machine that does nothing else.
pub fn run_scaling(s: &mut Session) {
    match Mpi::find(&s.repo) {
        Ok(mpi) => scaling::measure(&mpi, &mut s.report),
        Err(reason) => s.report.skip("scaling", &reason),
    }
}

/// Makes MPI ready, builds `staya-mpi` and compares it with `staya`.
pub fn run(s: &mut Session) {
    if s.staya("debug").is_none() {
        return skip(&mut s.report, "the program was not built");
    }
    let (repo, report) = (&s.repo, &mut s.report);
    let mpi = match Mpi::find(repo) {
        Ok(mpi) => mpi,
        Err(reason) => return skip(report, &reason),
    };
    if !report.step("staya-mpi", || run_command(&mut mpi.build())) {
        return skip(report, "staya-mpi was not built");
    }
    report.step(HASHES, || mpi.compare());
    report.step(RESUMED, || mpi.go_on());
    report.step(KILLED, || mpi.kill_one());
    report.step(WRONG, || mpi.refuse());
}

fn skip(report: &mut Report, reason: &str) {
    for part in [HASHES, RESUMED, KILLED, WRONG] {
        report.skip(part, reason);
    }
}

/// OpenMPI, installed or unpacked.
struct Mpi<'a> {
    repo: &'a Repo,
    mpirun: String,
    environment: Vec<(&'static str, String)>,
    folder: PathBuf,
}

impl<'a> Mpi<'a> {
    fn find(repo: &'a Repo) -> Result<Self, String> {
        let folder = repo.target.join("mpi");
        let make = |mpirun: &str, environment| Mpi { repo, mpirun: mpirun.to_string(), environment, folder };
        let starts = |program: &str, argument: &str| output_of(repo.command(program).arg(argument)).is_some();
        let has_clang = || output_of(repo.command("sh").args(["-c", "ldconfig -p | grep -q libclang"])).is_some();
        if starts("mpirun", "--version") && starts("mpicc", "-show") && has_clang() {
            return Ok(make("mpirun", Vec::new()));
        }
        MPI.prepare(repo, || repo.tools().join(MPI.programs[0]).is_file())?;
        let root = repo.target.join("tools/unpacked/usr");
        let clang = fs::read_dir(root.join("lib")).into_iter().flatten().flatten();
        let clang = clang.map(|entry| entry.path().join("lib")).find(|lib| lib.join("libclang.so.1").exists());
        let clang = clang.ok_or("the packages hold no libclang")?;
        // clang's own headers are a package more; the compiler's do as well.
        let headers = output_of(repo.command("cc").arg("-print-file-name=include")).ok_or("no C compiler")?;
        let libraries = unpacked(repo, "openmpi").and_then(|folder| Some(folder.parent()?.to_path_buf()));
        let libraries = libraries.ok_or("the packages hold no libraries of OpenMPI")?;
        let libraries = [libraries.clone(), libraries.join("openmpi/lib")].map(|path| path.display().to_string());
        let environment = vec![
            ("OPAL_PREFIX", root.display().to_string()),
            ("LD_LIBRARY_PATH", libraries.join(":")),
            ("LIBCLANG_PATH", clang.display().to_string()),
            ("BINDGEN_EXTRA_CLANG_ARGS", format!("-I{headers}")),
            ("MPICC", repo.tools().join(MPI.programs[1]).display().to_string()),
        ];
        let mpi = make(MPI.programs[0], environment);
        let version = output_of(mpi.command(&mpi.mpirun).arg("--version"));
        version.map(|_| mpi).ok_or_else(|| String::from("OpenMPI does not start"))
    }

    fn command(&self, program: &str) -> Command {
        let mut command = self.repo.command(program);
        command.envs(self.environment.iter().map(|(name, value)| (name, value)));
        command
    }

    /// In the folder and the profile of all tests, so that what they share is there already.
    fn build(&self) -> Command {
        let mut command = self.repo.cargo(&["build", "--locked", "--package", "staya-mpi", "--features", "mpi"]);
        command.envs(self.environment.iter().map(|(name, value)| (name, value)));
        command
    }

    fn program(&self, name: &str) -> PathBuf {
        self.program_of("debug", name)
    }

    fn program_of(&self, profile: &str, name: &str) -> PathBuf {
        self.repo.target.join(profile).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }

    /// `mpirun -n RANKS staya-mpi run`, on this machine alone.
    fn ranks(&self, ranks: u32, arguments: &[&str]) -> Command {
        self.ranks_of("debug", ranks, arguments)
    }

    /// The same with the program of another profile.
    fn ranks_of(&self, profile: &str, ranks: u32, arguments: &[&str]) -> Command {
        let mut command = self.command(&self.mpirun);
        command
            .args(["--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-n", &ranks.to_string()])
            .arg(self.program_of(profile, "staya-mpi"))
            .args(["run", "--quiet", "--json"])
            .args(arguments)
            // Shared memory, no network; and no words of parts that the packages leave out.
            .env("OMPI_MCA_pml", "ob1")
            .env("OMPI_MCA_btl", "self,vader")
            .env("OMPI_MCA_btl_vader_single_copy_mechanism", "none")
            .env("OMPI_MCA_mca_base_component_show_load_errors", "0")
            .env("PMIX_MCA_pcompress_base_silence_warning", "1");
        command
    }

    /// The scenarios, written down; the path of each.
    fn scenarios(&self) -> Result<Vec<(&'static str, String)>, String> {
        let written = SCENARIOS.iter().map(|&(name, text)| {
            if Path::new(text).extension().is_some_and(|end| end == "toml") {
                return Ok((name, text.to_string()));
            }
            let file = self.folder.join(format!("{name}.toml"));
            files::write(&file, text)?;
            Ok((name, file.display().to_string()))
        });
        written.collect()
    }

    fn compare(&self) -> Result<(), String> {
        for (name, scenario) in self.scenarios()? {
            let out = self.folder.join(format!("out/{name}"));
            let out = out.display().to_string();
            let mut alone = self.repo.command(self.program("staya"));
            alone.args(["run", &scenario, "--quiet", "--json", "--out", &out]);
            let alone = figures(&mut alone)?;
            let trace = || files::bytes(&Path::new(&out).join("trace.csv"));
            let alone_trace = trace()?;
            for ranks in [1, 2, 3, 4, 8] {
                let here = figures(&mut self.ranks(ranks, &[&scenario, "--out", &out]))?;
                if here != alone {
                    return Err(format!("{name} on {ranks} ranks: {here}, on one machine {alone}"));
                }
                if trace()? != alone_trace {
                    return Err(format!("{name} on {ranks} ranks: trace.csv is not that of one process"));
                }
            }
            println!("{name}: {alone} and trace.csv byte for byte on 1, 2, 3, 4 and 8 ranks as by one process");
        }
        Ok(())
    }

    /// Half a run on three ranks, and the other half elsewhere.
    fn go_on(&self) -> Result<(), String> {
        for (name, scenario) in self.scenarios()? {
            let out = self.folder.join(format!("out/{name}-half")).display().to_string();
            let checkpoint = format!("{out}.checkpoint");
            let mut alone = self.repo.command(self.program("staya"));
            let alone = figures(alone.args(["run", &scenario, "--quiet", "--json", "--out", &out]))?;
            let half = [&scenario[..], "--ticks", "50", "--checkpoint", "50ticks", "--out", &out];
            figures(&mut self.ranks(3, &half))?;
            let rest = [&scenario[..], "--from", &checkpoint, "--out", &out];
            let two = figures(&mut self.ranks(2, &rest))?;
            let mut one = self.repo.command(self.program("staya"));
            let one = figures(one.args(["run", "--quiet", "--json"]).args(rest))?;
            if two != alone || one != alone {
                return Err(format!("{name}: without a break {alone}; on two ranks {two}; by one process {one}"));
            }
        }
        Ok(())
    }

    /// Kills rank 2 of 4 in the middle.
    fn kill_one(&self) -> Result<(), String> {
        let scenario = self.scenarios()?.into_iter().find(|(name, _)| *name == "grid").map(|(_, path)| path);
        let out = self.folder.join("out/killed");
        files::make_empty(&self.folder.join("out"))?;
        let out_text = out.display().to_string();
        let arguments = [&scenario.unwrap_or_default(), "--ticks", "1000000", "--out", &out_text];
        let mut command = self.ranks(4, &arguments);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = child.map_err(|error| format!("cannot start: {error}"))?;
        // Once it has written something, so that there is something to leave.
        let began = Instant::now();
        while series(&self.folder.join("out")).is_none_or(|bytes| bytes < 4096) {
            if began.elapsed() > PATIENCE || child.try_wait().ok().flatten().is_some() {
                let _ = child.kill();
                return Err(String::from("the run wrote nothing"));
            }
            sleep(Duration::from_millis(50));
        }
        let pid = pid_of_rank(2, &out_text).ok_or("there is no rank 2")?;
        output_of(self.repo.command("kill").args(["-KILL", &pid])).ok_or("rank 2 cannot be killed")?;
        let began = Instant::now();
        while child.try_wait().ok().flatten().is_none() {
            if began.elapsed() > PATIENCE {
                let _ = child.kill();
                return Err(String::from("the run goes on without rank 2"));
            }
            sleep(Duration::from_millis(50));
        }
        let Output { status, stderr, .. } = child.wait_with_output().map_err(|error| error.to_string())?;
        let said = String::from_utf8_lossy(&stderr).replace('\n', " ");
        if status.success() {
            return Err(String::from("the run ended as if nothing had happened"));
        }
        // Rank 0 also says where what was written is kept, if it comes to it in the second that mpirun gives it.
        for word in ["rank 2", "signal 9"] {
            if !said.contains(word) {
                return Err(format!("nothing says {word:?}: {said}"));
            }
        }
        let left = series(&self.folder.join("out")).ok_or("nothing was left")?;
        println!("{status}; {left} bytes of series.csv are left; {said}");
        Ok(())
    }

    fn refuse(&self) -> Result<(), String> {
        let text = "name = 'two'\nticks = 9\ntick_s = 0.1\n[plane]\nradius_m = 0.3\nmax_speed_mps = 1\n\
            [plane.robots.circle]\ncount = 2\nradius_m = 3\n";
        let file = self.folder.join("two.toml");
        files::write(&file, text)?;
        for (scenario, remedy) in [(file.display().to_string(), "start at most 2"), ("no.toml".into(), "no.toml")] {
            let out = self.folder.join("out/refused").display().to_string();
            let output = self.ranks(3, &[&scenario, "--out", &out]).output();
            let Output { status, stderr, .. } = output.map_err(|error| format!("cannot start: {error}"))?;
            let said = String::from_utf8_lossy(&stderr).into_owned();
            let ours: Vec<_> = said.lines().filter(|line| line.starts_with("staya-mpi:")).collect();
            if status.success() || ours.len() != 1 || !ours[0].contains(remedy) {
                return Err(format!("{status}: {said}"));
            }
            println!("{}", ours[0]);
        }
        Ok(())
    }
}

/// What a run printed that must be the same everywhere: arrivals, collisions, packets, hash.
fn figures(command: &mut Command) -> Result<String, String> {
    let line = crate::repo::shown(command);
    let said = command.output().map_err(|error| format!("{line}: {error}"))?;
    if !said.status.success() {
        return Err(format!("{line}: {}", String::from_utf8_lossy(&said.stderr)));
    }
    let text = String::from_utf8_lossy(&said.stdout).into_owned();
    let wanted =
        ["\"arrived\"", "\"collisions\"", "\"delivered\"", "\"rejected\"", "\"least_gap_m\"", "\"trace_hash\""];
    let lines = text.lines().map(|line| line.trim().trim_end_matches(','));
    let lines: Vec<_> = lines.filter(|line| wanted.iter().any(|name| line.starts_with(name))).collect();
    if lines.iter().any(|line| line.starts_with("\"trace_hash\"")) {
        return Ok(lines.join(", "));
    }
    Err(format!("{line}: no figures in {text}"))
}

/// How long the series is that a run under way, or one that failed, has in a folder beside its results.
fn series(folder: &Path) -> Option<u64> {
    let entries = fs::read_dir(folder).ok()?.flatten();
    let sizes = entries.filter_map(|entry| Some(fs::metadata(entry.path().join("series.csv")).ok()?.len()));
    sizes.max()
}

/// The process of a rank that writes to `out`, by what mpirun tells each.
fn pid_of_rank(rank: u32, out: &str) -> Option<String> {
    let wanted = format!("OMPI_COMM_WORLD_RANK={rank}");
    fs::read_dir("/proc").ok()?.flatten().find_map(|entry| {
        let read = |name: &str| fs::read(entry.path().join(name)).ok();
        let (line, environment) = (read("cmdline")?, read("environ")?);
        let line = String::from_utf8_lossy(&line).into_owned();
        let is_ours = line.split('\0').any(|word| word == out);
        let is_it = is_ours && environment.split(|&byte| byte == 0).any(|word| word == wanted.as_bytes());
        is_it.then(|| entry.file_name().to_string_lossy().into_owned())
    })
}
