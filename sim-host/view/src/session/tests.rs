use super::*;
use crate::frame::FrameData;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use staya_sim::engine::simulate;
use std::net::{SocketAddr, TcpStream};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

const IN_PLANE: &str = "name = \"t\"\nseed = 3\nticks = 2000\ntick_s = 0.05\n[radio]\nrange_m = 9\nloss = 0.1\n\
     [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[[plane.robots.list]]\nstart_m = [0, 0]\ngoal_m = [6, 0]\n\
     [[plane.robots.list]]\nstart_m = [6, 0.1]\ngoal_m = [0, 0]\n[[plane.ball]]\ncenter_m = [4, 2]\nradius_m = 0.3\n";

struct Running {
    page: WebSocket<MaybeTlsStream<TcpStream>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    url: String,
    /// Frames and texts are not ordered.
    last: Option<FrameData>,
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Running {
    fn new(text: &str) -> Self {
        let session = Session::new(text.to_owned(), Path::new("t.toml"), &Overrides::default(), true);
        let session = session.expect("a good scenario");
        let server = Server::start(SocketAddr::from(([127, 0, 0, 1], 0)), Vec::new()).expect("a port is free");
        let url = server.url().replace("http:", "ws:").replace("/?", "/live?");
        let stop = Arc::new(AtomicBool::new(false));
        let stops = Arc::clone(&stop);
        // The engine cannot move between threads.
        let thread = std::thread::spawn(move || session.run(&server, &|| stops.load(Ordering::Relaxed)));
        let (mut page, _) = tungstenite::connect(&url).expect("it lets its pages in");
        if let MaybeTlsStream::Plain(stream) = page.get_mut() {
            // A missing message fails the test instead of blocking it.
            stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a time");
        }
        Self { page, stop, thread: Some(thread), url, last: None }
    }

    fn say(&mut self, word: &Value) {
        self.page.send(Message::Text(word.to_string().into())).expect("it reads");
    }

    fn until<T>(&mut self, mut is: impl FnMut(Result<Value, FrameData>) -> Option<T>) -> T {
        loop {
            let found = match self.page.read().expect("a message") {
                Message::Text(text) => is(Ok(serde_json::from_str(&text).expect("JSON"))),
                Message::Binary(bytes) => {
                    let frame = FrameData::decode(&bytes).expect("a frame");
                    self.last = Some(frame.clone());
                    is(Err(frame))
                }
                _ => None,
            };
            if let Some(found) = found {
                return found;
            }
        }
    }

    fn text(&mut self, kind: &str) -> Value {
        self.until(|message| message.ok().filter(|message| message["type"] == kind))
    }

    fn state(&mut self, is: impl Fn(&Value) -> bool) -> Value {
        self.until(|message| message.ok().filter(|message| message["type"] == "state" && is(message)))
    }

    fn frame(&mut self, tick: u32) -> FrameData {
        if let Some(last) = self.last.take_if(|last| last.tick == tick) {
            return last;
        }
        self.until(|message| message.err().filter(|frame| frame.tick == tick))
    }
}

fn hash(text: &str) -> String {
    let scenario = Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).expect("a good scenario");
    let outcome = simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("they can be placed");
    format!("{:016x}", outcome.trace_hash)
}

#[test]
fn pausing_stepping_and_seeking_leave_the_run_unchanged() {
    let mut run = Running::new(IN_PLANE);
    let scene = run.text("scene");
    assert_eq!(
        (&scene["kind"], &scene["mode"], &scene["solids"][0]["kind"]),
        (&json!("plane"), &json!("live"), &json!("circle"))
    );
    assert!(scene["parameters"].as_array().expect("a list").iter().any(|parameter| parameter["name"] == "horizon_s"));
    assert_eq!(run.frame(0).bodies(), 2);
    for tick in 1..=13 {
        run.say(&json!({ "do": "step" }));
        assert_eq!(run.frame(tick).tick, tick);
    }
    let tenth = {
        run.say(&json!({ "do": "seek", "tick": 10 }));
        run.frame(10)
    };
    assert!(tenth.position_m[0][0] > 0.0);
    run.say(&json!({ "do": "speed", "x": null }));
    run.say(&json!({ "do": "play" }));
    let end = run.state(|state| state["at_end"] == true);
    assert_eq!(end["paused"], true);
    let last = u32::try_from(end["tick"].as_u64().expect("a number")).expect("small");
    assert_eq!(run.frame(last).figures.hash, hash(IN_PLANE));
}

#[test]
fn a_saved_scenario_repeats_the_actions_of_a_page() {
    let mut run = Running::new(IN_PLANE);
    run.text("scene");
    let order = |order: Value| json!({ "do": "order", "order": order });
    for _ in 0..7 {
        run.say(&json!({ "do": "step" }));
    }
    run.say(&order(json!({ "kind": "goal", "robot": 0, "place_m": [3, 3, 0] })));
    run.say(&order(json!({ "kind": "solid", "solid": { "kind": "segment", "from_m": [2, 1], "to_m": [3, 1] } })));
    assert_eq!(
        run.until(|message| message.ok().filter(|scene| scene["solids"][1].is_object()))["solids"][1]["kind"],
        "segment"
    );
    run.say(&order(json!({ "kind": "parameter", "name": "horizon_s", "value": 3 })));
    run.say(&order(json!({ "kind": "radio", "loss": 0.5, "range_m": null })));
    run.say(&json!({ "do": "step" }));
    run.say(&order(json!({ "kind": "move", "index": 0, "by_m": [-1, -1] })));
    run.say(&order(json!({ "kind": "down", "robot": 1, "for_s": 1 })));
    run.say(&json!({ "do": "speed", "x": null }));
    run.say(&json!({ "do": "play" }));
    let state = run.state(|state| state["at_end"] == true);
    assert_eq!(state["radio"], json!({ "loss": 0.5, "range_m": null }));
    let last = state["tick"].as_u64().expect("a number");
    run.say(&json!({ "do": "seek", "tick": 5 }));
    run.state(|state| state["tick"] == 5);
    run.say(&json!({ "do": "seek", "tick": last }));
    run.state(|state| state["tick"] == last);
    run.say(&json!({ "do": "save" }));
    let saved = run.text("saved");
    let text = saved["text"].as_str().expect("a text");
    let said = format!("# Trace hash after tick {last}: {}", hash(text));
    assert!(text.contains(&said), "{said}\n{text}");
    assert_ne!(hash(text), hash(IN_PLANE));
    run.say(&json!({ "do": "seek", "tick": 5 }));
    run.state(|state| state["tick"] == 5);
    // Playing from the past repeats the later orders.
    run.last = None;
    run.say(&json!({ "do": "play" }));
    let again = run.state(|state| state["at_end"] == true && state["tick"].as_u64() > Some(5));
    assert_eq!(again["tick"], last);
    assert_eq!(run.frame(u32::try_from(last).expect("small")).figures.hash, hash(text));
    // All six orders undone.
    for left in (0..6).rev() {
        run.say(&json!({ "do": "undo" }));
        run.state(|state| {
            let branches = state["branches"].as_array().expect("a list").iter();
            branches.clone().any(|each| each["number"] == state["branch"] && each["orders"] == left)
        });
    }
    run.last = None;
    run.say(&json!({ "do": "play" }));
    let state = run.state(|state| state["at_end"] == true && state["paused"] == true && state["tick"] != last);
    let last = u32::try_from(state["tick"].as_u64().expect("a number")).expect("small");
    assert_eq!(run.frame(last).figures.hash, hash(IN_PLANE));
}

#[test]
fn an_order_in_the_past_makes_a_branch_and_the_old_future_stays() {
    let mut run = Running::new(IN_PLANE);
    run.text("scene");
    run.say(&json!({ "do": "seek", "tick": 40 }));
    let end = run.frame(40).figures.hash;
    run.state(|state| state["tick"] == 40 && state["last"] == 40);
    run.say(&json!({ "do": "seek", "tick": 10 }));
    run.state(|state| state["tick"] == 10);
    run.say(&json!({ "do": "order", "order": { "kind": "goal", "robot": 0, "place_m": [3, 3, 0] } }));
    let state = run.state(|state| state["branch"] == 2);
    assert_eq!((&state["last"], &state["branches"][0]["last"]), (&json!(10), &json!(40)));
    assert_eq!(state["branches"][1], json!({ "number": 2, "from": 10, "last": 10, "orders": 1 }));
    run.say(&json!({ "do": "seek", "tick": 40 }));
    run.state(|state| state["tick"] == 40 && state["last"] == 40);
    run.say(&json!({ "do": "branch", "number": 1 }));
    run.until(|message| message.err().filter(|frame| frame.tick == 40 && frame.figures.hash == end));
    run.state(|state| state["branch"] == 1 && state["last"] == 40);
    for wrong in [json!({ "do": "branch", "number": 1 }), json!({ "do": "undo" })] {
        run.say(&wrong);
        assert!(run.text("error")["text"].is_string(), "{wrong}");
    }
}

#[test]
fn a_later_seek_replaces_the_one_under_way() {
    let mut run = Running::new(IN_PLANE);
    run.text("scene");
    run.say(&json!({ "do": "seek", "tick": 60 }));
    run.state(|state| state["tick"] == 60 && state["paused"] == true);
    // More than the number of requests that may wait.
    for tick in (0..2 * DEFERRED).map(|at| at % 60) {
        run.say(&json!({ "do": "seek", "tick": tick }));
    }
    run.say(&json!({ "do": "seek", "tick": 17 }));
    run.say(&json!({ "do": "order", "order": { "kind": "goal", "robot": 0, "place_m": [3, 3, 0] } }));
    let state = run.state(|state| state["branch"] == 2);
    assert_eq!((&state["tick"], &state["branches"][1]["from"]), (&json!(17), &json!(17)));
}

#[test]
fn past_positions_and_all_figures_are_sent() {
    let mut run = Running::new(IN_PLANE);
    run.text("scene");
    run.say(&json!({ "do": "seek", "tick": 12 }));
    let frame = run.frame(12);
    run.say(&json!({ "do": "trail", "ticks": [0, 5, 12] }));
    let trail = run.text("trail");
    let rows = trail["rows"].as_array().expect("a list");
    assert_eq!(rows.iter().map(|row| row[0].as_u64()).collect::<Vec<_>>(), [Some(0), Some(5), Some(12)]);
    let bytes = BASE64_STANDARD.decode(rows[2][1].as_str().expect("a text")).expect("base64");
    let columns = [0, 1].into_iter().flat_map(|axis| frame.position_m.iter().map(move |at| at[axis]));
    assert_eq!(trail["branch"], Value::Null);
    assert_eq!(bytes, columns.flat_map(f32::to_le_bytes).collect::<Vec<_>>());
}

#[test]
fn a_selected_robot_shows_its_knowledge() {
    let mut run = Running::new(IN_PLANE);
    run.text("scene");
    run.say(&json!({ "do": "select", "robot": 1 }));
    run.say(&json!({ "do": "links", "on": true }));
    for _ in 0..8 {
        run.say(&json!({ "do": "step" }));
    }
    let robot = run.until(|message| message.ok().filter(|robot| robot["type"] == "robot" && robot["tick"] == 8));
    assert_eq!((&robot["index"], &robot["id"]), (&json!(1), &json!(2)));
    assert_eq!(robot["neighbors"][0]["index"], 0);
    assert!(robot["neighbors"][0]["error_m"].as_f64() < Some(0.2), "{robot}");
    assert!(robot["orca"]["max_speed_mps"].as_f64() > Some(0.0) && robot["orca"]["lines"].is_array());
    assert!(robot["events"].as_array().is_some_and(|events| !events.is_empty()));
    let links = run.until(|message| message.ok().filter(|links| links["type"] == "links" && links["tick"] == 8));
    assert!(links["pairs"].is_string());
}

#[test]
fn a_selected_robot_that_negotiates_shows_its_plan() {
    let mut run = Running::new(
        "name = \"t\"\nticks = 50\ngrid.law = \"negotiation\"\nradio.range_m = 5\n\
         terrain.uniform = { width = 9, height = 1, classes = 1 }\n[robots]\n\
         list = [{ start = [0, 0], goal = [8, 0] }, { start = [2, 0], goal = [7, 0] }]\n",
    );
    run.text("scene");
    run.say(&json!({ "do": "select", "robot": 0 }));
    for _ in 0..2 {
        run.say(&json!({ "do": "step" }));
    }
    let robot = run.until(|message| message.ok().filter(|robot| robot["type"] == "robot" && robot["tick"] == 2));
    assert_eq!(robot["plan"], json!([{ "index": 0, "cell": [3, 0] }, { "index": 1, "cell": [5, 0] }]));
}

#[test]
fn a_changing_map_is_sent_to_pages() {
    let mut run = Running::new(
        "name = \"t\"\nticks = 50\n[terrain]\nuniform = { width = 9, height = 1, classes = 1 }\n\
         [[terrain.change]]\nat_s = 2\nclass = 0\ncells = [[5, 0]]\n[robots]\nlist = [{ start = [0, 0], goal = [8, 0] }]\n",
    );
    let cells = |scene: &Value| scene["land"]["cells"].as_str().expect("there is land").to_owned();
    let first = cells(&run.text("scene"));
    for _ in 0..3 {
        run.say(&json!({ "do": "step" }));
    }
    let then = cells(&run.text("scene"));
    assert_ne!(first, then);
    run.say(&json!({ "do": "seek", "tick": 1 }));
    assert_eq!(cells(&run.text("scene")), first, "the map before the change");
}

#[test]
fn invalid_requests_are_answered_and_other_data_disconnect() {
    let mut run = Running::new(IN_PLANE);
    run.text("scene");
    let wrong = [
        json!({ "do": "fly" }),
        json!({ "do": "order", "order": { "kind": "goal", "robot": 9, "place_m": [0, 0, 0] } }),
        json!({ "do": "order", "order": { "kind": "goal", "robot": 0 } }),
        json!({ "do": "order", "order": { "kind": "remove", "index": 5 } }),
        json!({ "do": "order", "order": { "kind": "cell", "cell": [0, 0], "class": 0 } }),
        json!({ "do": "order", "order": { "kind": "parameter", "name": "share", "value": 7 } }),
        json!({ "do": "seek", "tick": -1 }),
        json!({ "do": "new", "robots": 0, "goals": 1, "obstacles": 0, "seed": 1 }),
        json!({ "do": "new", "robots": u32::MAX, "goals": 1, "obstacles": 0, "seed": 1 }),
    ];
    for word in wrong {
        run.say(&word);
        let error = run.text("error");
        assert!(error["text"].as_str().is_some_and(|text| text.len() > 10), "{word}: {error}");
    }
    assert_eq!(
        {
            run.say(&json!({ "do": "step" }));
            run.frame(1)
        }
        .tick,
        1
    );
    let (mut stranger, _) = tungstenite::connect(&run.url).expect("it knows the token");
    stranger.send(Message::Text("garbage".into())).expect("it reads");
    while stranger.read().is_ok() {}
    assert_eq!(
        {
            run.say(&json!({ "do": "step" }));
            run.frame(2)
        }
        .tick,
        2
    );
}

#[test]
fn a_new_run_replaces_the_old_one() {
    let mut run = Running::new(IN_PLANE);
    run.text("scene");
    run.say(&json!({ "do": "new", "robots": 12, "goals": 3, "obstacles": 5, "seed": 4 }));
    let scene = run.text("scene");
    assert_eq!((&scene["name"], scene["solids"].as_array().map(Vec::len)), (&json!("new-run"), Some(5)));
    let frame = run.until(|message| message.err().filter(|frame| frame.bodies() > 2));
    assert_eq!((frame.bodies(), frame.figures.goals.len()), (12, 3));
    run.say(&json!({
        "do": "new", "robots": 4, "goals": 1, "obstacles": 5, "seed": 4, "tick_s": 0.05, "avoidance": "tangential",
        "discs": [[12, 1, 0.5]],
    }));
    let scene = run.text("scene");
    assert_eq!((&scene["tick_s"], scene["solids"].as_array().map(Vec::len)), (&json!(0.05), Some(1)));
    run.say(&json!({ "do": "new", "robots": 4, "goals": 1, "obstacles": 5, "seed": 4, "discs": [[12, null, 1]] }));
    let error = run.text("error");
    assert!(error["text"].as_str().is_some_and(|text| text.starts_with("obstacle 1 is not three numbers")), "{error}");
    run.say(&json!({ "do": "restart", "seed": 5 }));
    assert_eq!(run.text("scene")["seed"], 5);
}

#[test]
fn a_scenario_of_a_figure_shows_its_claims_until_another_run_replaces_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../papers/pav/goals/scenario.toml");
    let text = std::fs::read_to_string(&path).expect("a scenario");
    let mut session = Session::new(text, &path, &Overrides::default(), true).expect("a good scenario");
    let claims = |session: &mut Session| {
        let scene: Value = serde_json::from_str(&session.scene()).expect("JSON");
        scene.get("claims").and_then(Value::as_array).cloned().unwrap_or_default()
    };
    let shown = claims(&mut session);
    assert!(shown.len() >= 8 && shown.iter().any(|claim| claim["paper"] == "about equal"), "{shown:?}");
    assert!(shown.iter().all(|claim| claim["judgement"] == "holds" || claim["fails"] != ""), "{shown:?}");
    let server = Server::start(SocketAddr::from(([127, 0, 0, 1], 0)), Vec::new()).expect("a port is free");
    let replaced = session.replace(IN_PLANE.to_owned(), Path::new("new-run.toml"), &Overrides::default(), &server);
    replaced.expect("a good scenario");
    assert!(claims(&mut session).is_empty());
}

#[test]
fn a_run_without_goals_continues_until_a_robot_gets_one() {
    let nowhere = "name = \"t\"\nseed = 3\nticks = 100000\ntick_s = 0.05\n[radio]\nrange_m = 9\n\
         [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[[plane.robots.list]]\nstart_m = [0, 0]\n";
    let mut run = Running::new(nowhere);
    run.text("scene");
    run.say(&json!({ "do": "speed", "x": 100 }));
    run.say(&json!({ "do": "play" }));
    run.state(|state| state["paused"] == false && state["at_end"] == false && state["tick"].as_u64() > Some(20));
    run.say(&json!({ "do": "order", "order": { "kind": "goal", "robot": 0, "place_m": [1, 0, 0] } }));
    let state = run.state(|state| state["at_end"] == true);
    assert_eq!(state["paused"], true);
    assert!(state["tick"].as_u64() < Some(100_000), "{state}");
}

#[test]
fn a_page_with_too_many_deferred_requests_is_disconnected() {
    let session = Session::new(IN_PLANE.to_owned(), Path::new("t.toml"), &Overrides::default(), true);
    let mut session = session.expect("a good scenario");
    let server = Server::start(SocketAddr::from(([127, 0, 0, 1], 0)), Vec::new()).expect("a port is free");
    let url = server.url().replace("http:", "ws:").replace("/?", "/live?");
    let _page = tungstenite::connect(url).expect("it lets its pages in");
    let Some(FromPage::Opened(client)) = server.next(Duration::from_secs(10)) else {
        panic!("no page has connected");
    };
    session.catches_up_to = Some(1000);
    for _ in 0..DEFERRED {
        session.hear(FromPage::Said(client, "{\"do\": \"save\"}".to_owned()), &server);
    }
    assert_eq!(server.next(Duration::from_millis(50)), None);
    session.hear(FromPage::Said(client, "{\"do\": \"save\"}".to_owned()), &server);
    assert_eq!(server.next(Duration::from_secs(10)), Some(FromPage::Closed(client)));
    assert_eq!(session.deferred.len(), DEFERRED);
}
