//! A contact sheet: pictures in rows, each with its name below.

use super::image_io::{Image, luminance};

/// A picture of the sheet.
pub struct Tile<'a> {
    /// Its name: small letters, digits and hyphens; what else there is leaves a gap.
    pub name: &'a str,
    /// Linear RGB.
    pub picture: &'a Image,
    /// Linear colour of the name.
    pub ink: [f32; 3],
}

/// Linear grey between the pictures.
const PAPER: [f32; 3] = [0.02; 3];

/// Pixels between the pictures.
const GAP: u32 = 8;

/// Mean luminance that what is not black in a picture is exposed to: a middle grey that leaves room for what is twice as bright.
const EXPOSURE: f64 = 0.35;

/// Columns and rows of a glyph, without the space around it.
const GLYPH: [u32; 2] = [5, 7];

/// Rows by which letters with a tail reach below the line.
const DESCENT: u32 = 2;

/// A sheet of so many columns, linear RGB; each picture exposed to the same mean luminance of what is not black.
pub fn contact_sheet(tiles: &[Tile], columns: u32) -> Image {
    let widest = tiles.iter().map(|t| t.picture.width.max(text_width(t.name))).max().unwrap_or(0);
    let highest = tiles.iter().map(|t| t.picture.height).max().unwrap_or(0);
    let (step_x, step_y) = (widest + GAP, highest + GLYPH[1] + 2 * GAP);
    let columns = columns.clamp(1, (tiles.len() as u32).max(1));
    let rows = (tiles.len() as u32).div_ceil(columns);
    let mut sheet = Image::from_fn(columns * step_x + GAP, rows * step_y + GAP, |_, _| PAPER);
    for (i, tile) in tiles.iter().enumerate() {
        let (column, row) = (i as u32 % columns, i as u32 / columns);
        let (x, y) = (GAP + column * step_x, GAP + row * step_y);
        let picture = tile.picture;
        let gain = exposure(picture);
        // Pictures stand on one line, above their names.
        let top = y + highest - picture.height;
        for (j, line) in picture.pixels.chunks(picture.width as usize).enumerate() {
            let exposed = line.iter().map(|p| p.map(|c| c * gain));
            let start = ((top + j as u32) * sheet.width + x) as usize;
            sheet.pixels[start..start + line.len()].copy_from_slice(&exposed.collect::<Vec<_>>());
        }
        write(&mut sheet, [x, y + highest + GAP / 2], tile.name, tile.ink);
    }
    sheet
}

/// The factor that brings the mean luminance of the pixels that are not black, bright spots cut off at ten times the mean,
/// to [`EXPOSURE`].
fn exposure(picture: &Image) -> f32 {
    let lit = || picture.pixels.iter().map(|p| luminance(*p)).filter(|l| *l > 0.0 && l.is_finite());
    let mean = |most: f64| lit().map(|l| l.min(most)).sum::<f64>() / lit().count().max(1) as f64;
    let mean = mean(10.0 * mean(f64::INFINITY));
    if mean > 0.0 { (EXPOSURE / mean) as f32 } else { 1.0 }
}

fn text_width(text: &str) -> u32 {
    text.chars().count() as u32 * (GLYPH[0] + 1)
}

/// Writes `text` with its top left corner at `at`.
fn write(sheet: &mut Image, [x, y]: [u32; 2], text: &str, ink: [f32; 3]) {
    for (i, c) in text.chars().enumerate() {
        let left = x + i as u32 * (GLYPH[0] + 1);
        let top = if "gpqy".contains(c) { y + DESCENT } else { y };
        for (row, bits) in (top..).zip(glyph(c)) {
            for column in (0..GLYPH[0]).filter(|c| bits >> (GLYPH[0] - 1 - c) & 1 == 1) {
                sheet.pixels[(row * sheet.width + left + column) as usize] = ink;
            }
        }
    }
}

/// The rows of a character from the top, the leftmost column in bit 4; none for a character that the font lacks.
fn glyph(c: char) -> [u8; 7] {
    let of =
        |first: char, table: &[[u8; 7]]| (c as usize).checked_sub(first as usize).and_then(|i| table.get(i).copied());
    let hyphen = (c == '-').then_some([0, 0, 0, 0b01110, 0, 0, 0]);
    of('a', &LETTERS).or_else(|| of('0', &DIGITS)).or(hyphen).unwrap_or_default()
}

#[rustfmt::skip]
const LETTERS: [[u8; 7]; 26] = [
    [0b00000, 0b00000, 0b01110, 0b00001, 0b01111, 0b10001, 0b01111], // a
    [0b10000, 0b10000, 0b11110, 0b10001, 0b10001, 0b10001, 0b11110], // b
    [0b00000, 0b00000, 0b01110, 0b10000, 0b10000, 0b10001, 0b01110], // c
    [0b00001, 0b00001, 0b01111, 0b10001, 0b10001, 0b10001, 0b01111], // d
    [0b00000, 0b00000, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110], // e
    [0b00110, 0b01001, 0b01000, 0b11100, 0b01000, 0b01000, 0b01000], // f
    [0b01111, 0b10001, 0b10001, 0b10001, 0b01111, 0b00001, 0b01110], // g
    [0b10000, 0b10000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001], // h
    [0b00100, 0b00000, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110], // i
    [0b00010, 0b00000, 0b00110, 0b00010, 0b00010, 0b10010, 0b01100], // j
    [0b10000, 0b10000, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010], // k
    [0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110], // l
    [0b00000, 0b00000, 0b11010, 0b10101, 0b10101, 0b10101, 0b10101], // m
    [0b00000, 0b00000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001], // n
    [0b00000, 0b00000, 0b01110, 0b10001, 0b10001, 0b10001, 0b01110], // o
    [0b11110, 0b10001, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000], // p
    [0b01111, 0b10001, 0b10001, 0b10001, 0b01111, 0b00001, 0b00001], // q
    [0b00000, 0b00000, 0b10110, 0b11001, 0b10000, 0b10000, 0b10000], // r
    [0b00000, 0b00000, 0b01111, 0b10000, 0b01110, 0b00001, 0b11110], // s
    [0b01000, 0b01000, 0b11100, 0b01000, 0b01000, 0b01001, 0b00110], // t
    [0b00000, 0b00000, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101], // u
    [0b00000, 0b00000, 0b10001, 0b10001, 0b10001, 0b01010, 0b00100], // v
    [0b00000, 0b00000, 0b10001, 0b10001, 0b10101, 0b10101, 0b01010], // w
    [0b00000, 0b00000, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001], // x
    [0b10001, 0b10001, 0b10001, 0b10001, 0b01111, 0b00001, 0b01110], // y
    [0b00000, 0b00000, 0b11111, 0b00010, 0b00100, 0b01000, 0b11111], // z
];

#[rustfmt::skip]
const DIGITS: [[u8; 7]; 10] = [
    [0b01110, 0b10001, 0b10011, 0b10101, 0b11001, 0b10001, 0b01110], // 0
    [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110], // 1
    [0b01110, 0b10001, 0b00001, 0b00010, 0b00100, 0b01000, 0b11111], // 2
    [0b11111, 0b00010, 0b00100, 0b00010, 0b00001, 0b10001, 0b01110], // 3
    [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010], // 4
    [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110], // 5
    [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110], // 6
    [0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000], // 7
    [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110], // 8
    [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100], // 9
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_in_rows_with_their_names_below() {
        let picture = Image::from_fn(30, 4, |_, _| [2.0; 3]);
        let black = Image::from_fn(10, 2, |_, _| [0.0; 3]);
        let ink = [1.0, 0.5, 0.0];
        let tile = |name, picture| Tile { name, picture, ink };
        let sheet = contact_sheet(&[tile("l", &picture), tile("b", &black), tile("-", &picture)], 2);
        assert_eq!((sheet.width, sheet.height), (2 * 38 + 8, 2 * 27 + 8));
        let at = |x: u32, y: u32| sheet.pixels[(y * sheet.width + x) as usize];
        // Exposed to the mean; a smaller picture stands on the line; paper between.
        assert!((luminance(at(8, 8)) - EXPOSURE).abs() < 1e-6);
        assert_eq!([at(46, 9), at(46, 10), at(46 + 10, 10)], [PAPER, [0.0; 3], PAPER]);
        assert!((luminance(at(8, 35)) - EXPOSURE).abs() < 1e-6);
        // The first row of an l is its second and third column.
        assert_eq!([0, 1, 2, 3].map(|x| at(8 + x, 16)), [PAPER, ink, ink, PAPER]);
        let inked = sheet.pixels.iter().filter(|p| **p == ink).count() as u32;
        assert_eq!(
            inked,
            ["l", "b", "-"]
                .map(|s| glyph(s.chars().next().expect("one")).map(u8::count_ones).iter().sum::<u32>())
                .iter()
                .sum::<u32>()
        );
    }

    #[test]
    fn glyphs_are_told_apart() {
        let known: Vec<char> = ('a'..='z').chain('0'..='9').chain(['-']).collect();
        for (i, a) in known.iter().enumerate() {
            assert!(known[..i].iter().all(|b| glyph(*a) != glyph(*b)) && glyph(*a) != [0; 7], "{a}");
        }
        assert_eq!(glyph('Ä'), [0; 7]);
    }
}
