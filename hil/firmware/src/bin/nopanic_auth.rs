//! Links only if no panic is reachable from the authenticating wire formats: `Sealed`, `Signed`,
//! and MAVLink's signatures on raw frames. Works like `nopanic`.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::panics_do_not_link!();

#[cfg(target_os = "none")]
mod program {
    use core::hint::black_box;
    use heapless::Vec;
    use staya_controller::auth::{KEY_LEN, Key, Master};
    use staya_controller::robot::RobotId;
    use staya_controller::wire::{Beacon, Header, KeyPhase, Message, OperatorWire, Ring, Sealed, Wire};
    use staya_mavlink::frame::next_frame;
    use staya_mavlink::signed::Signed;
    use staya_mavlink::signing::Signing;

    pub fn run() -> ! {
        let key = || Key::new(black_box([1; KEY_LEN]));
        let starts = black_box(1);
        loop {
            if let Some(mut sealed) = Sealed::<8>::at_start(&key(), starts) {
                sealed.refuse_before(black_box(1));
                talk(&mut sealed);
                for (sender, counter) in black_box(&sealed).guard().export() {
                    black_box((sender, counter));
                }
                black_box(sealed.guard_mut().import(black_box(1), black_box(1)));
            }
            let master = Master::new(&key());
            let id = RobotId(black_box(1));
            let generation = black_box(1);
            let ring = Ring::of_generation(generation, &master.seed(generation)).with_own(&master.own_key(id));
            if let Some(mut sealed) = Sealed::<8>::with_ring(ring, id, starts) {
                talk(&mut sealed);
                black_box(sealed.ring().seeds()[0].is_some());
                sealed.ring_mut().hear_key(black_box(2), &key());
                sealed.ring_mut().speak(black_box(2));
                sealed.ring_mut().forget_before(black_box(2));
            }
            if let Some(mut operator) = OperatorWire::<8>::at_start(master, id, starts) {
                let mut out = Vec::<u8, 64>::new();
                black_box(operator.send_key(id, generation, KeyPhase::Speak, black_box(&mut out)).is_ok());
                black_box(operator.hear(black_box(&[1; 60])).is_ok());
            }
            let mut signed = Signed::<8>::new(Signing::new(key(), black_box(0), black_box(1)));
            signed.signing_mut().advance_to(black_box(1));
            signed.signing_mut().hear(key());
            signed.signing_mut().speak();
            signed.signing_mut().forget();
            talk(&mut signed);
            let mut signing = Signing::<8>::new(key(), 0, black_box(1));
            let mut bytes = [0; 300];
            black_box(signing.sign(black_box(&mut bytes)).is_ok());
            let mut rest = black_box(&bytes[..]);
            while let Some(frame) = next_frame(&mut rest) {
                black_box(signing.verify(&frame).is_accepted());
            }
            black_box(Key::of_passphrase(black_box(&[1; 9])).as_bytes());
        }
    }

    fn talk<W: Wire>(wire: &mut W) {
        let mut out = Vec::<u8, 256>::new();
        let mut inbox = black_box(&[1; 99][..]);
        while black_box(true) {
            let wire = black_box(&mut *wire);
            let message = black_box(Message::Beacon(Beacon::default()));
            let said = wire.encode(black_box(Header::default()), &message, black_box(&mut out));
            black_box(said.is_ok());
            if let Some(frame) = wire.next_frame(black_box(&mut inbox)) {
                black_box(wire.decode(frame).is_ok());
            }
        }
    }
}
