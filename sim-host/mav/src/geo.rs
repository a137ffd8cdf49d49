//! Conversion between metres about a shared origin and WGS 84 latitude, longitude and altitude.
//!
//! x (east) and y (north) are in the plane that touches the ellipsoid at the origin. z (up) is the
//! altitude above the origin's, as autopilots define it: level flight has a constant z.
//!
//! The conversion is exact to less than a millimetre. The Earth's curvature remains: at distance d
//! lengths in the plane are short by at most d^2 / 2R^2 (1.3 mm per km at 10 km, 130 mm at 100 km),
//! and north deviates from y by about d tan(latitude) / R (2 mrad at 10 km and 55 degrees).
//! Velocities are *not* corrected for that angle.

use staya_sim::table;
use std::f64::consts::PI;
use std::str::FromStr;

const A_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
const E2: f64 = FLATTENING * (2.0 - FLATTENING);
/// Largest distance from the origin, metres.
pub const FAR_M: f64 = 1_000_000.0;

table! {
    /// A geographic position (WGS 84).
    #[derive(Copy, PartialEq)]
    pub struct Global {
        /// Latitude, degrees north, -90 to 90.
        pub latitude_deg: f64;
        /// Longitude, degrees east, -180 to 180.
        pub longitude_deg: f64;
        /// Altitude, metres. All positions of a swarm use the same reference, such as sea level.
        pub altitude_m: f64 = 0.0;
    }
}

impl Global {
    /// From the integers in messages: 1e-7 degrees and millimetres.
    #[must_use]
    pub fn from_e7(latitude: i32, longitude: i32, altitude_mm: i32) -> Self {
        Self {
            latitude_deg: f64::from(latitude) / 1e7,
            longitude_deg: f64::from(longitude) / 1e7,
            altitude_m: f64::from(altitude_mm) / 1e3,
        }
    }

    /// To the integers in messages: 1e-7 degrees (11 mm) and millimetres; saturates.
    #[must_use]
    pub fn to_e7(self) -> [i32; 3] {
        [
            libm::round(self.latitude_deg * 1e7) as i32,
            libm::round(self.longitude_deg * 1e7) as i32,
            libm::round(self.altitude_m * 1e3) as i32,
        ]
    }

    /// Whether latitude and longitude are valid and the altitude is within 100 km.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.latitude_deg.abs() <= 90.0 && self.longitude_deg.abs() <= 180.0 && self.altitude_m.abs() <= 100_000.0
    }
}

/// A shared origin, which converts between metres east, north, up of it and geographic positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    place: Global,
    center_m: [f64; 3],
    latitude: [f64; 2],
    /// Sine and cosine, as for the latitude.
    longitude: [f64; 2],
}

impl Origin {
    /// Creates an origin; `None` if `place` is invalid.
    #[must_use]
    pub fn new(place: Global) -> Option<Self> {
        let sound = place.is_sound().then_some(place)?;
        let (latitude, longitude) = (radians(sound.latitude_deg), radians(sound.longitude_deg));
        Some(Self {
            place,
            center_m: from_center_m(latitude, longitude, sound.altitude_m),
            latitude: [libm::sin(latitude), libm::cos(latitude)],
            longitude: [libm::sin(longitude), libm::cos(longitude)],
        })
    }

    /// Geographic position of the origin.
    #[must_use]
    pub const fn place(&self) -> Global {
        self.place
    }

    /// Metres east, north, up of the origin; `None` for an invalid position or beyond [`FAR_M`].
    #[must_use]
    pub fn to_enu_m(&self, place: &Global) -> Option<[f64; 3]> {
        if !place.is_sound() {
            return None;
        }
        let (latitude, longitude) = (radians(place.latitude_deg), radians(place.longitude_deg));
        let at = from_center_m(latitude, longitude, self.place.altitude_m);
        let off = [0, 1, 2].map(|axis| at[axis] - self.center_m[axis]);
        let [east, north, above] = self.turned(off);
        let is_near = [east, north, above].iter().all(|m| m.abs() <= FAR_M);
        is_near.then_some([east, north, place.altitude_m - self.place.altitude_m])
    }

    /// Geographic position of a point in metres east, north and up; `None` beyond [`FAR_M`].
    #[must_use]
    pub fn to_global(&self, enu_m: [f64; 3]) -> Option<Global> {
        let [east, north, up] = enu_m;
        if enu_m.iter().any(|m| m.is_nan() || m.abs() > FAR_M) {
            return None;
        }
        // Height of the ground below the plane. Each iteration reduces the error by a factor of 20.
        let mut above = -(east * east + north * north) / (2.0 * A_M);
        let mut found = (0.0, 0.0);
        for _ in 0..10 {
            let off = self.turned_back([east, north, above]);
            let at = [0, 1, 2].map(|axis| self.center_m[axis] + off[axis]);
            let (latitude, longitude, altitude_m) = geodetic(at);
            found = (latitude, longitude);
            above += self.place.altitude_m - altitude_m;
        }
        Some(Global {
            latitude_deg: found.0 * 180.0 / PI,
            longitude_deg: found.1 * 180.0 / PI,
            altitude_m: self.place.altitude_m + up,
        })
    }

    fn turned(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let ([sin_lat, cos_lat], [sin_lon, cos_lon]) = (self.latitude, self.longitude);
        let outward = x * cos_lon + y * sin_lon;
        [y * cos_lon - x * sin_lon, z * cos_lat - outward * sin_lat, outward * cos_lat + z * sin_lat]
    }

    fn turned_back(&self, [east, north, up]: [f64; 3]) -> [f64; 3] {
        let ([sin_lat, cos_lat], [sin_lon, cos_lon]) = (self.latitude, self.longitude);
        let outward = up * cos_lat - north * sin_lat;
        [outward * cos_lon - east * sin_lon, outward * sin_lon + east * cos_lon, north * cos_lat + up * sin_lat]
    }
}

/// Converts east, north, up to north, east, down.
#[must_use]
pub fn ned<T: Copy + std::ops::Neg<Output = T>>([east, north, up]: [T; 3]) -> [T; 3] {
    [north, east, -up]
}

/// Converts north, east, down to east, north, up.
#[must_use]
pub fn enu<T: Copy + std::ops::Neg<Output = T>>([north, east, down]: [T; 3]) -> [T; 3] {
    [east, north, -down]
}

impl FromStr for Origin {
    type Err = &'static str;

    /// Reads degrees north, degrees east and metres between commas.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
        let place = match numbers.as_deref() {
            Ok(&[latitude_deg, longitude_deg, altitude_m]) => Some(Global { latitude_deg, longitude_deg, altitude_m }),
            _ => None,
        };
        place.and_then(Self::new).ok_or("give LAT,LON,ALT: -90 to 90 degrees, -180 to 180 degrees, metres")
    }
}

fn radians(degrees: f64) -> f64 {
    degrees * PI / 180.0
}

/// x points to longitude 0, z to the north pole.
fn from_center_m(latitude: f64, longitude: f64, altitude_m: f64) -> [f64; 3] {
    let (sin, cos) = (libm::sin(latitude), libm::cos(latitude));
    let normal_m = A_M / (1.0 - E2 * sin * sin).sqrt();
    let outward = (normal_m + altitude_m) * cos;
    [outward * libm::cos(longitude), outward * libm::sin(longitude), (normal_m * (1.0 - E2) + altitude_m) * sin]
}

/// Latitude, longitude, altitude by two rounds of Bowring's formula.
fn geodetic([x, y, z]: [f64; 3]) -> (f64, f64, f64) {
    let outward = libm::hypot(x, y);
    let b_m = A_M * (1.0 - FLATTENING);
    let mut reduced = libm::atan2(z * A_M, outward * b_m);
    let mut latitude = 0.0;
    for _ in 0..2 {
        let (sin, cos) = (libm::sin(reduced), libm::cos(reduced));
        latitude = libm::atan2(z + E2 / (1.0 - E2) * b_m * sin * sin * sin, outward - E2 * A_M * cos * cos * cos);
        reduced = libm::atan2((1.0 - FLATTENING) * libm::sin(latitude), libm::cos(latitude));
    }
    let (sin, cos) = (libm::sin(latitude), libm::cos(latitude));
    let altitude_m = outward * cos + z * sin - A_M * (1.0 - E2 * sin * sin).sqrt();
    (latitude, libm::atan2(y, x), altitude_m)
}

#[cfg(test)]
mod tests;
