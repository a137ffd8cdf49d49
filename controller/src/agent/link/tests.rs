use super::*;
use crate::wire::Postcard;

#[test]
fn frames_fill_the_outbox_to_the_last_byte_that_is_not_reserved() {
    let config = AgentConfig::<f32>::new(RobotId(1), 0.2, Duration::from_millis(100));
    let mut link = Link::<f32, 3, Postcard, ()>::new(&config, Postcard);
    let (mut out, beacon) = (Outputs::default(), Message::Beacon(Beacon::default()));
    assert_eq!(link.say(&beacon, 0, &mut out), Ok(()));
    let len = out.outbox.len();
    assert_eq!(link.say(&beacon, OUTBOX - 2 * len, &mut out), Ok(()));
    assert_eq!(link.say(&beacon, OUTBOX - 3 * len + 1, &mut out), Err(EncodeError::Full));
    assert_eq!((out.outbox.len(), link.header.sequence), (2 * len, 2), "a frame that does not fit is taken back");
}

#[test]
fn a_lost_robot_without_a_key_may_begin_with_any_number_again() {
    let config = AgentConfig::<f32>::new(RobotId(1), 0.2, Duration::from_millis(100));
    let mut link = Link::<f32, 3, Postcard, ()>::new(&config, Postcard);
    let mut out = Outputs::default();
    for (id, heard_s) in [(2, 0), (3, 60)] {
        let heard = Instant::from_micros(heard_s * 1_000_000);
        let known = Neighbor::from_beacon(RobotId(id), &Beacon::default(), <()>::ID, heard);
        assert_eq!(link.table.put(known, Position::ORIGIN, heard, |_| false), Put::Inserted);
        link.note_sender(Sender::silent(RobotId(id)));
    }
    let body = Body {
        id: RobotId(1),
        velocity_mps: Vec3::ZERO,
        radius_m: 0.2,
        max_speed_mps: 1.0,
        max_acceleration_mps2: f32::MAX,
        step_s: 0.1,
    };
    link.expire(Position::ORIGIN, &body, Instant::from_micros(60_000_000), &config, true, &mut out);
    assert_eq!(out.events.as_slice(), [Event::NeighborLost(RobotId(2))]);
    assert!(link.senders.iter().map(|sender| sender.id).eq([RobotId(3)]));
}
