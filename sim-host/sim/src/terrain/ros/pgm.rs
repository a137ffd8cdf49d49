//! Grey images: PGM, plain (P2) and raw (P5), 8 or 16 bits.
//!
//! Source: Netpbm, "PGM". A comment reaches from `#` to the next CR or LF, and one byte of white
//! space separates the header of a raw image from its pixels. Two habits of other programs are read
//! if the bytes then add up: a CRLF as that white space, and comments behind the largest value.

use super::super::error::{MAX_SIDE, Place, TerrainError, fits, format_error};
use std::path::Path;

/// A grey image, first row at the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels from left to right.
    pub width: u16,
    /// Pixels from top to bottom.
    pub height: u16,
    /// Brightness of white, 1..=65535; no pixel is brighter.
    pub largest: u16,
    /// Brightness, row by row.
    pub pixels: Vec<u16>,
}

/// Reads a PGM image. O(size).
///
/// # Errors
/// A [`TerrainError::Format`] with the byte, if the file violates the format.
pub fn parse_pgm(bytes: &[u8], path: &Path) -> Result<Picture, TerrainError> {
    let mut words = Words { bytes, at: 0 };
    let fail = |at: usize, what: String, remedy: &str| Err(format_error(path, Place::Byte(at), what, remedy));
    let is_raw = match bytes.get(..2) {
        Some(b"P2") => false,
        Some(b"P5") => true,
        _ => {
            return fail(0, "the picture does not begin with P2 or P5".into(), "give a grey PGM picture");
        }
    };
    words.at = 2;
    let mut header = [0; 3];
    let fields = [("width", MAX_SIDE), ("height", MAX_SIDE), ("largest value", u16::MAX)];
    for (value, (field, limit)) in header.iter_mut().zip(fields) {
        *value = match words.number() {
            Ok(number) if (1..=u32::from(limit)).contains(&number) => number as u16,
            _ => {
                return fail(words.at, format!("{field} is not 1..={limit}"), "correct the header");
            }
        };
    }
    let [width, height, largest] = header;
    let wanted = usize::from(width) * usize::from(height);
    fits(path, width, height, 4)?;
    let mut pixels = Vec::new();
    if is_raw {
        let depth = if largest < 256 { 1 } else { 2 };
        let body = body(bytes, words.at, wanted * depth)
            .map_err(|(what, remedy)| format_error(path, Place::Byte(words.at), what, remedy))?;
        pixels.extend(
            body.chunks_exact(depth).map(|pixel| pixel.iter().fold(0, |sum, byte| sum << 8 | u16::from(*byte))),
        );
    } else {
        while pixels.len() < wanted {
            match words.number() {
                Ok(number) => pixels.push(u16::try_from(number).unwrap_or(u16::MAX)),
                Err(Trouble::End) => {
                    let what = format!("the file ends after {} of {wanted} pixels", pixels.len());
                    return fail(words.at, what, TRUNCATED);
                }
                Err(Trouble::NoNumber) => {
                    return fail(words.at, "no number where a pixel should be".into(), "correct the picture");
                }
            }
        }
        if !matches!(words.number(), Err(Trouble::End)) {
            let what = format!("something follows the {wanted} pixels that the header promises");
            return fail(words.at, what, SURPLUS);
        }
    }
    if let Some(at) = pixels.iter().position(|pixel| *pixel > largest) {
        return Err(format_error(
            path,
            Place::File,
            format!("pixel {at} has {} of at most {largest}", pixels[at]),
            "correct the largest value in the header",
        ));
    }
    Ok(Picture { width, height, largest, pixels })
}

const TRUNCATED: &str = "it is truncated: fetch it again, or correct the header";
const SURPLUS: &str = "correct the header, or remove what is too much (one picture in a file); if line ends were \
                       converted, fetch the file again as binary";

/// The `wanted` bytes of a raw image whose header's last number ends before byte `at`.
fn body(bytes: &[u8], at: usize, wanted: usize) -> Result<&[u8], (String, &'static str)> {
    let (header, rest) = bytes.split_at(at);
    let strict = match rest.first() {
        Some(b'#') => comment(rest),
        Some(byte) if is_space(*byte) => 1,
        Some(_) => return Err(("no white space after the largest value".into(), "correct the header")),
        None => 0,
    };
    // A header with CRLF has one behind its last number, too.
    let is_crlf = rest.starts_with(b"\r\n") && header.windows(2).any(|pair| pair == b"\r\n");
    let start = if is_crlf { 2 } else { strict };
    let found = rest.len() - start;
    if found == wanted {
        return Ok(&rest[start..]);
    }
    let habit = rest.len().checked_sub(wanted).map(|gap| rest.split_at(gap));
    match habit {
        Some((gap, body)) if gap == b"\r\n" || is_comments(gap) => Ok(body),
        _ if found < wanted => Err((format!("{found} of {wanted} bytes of pixels follow"), TRUNCATED)),
        _ => Err((format!("{found} bytes follow, the pixels are {wanted}"), SURPLUS)),
    }
}

/// Length of a comment with its line end.
fn comment(bytes: &[u8]) -> usize {
    bytes.iter().position(|byte| matches!(byte, b'\r' | b'\n')).map_or(bytes.len(), |end| end + 1)
}

/// Whether there is nothing but comments, with white space before each of them.
fn is_comments(mut gap: &[u8]) -> bool {
    loop {
        let spaces = gap.iter().take_while(|byte| is_space(**byte)).count();
        let Some(rest) = gap.get(spaces..).filter(|rest| rest.starts_with(b"#")) else { return false };
        let (line, after) = rest.split_at(comment(rest));
        match (line.last(), after) {
            (Some(b'\r'), b"\n") | (Some(b'\r' | b'\n'), []) => return true,
            (_, []) => return false,
            _ => gap = after,
        }
    }
}

/// Netpbm's white space.
const fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n')
}

enum Trouble {
    End,
    NoNumber,
}

struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Words<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// Next number, saturating; the position is then the byte after it.
    fn number(&mut self) -> Result<u32, Trouble> {
        loop {
            match self.peek() {
                Some(b'#') => {
                    while self.peek().is_some_and(|byte| !matches!(byte, b'\r' | b'\n')) {
                        self.at += 1;
                    }
                }
                Some(byte) if is_space(byte) => self.at += 1,
                Some(byte) if byte.is_ascii_digit() => break,
                Some(_) => return Err(Trouble::NoNumber),
                None => return Err(Trouble::End),
            }
        }
        let mut number: u32 = 0;
        while let Some(byte) = self.peek().filter(u8::is_ascii_digit) {
            number = number.saturating_mul(10).saturating_add(u32::from(byte - b'0'));
            self.at += 1;
        }
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn picture(bytes: &[u8]) -> Result<Picture, TerrainError> {
        parse_pgm(bytes, Path::new("a.pgm"))
    }

    #[test]
    fn plain_and_raw_pictures_are_equal() {
        let plain = picture(b"P2 # grey\n# CREATOR: a program\n3 2\n255\n1 2 3\n\n4 5 255").unwrap();
        let raw = picture(b"P5\n# CREATOR: a program\n3 2\n255\n\x01\x02\x03\x04\x05\xFF").unwrap();
        assert_eq!(plain, raw);
        assert_eq!(plain.pixels, [1, 2, 3, 4, 5, 255]);
    }

    #[test]
    fn sixteen_bit_pixels_are_big_endian() {
        assert_eq!(picture(b"P5 1 1 256 \x01\x00").unwrap().pixels, [256]);
    }

    #[test]
    fn raw_pixels_may_equal_whitespace_or_comment_bytes() {
        assert_eq!(picture(b"P5 2 1 255\n #").unwrap().pixels, [32, 35]);
    }

    #[test]
    fn headers_end_as_netpbm_says_or_where_the_bytes_add_up() {
        let headers: [&[u8]; 16] = [
            b"P5 2 1 255 ",
            b"P5\n2 1\n255\n",
            b"P5\r2\t1\r255\r",
            b"P5\r\n2 1\r\n255\r\n",
            b"P5 2 1 255\r\n",
            b"P5\r\n# CREATOR: a program\r\n2 1\r\n255\r\n",
            b"P5\n# one\r# two\n2 # wide\n1# high\n255\n",
            b"P5 2 1 255# grey\n",
            b"P5 2 1 255# grey\r",
            b"P5 2 1 255 # grey\n",
            b"P5 2 1 255 # grey\r\n",
            b"P5 2 1\n255\n# made by hand\n",
            b"P5 2 1\n255\n# made\n# by hand\n",
            b"P5\r\n2 1\r\n255\r\n# made by hand\r\n",
            b"P5 2 1 255#\n",
            b"P5 2 1 255\t",
        ];
        for header in headers {
            for body in [[65, 66], [10, 13], [13, 10], [35, 35], [32, 10]] {
                let bytes = [header, &body].concat();
                let pixels = picture(&bytes).unwrap_or_else(|error| panic!("{header:?}: {error}")).pixels;
                assert_eq!(pixels, body.map(u16::from), "{:?}", String::from_utf8_lossy(&bytes));
            }
        }
    }

    #[test]
    fn errors_name_file_byte_and_remedy() {
        let cases: [(&[u8], &str); 17] = [
            (b"", "a.pgm, byte 0: the picture does not begin with P2 or P5"),
            (b"P6 1 1 255 abc", "a.pgm, byte 0: "),
            (b"P5 0 1 255 ", "a.pgm, byte 4: width is not 1..=32767; correct the header"),
            (b"P5 1 40000 255 ", "a.pgm, byte 10: height is not"),
            (b"P5 1 1 0 ", "a.pgm, byte 8: largest value is not 1..=65535"),
            (b"P5 2 1 255 a", "a.pgm, byte 10: 1 of 2 bytes of pixels follow; it is truncated"),
            (b"P2 2 1 255 7", "a.pgm, byte 12: the file ends after 1 of 2 pixels"),
            (b"P2 2 1 255 7 x", "a.pgm, byte 13: no number where a pixel should be"),
            (b"P2 2 1 9 7 10", "a.pgm: pixel 1 has 10 of at most 9"),
            (b"P2 2 1 255 7 8 9", "a.pgm, byte 16: something follows the 2 pixels"),
            (b"P5 2 1 255 abc", "a.pgm, byte 10: 3 bytes follow, the pixels are 2; correct the header"),
            (b"P5 2 1 255\nab\n", "a.pgm, byte 10: 3 bytes follow"),
            (b"P5 2 1 255  ab", "a.pgm, byte 10: 3 bytes follow"),
            (b"P5 2 1 255xab", "a.pgm, byte 10: no white space after the largest value"),
            (b"P5\r\n2 1\r\n255\r\na", "a.pgm, byte 12: 1 of 2 bytes of pixels follow"),
            (b"P5 2 1 256 abc", "a.pgm, byte 10: 3 of 4 bytes of pixels follow"),
            (b"P5 2 1 255", "a.pgm, byte 10: 0 of 2 bytes of pixels follow"),
        ];
        for (bytes, expected) in cases {
            let message = picture(bytes).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_picture_or_an_error(bytes: Vec<u8>, magic in "P[25]") {
            let _ = picture(&bytes);
            let _ = picture(&[magic.as_bytes(), &bytes].concat());
        }

        #[test]
        fn any_numbers_are_a_picture_or_an_error(magic in "P[25]", body in "[0-9 #\n]{0,30}") {
            if let Ok(picture) = picture(format!("{magic} {body}").as_bytes()) {
                let wanted = usize::from(picture.width) * usize::from(picture.height);
                prop_assert_eq!(picture.pixels.len(), wanted);
            }
        }
    }
}
