//! The palette of a GIF: at most 255 colours, and a transparent one.

use color_quant::NeuQuant;
use tiny_skia::Pixmap;

/// Transparent colour, for unchanged pixels.
pub const CLEAR: u8 = 255;
const STEP: i32 = 5;
/// Bits of each channel in the lookup table.
const BITS: u32 = 6;

pub struct Palette {
    colours: Vec<u8>,
    nearest: Vec<u8>,
}

impl Palette {
    pub fn new(pictures: &[Pixmap]) -> Self {
        let pixels: Vec<u8> = pictures.iter().flat_map(|picture| picture.data()).copied().collect();
        let found = NeuQuant::new(STEP, usize::from(CLEAR), &pixels);
        let mut colours = found.color_map_rgb();
        // White is the most frequent colour and must be exact.
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

    /// Red, green and blue of each colour; black for the transparent one.
    pub fn colours(&self) -> &[u8] {
        &self.colours
    }

    pub fn indices(&self, picture: &Pixmap) -> Vec<u8> {
        let part = |value: u8| usize::from(value >> (8 - BITS));
        let index = |pixel: &[u8]| match pixel {
            [red, green, blue, _] => self.nearest[(part(*red) << (2 * BITS)) | (part(*green) << BITS) | part(*blue)],
            _ => 0,
        };
        picture.data().chunks_exact(4).map(index).collect()
    }
}
