//! Tests of the payloads in beacons.

use super::*;
use crate::auth::Key;
use crate::neighbor::Neighbor;
use crate::wire::{Bytes, MAX_PAYLOAD, Never, Sealed, Wire};
use core::marker::PhantomData;
use proptest::prelude::{any, prop_assert, prop_assert_eq, proptest};

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Told(u8, i16, f32);

impl Content for Told {}

#[derive(Clone, Debug, Default)]
struct Teller {
    own: Told,
    heard: Vec<(u32, Option<Told>)>,
    peers: usize,
}

/// A law that says this sends its beacons twice.
const TWICE: u8 = 77;

#[derive(Clone, Debug)]
struct Tells;

impl Protocol for Tells {
    const ID: ProtocolId = ProtocolId(64);
    type Payload = Told;
    type Message = Never;
    type Order = Never;
}

impl Law<f32> for Teller {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = Tells;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Tells>,
        _: &InPlane<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        self.heard = view.neighbors().map(|other| (other.id.0, other.payload)).collect();
        self.peers = view.peers().count();
        for (other, told) in view.peers() {
            assert_eq!(view.neighbor(other.id).and_then(|other| other.payload), Some(told));
        }
        assert_eq!(view.neighbor(RobotId(99)), None);
        Ok(Decision::default())
    }

    fn payload(&mut self, _: &InPlane<'_, f32>, _: Dir, radio: &mut Radio<'_, Tells>) -> Told {
        if self.own.0 == TWICE {
            radio.repeat_beacon();
        }
        self.own
    }
}

const OWN: Told = Told(7, -300, 1.5);

fn teller<G: Law<f32>, W: Wire>(id: u32, law: G, wire: W) -> Agent<f32, G, 4, Unguarded, W> {
    Agent::new(&config(id), law, Unguarded, wire)
}

fn step<G, W: Wire>(agent: &mut Agent<f32, G, 4, Unguarded, W>, n: u32, inbox: &[u8]) -> Outputs<f32>
where
    G: for<'a> Law<f32, Surroundings<'a> = InPlane<'a, f32>, Workspace = ()>,
{
    let surroundings = InPlane { max_speed_mps: 1.0, obstacles: &[] };
    agent.step(&Inputs { state: KinematicState::default(), surroundings, inbox }, tick(n), &mut ())
}

fn law(own: Told) -> Teller {
    Teller { own, ..Teller::default() }
}

/// A beacon with these bytes of a protocol.
fn telling(protocol: u8, bytes: &[u8]) -> Message {
    let payload = Bytes::from_slice(bytes).unwrap();
    Message::Beacon(Beacon { protocol: ProtocolId(protocol), payload, ..Beacon::default() })
}

fn encoded(told: Told) -> Bytes<MAX_PAYLOAD> {
    told.encode(Tells::ID).unwrap().1
}

#[test]
fn a_beacon_carries_the_payload_and_it_is_stored_with_the_neighbour() {
    let (mut one, mut two) = (teller(1, law(OWN), Postcard), teller(2, law(Told(9, 0, 0.0)), Postcard));
    let out = step(&mut one, 0, &[]);
    let [Frame { message: Message::Beacon(beacon), .. }] = &sent(&out)[..] else { panic!("a beacon") };
    assert_eq!((beacon.protocol, &beacon.payload), (ProtocolId(64), &encoded(OWN)));
    let _ = step(&mut two, 0, &out.outbox);
    assert_eq!(two.neighbors().iter().map(|other| other.payload).collect::<Vec<_>>(), [Some(OWN)]);
    assert_eq!((&two.law().heard[..], two.law().peers), (&[(1, Some(OWN))][..], 1));
}

#[test]
fn a_repeated_beacon_replaces_a_lost_one_and_counts_once() {
    let own = Told(TWICE, 1, 0.0);
    let out = step(&mut teller(1, law(own), Postcard), 0, &[]);
    let (first, second) = out.outbox.split_at(out.outbox.len() / 2);
    assert_eq!(first, second);
    for inbox in [first, &out.outbox] {
        let mut two = teller(2, law(OWN), Postcard);
        let heard = step(&mut two, 0, inbox);
        assert_eq!((heard.received, two.neighbors().len(), two.neighbors()[0].payload), (1, 1, Some(own)));
    }
}

#[test]
fn a_wrapper_sends_the_payload_of_the_law_inside() {
    let mut plain = teller(1, law(OWN), Postcard);
    let said = step(&mut plain, 0, &[]).outbox;
    let mut guided = teller(1, Guided::new(law(OWN), 1.0, 0.1), Postcard);
    assert_eq!(step(&mut guided, 0, &[]).outbox, said);
}

#[test]
fn the_payload_of_the_latest_beacon_counts() {
    let mut agent = teller(1, law(OWN), Postcard);
    let mut hear = |boot, sequence, told: Told| {
        let _ = step(&mut agent, 0, &bytes(2, boot, sequence, &[telling(64, &encoded(told))]));
        agent.neighbors()[0].payload
    };
    let late = Told(1, 1, 1.0);
    assert_eq!(hear(0, 2, OWN), Some(OWN));
    assert_eq!(hear(0, 1, late), Some(OWN), "an older one came later");
    assert_eq!(hear(0, 3, late), Some(late));
    assert_eq!(hear(1, 0, OWN), Some(OWN), "its computer has restarted");
}

#[test]
fn a_robot_whose_payload_does_not_decode_is_known_without_one() {
    let right = encoded(OWN);
    for (protocol, wrong) in
        [(64, &right[..6]), (64, &[&right[..], &[0]].concat()), (64, &[]), (65, &right), (1, &right), (0, &[])]
    {
        let mut agent = teller(1, law(OWN), Postcard);
        let _ = step(&mut agent, 0, &bytes(2, 0, 0, &[telling(64, &right)]));
        assert_eq!(agent.law().peers, 1);
        let out = step(&mut agent, 0, &bytes(2, 0, 1, &[telling(protocol, wrong)]));
        assert_eq!((out.received, out.rejected), (1, 0));
        assert_eq!((&agent.law().heard[..], agent.law().peers), (&[(2, None)][..], 0), "{protocol}");
    }
}

#[test]
fn with_a_key_a_forged_payload_is_refused() {
    let wire = |passphrase: &[u8]| Sealed::<4>::at_start(&Key::of_passphrase(passphrase), 0).unwrap();
    let mut one = teller(1, law(OWN), wire(b"swarm"));
    let mut two = teller(2, law(OWN), wire(b"swarm"));
    let mut forger = teller(1, law(Told(1, 1, 1.0)), wire(b"guessed"));
    let _ = step(&mut two, 0, &step(&mut one, 0, &[]).outbox);
    let known = [(1, Some(OWN))];
    assert_eq!(two.law().heard, known);
    let out = step(&mut two, 1, &step(&mut forger, 1, &[]).outbox);
    assert_eq!((out.refused.forged, &two.law().heard[..]), (1, &known[..]));
}

/// Says the same in each beacon.
struct Says<P>(P);

#[derive(Clone, Debug)]
struct Of<P>(PhantomData<P>);

impl<P: Content + Copy + Default + Send + Sync> Protocol for Of<P> {
    const ID: ProtocolId = ProtocolId(64);
    type Payload = P;
    type Message = Never;
    type Order = Never;
}

impl<P: Content + Copy + Default + Send + Sync> Law<f32> for Says<P> {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = Of<P>;
    type Workspace = ();

    fn decide(
        &mut self,
        _: &View<'_, f32, Of<P>>,
        _: &InPlane<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        Ok(Decision::default())
    }

    fn payload(&mut self, _: &InPlane<'_, f32>, _: Dir, _: &mut Radio<'_, Of<P>>) -> P {
        self.0
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Sixteen([u8; 16]);
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Seventeen([u8; 17]);
impl Content for Sixteen {}
impl Content for Seventeen {}

/// The protocol, the bytes, and the payload that a robot with the same law knows.
fn said<P: Content + Copy + Default + Send + Sync>(payload: P) -> (ProtocolId, Vec<u8>, Option<P>) {
    let (mut one, mut two) = (teller(1, Says(payload), Postcard), teller(2, Says(payload), Postcard));
    let out = step(&mut one, 0, &[]);
    let _ = step(&mut two, 0, &out.outbox);
    let [Frame { message: Message::Beacon(beacon), .. }] = &sent(&out)[..] else { panic!("a beacon") };
    (beacon.protocol, beacon.payload.to_vec(), two.neighbors()[0].payload)
}

#[test]
fn a_payload_of_16_bytes_is_sent_and_one_of_17_is_sent_as_none() {
    assert_eq!(MAX_PAYLOAD, 16);
    let fits = Sixteen([7; 16]);
    assert_eq!(said(fits), (ProtocolId(64), vec![7; 16], Some(fits)));
    assert_eq!(said(Seventeen([7; 17])), (ProtocolId::NONE, vec![], None));
}

#[test]
fn a_law_that_says_nothing_sends_no_payload_and_knows_none() {
    struct Silent;
    impl Law<f32> for Silent {
        type Surroundings<'a> = InPlane<'a, f32>;
        type Protocol = ();
        type Workspace = ();
        fn decide(
            &mut self,
            _: &View<'_, f32>,
            _: &InPlane<'_, f32>,
            _: Tools<'_, f32, Self>,
        ) -> Result<Decision<f32>, BadInput> {
            Ok(Decision::default())
        }
    }
    let mut agent = teller(1, Silent, Postcard);
    let out = step(&mut agent, 0, &bytes(2, 0, 0, &[telling(64, &encoded(OWN))]));
    let [Frame { message: Message::Beacon(beacon), .. }] = &sent(&out)[..] else { panic!("a beacon") };
    assert_eq!((beacon.protocol, beacon.payload.len()), (ProtocolId::NONE, 0));
    assert_eq!((out.received, agent.neighbors()[0].payload), (1, None));
    assert_eq!(size_of::<Neighbor<f32>>(), size_of::<Neighbor<f32, [u8; 0]>>());
    assert!(size_of::<Neighbor<f32, [u8; 16]>>() <= size_of::<Neighbor<f32>>() + 16);
}

#[test]
fn bytes_of_another_protocol_or_of_another_length_are_no_content() {
    let (id, bytes) = OWN.encode::<MAX_PAYLOAD>(Tells::ID).unwrap();
    assert_eq!((id, bytes.len()), (Tells::ID, 1 + 2 + 4));
    assert_eq!(Told::decode(Tells::ID, id, &bytes), Some(OWN));
    assert_eq!(Told::decode(Tells::ID, ProtocolId(65), &bytes), None);
    assert_eq!(Told::decode(ProtocolId(65), id, &bytes), None);
    assert_eq!(Told::decode(Tells::ID, id, &bytes[..6]), None);
    assert_eq!(Told::decode(Tells::ID, id, &[&bytes[..], &[0]].concat()), None);
    assert_eq!(OWN.encode::<7>(Tells::ID).map(|(_, bytes)| bytes.len()), Some(7));
    assert_eq!(OWN.encode::<6>(Tells::ID), None);
    assert_eq!(u64::MAX.encode::<9>(Tells::ID), None);
    assert_eq!(Some(3_u8).encode::<2>(Tells::ID).map(|(_, bytes)| bytes.to_vec()), Some(vec![1, 3]));
    assert_eq!(().encode::<0>(Tells::ID), Some((Tells::ID, Bytes::new())));
    assert!(Told::EXISTS && !Never::EXISTS && Never::decode(Tells::ID, Tells::ID, &[]).is_none());
}

proptest! {
    #[test]
    fn any_bytes_decode_to_a_value_or_to_none(bytes in proptest::collection::vec(any::<u8>(), 0..=MAX_PAYLOAD)) {
        if let Some(value) = Told::decode(Tells::ID, Tells::ID, &bytes) {
            let again = Told::decode(Tells::ID, Tells::ID, &encoded(value)).unwrap();
            prop_assert_eq!((again.0, again.1, again.2.to_bits()), (value.0, value.1, value.2.to_bits()));
        }
        prop_assert!(Seventeen::decode(Tells::ID, Tells::ID, &bytes).is_none());
        let any = AnyPayload::decode(AnyProtocol::ID, Tells::ID, &bytes).unwrap();
        let again = any.encode::<MAX_PAYLOAD>(AnyProtocol::ID);
        prop_assert_eq!(again.map(|(id, again)| (id, again.to_vec())), Some((Tells::ID, bytes)));
    }
}
