//! Tests of the payloads that laws send after their beacons.

use super::*;
use crate::auth::Key;
use crate::geom::Position;
use crate::neighbor::{Neighbor, NeighborTable};
use crate::wire::{MAX_PAYLOAD, PayloadBytes, Sealed, Wire};
use proptest::prelude::{any, prop_assert_eq, proptest};

type Told = (u8, i16, f32);

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct Teller {
    own: Told,
    heard: Vec<(u32, Told)>,
}

struct Tells;

impl Protocol for Tells {
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
        view: &View<'_, f32, Told>,
        _: &InPlane<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        self.heard = view.neighbors.iter().map(|other| (other.id.0, other.payload)).collect();
        Ok(Decision::default())
    }

    fn payload(&mut self, _: &mut Radio<'_, Never>) -> Told {
        self.own
    }
}

const OWN: Told = (7, -300, 1.5);

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
    Teller { own, heard: Vec::new() }
}

fn told(payload: Told) -> Message {
    Message::Payload(PayloadBytes::of(&payload).unwrap())
}

fn beacon() -> Message {
    Message::Beacon(beacon_at(3, 4))
}

#[test]
fn a_payload_follows_each_beacon_and_is_stored_with_the_neighbour() {
    let (mut one, mut two) = (teller(1, law(OWN), Postcard), teller(2, law((9, 0, 0.0)), Postcard));
    let out = step(&mut one, 0, &[]);
    let kinds: Vec<bool> = sent(&out).iter().map(|frame| frame.message == told(OWN)).collect();
    assert_eq!(kinds, [false, true]);
    let _ = step(&mut two, 0, &out.outbox);
    assert_eq!(two.neighbors().iter().map(|other| other.payload).collect::<Vec<_>>(), [OWN]);
    assert_eq!(two.law().heard, [(1, OWN)]);
}

#[test]
fn a_wrapper_sends_the_payload_of_the_law_inside() {
    let mut plain = teller(1, law(OWN), Postcard);
    let said = step(&mut plain, 0, &[]).outbox;
    let mut guided = teller(1, Guided::new(law(OWN), 1.0, 0.1), Postcard);
    assert_eq!(step(&mut guided, 0, &[]).outbox, said);
}

#[test]
fn a_payload_is_kept_between_beacons_and_discarded_after_a_restart() {
    let mut agent = teller(1, law(OWN), Postcard);
    let mut hear = |n, inbox: &[u8]| {
        let _ = step(&mut agent, n, inbox);
        agent.neighbors().first().map(|other| other.payload)
    };
    assert_eq!(hear(0, &bytes(2, 0, 0, &[told(OWN)])), None, "a payload alone makes no robot known");
    assert_eq!(hear(0, &bytes(2, 0, 1, &[beacon()])), Some(Told::default()));
    assert_eq!(hear(0, &bytes(2, 0, 2, &[told(OWN)])), Some(OWN));
    assert_eq!(hear(0, &bytes(2, 0, 4, &[beacon()])), Some(OWN));
    assert_eq!(hear(0, &bytes(2, 0, 3, &[told((1, 1, 1.0))])), Some(OWN), "an older one came later");
    assert_eq!(hear(0, &bytes(2, 1, 0, &[beacon()])), Some(Told::default()), "its computer has restarted");
}

#[test]
fn bytes_that_do_not_decode_change_nothing() {
    let mut agent = teller(1, law(OWN), Postcard);
    let _ = step(&mut agent, 0, &bytes(2, 0, 0, &[beacon(), told(OWN)]));
    let right = PayloadBytes::of(&OWN).unwrap();
    for (wrong, sequence) in [&right.as_slice()[..6], &[right.as_slice(), &[0]].concat(), &[]].into_iter().zip(2..) {
        let wrong = Message::Payload(PayloadBytes::new(wrong).unwrap());
        let out = step(&mut agent, 0, &bytes(2, 0, sequence, &[wrong]));
        assert_eq!(out.received, 1);
        assert_eq!(agent.neighbors()[0].payload, OWN);
    }
}

#[test]
fn with_a_key_a_forged_payload_is_refused() {
    let wire = |passphrase: &[u8]| Sealed::<4>::at_start(&Key::of_passphrase(passphrase), 0).unwrap();
    let mut one = teller(1, law(OWN), wire(b"swarm"));
    let (mut two, mut forger) = (teller(2, law(OWN), wire(b"swarm")), teller(1, law((1, 1, 1.0)), wire(b"guessed")));
    let _ = step(&mut two, 0, &step(&mut one, 0, &[]).outbox);
    assert_eq!(two.law().heard, [(1, OWN)]);
    let out = step(&mut two, 1, &step(&mut forger, 1, &[]).outbox);
    assert_eq!((out.refused.forged, &two.law().heard[..]), (2, &[(1, OWN)][..]));
}

#[test]
fn an_empty_payload_costs_no_byte_on_the_air_or_in_memory() {
    assert_eq!(size_of::<Neighbor<f32>>(), size_of::<Neighbor<f32, [u8; 0]>>());
    assert_eq!(size_of::<Neighbor<f32, [u8; 16]>>(), size_of::<Neighbor<f32>>() + 16);
    let mut agent = route_agent(1);
    let heard = bytes(2, 0, 0, &[beacon(), told(OWN)]);
    let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &heard), tick(0), &mut workspace());
    assert_eq!((sent(&out).len(), out.received, out.rejected), (1, 2, 0));
    let without = Neighbor::<f32>::from_beacon(RobotId(2), &beacon_at(3, 4), tick(0));
    assert_eq!(agent.neighbors(), [without]);
}

#[test]
fn a_payload_that_is_too_long_is_not_sent() {
    assert_eq!(PayloadBytes::of(&[u32::MAX; 4]), None);
    assert_eq!(PayloadBytes::of(&[[u8::MAX; 16]]).unwrap().as_slice().len(), MAX_PAYLOAD);
    assert_eq!(PayloadBytes::new(&[0; MAX_PAYLOAD + 1]), None);
    let mut table = NeighborTable::<f32, 1, u8>::new(config(1).ages);
    table.tell(RobotId(1), Some(3));
    let heard = Neighbor::from_beacon(RobotId(2), &beacon_at(1, 1), tick(0));
    let _ = table.put(heard, Position::default(), tick(0), |_| false);
    table.tell(RobotId(1), Some(3));
    assert_eq!(table.as_slice()[0].payload, 0);
    table.tell(RobotId(2), Some(3));
    assert_eq!(table.as_slice()[0].payload, 3);
}

proptest! {
    #[test]
    fn any_bytes_decode_to_a_value_or_to_none(bytes in proptest::collection::vec(any::<u8>(), 0..=MAX_PAYLOAD)) {
        let bytes = PayloadBytes::new(&bytes).unwrap();
        if let Some(value) = bytes.get::<Told>() {
            let again = PayloadBytes::of(&value).and_then(|bytes| bytes.get::<Told>()).unwrap();
            prop_assert_eq!((again.0, again.1, again.2.to_bits()), (value.0, value.1, value.2.to_bits()));
        }
        prop_assert_eq!(bytes.get::<[u8; 17]>(), None);
    }
}
