//! Sun and sky, as an environment: nothing of either is known to a renderer.
//!
//! The sky is Hosek and Wilkie's model, by the `hw-skymodel` crate. The sun is a black body seen through clear air with
//! aerosols, a disk of a few texels that sends what a disk of its true size sends. What is below the horizon is a diffuse
//! ground in their light.

use crate::Environment;
use hw_skymodel::rgb::{Channel, SkyParams, SkyState};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A clear sky by the place of its sun.
///
/// ```
/// use jerboa_scenes::Sky;
///
/// let sky = Sky { elevation_deg: 30.0, ..Sky::default() }.environment().unwrap();
/// assert_eq!((sky.width, sky.height), (2048, 1024));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Height of the sun over the horizon, degrees, 0..=90.
    pub elevation_deg: f64,
    /// Where the sun stands, degrees from −Z, counter-clockwise seen from above.
    pub azimuth_deg: f64,
    /// How hazy the air is: 1 is none, 2 the mountains, 3 a clear day, 6 a warm and moist one; 1..=10.
    pub turbidity: f32,
    /// Reflectance of the ground, linear RGB, 0..=1.
    pub albedo: [f32; 3],
    /// Is there a sun in the sky? Without it the light is that of a place in its shadow.
    pub sun: bool,
    /// Texels per row, at least 64 and a multiple of 4. At the default's 2048 the sun is three of them wide.
    pub width: u32,
}

impl Default for Sky {
    fn default() -> Self {
        Sky { elevation_deg: 45.0, azimuth_deg: 0.0, turbidity: 3.0, albedo: [0.3; 3], sun: true, width: 2048 }
    }
}

/// Half of the angle that the sun takes, radians: the sun's nominal radius over the astronomical unit (IAU 2012, 2015).
const SUN_RADIUS: f64 = 6.957e8 / 1.495978707e11;

/// Effective temperature of the sun, K (IAU 2015, nominal).
const SUN_TEMPERATURE: f64 = 5772.0;

/// A black body that looks like the white of sRGB, D65, K (CIE 15:2004).
const WHITE_TEMPERATURE: f64 = 6504.0;

/// Dominant wavelengths of sRGB's primaries, nm (from their chromaticities, IEC 61966-2-1, against D65).
const WAVELENGTHS: [f64; 3] = [611.0, 549.0, 464.0];

/// What the model's RGB is larger by than radiance per nanometre: the integral of the CIE 1931 observer's ȳ, nm.
const OBSERVER: f64 = 106.857;

impl Sky {
    /// The environment it makes: radiance in W/(m² sr nm), the mean over each channel's band. The error names what is out
    /// of range.
    pub fn environment(self) -> Result<Environment, String> {
        let state = self.state()?;
        let (width, height) = (self.width, self.width / 2);
        let sun = self.direction();
        let mut radiance = vec![[0.0f32; 3]; (width * height) as usize];
        // Light that a square metre of the ground gets.
        let mut received = [0.0f64; 3];
        for (row, texels) in radiance.chunks_mut(width as usize).enumerate().take(height as usize / 2) {
            for (column, texel) in texels.iter_mut().enumerate() {
                let direction = self.direction_of(row as f64 + 0.5, column as f64 + 0.5);
                *texel = sky(&state, direction, sun);
                gather(&mut received, *texel, direction[1] * self.solid_angle(row));
            }
        }
        if self.sun {
            for (row, column, texel) in self.sun_texels(sun) {
                gather(
                    &mut received,
                    texel,
                    self.direction_of(row as f64 + 0.5, column as f64 + 0.5)[1] * self.solid_angle(row),
                );
                let old = &mut radiance[row * width as usize + column];
                *old = [0, 1, 2].map(|c| old[c] + texel[c]);
            }
        }
        let ground = [0, 1, 2].map(|c| (f64::from(self.albedo[c]) / PI * received[c]) as f32);
        radiance[(width * height / 2) as usize..].fill(ground);
        Ok(Environment { width, height, radiance, intensity: 1.0, rotation_deg: 0.0 })
    }

    fn state(self) -> Result<SkyState, String> {
        let elevation = self.elevation_deg.to_radians();
        if !(0.0..=FRAC_PI_2).contains(&elevation) {
            return Err(format!("a sun {} degrees high, not 0 to 90", self.elevation_deg));
        }
        if !self.azimuth_deg.is_finite() {
            return Err("the sun's azimuth is not finite".into());
        }
        if self.width < 64 || !self.width.is_multiple_of(4) {
            return Err(format!("{} texels a row, not 64 or more by fours", self.width));
        }
        let params = SkyParams { elevation: elevation as f32, turbidity: self.turbidity, albedo: self.albedo };
        SkyState::new(&params).map_err(|e| e.to_string())
    }

    /// Towards the sun, unit.
    fn direction(self) -> [f64; 3] {
        let (elevation, azimuth) = (self.elevation_deg.to_radians(), self.azimuth_deg.to_radians());
        [-azimuth.sin() * elevation.cos(), elevation.sin(), -azimuth.cos() * elevation.cos()]
    }

    /// Texels above the horizon with a share of the sun's disk, by row and column, with what they add.
    fn sun_texels(self, sun: [f64; 3]) -> Vec<(usize, usize, [f32; 3])> {
        let mut found = Vec::new();
        let mut area = 0.0;
        for row in 0..self.width as usize / 4 {
            // Texels of a row near the zenith are narrow; elsewhere this leaves most rows out.
            let height = FRAC_PI_2 - (row as f64 + 0.5) * PI / f64::from(self.width / 2);
            if (height - self.elevation_deg.to_radians()).abs() > SUN_RADIUS + PI / f64::from(self.width) {
                continue;
            }
            for column in 0..self.width as usize {
                let share = self.covered(row, column, sun);
                if share > 0.0 {
                    area += share * self.solid_angle(row);
                    found.push((row, column, share));
                }
            }
        }
        // Half of the disk may be below the horizon, and its texels are not exactly as large as it is.
        let visible = if self.elevation_deg.to_radians() < SUN_RADIUS { 0.5 } else { 1.0 };
        let scale = visible * TAU * (1.0 - SUN_RADIUS.cos()) / area;
        let disk = self.sun_radiance();
        found.into_iter().map(|(r, c, share)| (r, c, disk.map(|l| (l * share * scale) as f32))).collect()
    }

    /// The direction of a place of the image, in rows from the top and columns.
    fn direction_of(self, row: f64, column: f64) -> [f64; 3] {
        let (theta, phi) = (row * TAU / f64::from(self.width), (column / f64::from(self.width) - 0.5) * TAU);
        [theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos()]
    }

    /// Solid angle of a texel of this row, sr.
    fn solid_angle(self, row: usize) -> f64 {
        let side = TAU / f64::from(self.width);
        side * ((row as f64 * side).cos() - ((row + 1) as f64 * side).cos())
    }

    /// Share of a texel that the sun's disk covers, by 8 x 8 places.
    fn covered(self, row: usize, column: usize, sun: [f64; 3]) -> f64 {
        const PLACES: usize = 8;
        let inside = |i: usize| {
            let at = |from: usize, i: usize| from as f64 + (i as f64 + 0.5) / PLACES as f64;
            angle(self.direction_of(at(row, i / PLACES), at(column, i % PLACES)), sun) < SUN_RADIUS
        };
        (0..PLACES * PLACES).filter(|i| inside(*i)).count() as f64 / (PLACES * PLACES) as f64
    }

    /// Radiance of the sun's disk at the ground, W/(m² sr nm): Planck's law, and what molecules and aerosols leave of it
    /// (Preetham, Shirley, Smits 1999, appendix A.1). Ozone, vapour and mixed gases, which take a few percent, are left out.
    fn sun_radiance(self) -> [f64; 3] {
        let zenith_deg = 90.0 - self.elevation_deg;
        let mass = 1.0 / (zenith_deg.to_radians().cos() + 0.15 * (93.885 - zenith_deg).powf(-1.253));
        let haze = 0.04608 * f64::from(self.turbidity) - 0.04586;
        let white = WAVELENGTHS.map(|l| planck(l, WHITE_TEMPERATURE)).iter().sum::<f64>() / 3.0;
        WAVELENGTHS.map(|l| {
            let micrometres = l / 1000.0;
            let molecules = 0.008735 * micrometres.powf(-4.08);
            let aerosols = haze * micrometres.powf(-1.3);
            let left = (-(molecules + aerosols) * mass).exp();
            planck(l, SUN_TEMPERATURE) / planck(l, WHITE_TEMPERATURE) * white * left
        })
    }
}

/// Adds a texel's radiance times a weight.
fn gather(sum: &mut [f64; 3], texel: [f32; 3], weight: f64) {
    sum.iter_mut().zip(texel).for_each(|(sum, c)| *sum += f64::from(c) * weight);
}

/// Angle between two unit vectors, accurate where it is small.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let chord: f64 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
    2.0 * (chord.sqrt() / 2.0).min(1.0).asin()
}

/// The sky's radiance in a direction above the horizon, W/(m² sr nm).
fn sky(state: &SkyState, direction: [f64; 3], sun: [f64; 3]) -> [f32; 3] {
    let (theta, gamma) = (direction[1].acos() as f32, angle(direction, sun) as f32);
    [Channel::R, Channel::G, Channel::B].map(|c| (state.radiance(theta, gamma, c).max(0.0) as f64 / OBSERVER) as f32)
}

/// Radiance of a black body, W/(m² sr nm), at a wavelength in nm and a temperature in K.
fn planck(wavelength: f64, temperature: f64) -> f64 {
    // h, c and k of the SI (2019).
    let (h, c, k) = (6.62607015e-34, 2.99792458e8, 1.380649e-23);
    let metres = wavelength * 1e-9;
    2.0 * h * c * c / metres.powi(5) / (h * c / (metres * k * temperature)).exp_m1() * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light on a plane that faces a direction, from above the horizon.
    fn irradiance(sky: Sky, normal: [f64; 3]) -> [f64; 3] {
        let image = sky.environment().expect("it is in range");
        let mut sum = [0.0; 3];
        for (i, texel) in image.radiance.iter().enumerate().take(image.radiance.len() / 2) {
            let (row, column) = (i / image.width as usize, i % image.width as usize);
            let to = sky.direction_of(row as f64 + 0.5, column as f64 + 0.5);
            let cos: f64 = (0..3).map(|k| to[k] * normal[k]).sum();
            gather(&mut sum, *texel, cos.max(0.0) * sky.solid_angle(row));
        }
        sum
    }

    #[test]
    fn the_sun_sends_what_its_disk_sends() {
        for (elevation_deg, azimuth_deg) in [(8.0, 0.0), (33.0, 77.0), (89.9, -10.0)] {
            let with = Sky { elevation_deg, azimuth_deg, ..Sky::default() };
            let towards = with.direction();
            let (both, alone) = (irradiance(with, towards), irradiance(Sky { sun: false, ..with }, towards));
            let disk = with.sun_radiance().map(|l| l * PI * SUN_RADIUS * SUN_RADIUS);
            for c in 0..3 {
                let error = (both[c] - alone[c]) / disk[c] - 1.0;
                assert!(error.abs() < 1e-3, "{elevation_deg}: channel {c} is off by {error:.1e}");
            }
        }
    }

    #[test]
    fn the_brightest_texel_is_where_the_sun_is() {
        // A quarter of a turn counter-clockwise from -Z is -X: u = 0.5 + atan2(-1, 0) / 2 pi = 0.25.
        let sky = Sky { elevation_deg: 60.0, azimuth_deg: 90.0, ..Sky::default() }.environment().unwrap();
        let brightest = (0..sky.radiance.len()).max_by(|a, b| sky.radiance[*a][1].total_cmp(&sky.radiance[*b][1]));
        let (row, column) = (brightest.unwrap() / 2048, brightest.unwrap() % 2048);
        assert!(row.abs_diff(2048 / 12) <= 2 && column.abs_diff(2048 / 4) <= 2, "{row}, {column}");
    }

    /// On a clear day with the sun high, most light on the ground comes from the sun, yet the sky's share is no trifle: both are
    /// in the same unit. And their colours are what everyone knows.
    #[test]
    fn sun_and_sky_are_in_proportion() {
        let clear = Sky { elevation_deg: 60.0, turbidity: 2.5, ..Sky::default() };
        let up = [0.0, 1.0, 0.0];
        let (both, sky) = (irradiance(clear, up), irradiance(Sky { sun: false, ..clear }, up));
        let ratio = (both[1] - sky[1]) / sky[1];
        assert!((4.0..9.0).contains(&ratio), "{ratio}");
        assert!(sky[2] > 1.3 * sky[0], "a clear sky is blue: {sky:?}");
        let low = Sky { elevation_deg: 3.0, ..clear }.sun_radiance();
        assert!(low[0] > 3.0 * low[2], "a low sun is red: {low:?}");
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let fault = |sky: Sky| sky.environment().unwrap_err();
        assert_eq!(fault(Sky { elevation_deg: -1.0, ..Sky::default() }), "a sun -1 degrees high, not 0 to 90");
        assert!(fault(Sky { turbidity: 11.0, ..Sky::default() }).contains("Turbidity"));
        assert!(fault(Sky { albedo: [2.0; 3], ..Sky::default() }).contains("Albedo"));
        assert!(fault(Sky { azimuth_deg: f64::NAN, ..Sky::default() }).contains("azimuth"));
    }
}
