//! Connections that misuse the server, beside a page that does not.

use super::*;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};

/// An empty ping with an all-zero mask.
const PING: [u8; 6] = [0x89, 0x80, 0, 0, 0, 0];
/// The start of a text, and a part that does not end it.
const FRAGMENT: [u8; 6] = [0x01, 0x80, 0, 0, 0, 0];
const CONTINUATION: [u8; 6] = [0x00, 0x80, 0, 0, 0, 0];
/// Longer than a command may take to end.
const LIMIT: Duration = Duration::from_secs(5);

fn text(bytes: u16) -> Vec<u8> {
    let [high, low] = bytes.to_be_bytes();
    [&[0x81, 0xfe, high, low, 0, 0, 0, 0], "x".repeat(bytes.into()).as_bytes()].concat()
}

fn stream(page: &Page) -> &TcpStream {
    match page.get_ref() {
        MaybeTlsStream::Plain(stream) => stream,
        _ => panic!("there is no encryption"),
    }
}

fn send(page: &Page, bytes: &[u8]) -> std::io::Result<()> {
    stream(page).write_all(bytes)
}

/// Returns the texts of the page until it is disconnected.
fn until_closed(server: &Server, page: Client) -> Vec<String> {
    let mut said = Vec::new();
    let until = Instant::now() + LIMIT;
    while Instant::now() < until {
        match server.next(Duration::from_millis(100)) {
            Some(FromPage::Closed(client)) if client == page => return said,
            Some(FromPage::Said(client, text)) if client == page => said.push(text),
            _ => {}
        }
    }
    panic!("the page is still connected");
}

#[derive(Clone, Copy, Debug)]
enum Misuse {
    Pings,
    Texts,
    Fragments,
    HalfRequests,
    Connections,
    NeverReads,
}

/// Misuses the server until `stop`, and connects again whenever it is disconnected.
fn misuse(server: &Server, how: Misuse, stop: &Arc<AtomicBool>) -> JoinHandle<()> {
    let url = server.url().replace("http:", "ws:").replace("/?", "/live?");
    let (address, stop) = (server.address(), Arc::clone(stop));
    let bytes = match how {
        Misuse::Pings => PING.repeat(1000),
        Misuse::Texts => text(60_000),
        Misuse::Fragments => [FRAGMENT.as_slice(), &CONTINUATION.repeat(1000)].concat(),
        Misuse::HalfRequests => b"GET /".repeat(100),
        Misuse::Connections | Misuse::NeverReads => Vec::new(),
    };
    std::thread::spawn(move || {
        while !stop.load(Ordering::Relaxed) {
            let page = match how {
                Misuse::HalfRequests | Misuse::Connections => None,
                _ => tungstenite::connect(&url).ok(),
            };
            let plain = if page.is_none() { TcpStream::connect(address).ok() } else { None };
            std::thread::sleep(Duration::from_millis(1));
            let Some(mut line) = page.as_ref().map(|(page, _)| stream(page)).or(plain.as_ref()) else { continue };
            let _ = line.set_write_timeout(Some(Duration::from_millis(100)));
            let is_waiting = matches!(how, Misuse::NeverReads);
            while !stop.load(Ordering::Relaxed) && !bytes.is_empty() && line.write_all(&bytes).is_ok() {}
            while !stop.load(Ordering::Relaxed) && is_waiting {
                std::thread::sleep(Duration::from_millis(10));
            }
        }
    })
}

/// A page gets its frames and the server ends, although all others misuse it meanwhile.
fn floods(span: Duration) {
    let server = server();
    let (mut page, client) = open(&server);
    let (_deaf, deaf) = open(&server);
    stream(&page).set_read_timeout(Some(LIMIT)).expect("a socket");
    let stop = Arc::new(AtomicBool::new(false));
    let ways = [
        Misuse::Pings,
        Misuse::Texts,
        Misuse::Fragments,
        Misuse::HalfRequests,
        Misuse::Connections,
        Misuse::NeverReads,
    ];
    let floods = ways.map(|how| misuse(&server, how, &stop));
    let (mut frames, mut closed) = (0, BTreeSet::new());
    let began = Instant::now();
    while began.elapsed() < span {
        for _ in 0..64 {
            match server.next(Duration::ZERO) {
                Some(FromPage::Closed(client)) => drop(closed.insert(client)),
                Some(_) => {}
                None => break,
            }
        }
        server.say(None, "x".repeat(1 << 20));
        server.show(vec![0; 1 << 20]);
        while !page.read().expect("the page gets its frames").is_binary() {}
        frames += 1;
    }
    let counts = server.counts();
    let ended = Instant::now();
    let (done, is_done) = channel();
    std::thread::spawn(move || {
        drop(server);
        let _ = done.send(());
    });
    is_done.recv_timeout(LIMIT).expect("the end does not wait for pages");
    let took = ended.elapsed();
    stop.store(true, Ordering::Relaxed);
    for thread in floods {
        thread.join().expect("a client has failed");
    }
    assert!(frames >= 5 && took < LIMIT, "{frames} frames, ended after {took:?}");
    assert!(closed.contains(&deaf) && !closed.contains(&client), "{closed:?} without {deaf:?}, with {client:?}");
    assert!(counts.left > 1, "{counts:?}");
}

#[test]
fn a_page_gets_its_frames_and_the_server_ends_during_a_flood() {
    floods(Duration::from_secs(1));
}

#[test]
#[ignore = "takes 20 s"]
fn a_page_gets_its_frames_and_the_server_ends_during_a_long_flood() {
    floods(Duration::from_secs(20));
}

#[test]
fn the_end_does_not_wait_for_a_thread_that_is_busy() {
    let server = server();
    let latest = Arc::clone(&server.latest);
    let busy = lock(&latest);
    server.seen(Client(0), 0);
    std::thread::sleep(Duration::from_millis(100));
    let (done, is_done) = channel();
    std::thread::spawn(move || {
        drop(server);
        let _ = done.send(());
    });
    is_done.recv_timeout(LIMIT).expect("the end waits for the thread");
    drop(busy);
}

#[test]
fn a_page_may_send_many_messages_a_second_and_no_more() {
    let server = server();
    let (mut page, _) = open(&server);
    send(&page, &PING.repeat(2000)).expect("it reads");
    send(&page, &text(10)).expect("it reads");
    assert!(matches!(server.next(LIMIT), Some(FromPage::Said(..))), "the page is within its limit");
    assert!(page.read().expect("an answer").is_pong());
    let too_much =
        [PING.repeat(20_000), text(60_000).repeat(40), [FRAGMENT.as_slice(), &CONTINUATION.repeat(1 << 19)].concat()];
    for (number, bytes) in too_much.into_iter().enumerate() {
        let (page, client) = open(&server);
        let sender = std::thread::spawn(move || {
            let _ = send(&page, &bytes);
            page
        });
        // The run reads, so that no queue is the reason.
        until_closed(&server, client);
        drop(sender.join());
        assert_eq!(server.counts().left, number as u64 + 1);
    }
}

#[test]
fn unread_messages_of_a_page_are_bounded_and_do_not_disconnect_others() {
    let server = server();
    let (page, client) = open(&server);
    let (other, quiet) = open(&server);
    send(&page, &text(60_000).repeat(12)).expect("it reads");
    let until = Instant::now() + LIMIT;
    while server.counts().left == 0 && Instant::now() < until {
        std::thread::sleep(Duration::from_millis(1));
    }
    send(&other, &text(60_000)).expect("it reads");
    let said: usize = until_closed(&server, client).iter().map(String::len).sum();
    assert!((60_000..=300_000).contains(&said), "{said}");
    assert!(matches!(server.next(LIMIT), Some(FromPage::Said(client, _)) if client == quiet));
}

#[test]
fn a_page_that_does_not_read_is_closed() {
    let server = server();
    let (_page, client) = open(&server);
    for _ in 0..40 {
        server.say(Some(client), "x".repeat(1 << 20));
    }
    until_closed(&server, client);
    assert_eq!(server.counts().left, 1);
}

#[test]
fn a_scene_and_a_frame_of_a_million_robots_arrive() {
    const LARGE: usize = 48 << 20;
    let server = server();
    let (mut page, client) = open(&server);
    server.send_scene(Some(client), "ä".repeat(LARGE / 2));
    server.say(Some(client), "next");
    server.show(vec![7; LARGE]);
    let said = [(); 3].map(|()| page.read().expect("it comes"));
    assert_eq!(said.each_ref().map(Message::len), [LARGE, 4, LARGE]);
    assert!(said[0].is_text() && said[1].is_text() && said[2].is_binary());
    assert_eq!(server.counts().left, 0);
}
