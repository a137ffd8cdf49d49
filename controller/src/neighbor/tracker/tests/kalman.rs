//! A track beside the textbook filter.

use super::*;

/// The textbook Kalman filter with matrices, one axis each.
#[derive(Clone, Copy)]
struct Filter {
    state: [[f64; 2]; 3],
    cov: [[f64; 2]; 2],
}

impl Filter {
    fn predict(&mut self, dt: f64, acceleration_mps2: f64) {
        if dt <= 0.0 {
            return;
        }
        for state in &mut self.state {
            state[0] += state[1] * dt;
        }
        let [[a, b], [c, d]] = self.cov;
        // F P F^T with F = (1 dt; 0 1), and the noise g g^T.
        let [[a, b], [c, d]] = [[a + dt * c, b + dt * d], [c, d]];
        let g = [dt * dt / 2.0 * acceleration_mps2, dt * acceleration_mps2];
        self.cov = [[a + b * dt + g[0] * g[0], b + g[0] * g[1]], [c + d * dt + g[1] * g[0], d + g[1] * g[1]]];
    }

    /// Component 0: the position, 1: the velocity.
    fn correct(&mut self, component: usize, measured: [f64; 3], variance: f64) {
        let gain = [0, 1].map(|row| self.cov[row][component] / (self.cov[component][component] + variance));
        for (state, measured) in self.state.iter_mut().zip(measured) {
            let surprise = measured - state[component];
            (state[0], state[1]) = (state[0] + gain[0] * surprise, state[1] + gain[1] * surprise);
        }
        let row = self.cov[component];
        self.cov = [0, 1].map(|one| [0, 1].map(|other| self.cov[one][other] - gain[one] * row[other]));
    }

    /// Distance to a position measured `late` seconds before the time of the state, metres and in
    /// standard deviations.
    fn off(&self, place: [f64; 3], variance: f64, late: f64) -> (f64, f64) {
        let squares =
            self.state.iter().zip(place).map(|([x, v], place)| (x - v * late - place) * (x - v * late - place));
        let off_m = squares.sum::<f64>().sqrt();
        (off_m, off_m / (self.cov[0][0] + late * late * self.cov[1][1] + variance).sqrt())
    }
}

fn floats(v: Vec3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z]
}

proptest! {
    /// Detections and beacons, prompt and late, near and beyond the gate.
    #[test]
    fn a_track_is_a_kalman_filter(
        events in proptest::collection::vec(
            (0..3, -400_i32..900, proptest::array::uniform3(-900_i32..900), proptest::array::uniform3(-2.0..2.0_f64),
             (0.001..0.5_f64, 0.001..0.5_f64)),
            1..12,
        ),
    ) {
        let square = |x: f64| x * x;
        let variance = |deviation: f64| square(deviation).max(16e-6);
        let params = params::<f64>();
        let noise = params.acceleration_mps2;
        let mut track = Track::new(RobotId(2), at(20), Position::ORIGIN, 0.05, &params);
        let mut filter = Filter { state: [[0.0; 2]; 3], cov: [[square(0.05), 0.0], [0.0, square(params.speed_mps)]] };
        let (mut seen, mut heard) = (None, None);
        for (kind, span_ms, place_mm, velocity_mps, (deviation_m, deviation_mps)) in events {
            let when = track.at + Duration::from_millis(span_ms);
            let (place, place_m) = (Position::from_mm(place_mm), place_mm.map(|mm| f64::from(mm) / 1000.0));
            let velocity = Vec3::new(velocity_mps[0], velocity_mps[1], velocity_mps[2]);
            let late = f64::from(-span_ms).max(0.0) / 1000.0;
            filter.predict(f64::from(span_ms) / 1000.0, noise);
            let then = |by: [f64; 3]| [0, 1, 2].map(|axis| place_m[axis] + by[axis] * late);
            if kind < 2 {
                let sighting = Sighting {
                    deviation_m,
                    velocity_mps: (kind == 1).then_some((velocity, deviation_mps)),
                    radius_m: deviation_mps,
                    ..sighting(0.0, 0.0)
                };
                let (off_m, surprise) = filter.off(place_m, variance(deviation_m), late);
                let fit = track.fit(place, deviation_m, deviation_mps, when, &params);
                prop_assert_eq!(fit.is_some(), surprise <= params.gate || off_m < track.radius_m + deviation_mps);
                prop_assert!(fit.is_none_or(|fit| (fit - surprise).abs() < 1e-6 * (1.0 + surprise)));
                if surprise > params.gate {
                    let [[position, _], [_, speed]] = filter.cov;
                    filter.cov = [[position + square(off_m), 0.0], [0.0, speed.max(square(params.speed_mps))]];
                }
                let drift = square(late) * (filter.cov[1][1] + square(noise * late / 2.0));
                let measured = then(filter.state.map(|[_, v]| v));
                filter.correct(0, measured, variance(deviation_m) + drift);
                if kind == 1 {
                    filter.correct(1, velocity_mps, variance(deviation_mps) + square(noise * late));
                }
                track.see(&sighting, place, when, &params);
                prop_assert_eq!(track.radius_m, deviation_mps);
                seen = Some(seen.filter(|seen| when.is_before(*seen)).unwrap_or(when));
            } else {
                let drift = square(late) * (square(params.heard_mps) + square(noise * late / 2.0));
                let measured = then(velocity_mps);
                filter.correct(0, measured, variance(params.heard_m) + drift);
                filter.correct(1, velocity_mps, variance(params.heard_mps) + square(noise * late));
                track.hear(place, velocity, when, &params);
                heard = Some(when);
            }
            prop_assert_eq!((track.seen, track.heard), (seen, heard));
            let (x, v) = (floats(track.offset_m(Position::ORIGIN)), floats(track.velocity_mps));
            for axis in 0..3 {
                let off = [x[axis] - filter.state[axis][0], v[axis] - filter.state[axis][1]];
                prop_assert!(off[0].abs() < 1e-6 && off[1].abs() < 1e-6, "axis {axis}: {off:?}");
            }
            let near = |got: f64, want: f64| (got - want).abs() <= 1e-6 * want + 1e-12;
            prop_assert!(near(track.position_variance, filter.cov[0][0]), "{track:?} {:?}", filter.cov);
            prop_assert!(near(track.velocity_variance, filter.cov[1][1]), "{track:?} {:?}", filter.cov);
        }
    }

    #[test]
    fn a_merged_estimate_is_at_least_as_accurate_as_each_input(
        known in 0.005_f64..1.0, seen in 0.005_f64..1.0, heard_m in 0.005_f64..1.0, off in -0.1_f64..0.1,
    ) {
        let params = TrackParams { heard_m, ..params::<f64>() };
        let mut track = Track::new(RobotId(2), at(0), Position::ORIGIN, known, &params);
        let place = Position::from_metres([off, 0.0, 0.0]).unwrap();
        track.see(&Sighting { deviation_m: seen, ..sighting(off, 0.0) }, place, at(0), &params);
        let both = known.min(seen);
        prop_assert!(track.deviation_m() <= both * (1.0 + 1e-12));
        track.hear(place, Vec3::ZERO, at(0), &params);
        prop_assert!(track.deviation_m() <= both.min(heard_m) * (1.0 + 1e-12));
        let x = track.offset_m(Position::ORIGIN).x;
        prop_assert!(x * off.signum() >= -1e-9 && x.abs() <= off.abs() + 1e-3);
    }

    #[test]
    fn any_detections_keep_tracks_bounded_and_ids_unique(
        steps in proptest::collection::vec(
            proptest::collection::vec((0_u32..6, any::<i16>(), any::<i16>(), 0_i32..400_000, -50_i16..3000), 0..40), 1..12,
        ),
    ) {
        let (mut tracker, mut table) = (Tracker::<f32>::new(params()), Table::new(AGES));
        for (step, seen) in (0..).zip(&steps) {
            let sightings: std::vec::Vec<_> = seen.iter().map(|&(id, x, y, age, deviation)| Sighting {
                offset_m: Vec3::from_milli([i32::from(x), i32::from(y), 0]),
                deviation_m: f32::from(deviation) / 1000.0,
                age: Duration::from_micros(age),
                id: (id > 0).then_some(RobotId(id)),
                ..sighting(0.0, 0.0)
            }).collect();
            let count = see(&mut tracker, &sightings, step);
            let all = [count.known, count.new, count.repeated, count.refused, count.no_room];
            prop_assert_eq!(all.iter().map(|&n| usize::from(n)).sum::<usize>(), sightings.len());
            let _ = merge(&mut tracker, &mut table, step);
            let mut ids = ids(&tracker);
            ids.sort_unstable();
            ids.dedup();
            prop_assert_eq!(ids.len(), tracker.tracks().len());
            prop_assert!(table.iter().all(|known| ids.contains(&known.id)) && table.lost().is_empty());
            for track in tracker.tracks() {
                prop_assert!(track.position_variance > 0.0 && track.position_variance.is_finite());
                prop_assert!(track.velocity_mps.is_finite() && track.velocity_variance >= 0.0);
                prop_assert!(track.id != OWN);
            }
        }
    }
}
