//! Measures the frames per second that a page can get, with a client in this process that draws
//! nothing. `cargo xtask bench view` runs it.

use staya_sim::engine::{Moment, simulate};
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Overrides, Scenario};
use staya_view::server::Server;
use staya_view::watch::Watcher;
use std::error::Error;
use std::net::SocketAddr;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tungstenite::Message;

/// Robots, and least acceptable frames per second.
const GOALS: [(u32, f64); 3] = [(1000, 60.0), (10_000, 60.0), (100_000, 20.0)];
const SPAN: Duration = Duration::from_secs(4);

struct Measured {
    read_per_s: f64,
    bytes_per_s: f64,
    /// Time that one frame costs the run, seconds.
    cost_s: f64,
}

fn main() -> ExitCode {
    let mut is_met = true;
    println!("{:>9} {:>14} {:>9} {:>22}  goal", "robots", "frames/s", "MB/s", "cost to the run, ms/frame");
    for (robots, goal) in GOALS {
        match measure(robots) {
            Ok(Measured { read_per_s, bytes_per_s, cost_s }) => {
                is_met &= read_per_s >= goal;
                let verdict = if read_per_s >= goal { "met" } else { "MISSED" };
                let (mb_per_s, ms) = (bytes_per_s / 1e6, cost_s * 1e3);
                println!("{robots:>9} {read_per_s:>14.0} {mb_per_s:>9.1} {ms:>22.3}  at least {goal}: {verdict}");
            }
            Err(error) => {
                is_met = false;
                println!("{robots:>9} {error}");
            }
        }
    }
    if is_met { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn scenario(robots: u32) -> Result<Scenario, Box<dyn Error>> {
    let side_m = f64::from(robots).sqrt() * 1.5;
    let text = format!(
        "name = \"pictures\"\nseed = 1\nticks = 10\ntick_s = 0.1\n[radio]\nrange_m = 5\n[plane]\nradius_m = 0.2\n\
         max_speed_mps = 1\nlaw = \"goal_flock\"\nsafety = \"orca\"\n[plane.robots.cloud]\ncount = {robots}\n\
         from_m = [0, 0]\nto_m = [{side_m:.1}, {side_m:.1}]\ngoals_m = [[{side_m:.1}, 0]]\n[plane.goal_flock]\nmin_distance_m = 0.6\n"
    );
    Ok(Scenario::parse(&text, Path::new("pictures.toml"), &Overrides::default())?)
}

fn measure(robots: u32) -> Result<Measured, Box<dyn Error>> {
    let scenario = scenario(robots)?;
    let server = Server::start(SocketAddr::from(([127, 0, 0, 1], 0)), Vec::new())?;
    let mut watcher = Watcher::new(server, &scenario)?;
    let stop = Arc::new(AtomicBool::new(false));
    let client = client(&watcher, Arc::clone(&stop));
    let began = Instant::now();
    while watcher.pages() == 0 && began.elapsed() < SPAN {
        watcher.is_due();
    }
    let (mut made, mut spent) = (0, Duration::ZERO);
    simulate(&scenario, |moment: &Moment<'_>, rows: &mut dyn Iterator<Item = RobotRow>| {
        let rows: Vec<_> = rows.collect();
        let began = Instant::now();
        while began.elapsed() < SPAN {
            watcher.is_due();
            let from = Instant::now();
            watcher.show(moment, rows.iter().copied(), &());
            spent += from.elapsed();
            made += 1;
        }
        ControlFlow::Break(())
    })?;
    stop.store(true, Ordering::Relaxed);
    drop(watcher);
    let (read, bytes) = client.join().map_err(|_| "the client failed")?;
    let span_s = SPAN.as_secs_f64();
    Ok(Measured {
        read_per_s: f64::from(read) / span_s,
        bytes_per_s: bytes as f64 / span_s,
        cost_s: spent.as_secs_f64() / f64::from(made),
    })
}

/// Returns the number and bytes of the frames that it read. It confirms none: the server limits the
/// messages of a page.
fn client(watcher: &Watcher, stop: Arc<AtomicBool>) -> JoinHandle<(u32, usize)> {
    let url = watcher.server().url().replace("http:", "ws:").replace("/?", "/live?");
    std::thread::spawn(move || {
        let (mut page, _) = tungstenite::connect(url).expect("it lets its pages in");
        let (mut read, mut bytes) = (0, 0);
        while !stop.load(Ordering::Relaxed) {
            match page.read() {
                Ok(Message::Binary(frame)) => {
                    read += 1;
                    bytes += frame.len();
                }
                Ok(_) => {}
                Err(_) => break,
            }
        }
        (read, bytes)
    })
}
