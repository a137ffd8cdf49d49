//! Two hundred hostile connections to a live page do not change the run.

use staya_sim::engine::simulate;
use staya_sim::scenario::{Overrides, Scenario};
use staya_view::server::Server;
use staya_view::watch::Watcher;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tungstenite::Message;

const CROWD: usize = 200;

struct Crowd {
    stop: Arc<AtomicBool>,
    connected: Arc<AtomicUsize>,
    thread: Option<JoinHandle<()>>,
}

impl Crowd {
    fn around(url: &str) -> Self {
        let (stop, connected) = <(Arc<AtomicBool>, Arc<AtomicUsize>)>::default();
        let (stops, connects) = (Arc::clone(&stop), Arc::clone(&connected));
        let (address, token) =
            url.trim_start_matches("http://").split_once("/?token=").expect("an address and a token");
        let (address, token): (SocketAddr, _) = (address.parse().expect("numbers"), token.to_owned());
        let thread = std::thread::spawn(move || {
            let mut open: Vec<_> = (0..CROWD).map(|_| None).collect();
            for number in 0.. {
                if stops.load(Ordering::Relaxed) {
                    return;
                }
                let stream = misbehave(address, &token, number);
                connects.fetch_add(usize::from(stream.is_some()), Ordering::Relaxed);
                open[number % CROWD] = stream;
                if number > CROWD {
                    std::thread::sleep(Duration::from_millis(1));
                }
            }
        });
        let this = Self { stop, connected, thread: Some(thread) };
        let until = Instant::now() + Duration::from_secs(20);
        while this.connected() < CROWD {
            assert!(Instant::now() < until, "the connections were not accepted");
            std::thread::sleep(Duration::from_millis(1));
        }
        this
    }

    fn connected(&self) -> usize {
        self.connected.load(Ordering::Relaxed)
    }
}

impl Drop for Crowd {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn misbehave(address: SocketAddr, token: &str, number: usize) -> Option<TcpStream> {
    let mut stream = TcpStream::connect(address).ok()?;
    let head = format!(
        "GET /live?token={token} HTTP/1.1\r\nHost: {address}\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    );
    let garbage: Vec<u8> = (0..900_usize).map(|at| (at * (number + 7) % 251) as u8).collect();
    let words = match number % 7 {
        0 => Vec::new(),
        // Half a handshake.
        1 => head[..head.len() / 2].to_owned().into_bytes(),
        2 => garbage,
        3 => format!("{head}\r\n").into_bytes(),
        // A page that sends invalid messages.
        4 => [format!("{head}\r\n").as_bytes(), &garbage].concat(),
        5 => format!("{head}Origin: http://evil.example\r\n\r\n").into_bytes(),
        _ => head.replacen(token, "0", 1).into_bytes().into_iter().chain(*b"\r\n").collect(),
    };
    let _ = stream.write_all(&words);
    if number.is_multiple_of(3) {
        let _ = stream.shutdown(Shutdown::Write);
    }
    Some(stream)
}

fn watcher(scenario: &Scenario) -> Watcher {
    let server = Server::start(SocketAddr::from(([127, 0, 0, 1], 0)), Vec::new()).expect("a port is free");
    Watcher::new(server, scenario).expect("a scene")
}

fn scenario(name: &str, overrides: &Overrides) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    Scenario::load(&path, overrides).expect("a good scenario")
}

fn shows_an_honest_page(url: &str) -> JoinHandle<()> {
    let url = url.replace("http:", "ws:").replace("/?", "/live?");
    std::thread::spawn(move || {
        let shown = (0..200).any(|_| {
            // Misbehaving pages may occupy all places until they are disconnected.
            std::thread::sleep(Duration::from_millis(20));
            let Ok((mut page, _)) = tungstenite::connect(&url) else { return false };
            std::iter::repeat_with(|| page.read())
                .map_while(Result::ok)
                .any(|message| matches!(message, Message::Binary(_)))
        });
        assert!(shown, "the page got no frame");
    })
}

#[test]
fn a_run_has_the_same_hash_with_two_hundred_connections() {
    let scenario = scenario("swap-circle.toml", &Overrides::default());
    let alone = simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("they can be placed");
    let mut watcher = watcher(&scenario);
    let crowd = Crowd::around(&watcher.server().url());
    let honest = shows_an_honest_page(&watcher.server().url());
    let run = |watcher: &mut Watcher| {
        simulate(&scenario, |moment, robots| {
            watcher.tick(moment, robots);
            ControlFlow::Continue(())
        })
        .expect("they can be placed")
    };
    let crowded = loop {
        let outcome = run(&mut watcher);
        assert_eq!((outcome.trace_hash, outcome.ticks), (alone.trace_hash, alone.ticks));
        if honest.is_finished() {
            break outcome;
        }
    };
    honest.join().expect("a well-behaved page is accepted");
    drop(crowd);
    assert_eq!(crowded, alone);
    let counts = watcher.server().counts();
    assert!(
        watcher.server().is_alive() && counts.connections >= CROWD as u64 && counts.refused >= CROWD as u64 / 4,
        "{counts:?}"
    );
}

fn address(child: &mut Child) -> String {
    let lines = BufReader::new(child.stderr.take().expect("it is piped")).lines();
    let mut urls = lines.map_while(Result::ok).filter(|line| line.contains("/?token="));
    urls.next().expect("it says where its page is").trim().to_owned()
}

#[test]
fn a_bridge_misses_no_deadline_for_two_hundred_connections() {
    // Longer than any other work of a busy machine, shorter than a wait for a connection.
    let text = "name = \"t\"\nseed = 1\nticks = 100\ntick_s = 0.5\n[radio]\nrange_m = 50\n[plane]\nradius_m = 0.2\n\
         max_speed_mps = 1\n[[plane.robots.list]]\nstart_m = [0, 0]\ngoal_m = [9, 0]\n\
         [[plane.robots.list]]\nstart_m = [9, 0.1]\ngoal_m = [0, 0]\n";
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("t.toml");
    std::fs::write(&file, text).expect("it can be written");
    let mut staya = Command::new(staya_tests::program());
    staya.arg("bridge").arg(&file);
    staya.args(["--mavlink", "udpout:127.0.0.1:9", "--view", "--ticks", "8", "--json", "-q"]);
    let mut child = staya.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let url = address(&mut child);
    let crowd = Crowd::around(&url);
    let honest = shows_an_honest_page(&url);
    let output = child.wait_with_output().expect("it ends");
    honest.join().expect("a well-behaved page is accepted");
    assert!(crowd.connected() > CROWD, "{}", crowd.connected());
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&report["ticks"], &report["deadlines_missed"]), (&8.into(), &0.into()), "{report}");
}
