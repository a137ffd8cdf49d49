//! A fleet whose devices restart, babble or send control characters.

mod common;

use common::{Scene, config, now};
use staya_link::message::FaultKind;
use staya_link::robot::{LARGE_INBOX, Large};
use staya_link::session::{About, Reaction, Session, content_bytes, fault_frame};
use staya_runner::{Answer, Channel, Fleet, Options};
use std::io::{Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::{Duration, Instant};

const LARGE: usize = content_bytes(169, 32, LARGE_INBOX);
const ABOUT: About = About { part: "stm32f405", firmware: "lockstep 0.1.0", boot: 0, ticks_per_second: 1 };

fn options() -> Options {
    Options { resend_after: Duration::from_millis(20), ..Options::new("nowhere".into()) }
}

/// A device whose end of the line is served by a thread.
fn channel(live: impl FnOnce(UnixStream) + Send + 'static) -> Channel {
    let (ours, theirs) = UnixStream::pair().expect("sockets");
    std::thread::spawn(move || live(theirs));
    Channel::new(ours.try_clone().expect("a second handle"), ours)
}

/// Answers until `is_over` returns true before an answer. Returns whether the line is still open.
fn serve(line: &mut UnixStream, about: About, mut is_over: impl FnMut() -> bool) -> bool {
    let mut session = Session::<Large, LARGE>::new(Large::new(), about);
    let mut byte = [0];
    if line.write_all(session.hello()).is_err() {
        return false;
    }
    while line.read_exact(&mut byte).is_ok() {
        match session.receive(byte[0], &mut ()) {
            Reaction::Answer(_) if is_over() => return true,
            Reaction::Answer(frame) if line.write_all(frame).is_ok() => {}
            Reaction::Answer(_) => return false,
            Reaction::None | Reaction::Restart => {}
        }
    }
    false
}

/// A device that sends `bytes` again and again, and reads nothing.
fn babbler(bytes: Vec<u8>) -> Channel {
    channel(move |mut line| {
        while line.write_all(&bytes).is_ok() {
            std::thread::sleep(Duration::from_millis(1));
        }
    })
}

/// A device that restarts instead of each answer after the first `answers`, and the number of its
/// restarts.
fn restless(answers: u32) -> (Channel, Arc<AtomicU32>) {
    let restarts = Arc::new(AtomicU32::new(0));
    let count = Arc::clone(&restarts);
    let channel = channel(move |mut line| {
        let mut is_open = true;
        while is_open {
            let boot = count.fetch_add(1, Ordering::Relaxed);
            let mut left = answers + 1;
            is_open = serve(&mut line, About { boot, ..ABOUT }, || {
                left -= 1;
                left == 0
            });
        }
    });
    (channel, restarts)
}

fn start_error(channel: Channel, limit: Duration) -> String {
    let options = Options { start_limit: limit, program: Some("lockstep 0.1.0".to_owned()), ..options() };
    Fleet::over(vec![(config(1, "thread"), channel)], options).expect_err("it cannot start").to_string()
}

#[test]
fn text_of_a_device_is_printed_without_control_characters() {
    let fault = fault_frame(FaultKind::Panic, "\u{1b}[2J\u{9b}31m it's\r\n\u{202e}d");
    let text = start_error(babbler(fault.bytes().to_vec()), Duration::from_secs(10));
    assert!(text.ends_with(r"Panic: \u{1b}[2J\u{9b}31m it's\r\n\u{202e}d"), "{text}");
    let about = About { part: "a\u{7}", firmware: "\u{1b}]0;x\u{7}", boot: 1, ticks_per_second: 1 };
    let (text, statistics) = {
        let run = |program| {
            let lines = vec![(config(1, "thread"), channel(move |mut line| _ = serve(&mut line, about, || false)))];
            Fleet::over(lines, Options { program, ..options() })
        };
        let error = run(Some("lockstep 0.1.0".to_owned())).expect_err("another program").to_string();
        (error, run(None).expect("any program").statistics())
    };
    assert!(text.contains(r"it runs `\u{1b}]0;x\u{7}`"), "{text}");
    assert_eq!((statistics[0].part.as_str(), statistics[0].firmware.as_str()), (r"a\u{7}", r"\u{1b}]0;x\u{7}"));
}

#[test]
fn bytes_that_make_no_message_name_the_baud_rate() {
    let limit = Duration::from_millis(200);
    let with_zeros: Vec<u8> = (0..500_u32).map(|i| (i * 37 % 251) as u8).collect();
    for junk in [with_zeros, vec![0xff; 64], vec![0; 64]] {
        let text = start_error(babbler(junk), limit);
        assert!(text.starts_with("robot 1 on thread: no answer to greeting within "), "{text}");
        assert!(text.contains(" bytes arrived, and no message") && text.contains("baud rate"), "{text}");
    }
    let silent = start_error(babbler(Vec::new()), limit);
    assert!(silent.ends_with(" attempts)"), "{silent}");
}

#[test]
fn device_that_restarts_while_it_starts_is_greeted_at_a_bounded_rate_and_given_up() {
    for answers in 0..=1 {
        let (channel, restarts) = restless(answers);
        let began = Instant::now();
        let text = start_error(channel, Duration::from_secs(1));
        let restarts = restarts.load(Ordering::Relaxed);
        // A greeting in 20 ms, which is the time between attempts here.
        assert!((3..=60).contains(&restarts), "{restarts} restarts, {text}");
        assert!(began.elapsed() < Duration::from_secs(5), "{:?}", began.elapsed());
        assert!(text.contains("restarts again and again") && text.contains("power supply"), "{text}");
    }
}

#[test]
fn device_that_was_given_up_does_not_come_back() {
    let is_silent = Arc::new(AtomicBool::new(false));
    let silenced = Arc::clone(&is_silent);
    let silent = channel(move |mut line| {
        serve(&mut line, ABOUT, || silenced.load(Ordering::Relaxed));
        std::thread::sleep(Duration::from_millis(200));
        serve(&mut line, About { boot: 1, ..ABOUT }, || false);
    });
    let well = channel(|mut line| {
        serve(&mut line, ABOUT, || false);
    });
    let options = Options { step_limit: Duration::from_millis(100), ..options() };
    let lines = vec![(config(1, "thread"), silent), (config(2, "thread"), well)];
    let mut fleet = Fleet::over(lines, options).expect("they start");
    let mut tick = |tick| {
        for index in 0..2 {
            let scene = Scene::new(index as u32 + 1, tick);
            fleet.send(index, tick, now(tick), &scene.inputs());
        }
        let answers = fleet.collect();
        assert!(matches!(answers[1], Answer::Decided(_)), "{:?}", answers[1]);
        answers.into_iter().next().expect("two")
    };
    assert!(matches!(tick(0), Answer::Decided(_)));
    is_silent.store(true, Ordering::Relaxed);
    assert!(matches!(tick(1), Answer::Failed(_)));
    std::thread::sleep(Duration::from_millis(400));
    for number in 2..6 {
        let Answer::Failed(error) = tick(number) else {
            panic!("it has answered step {number}");
        };
        assert_eq!(error.to_string(), "robot 1 on thread: it was given up before");
    }
}
