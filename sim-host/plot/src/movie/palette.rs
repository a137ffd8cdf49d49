//! Colours of a GIF: at most 255 for all its pictures, and one that is clear.

use color_quant::NeuQuant;
use tiny_skia::Pixmap;

/// The colour of what does not change.
pub const CLEAR: u8 = 255;
/// Of so many pixels one is looked at.
const STEP: i32 = 5;
/// Bits of red, green and blue by which colours are looked up.
const BITS: u32 = 6;

/// Up to 255 colours.
pub struct Palette {
    colours: Vec<u8>,
    /// The nearest one, by the leading bits of each part.
    nearest: Vec<u8>,
}

impl Palette {
    /// One that suits these pictures.
    pub fn new(pictures: &[Pixmap]) -> Self {
        let pixels: Vec<u8> = pictures.iter().flat_map(|picture| picture.data()).copied().collect();
        let found = NeuQuant::new(STEP, usize::from(CLEAR), &pixels);
        let mut colours = found.color_map_rgb();
        // White is what most is, and must not become nearly white.
        colours.truncate(3 * (usize::from(CLEAR) - 1));
        colours.extend([255; 3]);
        let side = 1_usize << BITS;
        let middle = |part: usize| ((part << (8 - BITS)) + (part >> (2 * BITS - 8))) as i32;
        let nearest = |at: usize| {
            let wanted = [at >> (2 * BITS), at >> BITS, at].map(|part| middle(part % side));
            let distance = |colour: &[u8]| -> i32 {
                colour.iter().zip(wanted).map(|(part, wanted)| (i32::from(*part) - wanted).pow(2)).sum()
            };
            let found = colours.chunks_exact(3).enumerate().min_by_key(|(_, colour)| distance(colour));
            found.map_or(0, |(index, _)| index as u8)
        };
        Self { nearest: (0..side.pow(3)).map(nearest).collect(), colours }
    }

    /// Red, green and blue of each; the clear one is black.
    pub fn colours(&self) -> &[u8] {
        &self.colours
    }

    /// A picture in these colours.
    pub fn indices(&self, picture: &Pixmap) -> Vec<u8> {
        let part = |value: u8| usize::from(value >> (8 - BITS));
        let index = |pixel: &[u8]| match pixel {
            [red, green, blue, _] => self.nearest[(part(*red) << (2 * BITS)) | (part(*green) << BITS) | part(*blue)],
            _ => 0,
        };
        picture.data().chunks_exact(4).map(index).collect()
    }
}
