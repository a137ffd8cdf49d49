use super::*;
use proptest::prelude::*;
use staya_controller::wire::{Beacon, Format, Header, Message, Wire};

const TICK_US: u32 = 100_000;
const FRAME: [u8; 8] = [7, 7, 7, 7, 7, 7, 7, 0];

fn radio(params: RadioParams, robots: u32) -> Radio {
    Radio::new(&params, 11, TICK_US, (1..=robots).map(RobotId))
}

fn line(robots: u32) -> Vec<[f64; 3]> {
    (0..robots).map(|i| [f64::from(i), 0.0, 0.0]).collect()
}

fn one_way(params: RadioParams, ticks: u32) -> (Radio, Vec<Vec<u8>>) {
    let mut radio = radio(params, 2);
    let inboxes = (0..ticks)
        .map(|tick| {
            let frame = [tick as u8 | 1, (tick >> 8) as u8 | 1, 1, 0];
            radio.carry(tick, &line(2), |i| if i == 0 { &frame[..] } else { &[] });
            radio.inbox(1).to_vec()
        })
        .collect();
    (radio, inboxes)
}

fn share(part: u64, whole: u64) -> f64 {
    part as f64 / whole as f64
}

#[test]
fn a_perfect_radio_delivers_by_sender_and_not_to_the_sender() {
    let mut radio = radio(RadioParams::default(), 3);
    let frames: Vec<_> = (1..=3).map(|i| [i, 0, i, 0]).collect();
    let counts = radio.carry(0, &line(3), |i| &frames[i]);
    assert_eq!(radio.inbox(0).to_vec(), [2, 0, 2, 0, 3, 0, 3, 0]);
    assert_eq!(radio.inbox(1).to_vec(), [1, 0, 1, 0, 3, 0, 3, 0]);
    assert_eq!((counts.sent, counts.delivered, counts.lost), (6, 12, 0));
    radio.carry(1, &line(3), |_| &[]);
    assert!((0..3).all(|i| radio.inbox(i).to_vec().is_empty()), "inboxes hold one tick");
}

#[test]
fn range_is_inclusive_and_may_be_infinite() {
    for (range_m, reached) in [(0.0, 0), (1.0, 1), (2.999, 2), (3.0, 3), (f64::INFINITY, 5)] {
        let params = RadioParams { range_m, ..RadioParams::default() };
        let mut radio = radio(params, 6);
        let counts = radio.carry(0, &line(6), |i| if i == 0 { &FRAME } else { &[] });
        assert_eq!(counts.delivered, reached, "range {range_m}");
    }
}

#[test]
fn coincident_robots_and_an_empty_swarm_are_valid() {
    let params = RadioParams { range_m: 0.0, ..RadioParams::default() };
    let mut crowd = radio(params, 5);
    let counts = crowd.carry(0, &[[2.0, 3.0, 0.0]; 5], |_| &FRAME);
    assert_eq!(counts.delivered, 20);
    let mut empty = radio(RadioParams::default(), 0);
    assert_eq!(empty.carry(0, &[], |_| &FRAME), Counts::default());
}

#[test]
fn loss_has_its_probability_and_extremes_are_exact() {
    for (loss, low, high) in [(0.0, 0.0, 0.0), (0.3, 0.28, 0.32), (1.0, 1.0, 1.0)] {
        let params = RadioParams { loss, ..RadioParams::default() };
        let (radio, _) = one_way(params, 10_000);
        let total = radio.total();
        assert_eq!(total.delivered + total.lost, 10_000);
        let lost = share(total.lost, 10_000);
        assert!((low..=high).contains(&lost), "{loss}: {lost}");
    }
}

#[test]
fn bursts_have_their_share_and_mean_length() {
    let burst = Some(Burst { share: 0.2, mean_ms: 1000.0, loss: 1.0 });
    let params = RadioParams { burst, ..RadioParams::default() };
    let (radio, inboxes) = one_way(params, 100_000);
    let lost = share(radio.total().lost, 100_000);
    assert!((0.18..0.22).contains(&lost), "{lost}");
    let bursts = inboxes.windows(2).filter(|w| !w[0].is_empty() && w[1].is_empty()).count();
    let mean_ticks = share(radio.total().lost, bursts as u64);
    assert!((9.0..11.0).contains(&mean_ticks), "{mean_ticks}");
}

#[test]
fn bursts_of_different_links_are_independent() {
    let burst = Some(Burst { share: 0.5, mean_ms: 500.0, loss: 1.0 });
    let mut radio = radio(RadioParams { burst, ..RadioParams::default() }, 3);
    let mut both = 0;
    for tick in 0..20_000 {
        radio.carry(tick, &line(3), |i| if i == 0 { &FRAME } else { &[] });
        both += u32::from(radio.inbox(1).to_vec().is_empty() && radio.inbox(2).to_vec().is_empty());
    }
    assert!((4_000..6_000).contains(&both), "{both}");
}

#[test]
fn delay_is_rounded_up_to_the_next_step() {
    for (delay_ms, steps) in [(0.0, 0), (100.0, 0), (100.5, 1), (350.0, 3)] {
        let params = RadioParams { delay_ms, ..RadioParams::default() };
        let mut radio = radio(params, 2);
        let arrived = (0..10).find(|&tick| {
            radio.carry(tick, &line(2), |i| if i == 0 && tick == 0 { &FRAME } else { &[] });
            !radio.inbox(1).to_vec().is_empty()
        });
        assert_eq!(arrived, Some(steps), "{delay_ms} ms");
        assert_eq!(radio.inbox(1).to_vec(), FRAME);
    }
}

#[test]
fn jitter_and_reorder_change_the_order_and_lose_no_packet() {
    let jitter = RadioParams { jitter_ms: 1000.0, ..RadioParams::default() };
    let reorder = RadioParams { reorder: 0.2, reorder_ms: 1000.0, ..RadioParams::default() };
    for params in [jitter, reorder] {
        let mut radio = radio(params, 2);
        let mut order: Vec<u8> = Vec::new();
        for tick in 0..220 {
            let frame = [1 + tick as u8, 0];
            let sent = if tick < 200 { &frame[..] } else { &[] };
            radio.carry(tick, &line(2), |i| if i == 0 { sent } else { &[] });
            order.extend(radio.inbox(1).to_vec().iter().filter(|byte| **byte != 0));
        }
        assert!(order.windows(2).any(|w| w[0] > w[1]), "some overtake");
        order.sort_unstable();
        assert_eq!(order, (1..=200).collect::<Vec<u8>>());
    }
}

#[test]
fn duplicates_have_their_probability() {
    let params = RadioParams { duplicate: 0.25, ..RadioParams::default() };
    let (radio, inboxes) = one_way(params, 10_000);
    let extra = share(radio.total().delivered - 10_000, 10_000);
    assert!((0.23..0.27).contains(&extra), "{extra}");
    assert!(inboxes.iter().all(|inbox| inbox.len() == 4 || inbox[..4] == inbox[4..]));
}

#[test]
fn bits_flip_at_their_rate_but_never_in_the_delimiter() {
    let params = RadioParams { bit_error_rate: 0.01, ..RadioParams::default() };
    let (radio, inboxes) = one_way(params, 20_000);
    let flipped: u32 = (0..)
        .zip(&inboxes)
        .map(|(tick, inbox)| {
            let sent = [tick as u8 | 1, (tick >> 8) as u8 | 1, 1, 0];
            assert_eq!(inbox.last(), Some(&0));
            inbox.iter().zip(sent).map(|(a, b): (&u8, u8)| (a ^ b).count_ones()).sum::<u32>()
        })
        .sum();
    let rate = share(u64::from(flipped), 480_000);
    assert!((0.0095..0.0105).contains(&rate), "{rate}");
    let hit = share(radio.total().damaged, 20_000);
    assert!((hit - (1.0 - libm::pow(0.99, 24.0))).abs() < 0.01, "{hit}");
    let all = RadioParams { bit_error_rate: 1.0, ..RadioParams::default() };
    assert_eq!(one_way(all, 1).1[0], [!1, !1, !1, 0]);
}

#[test]
fn bandwidth_caps_the_mean_and_counts_what_it_drops() {
    let params = RadioParams { bandwidth_bytes_per_s: Some(20), ..RadioParams::default() };
    // 80 B/s, of which 20 B/s are allowed, after 256 bytes saved at the start.
    let mut radio = radio(params, 2);
    for tick in 0..1000 {
        radio.carry(tick, &line(2), |i| if i == 0 { &FRAME } else { &[] });
    }
    let total = radio.total();
    assert_eq!(total.sent + total.throttled, 1000);
    assert_eq!(total.sent, (999 * 2 + 256) / 8);
}

#[test]
fn a_blackout_loses_everything_while_it_lasts() {
    let params = RadioParams { blackout_s: vec![[1.0, 2.0]], ..RadioParams::default() };
    let (radio, inboxes) = one_way(params, 30);
    for (tick, inbox) in inboxes.iter().enumerate() {
        assert_eq!(inbox.is_empty(), (10..20).contains(&tick), "tick {tick}");
    }
    assert_eq!(radio.total().lost, 10);
}

/// For each of three robots, the ticks of its receptions with the sender's number.
fn heard_with(fault: Vec<RadioFault>, ticks: u32) -> Vec<Vec<(u32, u8)>> {
    let mut radio = radio(RadioParams { fault, ..RadioParams::default() }, 3);
    let frames: Vec<_> = (1..=3).map(|i| [i, 9, 9, 0]).collect();
    let mut heard = vec![Vec::new(); 3];
    for tick in 0..ticks {
        radio.carry(tick, &line(3), |i| &frames[i]);
        for (index, heard) in heard.iter_mut().enumerate() {
            let inbox = radio.inbox(index).to_vec();
            heard.extend(inbox.chunks(4).map(|frame| (tick, frame[0])));
        }
    }
    heard
}

/// Number of packets that each robot receives from each other one in 30 ticks.
fn links_with(fault: RadioFault) -> [usize; 6] {
    let heard = heard_with(vec![fault], 30);
    let count = |receiver: usize, sender| heard[receiver].iter().filter(|(_, from)| *from == sender).count();
    [count(0, 2), count(0, 3), count(1, 1), count(1, 3), count(2, 1), count(2, 2)]
}

#[test]
fn a_fault_concerns_only_its_senders_and_receivers() {
    let from = |ids: &[u32]| RadioFault { from: Some(ids.to_vec()), ..RadioFault::default() };
    let to = |ids: &[u32], fault| RadioFault { to: Some(ids.to_vec()), ..fault };
    let both = |fault| RadioFault { both_ways: true, ..fault };
    // Receptions 1 <- 2, 1 <- 3, 2 <- 1, 2 <- 3, 3 <- 1, 3 <- 2.
    for (fault, links) in [
        (from(&[1]), [30, 30, 0, 30, 0, 30]),
        (to(&[1], RadioFault::default()), [0, 0, 30, 30, 30, 30]),
        (to(&[2], from(&[1])), [30, 30, 0, 30, 30, 30]),
        (both(to(&[2], from(&[1]))), [0, 30, 0, 30, 30, 30]),
        (both(from(&[3])), [30, 0, 30, 0, 0, 0]),
        (to(&[3], from(&[2, 1])), [30, 30, 30, 30, 0, 0]),
        (RadioFault::default(), [0; 6]),
        (RadioFault { loss: 0.0, ..from(&[1]) }, [30; 6]),
    ] {
        assert_eq!(links_with(fault.clone()), links, "{fault:?}");
    }
}

#[test]
fn a_fault_lasts_from_its_begin_until_its_end() {
    for (at_s, for_s, silent) in
        [(0.0, Some(1.0), 0..10), (1.0, Some(0.5), 10..15), (2.0, None, 20..30), (1.0, Some(0.0), 0..0)]
    {
        let fault = RadioFault { from: Some(vec![1]), to: Some(vec![2]), at_s, for_s, ..RadioFault::default() };
        let heard = heard_with(vec![fault], 30);
        let ticks: Vec<u32> = heard[1].iter().filter(|(_, from)| *from == 1).map(|(tick, _)| *tick).collect();
        assert_eq!(ticks, (0..30).filter(|tick| !silent.contains(tick)).collect::<Vec<_>>(), "{at_s} {for_s:?}");
    }
}

#[test]
fn faults_on_one_link_lose_independently() {
    let bad = |id| RadioFault { from: Some(vec![id]), both_ways: true, loss: 0.5, ..RadioFault::default() };
    let heard = heard_with(vec![bad(1), bad(2)], 20_000);
    for (receiver, sender, low, high) in
        [(0, 2, 0.23, 0.27), (1, 1, 0.23, 0.27), (2, 1, 0.48, 0.52), (1, 3, 0.48, 0.52)]
    {
        let received = heard[receiver].iter().filter(|(_, from)| *from == sender).count();
        let received = share(received as u64, 20_000);
        assert!((low..high).contains(&received), "{receiver} <- {sender}: {received}");
    }
}

#[test]
fn a_fault_removes_packets_and_changes_no_other() {
    let fault = vec![RadioFault { from: Some(vec![1]), loss: 0.5, ..RadioFault::default() }];
    let bad = RadioParams { delay_ms: 0.0, jitter_ms: 0.0, reorder: 0.0, bandwidth_bytes_per_s: None, ..harsh() };
    let bad = RadioParams { fault: Vec::new(), ..bad };
    let (whole, all) = one_way(bad.clone(), 2_000);
    let (part, some) = one_way(RadioParams { fault, ..bad }, 2_000);
    assert!(all.iter().zip(&some).all(|(all, some)| some == all || some.is_empty()));
    let kept = share(part.total().delivered, whole.total().delivered);
    assert!((0.47..0.53).contains(&kept), "{kept}");
}

fn harsh() -> RadioParams {
    RadioParams {
        range_m: 3.0,
        loss: 0.1,
        burst: Some(Burst { share: 0.1, mean_ms: 400.0, loss: 0.9 }),
        delay_ms: 30.0,
        jitter_ms: 200.0,
        duplicate: 0.1,
        reorder: 0.1,
        bit_error_rate: 0.001,
        bandwidth_bytes_per_s: Some(70),
        fault: vec![RadioFault {
            from: Some(vec![3, 1]),
            both_ways: true,
            loss: 0.4,
            at_s: 0.3,
            ..RadioFault::default()
        }],
        ..RadioParams::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn fates_depend_neither_on_threads_nor_on_the_order_of_robots(seed: u64, places in prop::collection::vec((0.0..20.0, 0.0..20.0), 1..80)) {
        let ids: Vec<_> = (1..).map(RobotId).take(places.len()).collect();
        let positions: Vec<_> = places.iter().map(|&(x, y)| [x, y, 0.0]).collect();
        let frames: Vec<_> = ids.iter().map(|id| [id.0 as u8, 9, 0, 3, id.0 as u8, 0]).collect();
        let run = |threads: usize, reversed: bool| {
            let order = |list: Vec<usize>| -> Vec<usize> {
                if reversed { list.into_iter().rev().collect() } else { list }
            };
            let order = order((0..ids.len()).collect());
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let mut radio = Radio::new(&harsh(), seed, TICK_US, order.iter().map(|&i| ids[i]));
                let positions: Vec<_> = order.iter().map(|&i| positions[i]).collect();
                let mut heard = vec![Vec::new(); ids.len()];
                for tick in 0..12 {
                    radio.carry(tick, &positions, |i| &frames[order[i]]);
                    for (at, &i) in order.iter().enumerate() {
                        heard[i].extend_from_slice(&radio.inbox(at).to_vec());
                    }
                }
                (radio.total(), heard)
            })
        };
        let once = run(1, false);
        prop_assert_eq!(&run(2, false), &once);
        prop_assert_eq!(&run(8, true), &once);
    }

    #[test]
    fn exactly_the_robots_in_range_are_received(
        range_m in 0.0..30.0_f64,
        places in prop::collection::vec((-50.0..50.0, -5.0..5.0, -30.0..30.0), 1..60),
    ) {
        let positions: Vec<_> = places.iter().map(|&(x, y, z)| [x, y, z]).collect();
        let frames: Vec<_> = (1..=places.len()).map(|i| [i as u8, 0]).collect();
        let params = RadioParams { range_m, ..RadioParams::default() };
        let mut radio = Radio::new(&params, 0, TICK_US, (1..).map(RobotId).take(places.len()));
        radio.carry(0, &positions, |i| &frames[i]);
        for (i, a) in positions.iter().enumerate() {
            let near = |b: &[f64; 3]| {
                let [dx, dy, dz] = [0, 1, 2].map(|axis| a[axis] - b[axis]);
                dx * dx + dy * dy + dz * dz <= range_m * range_m
            };
            let expected: Vec<u8> = (0..positions.len())
                .filter(|&j| j != i && near(&positions[j]))
                .flat_map(|j| frames[j])
                .collect();
            prop_assert_eq!(radio.inbox(i).to_vec(), expected);
        }
    }

    #[test]
    fn decoded_frames_are_those_that_a_receiver_would_decode(
        is_mavlink: bool,
        has_keys: bool,
        junk in prop::collection::vec((0..5_usize, prop::collection::vec(any::<u8>(), 0..9), 0..3_usize), 1..30),
    ) {
        let params = RadioParams {
            format: if is_mavlink { Format::Mavlink } else { Format::Postcard },
            ..RadioParams::default()
        };
        // Some frames are whole, some cut, some have other bytes before or behind them.
        let outboxes = junk.into_iter().zip(1..).map(|((kind, other, cut), id)| {
            let header = Header { boot: 0, sender: RobotId(id), sequence: 7 };
            let mut frame = heapless::Vec::<u8, 60>::new();
            let message = Message::Beacon(Beacon { radius_mm: id as u16, ..Beacon::default() });
            wire(params.format, None, 0).encode(header, &message, &mut frame).expect("room");
            let frame = frame.to_vec();
            match kind {
                0 => frame[..frame.len() - cut].to_vec(),
                1 => [other, frame].concat(),
                2 => [frame, other].concat(),
                _ => [frame.clone(), frame].concat(),
            }
        });
        let outboxes: Vec<Vec<u8>> = outboxes.collect();
        let robots = outboxes.len();
        let mut radio = Radio::new(&params, 3, TICK_US, (1..).map(RobotId).take(robots)).with_keys(has_keys);
        radio.carry(0, &line(robots as u32), |i| &outboxes[i]);
        let decoded = |bytes: &[u8]| {
            let (mut rest, mut own) = (bytes, wire(params.format, None, 0));
            let pieces = std::iter::from_fn(|| own.next_frame(&mut rest)).map(<[u8]>::to_vec).collect::<Vec<_>>();
            pieces.iter().map(|piece| own.decode(piece)).collect::<Vec<_>>()
        };
        for own in 0..robots {
            let inbox = radio.inbox(own);
            prop_assert_eq!(inbox.frame_bytes() + inbox.bytes.len(), inbox.to_vec().len());
            prop_assert!(!has_keys || inbox.frames().next().is_none());
            let shared = inbox.frames().cloned().map(Ok);
            let others = (0..robots).filter(|&other| other != own).flat_map(|other| outboxes[other].clone());
            let sent = decoded(&others.collect::<Vec<_>>());
            prop_assert_eq!(shared.chain(decoded(inbox.bytes)).collect::<Vec<_>>(), sent);
        }
    }

    #[test]
    fn on_a_torus_robots_in_range_of_the_nearest_image_are_received_once(
        range_m in 0.0..30.0_f64,
        sides in (1.0..60.0_f64, 1.0..60.0_f64),
        places in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..60),
    ) {
        let sides = [sides.0, sides.1];
        let positions: Vec<_> = places.iter().map(|&(x, y)| [x * sides[0], y * sides[1], 0.0]).collect();
        let frames: Vec<_> = (1..=places.len()).map(|i| [i as u8, 0]).collect();
        let params = RadioParams { range_m, ..RadioParams::default() };
        let ids = (1..).map(RobotId).take(places.len());
        let mut radio = Radio::new(&params, 0, TICK_US, ids).on_torus(Some(sides));
        radio.carry(0, &positions, |i| &frames[i]);
        for (i, a) in positions.iter().enumerate() {
            let distance_m = |b: &[f64; 3]| {
                let along = |axis: usize| {
                    let way = (a[axis] - b[axis]).abs();
                    way.min(sides[axis] - way)
                };
                libm::hypot(along(0), along(1))
            };
            // Skips cases in which rounding decides whether a robot is in range.
            prop_assume!(positions.iter().all(|b| (distance_m(b) - range_m).abs() > 1e-9));
            let near = (0..positions.len()).filter(|&j| j != i && distance_m(&positions[j]) <= range_m);
            let expected: Vec<u8> = near.flat_map(|j| frames[j]).collect();
            prop_assert_eq!(radio.inbox(i).to_vec(), expected);
        }
    }
}

#[test]
fn delayed_bytes_are_shared_by_all_receivers() {
    let delayed = RadioParams { delay_ms: 300.0, bit_error_rate: 1e-3, ..RadioParams::default() };
    let mut radio = radio(delayed, 50);
    let mut longest = 0;
    for tick in 0..20 {
        radio.carry(tick, &line(50), |_| &[7; 40]);
        longest = longest.max(radio.air.bytes());
    }
    assert!(longest <= 5 * 50 * 40, "{longest} bytes of the packets of at most five ticks");
}

#[test]
fn memory_is_estimated_from_pairs_in_range() {
    let near = RadioParams { range_m: 10.0, ..RadioParams::default() };
    let slow = RadioParams { delay_ms: 1000.0, ..near.clone() };
    let all = RadioParams::default();
    let square = |side: u32| (0..side * side).map(move |i| [f64::from(i % side), f64::from(i / side), 0.0]);
    let expected = |params: &RadioParams, side: u32| {
        let places: Vec<_> = square(side).collect();
        expected_bytes(params, TICK_US, 1.0, &places) as f64 / (places.len() as f64 * PACKET_BYTES)
    };
    // Robots in range of each: all 400, or the 317 of a circle of 10 m.
    assert!((390.0..410.0).contains(&expected(&all, 20)), "{}", expected(&all, 20));
    assert!((250.0..330.0).contains(&expected(&near, 100)), "{}", expected(&near, 100));
    assert!(expected(&slow, 100) > 4.0 * expected(&near, 100));
}
