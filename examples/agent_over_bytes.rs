//! Two robots change places and exchange nothing but bytes: a packet sent in one tick arrives in
//! the next, sometimes with a damaged byte. Run it with `cargo run --example agent_over_bytes`.

use staya_controller::agent::*;
use staya_controller::geom::Position;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::Postcard;

const TICK: Duration = Duration::from_millis(50);
const TICK_S: f32 = 0.05;
const RADIUS_M: f32 = 0.2;
const SPEED_MPS: f32 = 0.5;

struct Robot {
    agent: OrcaAgent,
    state: KinematicState<f32>,
    inbox: Vec<u8>,
}

fn robot(id: u32, from: Position, to: Position) -> Robot {
    let config = AgentConfig::new(RobotId(id), RADIUS_M, TICK);
    let law = WaypointGuidance::new(SPEED_MPS, 0.02);
    let inflation = StalenessInflation { growth_mps: 0.1, max_m: 0.2 };
    let safety = OrcaSafety::new(AvoidParams::default(), inflation);
    let mut agent = OrcaAgent::new(&config, law, safety, Postcard);
    agent.order(&WaypointOrder::first(Waypoint::fixed(to)));
    let state = KinematicState { position: from, ..KinematicState::default() };
    Robot { agent, state, inbox: Vec::new() }
}

fn main() {
    let (west, east) = (Position::from_mm([-2000, 0, 0]), Position::from_mm([2000, 0, 0]));
    let mut robots = [robot(1, west, east), robot(2, east, west)];
    let (mut now, mut noise) = (Instant::from_micros(0), Rng::new(1));
    let (mut ticks, mut bytes, mut refused, mut least_gap_m) = (0, 0, 0, f32::MAX);
    while robots.iter().any(|robot| robot.agent.mode() != Mode::Arrived) {
        let mut said = Vec::new();
        for robot in &mut robots {
            let surroundings = InPlane { max_speed_mps: SPEED_MPS, obstacles: &[] };
            let inputs = Inputs { state: robot.state, surroundings, inbox: &robot.inbox };
            let out = robot.agent.step(&inputs, now, &mut ());
            refused += out.rejected;
            said.push(out.outbox.to_vec());
            if let Command::Velocity(velocity_mps) = out.command {
                robot.state.velocity_mps = velocity_mps;
                robot.state.position = robot.state.position.moved(velocity_mps * TICK_S).expect("near by");
            }
        }
        for byte in said.iter_mut().flatten() {
            bytes += 1;
            if noise.below(1000) == 0 {
                *byte ^= 1 << noise.below(8);
            }
        }
        robots[1].inbox = said.swap_remove(0);
        robots[0].inbox = said.swap_remove(0);
        let between = robots[1].state.position.since::<f32>(robots[0].state.position);
        least_gap_m = least_gap_m.min(between.norm() - 2.0 * RADIUS_M);
        if ticks % 40 == 0 {
            let places = robots.each_ref().map(|robot| robot.state.position.since::<f32>(Position::ORIGIN));
            let [a, b] = places;
            println!(
                "{:4.1} s: ({:5.2}, {:5.2}) and ({:5.2}, {:5.2})",
                f64::from(ticks) * 0.05,
                a.x,
                a.y,
                b.x,
                b.y
            );
        }
        now = now + TICK;
        ticks += 1;
        assert!(ticks < 1000, "a robot never arrives");
    }
    println!("both arrived after {:.1} s; the least gap was {least_gap_m:.3} m", f64::from(ticks) * 0.05);
    println!("{bytes} bytes went through the pipe, {refused} damaged frames were refused");
    assert!(least_gap_m > 0.0, "they touched");
    assert!(refused > 0, "nothing was damaged");
}
