//! Links only if no panic is reachable from optional parts of a firmware: an operator who takes
//! over a robot, parameter changes at runtime, number formats, MAVLink messages of any kind.
//! Works like `nopanic`.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::panics_do_not_link!();

#[cfg(target_os = "none")]
mod program {
    use core::hint::black_box;

    // For one part only: the many kinds of agents take minutes per part.
    #[cfg(part = "stm32f405")]
    mod agents {
        use core::hint::black_box;
        use staya_cases::{Case, Opaque, Probe};
        use staya_controller::agent::{Agent, Guided, Inputs, Law, Outputs, Safety, Wish};
        use staya_controller::scalar::{Fast32, Scalar};
        use staya_controller::time::Instant;
        use staya_controller::wire::Wire;

        struct Operator;

        impl<S: Scalar> Probe<S> for Operator {
            fn step<G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(
                &mut self,
                agent: &mut Agent<S, G, N, A, W>,
                inputs: &Inputs<'_, S, G::Surroundings<'_>>,
                now: Instant,
                workspace: &mut G::Workspace,
                out: &mut Outputs<S>,
            ) {
                let mut guided = black_box(None::<Agent<S, Guided<S, G>, N, A, W>>);
                if let Some(agent) = black_box(&mut guided) {
                    tune(agent);
                    black_box(agent.law_mut().command(black_box(Wish::Own)).is_ok());
                    black_box(agent.law_mut().wish());
                    let (inputs, workspace) = (black_box(inputs), black_box(&mut *workspace));
                    let _ = black_box(agent.step(inputs, black_box(now), workspace));
                }
                let (agent, inputs, out) = (black_box(agent), black_box(inputs), black_box(out));
                tune(agent);
                agent.step_into(inputs, black_box(now), black_box(workspace), out);
                black_box(out);
            }
        }

        fn tune<S: Scalar, G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(agent: &mut Agent<S, G, N, A, W>) {
            let name = black_box("radius_m");
            black_box(black_box(&mut *agent).set_parameter(name, black_box(1.0)).is_ok());
            black_box(black_box(&mut *agent).parameter(name));
        }

        pub fn run() {
            for &case in black_box(Case::ALL) {
                black_box(case.run::<f32, _>(&mut Operator));
                black_box(case.run::<f64, _>(&mut Opaque));
                black_box(case.run::<Fast32, _>(&mut Opaque));
            }
        }
    }

    fn messages() {
        let mut rest = black_box(&[1; 300][..]);
        while let Some(frame) = staya_mavlink::frame::next_frame(&mut rest) {
            black_box((frame.sender(), frame.is_known()));
            black_box(frame.message());
        }
    }

    pub fn run() -> ! {
        #[cfg(part = "stm32f405")]
        agents::run();
        messages();
        loop {
            core::hint::spin_loop();
        }
    }
}
