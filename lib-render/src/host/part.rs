//! Partial renders on disk: films that can be added up to the very bits of the whole (Law 9).
//!
//! A *part* is an ordinary `.exr`, whose channels `R`, `G`, `B` are the mean of its samples, as every viewer shows them. Beside
//! them it has the film itself, in channels of unsigned 32-bit words, which no reader of OpenEXR changes:
//!
//! | channel | what |
//! |---|---|
//! | `jerboa.g0.R0` to `.R3` | the sum of red over the samples of group 0: a multiple of 2^-64 in 128 bits, two's complement, the least significant word first |
//! | `jerboa.g0.G0` to `.B3` | green and blue likewise |
//! | `jerboa.g0.N` | samples in the pixel |
//! | `jerboa.g1.R0` to `jerboa.g7.N` | the other groups, in a film that keeps them apart: see [`super::variance`] |
//!
//! The attribute `jerboa` is a text of lines, a word and what it stands for: `part 1` (the number of this format), `film` (columns
//! and rows of the image, then left, top, width and height of the window), `groups`, `samples` (`SEED:FIRST..END`, comma between),
//! `dropped` (samples that were not finite), the facts of an [`Origin`] and, in the last line, `hash`: that of all words and
//! lines, since OpenEXR has none. One attribute, because the order of several would be left to chance.

use std::collections::BTreeMap;
use std::path::Path;

use super::aov::components;
use super::error::Error;
use super::exr::{Content, Words, read_content, read_text, write_content};
use super::film::{Film, GROUPS, Window, sums};
use super::origin::{Hash, Origin, Span};

/// Name of the attribute.
const ATTRIBUTE: &str = "jerboa";
/// What a word of a sum is called, for each channel from the least significant.
const SUMS: [&str; 12] = ["R0", "R1", "R2", "R3", "G0", "G1", "G2", "G3", "B0", "B1", "B2", "B3"];

/// A film and where its samples are from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Part {
    /// The sums.
    pub film: Film,
    /// Which samples, and of what.
    pub origin: Origin,
}

/// Writes a film as a part, whole or not at all.
///
/// # Errors
/// When the file cannot be written.
pub fn write(path: &Path, film: &Film, origin: &Origin) -> Result<(), Error> {
    let words: Vec<Words> = (0..film.groups()).flat_map(|group| words_of(film, group)).collect();
    let image = film.mean();
    let text = text_of(film, origin, &words);
    let content = Content { floats: components("", ["R", "G", "B"], &image).collect(), words };
    write_content(path, [image.width, image.height], content, Some((ATTRIBUTE, &text)))
}

/// The channels of a group.
fn words_of(film: &Film, group: u32) -> Vec<Words> {
    let sum = |i: usize| film.group(group).map(move |(sum, _)| (sum[i / 4] >> (32 * (i % 4))) as u32).collect();
    let name = |word: &str| channel_name(group, word);
    let mut all: Vec<Words> = (0..12).map(|i| Words { name: name(SUMS[i]), values: sum(i) }).collect();
    all.push(Words { name: name("N"), values: film.group(group).map(|(_, count)| count).collect() });
    all
}

fn channel_name(group: u32, word: &str) -> String {
    format!("jerboa.g{group}.{word}")
}

fn text_of(film: &Film, origin: &Origin, words: &[Words]) -> String {
    let ([columns, rows], Window { x, y, width, height }) = (film.size(), film.window());
    let spans: Vec<String> = origin.spans.iter().map(|s| format!("{}:{}..{}", s.seed, s.first, s.end)).collect();
    let mut text = format!("part 1\nfilm {columns},{rows},{x},{y},{width},{height}\ngroups {}\n", film.groups());
    text += &format!("samples {}\ndropped {}\n", spans.join(","), film.dropped());
    origin.facts.iter().for_each(|(name, fact)| text += &format!("{name} {fact}\n"));
    let hash = hash_of(&text, words);
    text + &format!("hash {hash:016x}\n")
}

/// A hash of what a part says and of its words.
fn hash_of(text: &str, words: &[Words]) -> u64 {
    let mut hash = Hash::default();
    text.bytes().for_each(|byte| hash.word(byte.into()));
    words.iter().flat_map(|w| &w.values).for_each(|word| hash.word(*word));
    hash.0
}

/// Words of the attribute that are no facts of an [`Origin`].
const OWN: [&str; 5] = ["part", "film", "groups", "samples", "dropped"];

impl Part {
    /// Reads a part.
    ///
    /// # Errors
    /// When the file cannot be read, is no part, or was changed since it was written.
    pub fn read(path: &Path) -> Result<Part, Error> {
        let fault = |why: &str| Error::new(format!("cannot read {}: {why}", path.display()));
        let Some(text) = read_text(path, ATTRIBUTE)? else {
            return Err(fault("it is no part: `jerboa render --sample-range A..B` writes one"));
        };
        let broken = || fault("it is a broken part: render it again");
        let (text, hash) = text.trim_end().rsplit_once("hash ").ok_or_else(broken)?;
        let lines: BTreeMap<&str, &str> = text.lines().filter_map(|line| line.split_once(' ')).collect();
        let line = |name: &str| lines.get(name).copied().ok_or_else(broken);
        if line("part")? != "1" {
            return Err(fault("it is a part of another version of Jerboa"));
        }
        let film: [u32; 6] = numbers(line("film")?).ok_or_else(broken)?;
        let [groups] = numbers(line("groups")?).filter(|[n]| [1, GROUPS].contains(n)).ok_or_else(broken)?;
        let spans = line("samples")?.split(',').map(span).collect::<Option<Vec<_>>>().ok_or_else(broken)?;
        let dropped = line("dropped")?.parse().map_err(|_| broken())?;
        let facts = text.lines().filter_map(|line| line.split_once(' ')).filter(|(name, _)| !OWN.contains(name));
        let mut origin = Origin { facts: facts.map(|(n, f)| (n.into(), f.into())).collect(), spans: Vec::new() };
        for span in spans {
            origin.join(&origin.of(span)).map_err(|_| broken())?;
        }

        let ([width, height], Content { mut words, .. }) = read_content(path)?;
        let window = Window { x: film[2], y: film[3], width: film[4], height: film[5] };
        let whole = Window { x: 0, y: 0, width: film[0], height: film[1] };
        let names = (0..groups).flat_map(|g| SUMS.iter().chain([&"N"]).map(move |word| channel_name(g, word)));
        let mut take = |name: String| Some(words.swap_remove(words.iter().position(|w| w.name == name)?));
        let words = names.map(&mut take).collect::<Option<Vec<Words>>>().ok_or_else(broken)?;
        let fits = (width, height) == (window.width, window.height) && whole.contains(&window);
        if !fits || hash != format!("{:016x}", hash_of(text, &words)) {
            return Err(broken());
        }
        let size = [whole.width, whole.height];
        let film = if groups == 1 { Film::try_crop(size, window) } else { Film::try_grouped(size, window) }?;
        let mut film = filled(film, &words);
        film.drop_more(dropped);
        film.asked_below(origin.spans.iter().map(|s| s.end).max().unwrap_or(0));
        Ok(Part { film, origin })
    }

    /// Adds the samples of another part.
    ///
    /// # Errors
    /// When they are of another image, film or window, some are in both, or one keeps groups apart and the other does not.
    pub fn merge(&mut self, other: &Part) -> Result<(), Error> {
        let refuse = |why: String| Err(Error::new(why));
        let ([w, h], [other_w, other_h]) = (self.film.size(), other.film.size());
        if [w, h] != [other_w, other_h] {
            return refuse(format!("its film has {other_w}x{other_h} pixels, not {w}x{h}"));
        }
        let (ours, theirs) = (self.film.window(), other.film.window());
        if ours != theirs {
            let crop = |w: Window| format!("{},{},{},{}", w.x, w.y, w.width, w.height);
            return refuse(format!("it holds the pixels {}, not {}", crop(theirs), crop(ours)));
        }
        if let Some(difference) = self.origin.difference(&other.origin) {
            return Err(difference);
        }
        if self.film.groups() != other.film.groups() {
            let [with, without] = ["with", "without"].map(|word| format!("{word} --variance"));
            let (theirs, ours) = if other.film.groups() > 1 { (with, without) } else { (without, with) };
            return refuse(format!("it was rendered {theirs}, the others {ours}"));
        }
        self.origin.join(&other.origin)?;
        self.film.merge(&other.film)
    }
}

/// An empty film with what the channels of its groups hold.
fn filled(mut film: Film, words: &[Words]) -> Film {
    let window = film.window();
    for (group, words) in (0..).zip(words.chunks(SUMS.len() + 1)) {
        for index in 0..window.area() {
            let pixel = [window.x + index as u32 % window.width, window.y + index as u32 / window.width];
            let row: [u32; 13] = std::array::from_fn(|i| words[i].values[index]);
            film.add_sum(pixel, group, sums(&row), row[12], 0);
        }
    }
    film
}

/// `SEED:FIRST..END`, with a sample at least.
fn span(text: &str) -> Option<Span> {
    let (seed, range) = text.split_once(':')?;
    let (first, end) = range.split_once("..")?;
    let span = Span { seed: seed.parse().ok()?, first: first.parse().ok()?, end: end.parse().ok()? };
    (span.first < span.end).then_some(span)
}

fn numbers<const N: usize>(text: &str) -> Option<[u32; N]> {
    let all: Option<Vec<u32>> = text.split(',').map(|n| n.parse().ok()).collect();
    all?.try_into().ok()
}
