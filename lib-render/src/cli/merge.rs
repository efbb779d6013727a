//! `jerboa merge`: partial renders to the image of all their samples.

use super::args::MergeArgs;
use super::render::{dropped_line, estimated_error, noise_line, write_image};
use crate::host::error::Error;
use crate::host::film::GROUPS;
use crate::host::image_io::Image;
use crate::host::origin::Span;
use crate::host::part::{self, Part};

/// Adds up the parts, writes the image and returns what to print.
pub(super) fn run(args: &MergeArgs) -> Result<String, Error> {
    Image::check_target(&args.output)?;
    if args.part || args.variance {
        Image::check_layers(&args.output)?;
    }
    let sum = sum(args)?;
    if args.part {
        part::write(&args.output, &sum.film, &sum.origin)?;
    } else {
        write_image(&sum.film, &args.output, args.exposure, args.variance, Vec::new())?;
    }
    Ok(report(args, &sum))
}

/// All parts in one, which has what is asked of it.
fn sum(args: &MergeArgs) -> Result<Part, Error> {
    let (first, others) = args.parts.split_first().expect("the command line asks for one at least");
    let mut sum = Part::read(first)?;
    for path in others {
        let refused = |e| Error::new(format!("cannot add {} to {}: {e}", path.display(), first.display()));
        sum.merge(&Part::read(path)?).map_err(refused)?;
    }
    if let Some(gap) = sum.origin.gap().filter(|_| !args.gaps) {
        let message = format!("samples {gap} are in no part: render them, or put up with that by --gaps");
        return Err(Error::new(message));
    }
    if args.variance && sum.film.groups() != GROUPS {
        return Err(Error::new("the parts do not tell their variance: render them with --variance"));
    }
    Ok(sum)
}

fn report(args: &MergeArgs, Part { film, origin }: &Part) -> String {
    let spp: u32 = origin.spans.iter().map(|s| s.end - s.first).sum();
    let samples: Vec<String> = origin.spans.iter().map(Span::to_string).collect();
    let error = estimated_error(film);
    if args.json {
        let object = serde_json::json!({
            "output": args.output,
            "spp": spp,
            "samples": samples,
            "dropped_samples": film.dropped(),
            "estimated_relmse": error,
        });
        return format!("{object}\n");
    }
    let first = format!("{}: {spp} spp, samples {}\n", args.output.display(), samples.join(", "));
    first + &noise_line(error) + &dropped_line(film.dropped())
}
