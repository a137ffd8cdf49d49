use super::{ABOUT, LARGE, SMALL, answers, frame, in_plane, large, read, stepped};
use crate::message::{Configured, Fault, FaultKind, Greeting, Step, StepInputs, Token, kind};
use crate::own::{OwnLarge, OwnSmall};
use crate::refusal::Refusal;
use crate::robot::Controller;
use crate::session::{About, Session};
use crate::surroundings::PackedSurroundings;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    Action, BadInput, Command, Decision, InAny, InPlane, KinematicState, Law, Progress, Protocol, Setup, Task, Tools,
    View, Waypoint,
};
use staya_controller::geom::{Position, Vec3};
use staya_controller::scalar::{NumberFormat, Scalar};
use staya_controller::time::Instant;
use staya_controller::wire::{Never, ProtocolId};
use std::vec::Vec;

#[derive(Clone, Debug, Serialize, Deserialize)]
struct East {
    mmps: u16,
    gain_mmps: u16,
}

#[derive(Clone, Debug)]
enum Bytes {}

impl Protocol for Bytes {
    const ID: ProtocolId = ProtocolId(64);
    type Payload = u8;
    type Message = Never;
    type Order = Never;
}

impl InAny for Bytes {}

impl<S: Scalar> Law<S> for East {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = Bytes;
    type Workspace = ();

    fn decide(
        &mut self,
        _: &View<'_, S, Bytes>,
        _: &InPlane<'_, S>,
        _: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        self.mmps += self.gain_mmps;
        let x = S::from_f32(f32::from(self.mmps) / 1000.0).unwrap_or(S::ZERO);
        let wish_mps = Vec3 { x, ..Vec3::ZERO };
        Ok(Decision::new(Action::Velocity { wish_mps, way_m: None }, Progress::Going))
    }
}

const LAW: East = East { mmps: 20, gain_mmps: 10 };

fn greeting() -> Vec<u8> {
    frame(kind::GREETING, &Greeting { token: Token { run: 1, number: 1 } })
}

fn configure(law: &impl Serialize) -> Vec<u8> {
    frame(kind::CONFIGURE, &(1_u16, in_plane(), None::<Task>, law))
}

fn inputs(tick: u32) -> StepInputs<'static> {
    StepInputs {
        tick,
        now: Instant::from_micros(tick * 100_000),
        state: KinematicState::default(),
        cell: None,
        window: None,
        surroundings: Some(PackedSurroundings { max_speed_mps: 1.0, in_cell: None, obstacles: &[] }),
        inbox: &[],
    }
}

fn run<C: Controller, const N: usize>(mut session: Session<C, N>, mut shadow: C, ticks: u16) -> f32 {
    let mut law = [0; 16];
    let law = postcard::to_slice(&LAW, &mut law).expect("fits");
    let digest = shadow.configure(&in_plane(), None, law).expect("a robot");
    drop(answers(&mut session, &greeting()));
    let configured = answers(&mut session, &configure(&LAW));
    assert_eq!(read::<Configured>(kind::CONFIGURED, &configured[0]), Configured { seq: 1, digest });
    let mut east = 0.0;
    for tick in 0..ticks {
        let inputs = inputs(tick.into());
        let answer = answers(&mut session, &frame(kind::STEP, &Step { seq: tick + 2, inputs }));
        let stepped = stepped(&answer[0]);
        shadow.step(&inputs).expect("it steps");
        assert!(stepped.result.is_identical(&shadow.result().expect("a result")));
        let Command::Velocity(velocity_mps) = stepped.result.outputs.command else {
            panic!("{:?}", stepped.result.outputs.command);
        };
        east = velocity_mps.x;
    }
    east
}

#[test]
fn device_steps_the_law_sent_by_the_host_in_both_number_formats() {
    let session = Session::<OwnLarge<East>, LARGE>::new(OwnLarge::new(), ABOUT);
    assert!((run(session, OwnLarge::new(), 4) - 0.06).abs() < 1e-6);
    let about = About { part: "nrf51", ..ABOUT };
    let session = Session::<OwnSmall<East>, SMALL>::new(OwnSmall::new(), about);
    assert!((run(session, OwnSmall::new(), 4) - 0.06).abs() < 1e-4);
    assert_eq!(OwnSmall::<East>::new().number(), NumberFormat::Q16);
}

#[test]
fn laws_that_cannot_be_parsed_are_refused() {
    let fault = |answer: &[Vec<u8>]| {
        let Fault { kind, text, .. } = read(kind::FAULT, &answer[0]);
        assert_eq!(kind, FaultKind::Setup);
        assert!(text.contains("another guidance law"), "{text}");
    };
    let mut own = Session::<OwnLarge<East>, LARGE>::new(OwnLarge::new(), ABOUT);
    drop(answers(&mut own, &greeting()));
    fault(&answers(&mut own, &configure(&())));
    fault(&answers(&mut own, &configure(&5_u8)));
    fault(&answers(&mut own, &configure(&(LAW, 1_u8))));
    let mut ours = large();
    drop(answers(&mut ours, &greeting()));
    fault(&answers(&mut ours, &configure(&LAW)));
}

#[test]
fn tasks_that_the_law_does_not_accept_are_refused() {
    let mut robot = OwnLarge::<East>::new();
    let mut law = [0; 16];
    let law = postcard::to_slice(&LAW, &mut law).expect("fits");
    let waypoint = Waypoint::fixed(Position::from_mm([1000, 0, 0]));
    let task = Task::Waypoints([(0, waypoint)].into_iter().collect());
    let setup: Setup = in_plane();
    assert_eq!(robot.configure(&setup, Some(&task), law), Err(Refusal::Task));
    assert_eq!(robot.step(&inputs(0)), Err(Refusal::NotConfigured));
    assert!(robot.configure(&setup, Some(&Task::Waypoints(heapless::Vec::new())), law).is_ok());
}
