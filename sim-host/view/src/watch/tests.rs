use super::*;
use serde_json::Value;
use staya_controller::robot::RobotId;
use staya_sim::engine::simulate;
use staya_sim::scenario::Overrides;
use std::net::{SocketAddr, TcpStream};
use std::ops::ControlFlow;
use std::path::Path;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

const THREE: &str = "name = \"t\"\nseed = 3\nticks = 40\ntick_s = 0.05\n[radio]\nrange_m = 9\n\
     [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[[plane.robots.list]]\nstart_m = [0, 0]\ngoal_m = [6, 0]\n\
     [[plane.robots.list]]\nstart_m = [6, 1]\ngoal_m = [0, 1]\n[[plane.robots.list]]\nstart_m = [3, 5]\n";

struct Some3;

impl Insight for Some3 {
    fn about(&self, index: usize) -> About {
        let other = |id| Known { id: RobotId(id), position_m: [1.0, 0.0, 0.0], velocity_mps: [0.0; 3], age_s: 0.5 };
        About {
            known: (index == 1).then(|| vec![other(1), other(3), other(77)]),
            device: Some(DeviceFigures { instructions: Some(1234), stack: 99, ..DeviceFigures::default() }),
            facts: vec![("companion", "steers".to_owned())],
        }
    }

    fn is_measured(&self, index: usize) -> bool {
        index != 2
    }

    fn links(&self) -> Option<Vec<[u32; 2]>> {
        Some(vec![[0, 1]])
    }
}

fn scenario() -> Scenario {
    Scenario::parse(THREE, Path::new("t.toml"), &Overrides::default()).expect("a good scenario")
}

fn watcher(scenario: &Scenario) -> Watcher {
    let server = Server::start(SocketAddr::from(([127, 0, 0, 1], 0)), Vec::new()).expect("a port is free");
    Watcher::new(server, scenario).expect("a scene")
}

type Page = WebSocket<MaybeTlsStream<TcpStream>>;

fn open(watcher: &mut Watcher) -> Page {
    let url = watcher.server().url().replace("http:", "ws:").replace("/?", "/live?");
    let (page, _) = tungstenite::connect(url).expect("it lets its pages in");
    let known = watcher.pages();
    while watcher.pages() == known {
        watcher.is_due();
    }
    page
}

fn text(page: &mut Page, kind: &str) -> Value {
    loop {
        if let Message::Text(text) = page.read().expect("a message") {
            let value: Value = serde_json::from_str(&text).expect("JSON");
            if value["type"] == kind {
                return value;
            }
        }
    }
}

fn say(page: &mut Page, watcher: &mut Watcher, words: &[Value]) {
    for word in words {
        page.send(Message::Text(word.to_string().into())).expect("it reads");
    }
    let until = Instant::now() + Duration::from_secs(10);
    let heard = |watcher: &Watcher| watcher.pages.values().any(|looks| looks.links);
    while !heard(watcher) && Instant::now() < until {
        watcher.is_due();
    }
    assert!(heard(watcher), "it does not listen");
}

#[test]
fn a_selected_robot_shows_the_details_of_the_run() {
    let scenario = scenario();
    let mut watcher = watcher(&scenario);
    let mut page = open(&mut watcher);
    say(&mut page, &mut watcher, &[json!({ "do": "select", "robot": 1 }), json!({ "do": "links", "on": true })]);
    let outcome = simulate(&scenario, |moment, robots| {
        watcher.show(moment, robots, &Some3);
        if moment.row.tick < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    outcome.expect("they can be placed");
    let robot = std::iter::repeat_with(|| text(&mut page, "robot")).find(|robot| robot["tick"] == 3).expect("it comes");
    assert_eq!(
        (&robot["id"], &robot["device"]["instructions"], &robot["device"]["stack"]),
        (&json!(2), &json!(1234), &json!(99))
    );
    assert_eq!(robot["facts"], json!([["companion", "steers"]]));
    let neighbors = robot["neighbors"].as_array().expect("it knows some");
    let error_m = neighbors[0]["error_m"].as_f64().expect("the first one is measured");
    assert!((0.8..=1.0).contains(&error_m), "{error_m}");
    assert_eq!((&neighbors[1]["index"], &neighbors[1]["error_m"]), (&json!(2), &Value::Null));
    assert_eq!((&neighbors[2]["index"], &neighbors[2]["error_m"]), (&Value::Null, &Value::Null));
    let pairs = text(&mut page, "links")["pairs"].as_str().map(|pairs| BASE64_STANDARD.decode(pairs));
    assert_eq!(pairs.expect("a text").expect("base64"), [0, 0, 0, 0, 4, 0, 0, 0]);
}

#[test]
fn other_requests_of_read_only_pages_are_ignored_or_disconnect() {
    let scenario = scenario();
    let mut watcher = watcher(&scenario);
    let mut pages = [(); 3].map(|()| open(&mut watcher));
    let words =
        ["{\"do\": \"order\", \"order\": {}}".to_owned(), "{\"do\": \"select\"".to_owned(), "x".repeat(LONGEST + 1)];
    for (page, word) in pages.iter_mut().zip(words) {
        page.send(Message::Text(word.into())).expect("it reads");
    }
    let until = Instant::now() + Duration::from_secs(10);
    while watcher.pages() > 1 && Instant::now() < until {
        watcher.is_due();
    }
    assert_eq!(watcher.pages(), 1);
    drop(watcher);
    let close = std::iter::repeat_with(|| pages[0].read()).find_map(|read| match read {
        Ok(Message::Close(frame)) => Some(frame),
        Ok(_) => None,
        Err(error) => panic!("{error}"),
    });
    assert_eq!(close.flatten().map(|frame| u16::from(frame.code)), Some(1001));
}

#[test]
fn without_a_page_no_row_is_read() {
    let scenario = scenario();
    let mut watcher = watcher(&scenario);
    let outcome = simulate(&scenario, |moment, _| {
        let mut robots = std::iter::from_fn(|| -> Option<RobotRow> { panic!("no page is open") });
        watcher.tick(moment, &mut robots);
        ControlFlow::Continue(())
    });
    assert!(outcome.is_ok());
}
