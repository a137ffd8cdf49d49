//! Links only if no panic is reachable from `staya-robot` or from the models of `staya-voxel`, in
//! `f32` and in Q16.16. Works like `nopanic`.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::panics_do_not_link!();

#[cfg(target_os = "none")]
mod program {
    use core::convert::Infallible;
    use core::hint::black_box;
    use embedded_hal::digital::{ErrorType as PinError, OutputPin};
    use embedded_hal::pwm::{ErrorType as PwmError, SetDutyCycle};
    use embedded_io::{ErrorType as LineError, Read, ReadReady, Write, WriteReady};
    use staya_controller::geom::{Position, Vec2};
    use staya_controller::grid::{Cell, GridFrame};
    use staya_controller::neighbor::Neighbor;
    use staya_controller::orca::{HalfSpaces as _, MovingBall, Params};
    use staya_controller::scalar::{Q16, Scalar};
    use staya_controller::time::{Duration, Instant};
    use staya_controller::wire::Postcard;
    use staya_mavlink::wire::Mavlink;
    use staya_robot::drive::{
        Calibration, Differential, HBridge, Kinematics, Limits, LookAhead, Mecanum, Mixer, Omni, SignMagnitude, Twist,
        TwoPins, Wheels,
    };
    use staya_robot::odometry::{Encoder, Odometry};
    use staya_robot::radio::{Framing, PacketLink, Receiver};
    use staya_robot::scan::{LocalMap, MapParams, OutlineParams, Scan, is_neighbor, outline};
    use staya_voxel::{Model, VoxelNeighbor, obstacles, velocity_half_plane};

    pub fn run() -> ! {
        loop {
            packets::<Postcard>();
            packets::<Mavlink>();
            let _ = wheels::<f32>();
            let _ = wheels::<Q16>();
            ranges::<f32>();
            ranges::<Q16>();
            voxels::<f32>();
            voxels::<Q16>();
        }
    }

    /// A number that the optimiser does not know.
    fn any<S: Scalar>() -> S {
        black_box(S::ONE)
    }

    fn any_vec<S: Scalar>() -> Vec2<S> {
        Vec2::new(any(), any())
    }

    fn span() -> Duration {
        Duration::from_micros(black_box(1))
    }

    /// A stub that accepts everything and returns any value.
    struct Pin;

    impl PinError for Pin {
        type Error = Infallible;
    }

    impl OutputPin for Pin {
        fn set_low(&mut self) -> Result<(), Infallible> {
            black_box(false);
            Ok(())
        }

        fn set_high(&mut self) -> Result<(), Infallible> {
            black_box(true);
            Ok(())
        }
    }

    impl PwmError for Pin {
        type Error = Infallible;
    }

    impl SetDutyCycle for Pin {
        fn max_duty_cycle(&self) -> u16 {
            black_box(1)
        }

        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
            black_box(duty);
            Ok(())
        }
    }

    impl LineError for Pin {
        type Error = Infallible;
    }

    impl Read for Pin {
        fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
            black_box(bytes);
            Ok(black_box(1))
        }
    }

    impl ReadReady for Pin {
        fn read_ready(&mut self) -> Result<bool, Infallible> {
            Ok(black_box(true))
        }
    }

    impl Write for Pin {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
            black_box(bytes);
            Ok(black_box(1))
        }

        fn flush(&mut self) -> Result<(), Infallible> {
            Ok(())
        }
    }

    impl WriteReady for Pin {
        fn write_ready(&mut self) -> Result<bool, Infallible> {
            Ok(black_box(true))
        }
    }

    fn packets<F: Framing>() {
        let mut link = PacketLink::<Pin, F, 512, 256>::new(Pin);
        let mut radio = Receiver::<F, 512>::new();
        while black_box(true) {
            let link = black_box(&mut link);
            let Ok(()) = link.pump();
            black_box(link.take());
            link.send(black_box(&[1; 90]));
            let radio = black_box(&mut radio);
            radio.push_packet(black_box(&[0xFD; 90]));
            radio.line_error();
            black_box(radio.take());
        }
    }

    fn wheels<S: Scalar>() -> Option<()> {
        let calibration = || black_box(Calibration::linear(any::<S>()));
        let limits = Limits { speed_mps: any(), acceleration_mps2: any() };
        let mut two = Mixer::new(Differential::new(any())?, limits)?;
        let mut three = Mixer::new(Omni::<S, 3>::new(any(), any())?, limits)?;
        let mut four = Mixer::new(Mecanum::new(any(), any())?, limits)?;
        let bridge = || (HBridge::new(Pin, Pin), calibration());
        let mut bridges = Wheels::new([bridge(), bridge()]);
        let sign = || (SignMagnitude::new(Pin, Pin), calibration());
        let mut signs = Wheels::new([sign(), sign(), sign()]);
        let pins = || (TwoPins::new(Pin, Pin, Pin), calibration());
        let mut pins = Wheels::new([pins(), pins(), pins(), pins()]);
        let ahead = LookAhead::new(any())?;
        let mut encoder = Encoder::new(any(), black_box(1), black_box(false))?;
        let mut odometry = Odometry::new(Position::from_mm(black_box([0; 3])), any())?;
        while black_box(true) {
            let way = two.kinematics().twist(&[encoder.travelled(black_box(1)), any()]);
            odometry.advance(&way, span());
            let heading = odometry.heading_rad();
            black_box(ahead.state(&odometry.state(), heading, any()));
            let _ = bridges.turn(&two.mix(&ahead.twist(any_vec(), heading), span()));
            let wish = Twist::holonomic(any_vec(), heading, any());
            let rims = three.mix(&wish, span());
            black_box(three.kinematics().twist(&rims));
            let _ = signs.turn(&rims);
            let rims = four.mix(&wish, span());
            black_box(four.kinematics().twist(&rims));
            let _ = pins.turn(&rims);
            odometry.correct(Position::from_mm(black_box([0; 3])), any());
        }
        Some(())
    }

    fn ranges<S: Scalar>() {
        let own = || Cell::new(black_box(1), black_box(1));
        let mut map = LocalMap::<11>::new(black_box(MapParams::default()), own());
        let neighbors: &[Neighbor<S>] = black_box(&[]);
        while black_box(true) {
            let ranges_m = [any::<S>(); 16];
            let scan = Scan {
                first_rad: any(),
                step_rad: any(),
                ranges_m: black_box(&ranges_m),
                min_m: any(),
                max_m: any(),
                mount_m: any_vec(),
            };
            let frame = GridFrame { origin_m: any_vec(), cell_m: any() };
            let now = Instant::from_micros(black_box(1));
            let place = Position::from_mm(black_box([0; 3]));
            let is_robot = |seen| is_neighbor(neighbors, place, now, span(), seen, any());
            let map = black_box(&mut map);
            black_box(map.observe(&frame, any_vec(), any(), &scan, now, is_robot));
            black_box(map.set_ground(own(), black_box(1)));
            black_box(map.window());
            let params = OutlineParams { tolerance_m: any(), gap_m: any(), point_m: any() };
            black_box(outline::<S, 16>(&scan, any(), &params, is_robot));
        }
    }

    fn voxels<S: Scalar>() {
        let bytes: &[u8] = black_box(&[1; 100]);
        if let Ok(model) = Model::<S, 2>::from_bytes(bytes) {
            black_box(model.nearest([any(), any()]));
            black_box(model.node(black_box([1, 1])));
            black_box(velocity_half_plane(&model, any_vec(), any_vec(), any()));
            black_box(obstacles(&model, any_vec(), any()));
        }
        if let Ok(model) = Model::<S, 3>::from_bytes(bytes) {
            black_box(model.nearest([any(), any(), any()]));
            let ball = MovingBall { offset_m: any_vec(), velocity_mps: any_vec(), radii_m: any(), tie: any_vec() };
            let params = Params { horizon_s: any(), separation_s: any(), share: any() };
            black_box(VoxelNeighbor::new(model).half_space(any_vec(), &ball, &params));
        }
    }
}
