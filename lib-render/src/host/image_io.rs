//! Linear RGB images in memory and on disk.
//!
//! | extension | read | written |
//! |---|---|---|
//! | `.exr` | linear RGB, alpha ignored | linear 32-bit RGB, every bit kept |
//! | `.hdr` | linear RGB (shared exponent) | no |
//! | `.png` | 8 or 16 bits, sRGB curve undone | 8 bits, tone-mapped |
//!
//! *Tone mapping* is exposure and the display's own curve, nothing that flatters: each channel is multiplied by
//! 2^EV, clamped to [0, 1] (NaN becomes 0), and encoded by the sRGB transfer function of IEC 61966-2-1.
//!
//! A write is whole or absent: the bytes go to a temporary file in the target's folder, are flushed to the disk, and
//! the file is then renamed over the target. Whatever fails before that leaves the old file as it was.

use super::aov::components;
use super::error::Error;
use super::exr::{Channel, write_channels};
use image::{DynamicImage, ImageReader, Rgb32FImage, RgbImage};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Linear RGB radiance, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width`·`height` pixels: linear red, green and blue (Rec. 709 primaries).
    pub pixels: Vec<[f32; 3]>,
}

/// Luminance of a linear RGB value with the primaries and white of Rec. ITU-R BT.709.
pub fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

impl Image {
    /// An image whose pixel in column x and row y is `pixel(x, y)`.
    pub fn from_fn(width: u32, height: u32, mut pixel: impl FnMut(u32, u32) -> [f32; 3]) -> Image {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        Image { width, height, pixels }
    }

    /// Reads an `.exr`, `.hdr` or `.png`, chosen by the extension.
    pub fn read(path: &Path) -> Result<Image, Error> {
        let format = Format::of(path)?;
        let fault = |e: &dyn std::fmt::Display| Error::new(format!("cannot read {}: {e}", path.display()));
        let mut reader = ImageReader::open(path).map_err(|e| fault(&e))?;
        reader.set_format(format.codec());
        let decoded = reader.decode().map_err(|e| fault(&e))?;
        let rgb = decoded.to_rgb32f();
        let decode = if format == Format::Png { srgb_to_linear } else { |c| c };
        Ok(Image { width: rgb.width(), height: rgb.height(), pixels: rgb.pixels().map(|p| p.0.map(decode)).collect() })
    }

    /// Writes an `.exr` (linear) or a `.png` (tone-mapped with `exposure` in stops), chosen by the extension.
    pub fn write(&self, path: &Path, exposure: f32) -> Result<(), Error> {
        let format = Format::writable(path)?;
        let encoded = if format == Format::Exr { self.to_linear() } else { self.to_display(exposure) };
        write_atomic(path, |file| {
            let mut file = BufWriter::new(file);
            encoded.write_to(&mut file, format.codec()).map_err(std::io::Error::other)?;
            file.flush()
        })
    }

    /// Writes an `.exr` with more channels beside red, green and blue.
    ///
    /// # Errors
    /// The file is to be another one, or cannot be written.
    pub fn write_with(&self, path: &Path, channels: Vec<Channel>) -> Result<(), Error> {
        Image::check_layers(path)?;
        let all = components("", ["R", "G", "B"], self).chain(channels).collect();
        write_channels(path, [self.width, self.height], all)
    }

    /// Can layers be written there? As [`Image::check_target`].
    ///
    /// # Errors
    /// The extension is not .exr.
    pub fn check_layers(path: &Path) -> Result<(), Error> {
        if Format::of(path)? == Format::Exr {
            return Ok(());
        }
        Err(Error::new(format!(
            "cannot write {}: only an .exr has layers, so its name must end in that",
            path.display()
        )))
    }

    /// Can an image be written there? Asked before a long render, not after it.
    ///
    /// # Errors
    /// The extension is not .exr or .png, the folder does not exist, or something that is no file has this name.
    pub fn check_target(path: &Path) -> Result<(), Error> {
        Format::writable(path)?;
        let fault = |why: &str| Err(Error::new(format!("cannot write {}: {why}", path.display())));
        if path.exists() && !path.is_file() {
            return fault("it is not a regular file");
        }
        if !folder_of(path).is_dir() { fault("there is no such folder") } else { Ok(()) }
    }

    fn to_linear(&self) -> DynamicImage {
        let floats = self.pixels.as_flattened().to_vec();
        let image = Rgb32FImage::from_raw(self.width, self.height, floats);
        DynamicImage::ImageRgb32F(image.expect("an Image holds width·height pixels"))
    }

    fn to_display(&self, exposure: f32) -> DynamicImage {
        let gain = exposure.exp2();
        let encode = |c: &f32| (linear_to_srgb(c * gain) * 255.0).round() as u8;
        let bytes = self.pixels.as_flattened().iter().map(encode).collect();
        let image = RgbImage::from_raw(self.width, self.height, bytes);
        DynamicImage::ImageRgb8(image.expect("an Image holds width·height pixels"))
    }
}

/// What a file's extension says about its content.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Exr,
    Hdr,
    Png,
}

impl Format {
    fn of(path: &Path) -> Result<Format, Error> {
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("exr") => Ok(Format::Exr),
            Some("hdr") => Ok(Format::Hdr),
            Some("png") => Ok(Format::Png),
            _ => Err(Error::new(format!("{}: the image's name must end in .exr, .hdr or .png", path.display()))),
        }
    }

    /// The format of a file to write: EXR or PNG.
    fn writable(path: &Path) -> Result<Format, Error> {
        match Format::of(path) {
            Ok(format @ (Format::Exr | Format::Png)) => Ok(format),
            _ => {
                let path = path.display();
                Err(Error::new(format!(
                    "cannot write {path}: its name must end in .exr (linear) or .png (tone-mapped)"
                )))
            }
        }
    }

    fn codec(self) -> image::ImageFormat {
        match self {
            Format::Exr => image::ImageFormat::OpenExr,
            Format::Hdr => image::ImageFormat::Hdr,
            Format::Png => image::ImageFormat::Png,
        }
    }
}

/// The folder that a file is in.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Lets `fill` write a new file and puts it at `path`, whole or not at all.
///
/// # Errors
/// Names `path` and what failed: no such folder, no right to write there, no space left, or `fill`'s own error.
pub fn write_atomic(path: &Path, fill: impl FnOnce(&mut std::fs::File) -> std::io::Result<()>) -> Result<(), Error> {
    let folder = folder_of(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".jerboa-");
    // A temporary file is private by default; an image is as readable as any new file (the umask still applies).
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let save = || {
        let mut file = builder.tempfile_in(folder)?;
        fill(file.as_file_mut())?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|e| e.error)
    };
    save().map(drop).map_err(|e| {
        // The temporary file's name means nothing to the user.
        let reason = e.to_string();
        let reason = reason.split(" at path").next().unwrap_or(&reason);
        Error::new(format!("cannot write {}: {reason}", path.display()))
    })
}

/// The sRGB encoding of a linear value, clamped to [0, 1] first (NaN to 0); IEC 61966-2-1.
fn linear_to_srgb(c: f32) -> f32 {
    let c = if c > 0.0 { c.min(1.0) } else { 0.0 };
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// The linear value of an sRGB encoded one; IEC 61966-2-1.
fn srgb_to_linear(c: f32) -> f32 {
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn picture() -> Image {
        Image::from_fn(5, 3, |x, y| [x as f32 * 1e-3, -1.5 * y as f32, 3e5 + x as f32])
    }

    #[test]
    fn an_exr_keeps_every_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.EXR");
        picture().write(&path, 0.0).unwrap();
        assert_eq!(Image::read(&path).unwrap(), picture());
    }

    #[test]
    fn a_png_is_exposed_clamped_and_encoded() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let image = Image { width: 2, height: 1, pixels: vec![[0.25, 0.5, 7.0], [f32::NAN, -1.0, 0.001]] };
        image.write(&path, 1.0).unwrap();
        let bytes = image::open(&path).unwrap().to_rgb8();
        // srgb(0.5) = 187.5 of 255 and srgb(0.002) = 6.59 of 255, by the formula.
        assert_eq!(bytes.as_raw(), &[188, 255, 255, 0, 0, 7]);
        let back = Image::read(&path).unwrap();
        assert!((back.pixels[0][0] - 0.5).abs() < 4e-3);
    }

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.png");
        fs::write(&path, "old").unwrap();
        let full = |file: &mut fs::File| {
            file.write_all(b"half")?;
            Err(std::io::Error::from(std::io::ErrorKind::StorageFull))
        };
        let error = write_atomic(&path, full).unwrap_err().to_string();
        assert!(error.starts_with("cannot write ") && error.contains("out.png") && !error.contains('\n'), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "the temporary file is gone");
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_one_readable_line() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "").unwrap();
        for target in ["missing/out.exr", "file/out.png"] {
            let error = picture().write(&folder.path().join(target), 0.0).unwrap_err().to_string();
            assert!(error.contains(target) && !error.contains(".jerboa-") && !error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn an_unknown_extension_is_named() {
        for name in ["a.bmp", "noextension"] {
            let error = Image::read(Path::new(name)).unwrap_err().to_string();
            assert_eq!(error, format!("{name}: the image's name must end in .exr, .hdr or .png"));
        }
        for name in ["a.bmp", "noextension", "a.hdr"] {
            let why = format!("cannot write {name}: its name must end in .exr (linear) or .png (tone-mapped)");
            assert_eq!(picture().write(Path::new(name), 0.0).unwrap_err().to_string(), why);
            assert_eq!(Image::check_target(Path::new(name)).unwrap_err().to_string(), why);
        }
    }

    #[test]
    fn a_broken_file_is_an_error_that_names_it() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["broken.exr", "broken.png", "broken.hdr"] {
            let path = folder.path().join(name);
            fs::write(&path, "not an image").unwrap();
            assert!(Image::read(&path).unwrap_err().to_string().contains(name));
        }
    }
}
