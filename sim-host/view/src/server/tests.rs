use super::*;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

fn server() -> Server {
    let page = File { name: "", kind: "text/html", text: "<script nonce=\"NONCE\"></script>".to_owned() };
    let script = File { name: "app.js", kind: "text/javascript", text: "x".repeat(300_000) };
    Server::start(SocketAddr::from(([127, 0, 0, 1], 0)), vec![page, script]).expect("a port is free")
}

fn get(server: &Server, target: &str) -> String {
    let mut stream = TcpStream::connect(server.address()).expect("it listens");
    let request = format!("GET {target} HTTP/1.1\r\nHost: {}\r\n\r\n", server.address());
    stream.write_all(request.as_bytes()).expect("it reads");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("it answers");
    answer
}

type Page = WebSocket<MaybeTlsStream<TcpStream>>;

fn open(server: &Server) -> (Page, Client) {
    let url = server.url().replace("http:", "ws:").replace("/?", "/live?");
    let (page, _) = tungstenite::connect(url).expect("it lets its pages in");
    match server.next(Duration::from_secs(10)) {
        Some(FromPage::Opened(client)) => (page, client),
        other => panic!("{other:?}"),
    }
}

#[test]
fn files_are_whole_and_each_answer_has_its_own_nonce() {
    let server = server();
    let page = format!("/?token={}", server.token);
    let nonce = |answer: &str| answer.split("nonce=\"").nth(1).map(|rest| rest[..32].to_owned()).expect("a nonce");
    let [one, other] = [(); 2].map(|()| get(&server, &page));
    assert!(
        one.starts_with("HTTP/1.1 200 OK\r\n") && one.contains(&format!("script-src 'self' 'nonce-{}'", nonce(&one)))
    );
    assert_ne!(nonce(&one), nonce(&other));
    assert!(get(&server, "/app.js").ends_with(&"x".repeat(300_000)));
    for target in ["/", "//", "/./", "/%2f", &format!("/{page}")] {
        assert!(get(&server, target).starts_with("HTTP/1.1 403 "), "{target}");
    }
    assert!(get(&server, "/secret.js").starts_with("HTTP/1.1 404 "));
}

#[test]
fn a_page_talks_and_is_shown_the_newest_frame() {
    let server = server();
    let (mut page, client) = open(&server);
    page.send(Message::Text("hello".into())).expect("it reads");
    assert_eq!(server.next(Duration::from_secs(10)), Some(FromPage::Said(client, "hello".to_owned())));
    server.say(Some(client), "to you");
    server.say(None, "to all");
    server.show(vec![1, 2, 3]);
    let said = [(); 3].map(|()| page.read().expect("it says so"));
    assert_eq!(
        said,
        [Message::Text("to you".into()), Message::Text("to all".into()), Message::Binary(vec![1, 2, 3].into())]
    );
    page.close(None).expect("it can leave");
    page.flush().ok();
    assert_eq!(server.next(Duration::from_secs(10)), Some(FromPage::Closed(client)));
}

#[test]
fn a_slow_page_misses_frames_without_delaying_others() {
    let server = server();
    let (mut slow, _) = open(&server);
    let (mut quick, _) = open(&server);
    let mut seen = 0;
    for number in 0..200_u8 {
        server.show(vec![number; 1 << 20]);
        let frame = quick.read().expect("it comes").into_data();
        seen += usize::from(frame.first() == Some(&number));
    }
    assert_eq!(seen, 200);
    let (mut frames, mut last) = (0, 0);
    while last != 199 {
        last = slow.read().expect("the newest comes").into_data()[0];
        frames += 1;
    }
    assert!(frames < 100, "{frames}");
}

#[test]
fn garbage_and_many_connections_do_not_block_a_page() {
    let server = server();
    let (mut page, client) = open(&server);
    let mut crowd: Vec<TcpStream> = Vec::new();
    for number in 0..CONNECTIONS + 50 {
        let mut stream = TcpStream::connect(server.address()).expect("it listens");
        if number % 3 == 0 {
            let _ = stream.write_all(&[number as u8; 700]);
        }
        crowd.push(stream);
    }
    assert!(get(&server, &format!("/?token={}", server.token)).starts_with("HTTP/1.1 200 OK"));
    server.say(None, "still there");
    assert_eq!(page.read().expect("it is"), Message::Text("still there".into()));
    page.send(Message::Text("x".repeat(100_000).into())).ok();
    assert_eq!(server.next(Duration::from_secs(10)), Some(FromPage::Closed(client)));
    drop(crowd);
}

#[test]
fn too_many_pages_are_answered_with_an_error() {
    let server = server();
    let pages: Vec<_> = (0..PAGES).map(|_| open(&server)).collect();
    let url = server.url().replace("http:", "ws:").replace("/?", "/live?");
    let error = tungstenite::connect(url).expect_err("there is no room");
    assert!(error.to_string().contains("503"), "{error}");
    drop(pages);
}

#[test]
fn a_port_in_use_is_an_error_with_a_remedy() {
    let server = server();
    let error = Server::start(server.address(), Vec::new()).expect_err("it is taken").to_string();
    assert!(error.contains(&server.address().to_string()) && error.contains("--listen"), "{error}");
}

#[test]
fn waiting_respects_the_timeout_after_the_thread_ended() {
    let server = server();
    assert!(server.is_alive());
    server.send(ToPages::End);
    let began = Instant::now();
    while server.is_alive() && began.elapsed() < Duration::from_secs(10) {
        std::thread::yield_now();
    }
    assert!(!server.is_alive());
    let began = Instant::now();
    assert_eq!(server.next(Duration::from_millis(50)), None);
    assert!(began.elapsed() >= Duration::from_millis(50), "a busy loop");
    assert_eq!(server.next(Duration::ZERO), None);
}

mod flood;
