//! Where the samples of a film are from: all that an image is a function of (Law 9), so that films of different images are
//! never added up.
//!
//! Scenes are large, so they are told apart by a hash of everything in them that light meets: 64 bits, against mistakes, not
//! against forgery. Names, warnings and other cameras do not count. Camera, choices and tracer are kept as text, so that an
//! error can say what differs. What changes no bit is not here: level of knowledge, device, threads, tiles.

use std::fmt::{self, Write};

use jerboa_scenes::{Camera, Environment, Image, Instance, Mesh, Scene};

use super::error::Error;
use super::renderer::Options;

/// Samples of one seed, by number: from `first` on, before `end`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Span {
    /// Seed of the render.
    pub seed: u32,
    /// The first sample.
    pub first: u32,
    /// The first one behind.
    pub end: u32,
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}..{} of seed {}", self.first, self.end, self.seed)
    }
}

/// Where the samples of a film are from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Origin {
    /// What they are samples of: names of facts, and the facts.
    pub facts: Vec<(String, String)>,
    /// Which samples, ascending and apart from each other.
    pub spans: Vec<Span>,
}

impl Origin {
    /// No samples yet of what this camera sees of a scene.
    pub fn new(scene: &Scene, camera: &Camera, options: &Options) -> Origin {
        // Whoever adds an option says here whether the image depends on it.
        let Options { known: _, tracer, choices, spp: _, seed: _, keep: _, device: _, traversal: _, cut: _ } = options;
        let mut hash = Hash::default();
        hash.scene(scene);
        let camera = Camera { name: String::new(), ..camera.clone() };
        let facts = [
            ("version", env!("CARGO_PKG_VERSION").into()),
            ("scene", format!("{:016x}", hash.0)),
            ("camera", format!("{camera:?}")),
            ("tracer", format!("{tracer:?}")),
            ("choices", format!("{choices:?}")),
        ];
        Origin { facts: facts.map(|(name, fact)| (name.to_string(), fact)).into(), spans: Vec::new() }
    }

    /// The same with these samples alone.
    #[must_use]
    pub fn of(&self, span: Span) -> Origin {
        Origin { spans: vec![span], ..self.clone() }
    }

    /// What the first fact is that differs from another's, as a reason not to add the two up.
    pub fn difference(&self, other: &Origin) -> Option<Error> {
        if self.facts == other.facts {
            return None;
        }
        let mut pairs = self.facts.iter().zip(&other.facts);
        let Some(((name, ours), (_, theirs))) = pairs.find(|(a, b)| a != b) else {
            return Some(Error::new("it says more, or less, of where it is from"));
        };
        let [ours, theirs] = first_difference(ours, theirs);
        Some(Error::new(format!("its {name} differs: {theirs}, not {ours}")))
    }

    /// Takes in the samples of another.
    ///
    /// # Errors
    /// When some are in both, or they are too many for a film.
    pub fn join(&mut self, other: &Origin) -> Result<(), Error> {
        let mut spans = [&self.spans[..], &other.spans].concat();
        spans.sort();
        for pair in spans.windows(2) {
            if pair[0].seed == pair[1].seed && pair[1].first < pair[0].end {
                let both = Span { end: pair[0].end.min(pair[1].end), ..pair[1] };
                return Err(Error::new(format!("samples {both} are counted twice")));
            }
        }
        if spans.iter().map(|s| u64::from(s.end - s.first)).sum::<u64>() > u32::MAX.into() {
            return Err(Error::new("together they have 2^32 samples or more"));
        }
        spans.dedup_by(|next, span| {
            let follows = span.seed == next.seed && span.end == next.first;
            if follows {
                span.end = next.end;
            }
            follows
        });
        self.spans = spans;
        Ok(())
    }

    /// The first samples that are missing between others of their seed.
    pub fn gap(&self) -> Option<Span> {
        let pair = self.spans.windows(2).find(|pair| pair[0].seed == pair[1].seed)?;
        Some(Span { first: pair[0].end, end: pair[1].first, seed: pair[0].seed })
    }
}

/// Two texts, each cut down to the first words between commas in which they differ.
fn first_difference<'t>(a: &'t str, b: &'t str) -> [&'t str; 2] {
    a.split(", ").zip(b.split(", ")).find(|(a, b)| a != b).map_or([a, b], |(a, b)| [a, b])
}

/// FNV-1a (Fowler, Noll & Vo) of 64 bits, by words of 32 in place of bytes.
pub(super) struct Hash(pub(super) u64);

impl Default for Hash {
    fn default() -> Hash {
        Hash(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    pub(super) fn word(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    /// A list: how long it is, and its words.
    fn words(&mut self, length: usize, words: impl IntoIterator<Item = u32>) {
        self.word(length as u32);
        words.into_iter().for_each(|word| self.word(word));
    }

    /// A list of vectors, or that there is none.
    fn floats<const N: usize>(&mut self, list: Option<&[impl Copy + Into<[f32; N]>]>) {
        let words = list.unwrap_or_default().iter().flat_map(|v| (*v).into().map(f32::to_bits));
        self.words(list.map_or(usize::MAX, <[_]>::len), words);
    }

    /// Small things, as they print: floats print with all their digits.
    fn text(&mut self, thing: &impl fmt::Debug) {
        write!(self, "{thing:?};").expect("hashing does not fail");
    }

    fn scene(&mut self, scene: &Scene) {
        // Whoever adds a part says here whether light meets it.
        let Scene {
            name: _,
            meshes,
            instances,
            materials,
            textures,
            images,
            cameras: _,
            lights,
            own,
            environment,
            warnings: _,
        } = scene;
        self.word(meshes.len() as u32);
        meshes.iter().for_each(|mesh| self.mesh(mesh));
        self.word(instances.len() as u32);
        for Instance { mesh, to_world } in instances {
            let words =
                to_world.to_cols_array().map(f64::to_bits).into_iter().flat_map(|b| [b as u32, (b >> 32) as u32]);
            self.words(*mesh, words);
        }
        self.text(materials);
        self.text(textures);
        self.word(images.len() as u32);
        for Image { name: _, width, height, rgba } in images {
            self.words(*width as usize, [*height]);
            self.words(rgba.len(), rgba.iter().map(|texel| u32::from_le_bytes(*texel)));
        }
        self.text(lights);
        self.text(own);
        self.word(environment.is_some().into());
        if let Some(Environment { width, height, radiance, intensity, rotation_deg }) = environment {
            self.words(*width as usize, [*height, intensity.to_bits(), rotation_deg.to_bits()]);
            self.floats(Some(radiance));
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        let Mesh { name: _, positions, normals, tangents, uvs, colors, triangles, material } = mesh;
        self.floats(Some(positions));
        self.floats(normals.as_deref());
        self.floats(tangents.as_deref());
        uvs.iter().for_each(|uvs| self.floats(uvs.as_deref()));
        self.floats(colors.as_deref());
        self.words(triangles.len(), triangles.as_flattened().iter().copied());
        self.word(*material as u32);
    }
}

impl Write for Hash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().for_each(|byte| self.word(byte.into()));
        Ok(())
    }
}
