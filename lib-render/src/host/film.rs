//! The film: where samples of radiance are summed.
//!
//! A sum of floating-point numbers depends on their order, and one in f32 even stops growing (69 % too dark after
//! 2^26 samples of 0.1). Here each sample is rounded once, by itself, to a multiple of 2^-64, and these integers
//! are summed in 128 bits, which is exact. So no order of arrival, thread, tile, device or merge can change a bit,
//! and partial renders add up to the very bits of the whole (Law 9; accuracy.md, N21).
//! `tests/tests/film.rs` says so with 2^26 samples.
//!
//! A sample s becomes the integer nearest to s·2^64 (ties to even). With |s| <= 2^31, 2^32 of them stay within
//! 2^127, so the sum cannot overflow. Every f32 of magnitude 2^-41 or more is represented exactly.
//!
//! ```
//! use jerboa_lib_render::host::film::{Film, Window};
//! let mut film = Film::new(Window { x: 0, y: 0, width: 2, height: 1 });
//! film.add([0, 0], [0.25, 0.5, 1.0]);
//! film.add([0, 0], [0.75, 0.5, 0.0]);
//! film.add([1, 0], [f32::NAN, 0.0, 0.0]);
//! assert_eq!(film.mean().pixels, [[0.5, 0.5, 0.5], [0.0; 3]]);
//! assert_eq!(film.dropped(), 1);
//! ```

use super::error::Error;
use super::image_io::Image;

/// Fraction bits of the fixed-point sums.
const FRACTION_BITS: i32 = 64;

/// Largest magnitude of a sample's channel that is accepted: 2^31.
///
/// 2^31 · 2^64 · 2^32 samples = 2^127, the room of an `i128`.
pub const RANGE: f32 = crate::core::exact::RANGE;

/// Groups in which a film can keep its samples apart, see [`Film::try_grouped`]. A power of two: sample s is in group
/// s mod 8.
pub const GROUPS: u32 = 8;

/// A rectangle of pixels of the full image. Row 0 is the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Leftmost column.
    pub x: u32,
    /// Topmost row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Window {
    /// Index of pixel `[column, row]` of the full image within this window, row by row; `None` outside it.
    pub fn index(&self, [x, y]: [u32; 2]) -> Option<usize> {
        let (dx, dy) = (x.checked_sub(self.x)?, y.checked_sub(self.y)?);
        (dx < self.width && dy < self.height).then(|| dy as usize * self.width as usize + dx as usize)
    }

    /// Number of pixels.
    pub fn area(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Whether every pixel of `inner` lies in this window.
    pub fn contains(&self, inner: &Window) -> bool {
        let inside = |lo: u32, n: u32, inner_lo: u32, inner_n: u32| {
            inner_lo >= lo && inner_lo as u64 + inner_n as u64 <= lo as u64 + n as u64
        };
        inside(self.x, self.width, inner.x, inner.width) && inside(self.y, self.height, inner.y, inner.height)
    }
}

/// One pixel: three exact sums in units of 2^-64, and how many samples they hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Pixel {
    sum: [i128; 3],
    count: u32,
}

impl Pixel {
    /// Adds the samples of another. Those of 2^32 renders never go round; a forged file may, and spoils its own image alone.
    fn take(&mut self, other: &Pixel) {
        self.count = self.count.wrapping_add(other.count);
        self.sum.iter_mut().zip(other.sum).for_each(|(sum, more)| *sum = sum.wrapping_add(more));
    }
}

/// Exact sums of linear RGB samples over a window of the image, at most 2^32 - 1 samples a pixel.
///
/// A tile's film is a film with a smaller window: threads fill one each and [`Film::merge`] them, in any order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    size: [u32; 2],
    window: Window,
    /// 1 or [`GROUPS`].
    groups: u32,
    next_sample: u32,
    /// All pixels of the first group, row by row, then those of the next.
    pixels: Vec<Pixel>,
    dropped: u64,
}

impl Film {
    /// An empty film of `size`, width and height. It takes 64 bytes a pixel.
    pub fn of_size(size: [u32; 2]) -> Film {
        Film::new(Window { x: 0, y: 0, width: size[0], height: size[1] })
    }

    /// An empty film over `window` of an image that ends with it.
    pub fn new(window: Window) -> Film {
        Film::crop([window.x + window.width, window.y + window.height], window)
    }

    /// An empty film over `window` of an image of `size`.
    ///
    /// # Panics
    /// If the window reaches beyond the image, or there is no memory for so many pixels.
    pub fn crop(size: [u32; 2], window: Window) -> Film {
        Film::try_crop(size, window).unwrap_or_else(|e| panic!("Film::crop: {e}"))
    }

    /// As [`Film::crop`], for a size that a user has chosen.
    ///
    /// # Errors
    /// When there is no memory for so many pixels.
    ///
    /// # Panics
    /// If the window reaches beyond the image.
    pub fn try_crop(size: [u32; 2], window: Window) -> Result<Film, Error> {
        Film::empty(size, window, 1)
    }

    /// As [`Film::try_crop`], of a film that keeps [`GROUPS`] sums for each pixel, from which [`super::variance`] tells how
    /// far off the mean is. It takes 512 bytes a pixel.
    ///
    /// # Errors
    /// When there is no memory for so many pixels.
    ///
    /// # Panics
    /// If the window reaches beyond the image.
    pub fn try_grouped(size: [u32; 2], window: Window) -> Result<Film, Error> {
        Film::empty(size, window, GROUPS)
    }

    /// An empty film over another window of the same image, with as many groups.
    ///
    /// # Errors
    /// When there is no memory for so many pixels.
    pub(super) fn over(&self, window: Window) -> Result<Film, Error> {
        Film::empty(self.size, window, self.groups)
    }

    /// An empty film for a tile of a film with so many groups.
    pub(super) fn tile(window: Window, groups: u32) -> Film {
        let end = [window.x + window.width, window.y + window.height];
        Film::empty(end, window, groups).unwrap_or_else(|e| panic!("Film::tile: {e}"))
    }

    fn empty(size: [u32; 2], window: Window, groups: u32) -> Result<Film, Error> {
        let whole = Window { x: 0, y: 0, width: size[0], height: size[1] };
        assert!(whole.contains(&window), "Film::crop: {window:?} reaches beyond {size:?}");
        let mut pixels = Vec::new();
        let all = window.area() * groups as usize;
        if pixels.try_reserve_exact(all).is_err() {
            let Window { width, height, .. } = window;
            return Err(Error::new(format!("no memory for a film of {width}x{height}: render parts by --crop")));
        }
        pixels.resize(all, Pixel::default());
        Ok(Film { size, window, groups, next_sample: 0, pixels, dropped: 0 })
    }

    /// In how many groups samples are kept apart: 1 or [`GROUPS`].
    pub fn groups(&self) -> u32 {
        self.groups
    }

    /// The exact sums of a group, in units of 2^-64, and the numbers of its samples, pixel by pixel of the window.
    pub fn group(&self, group: u32) -> impl Iterator<Item = ([i128; 3], u32)> {
        let area = self.window.area();
        self.pixels[group as usize * area..][..area].iter().map(|p| (p.sum, p.count))
    }

    /// Where the samples of this number are summed for a pixel.
    fn place(&self, pixel: [u32; 2], number: u32) -> Option<usize> {
        Some((number & (self.groups - 1)) as usize * self.window.area() + self.window.index(pixel)?)
    }

    /// Number of the first sample that no render has asked for yet: where the next one goes on.
    pub fn next_sample(&self) -> u32 {
        self.next_sample
    }

    /// Samples below `next` have been asked for.
    pub fn asked_below(&mut self, next: u32) {
        self.next_sample = self.next_sample.max(next);
    }

    /// Width and height of the full image.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The pixels this film holds.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Adds one sample (linear RGB radiance) to `pixel`, given as column and row of the full image; to the first group, where
    /// there are more.
    ///
    /// As [`Film::add_sample`].
    pub fn add(&mut self, pixel: [u32; 2], sample: [f32; 3]) {
        self.add_sample(pixel, 0, sample);
    }

    /// Adds the sample of this number (linear RGB radiance) to `pixel`, given as column and row of the full image.
    ///
    /// A sample with a channel that is not finite or above [`RANGE`] in magnitude is dropped whole and counted: it
    /// enters neither the sum nor the number of samples. Negative values are accepted.
    ///
    /// # Panics
    /// If `pixel` lies outside the window, which is an error of the caller.
    pub fn add_sample(&mut self, pixel: [u32; 2], number: u32, sample: [f32; 3]) {
        let index = self.place(pixel, number).expect("Film::add: pixel outside the film's window");
        // NaN compares false, so it is dropped too.
        if sample.iter().all(|s| s.abs() <= RANGE) {
            let pixel = &mut self.pixels[index];
            pixel.count += 1;
            for (sum, s) in pixel.sum.iter_mut().zip(sample) {
                *sum += to_fixed(s);
            }
        } else {
            self.dropped += 1;
        }
    }

    /// Adds the exact sums of `count` samples of `pixel`, in units of 2^-64, as a device has summed them by itself (see
    /// [`crate::core::exact`]); `dropped` more were dropped. All are of the group of sample `number`.
    ///
    /// # Panics
    /// If `pixel` lies outside the window, which is an error of the caller.
    pub fn add_sum(&mut self, pixel: [u32; 2], number: u32, sum: [i128; 3], count: u32, dropped: u32) {
        let index = self.place(pixel, number).expect("Film::add_sum: pixel outside the film's window");
        let pixel = &mut self.pixels[index];
        pixel.take(&Pixel { sum, count });
        self.dropped += u64::from(dropped);
    }

    /// Adds the samples of the pixels that `other` has in common with this film, and what it dropped anywhere. Both have
    /// as many groups.
    pub(super) fn merge_common(&mut self, other: &Film) {
        let (window, area) = (self.window, other.window.area());
        for (group, plane) in self.pixels.chunks_mut(window.area().max(1)).enumerate() {
            for (y, row) in (window.y..).zip(plane.chunks_mut(window.width.max(1) as usize)) {
                for (x, into) in (window.x..).zip(row) {
                    let Some(index) = other.window.index([x, y]) else { continue };
                    into.take(&other.pixels[group * area + index]);
                }
            }
        }
        self.dropped += other.dropped;
    }

    /// Adds all samples of `part`, whose window must lie within this one's.
    ///
    /// # Errors
    /// When it does not, or one of them keeps groups apart and the other does not.
    pub fn merge(&mut self, part: &Film) -> Result<(), Error> {
        if !self.window.contains(&part.window) {
            return Err(Error::new(format!(
                "Film::merge: a part over {:?} does not lie within {:?}; merge into the film of the larger window",
                part.window, self.window
            )));
        }
        if self.groups != part.groups {
            let (ours, theirs) = (self.groups, part.groups);
            let message =
                format!("Film::merge: a part with {theirs} groups of samples has no place in one with {ours}");
            return Err(Error::new(message));
        }
        let (width, height) = (part.window.width as usize, part.window.height as usize);
        for (row, from) in part.pixels.chunks(width.max(1)).enumerate() {
            let start = [part.window.x, part.window.y + (row % height) as u32];
            let start = self.place(start, (row / height) as u32).expect("the part's rows lie within the window");
            self.pixels[start..start + width].iter_mut().zip(from).for_each(|(into, from)| into.take(from));
        }
        self.dropped += part.dropped;
        self.next_sample = self.next_sample.max(part.next_sample);
        Ok(())
    }

    /// Samples accepted by `pixel`, given as column and row of the full image; 0 outside the window.
    pub fn count(&self, pixel: [u32; 2]) -> u32 {
        self.window.index(pixel).map_or(0, |index| self.total(index).count)
    }

    /// Samples dropped because a channel was not finite or above [`RANGE`].
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// So many samples more were dropped.
    pub(super) fn drop_more(&mut self, samples: u64) {
        self.dropped += samples;
    }

    /// The image of the window: per pixel and channel the exact mean, rounded once to f32; black where no sample is.
    pub fn mean(&self) -> Image {
        let mean = |index| {
            let total = self.total(index);
            total.sum.map(|sum| round_mean(sum, total.count))
        };
        let pixels = (0..self.window.area()).map(mean).collect();
        Image { width: self.window.width, height: self.window.height, pixels }
    }

    /// All samples of the pixel of this index in the window.
    fn total(&self, index: usize) -> Pixel {
        let mut total = self.pixels[index];
        let others = self.pixels.iter().skip(index + self.window.area()).step_by(self.window.area());
        others.for_each(|group| total.take(group));
        total
    }
}

/// Three sums in units of 2^-64 from four words each, the least significant first, as devices leave them.
pub fn sums(words: &[u32]) -> [i128; 3] {
    std::array::from_fn(|c| {
        let words = &words[4 * c..4 * c + 4];
        words.iter().rev().fold(0, |sum, word| sum << 32 | u128::from(*word)) as i128
    })
}

/// The integer nearest to s·2^64. Where the last bit of s is worth no less, it is the mantissa in its place.
fn to_fixed(s: f32) -> i128 {
    const MANTISSA: u32 = f32::MANTISSA_DIGITS - 1;
    const WHOLE: u32 = 127 + MANTISSA - FRACTION_BITS as u32;
    let (bits, exponent) = (s.to_bits(), s.to_bits() >> MANTISSA & 0xff);
    let Some(shift) = exponent.checked_sub(WHOLE) else { return if s == 0.0 { 0 } else { rounded(s) } };
    let magnitude = i128::from(bits & ((1 << MANTISSA) - 1) | 1 << MANTISSA) << shift;
    if s < 0.0 { -magnitude } else { magnitude }
}

/// The integer nearest to s·2^64. The product is exact in f64, and so is the rounding to an integer.
fn rounded(s: f32) -> i128 {
    (f64::from(s) * f64::from(FRACTION_BITS).exp2()).round_ties_even() as i128
}

/// `sum`·2^-64 / `count`, correctly rounded to f32 (nearest, ties to even); 0 without samples.
fn round_mean(sum: i128, count: u32) -> f32 {
    if count == 0 {
        return 0.0;
    }
    // Shifted so that the quotient keeps at least 31 bits; the remainder's existence goes into its last bit, so that
    // the one rounding, in the conversion to f32, sees on which side of a tie the exact value lies.
    let magnitude = sum.unsigned_abs();
    let shift = magnitude.leading_zeros().saturating_sub(1).min(63);
    let shifted = magnitude << shift;
    let quotient = (shifted / u128::from(count)) | u128::from(!shifted.is_multiple_of(u128::from(count)));
    // 2^-64 / 2^32 is far above the denormals, so scaling by a power of two is exact. Two steps keep the factor in range.
    let mean = quotient as f32 * (-FRACTION_BITS as f32).exp2() * (-(shift as f32)).exp2();
    if sum < 0 { -mean } else { mean }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: Window = Window { x: 0, y: 0, width: 1, height: 1 };

    #[test]
    fn a_mean_is_rounded_once() {
        // The exact mean of the two samples is 1 + 2^-24 + 2^-51: just above the tie that a sum in f32 rounds down.
        let mut film = Film::new(ONE);
        film.add([0, 0], [1.0, -1.0, 0.0]);
        film.add([0, 0], [1.0 + 2.0_f32.powi(-23), -1.0 - 2.0_f32.powi(-23), 0.0]);
        for _ in 0..2 {
            film.add([0, 0], [1.0 + 2.0_f32.powi(-23), -1.0, 0.0]);
        }
        // 1 + 3/4 · 2^-23 rounds up; -1 - 1/4 · 2^-23 rounds towards -1.
        assert_eq!(film.mean().pixels, [[1.0 + f32::EPSILON, -1.0, 0.0]]);
        assert_eq!(round_mean(to_fixed(2.0) + to_fixed(f32::EPSILON) + 1, 2), 1.0 + f32::EPSILON);
        assert_eq!(round_mean(to_fixed(2.0) + to_fixed(f32::EPSILON), 2), 1.0);
        assert_eq!(round_mean(i128::MAX, u32::MAX), RANGE);
        assert_eq!(round_mean(1, u32::MAX), 2.0_f32.powi(-96));
    }

    #[test]
    fn a_mantissa_in_its_place_is_the_nearest_integer() {
        let magnitudes = (0..=RANGE.to_bits()).step_by(65_521).map(f32::from_bits);
        for x in magnitudes.chain([RANGE, 2.0_f32.powi(-41), 2.0_f32.powi(-65)]).flat_map(|x| [x, -x]) {
            assert_eq!(to_fixed(x), rounded(x), "{x}");
        }
    }

    #[test]
    fn a_sample_outside_the_range_is_dropped_whole() {
        let mut film = Film::new(ONE);
        for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, 3e9, -3e9] {
            film.add([0, 0], [1.0, bad, 1.0]);
        }
        film.add([0, 0], [RANGE, -RANGE, -0.5]);
        assert_eq!((film.dropped(), film.count([0, 0])), (5, 1));
        assert_eq!(film.mean().pixels, [[RANGE, -RANGE, -0.5]]);
        let part = film.clone();
        film.merge(&part).expect("the same window");
        assert_eq!((film.dropped(), film.count([0, 0])), (10, 2), "a part's are counted too");
    }

    #[test]
    fn a_part_outside_the_window_is_refused() {
        let mut film = Film::new(ONE);
        let part = Film::new(Window { x: 0, y: 1, width: 1, height: 1 });
        assert!(film.merge(&part).unwrap_err().to_string().contains("does not lie within"));
    }
}
