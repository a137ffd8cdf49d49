//! Colours that are distinct for all kinds of colour vision, equal to those of the page
//! (`look.js`).

use staya_controller::robot::Mode;

/// A colour; `alpha` 255 is opaque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// Opacity.
    pub alpha: u8,
}

impl Colour {
    /// An opaque colour from `0xRRGGBB`.
    #[must_use]
    pub const fn hex(rgb: u32) -> Self {
        let [_, red, green, blue] = rgb.to_be_bytes();
        Self { rgb: [red, green, blue], alpha: 255 }
    }

    /// Returns the colour with another opacity.
    #[must_use]
    pub const fn with_alpha(self, alpha: u8) -> Self {
        Self { alpha, ..self }
    }

    /// Returns the colour at `share` (0 to 1) between this one and another.
    #[must_use]
    pub fn towards(self, other: Self, share: f64) -> Self {
        let mix = |a: u8, b: u8| {
            let mixed = f64::from(a) + (f64::from(b) - f64::from(a)) * share.clamp(0.0, 1.0);
            mixed.round() as u8
        };
        Self { rgb: std::array::from_fn(|i| mix(self.rgb[i], other.rgb[i])), alpha: mix(self.alpha, other.alpha) }
    }
}

/// Background of pictures.
pub const WHITE: Colour = Colour::hex(0xff_ff_ff);
/// Titles and labels.
pub const INK: Colour = Colour::hex(0x22_22_22);
/// Numbers on axes, and notes.
pub const MUTED: Colour = Colour::hex(0x5c_5c_5c);
/// Grid lines.
pub const GRID: Colour = Colour::hex(0xe6_e6_e6);

/// Colours of Okabe and Ito ("Color universal design", 2008) without yellow, which is too pale.
pub const PALETTE: [Colour; 7] = [
    Colour::hex(0x00_72_b2),
    Colour::hex(0xd5_5e_00),
    Colour::hex(0x00_9e_73),
    Colour::hex(0xcc_79_a7),
    Colour::hex(0xe6_9f_00),
    Colour::hex(0x56_b4_e9),
    Colour::hex(0x17_1a_21),
];

/// Colour of the robots in a group; 0 for those in no group.
#[must_use]
pub fn of_group(group: u32) -> Colour {
    PALETTE[group as usize % PALETTE.len()]
}

/// Colour of robots in a mode.
#[must_use]
pub const fn of_mode(mode: Mode) -> Colour {
    let [blue, vermillion, green, purple, orange, sky, _] = PALETTE;
    match mode {
        Mode::Idle => Colour::hex(0x7d_85_90),
        Mode::Forming => sky,
        Mode::Cruise => blue,
        Mode::Hold => orange,
        Mode::Arrived => green,
        Mode::Fault => vermillion,
        Mode::Passive => purple,
    }
}

/// Colour of item `index`: the palette, darker and paler variants, then from the start again.
#[must_use]
pub fn nth(index: usize) -> Colour {
    let colour = PALETTE[index % PALETTE.len()];
    match index / PALETTE.len() % 3 {
        0 => colour,
        1 => colour.towards(INK, 0.5),
        _ => colour.towards(WHITE, 0.5),
    }
}
