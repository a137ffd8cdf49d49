//! `cargo xtask mpi --scaling`: how much sooner one world is done on more ranks. Times say something on a machine that does nothing
//! else; no test has them.

use super::Mpi;
use crate::files;
use crate::repo::run;
use crate::report::Report;
use std::process::Command;

const NAME: &str = "200,000 robots on 1, 2 and 4 ranks";
/// As dense as `scenarios/scale.toml`.
const SCENARIO: &str = "name = 'two-hundred-thousand'\nticks = 20\n[terrain.natural]\nwidth = 2121\nheight = 2121\nobstacles = 31495\n\
    [robots.scattered]\ncount = 200000\ntravel = 10\n[radio]\nrange_m = 8\nloss = 0.05\n";
/// Each number of ranks so often; the shortest time counts.
const TIMES: usize = 2;

/// Builds `staya-mpi` optimised and prints a table.
pub(super) fn measure(mpi: &Mpi<'_>, report: &mut Report) {
    if !report.step("staya-mpi, optimised", || run(mpi.build().arg("--release"))) {
        return report.skip(NAME, "staya-mpi was not built");
    }
    report.step(NAME, || table(mpi));
}

fn table(mpi: &Mpi<'_>) -> Result<(), String> {
    let file = mpi.folder.join("scaling.toml");
    files::write(&file, SCENARIO)?;
    let (scenario, out) = (file.display().to_string(), mpi.folder.join("out/scaling").display().to_string());
    println!("ranks   seconds   times sooner   processor, slowest rank   trace hash");
    let mut alone = None;
    for ranks in [1, 2, 4] {
        let mut best: Option<Figures> = None;
        for _ in 0..TIMES {
            let mut command = mpi.ranks_of("release", ranks, &[&scenario, "--no-trace", "--out", &out]);
            let figures = Figures::of(&mut command)?;
            if best.as_ref().is_none_or(|best| figures.wall_s < best.wall_s) {
                best = Some(figures);
            }
        }
        let best = best.ok_or("no run")?;
        let (first_s, first_hash) = alone.get_or_insert((best.wall_s, best.hash.clone()));
        let sooner = *first_s / best.wall_s;
        println!("{ranks:>5}{:>10.2}{sooner:>15.2}{:>26.2}   {}", best.wall_s, best.busy_s, best.hash);
        if best.hash != *first_hash {
            return Err(format!("{ranks} ranks have the hash {}, one has {first_hash}", best.hash));
        }
    }
    Ok(())
}

/// What a run printed of its times.
struct Figures {
    wall_s: f64,
    /// Of the slowest rank.
    busy_s: f64,
    hash: String,
}

impl Figures {
    fn of(command: &mut Command) -> Result<Self, String> {
        let line = crate::repo::shown(command);
        let said = command.output().map_err(|error| format!("{line}: {error}"))?;
        let text = String::from_utf8_lossy(&said.stdout).into_owned();
        if !said.status.success() {
            return Err(format!("{line}: {}", String::from_utf8_lossy(&said.stderr)));
        }
        let values = |name: &str| {
            let wanted = format!("\"{name}\": ");
            let values = text.lines().filter_map(|line| line.trim().strip_prefix(&wanted).map(String::from));
            values.map(|value| value.trim_end_matches(',').trim_matches('"').to_string()).collect::<Vec<_>>()
        };
        let numbers =
            |name: &str| values(name).iter().filter_map(|value| value.parse::<f64>().ok()).collect::<Vec<_>>();
        let (wall, hash) = (numbers("wall_seconds"), values("trace_hash"));
        let busy_s = numbers("busy_seconds").into_iter().fold(0.0, f64::max);
        match (wall.first(), hash.first()) {
            (Some(&wall_s), Some(hash)) => Ok(Self { wall_s, busy_s, hash: hash.clone() }),
            _ => Err(format!("{line}: no figures in {text}")),
        }
    }
}
