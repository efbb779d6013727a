//! `jerboa compare`: how far the mean of some images is from a reference.

use super::args::CompareArgs;
use crate::host::compare::{self, BLOCK, Comparison, REL_MSE_EPSILON, T13_MIN_RENDERS};
use crate::host::error::Error;
use crate::host::image_io::Image;
use std::path::Path;

/// Reads the images, writes the difference picture if asked, and returns the figures as text or JSON.
pub(super) fn report(args: &CompareArgs) -> Result<String, Error> {
    let (renders, reference) = args.images.split_at(args.images.len() - 1);
    let reference = Image::read(&reference[0])?;
    let renders = renders.iter().map(|path| Image::read(path)).collect::<Result<Vec<_>, _>>()?;
    let variance = args.ref_variance.as_deref().map(|v| read_variance(v, &reference)).transpose()?;
    let comparison = compare::compare(&renders, &reference, variance.as_ref())?;
    if let Some(path) = &args.diff {
        compare::difference_picture(&compare::mean_image(&renders), &reference).write(path, 0.0)?;
    }
    Ok(if args.json { as_json(&comparison) } else { as_text(&comparison, renders.len()) })
}

/// The variance of the reference's mean: a number that holds everywhere, or an image.
fn read_variance(value: &str, reference: &Image) -> Result<Image, Error> {
    match value.parse::<f32>() {
        Ok(v) if v >= 0.0 && v.is_finite() => Ok(Image { pixels: vec![[v; 3]; reference.pixels.len()], ..*reference }),
        Ok(v) => Err(Error::new(format!("--ref-variance {v}: a variance is finite and not negative"))),
        Err(_) => Image::read(Path::new(value)),
    }
}

/// One object; what the number of images does not allow to say is null.
fn as_json(c: &Comparison) -> String {
    let object = serde_json::json!({
        "rmse": c.rmse,
        "relmse": c.relmse,
        "rms_z": c.t13.map(|t| t.rms_z),
        "blocks_beyond": c.t13.map(|t| t.blocks_beyond),
        "max_z": c.t13.map(|t| t.max_z),
        "mean_sigmas": c.mean_sigmas,
    });
    format!("{object}\n")
}

fn as_text(c: &Comparison, renders: usize) -> String {
    let mut text = format!("RMSE    {:.6e}\nrelMSE  {:.6e}   (eps {REL_MSE_EPSILON})\n", c.rmse, c.relmse);
    if let Some(sigmas) = c.mean_sigmas {
        text += &format!("mean    {sigmas:+.2} standard errors off the reference's\n");
    }
    text += &match c.t13 {
        Some(t) => format!(
            "T13     {}: rms z {:.3}, {:.2} % of {BLOCK}x{BLOCK} blocks beyond the 1 % quantile, max |z| {:.2}\n",
            if t.pass { "pass" } else { "FAIL" },
            t.rms_z,
            100.0 * t.blocks_beyond,
            t.max_z
        ),
        None => format!("T13     needs {T13_MIN_RENDERS} independent images, got {renders}\n"),
    };
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn write(folder: &Path, name: &str, value: f32) -> PathBuf {
        let path = folder.join(name);
        Image::from_fn(15, 15, |_, _| [value; 3]).write(&path, 0.0).unwrap();
        path
    }

    #[test]
    fn the_json_has_exactly_the_promised_keys() {
        let comparison = compare::compare(&vec![flat(1.0); 16], &flat(1.0), None).unwrap();
        let json: serde_json::Value = serde_json::from_str(&as_json(&comparison)).unwrap();
        let mut keys = json.as_object().unwrap().keys().map(String::as_str).collect::<Vec<_>>();
        keys.sort_unstable();
        assert_eq!(keys, ["blocks_beyond", "max_z", "mean_sigmas", "relmse", "rms_z", "rmse"]);
        assert!(json.as_object().unwrap().values().all(|v| v.as_f64() == Some(0.0)));
    }

    fn flat(value: f32) -> Image {
        Image::from_fn(15, 15, |_, _| [value; 3])
    }

    #[test]
    fn images_are_compared_and_a_difference_picture_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let images = vec![write(folder.path(), "a.exr", 1.5), write(folder.path(), "ref.exr", 1.0)];
        let diff = folder.path().join("diff.png");
        let args = CompareArgs { images, ref_variance: Some("0.01".into()), json: true, diff: Some(diff.clone()) };
        assert!(report(&args).unwrap().starts_with('{'));
        assert_eq!(Image::read(&diff).unwrap().pixels[0], [1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_variance_is_a_number_or_an_image() {
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path(), "v.exr", 0.25);
        assert_eq!(read_variance("0.25", &flat(1.0)), Image::read(&path));
        assert!(read_variance("-1", &flat(1.0)).is_err());
        assert!(read_variance("nan", &flat(1.0)).is_err());
        let missing = read_variance("missing.exr", &flat(1.0)).unwrap_err().to_string();
        assert!(missing.starts_with("cannot read missing.exr"), "{missing}");
    }
}
