//! OpenEXR files of any channels.

use std::io::{BufWriter, Write};
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};

use super::error::Error;
use super::image_io::write_atomic;

/// A channel of an image: a number for each pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Its name in the file: `component`, or `layer.component`.
    pub name: String,
    /// The numbers.
    pub values: Vec<f32>,
}

/// A channel of whole numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Words {
    /// Its name in the file.
    pub name: String,
    /// The numbers.
    pub values: Vec<u32>,
}

/// All channels of an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Content {
    /// Those of 32-bit floats.
    pub floats: Vec<Channel>,
    /// Those of unsigned 32-bit integers.
    pub words: Vec<Words>,
}

/// Write channels of 32-bit floats as one part, whole or not at all; every bit is kept.
///
/// # Errors
/// When the file cannot be written, or a channel has not `width`·`height` values.
pub fn write_channels(path: &Path, size: [u32; 2], channels: Vec<Channel>) -> Result<(), Error> {
    write_content(path, size, Content { floats: channels, ..Content::default() }, None)
}

/// Write channels of either kind likewise, and a text as an attribute of this name. Equal content gives equal bytes.
///
/// # Errors
/// As [`write_channels`].
pub fn write_content(
    path: &Path,
    [width, height]: [u32; 2],
    content: Content,
    text: Option<(&str, &str)>,
) -> Result<(), Error> {
    let Content { floats, words } = content;
    let floats = floats.into_iter().map(|c| (c.name, FlatSamples::F32(c.values)));
    let words = words.into_iter().map(|c| (c.name, FlatSamples::U32(c.values)));
    let channels: Vec<(String, FlatSamples)> = floats.chain(words).collect();
    let area = width as usize * height as usize;
    if let Some((name, values)) = channels.iter().find(|(_, values)| values.len() != area) {
        let message = format!("channel {name} has {} values for {area} pixels", values.len());
        return Err(Error::new(format!("cannot write {}: {message}", path.display())));
    }
    let channels = channels.into_iter().map(|(name, values)| AnyChannel::new(name.as_str(), values)).collect();
    let mut attributes = LayerAttributes::default();
    let text = text.map(|(name, text)| (Text::from(name), Text::from_slice_unchecked(text.as_bytes())));
    attributes.other.extend(text.map(|(name, text)| (name, AttributeValue::Text(text))));
    let size = (width as usize, height as usize);
    let layer = Layer::new(size, attributes, Encoding::FAST_LOSSLESS, AnyChannels::sort(channels));
    let image = Image::from_layer(layer);
    write_atomic(path, |file| {
        let mut file = BufWriter::new(file);
        // On several threads blocks might come in any order.
        image.write().non_parallel().to_buffered(&mut file).map_err(std::io::Error::other)?;
        file.flush()
    })
}

/// The channels of the first part of a file, by name.
///
/// # Errors
/// When it cannot be read, or has channels of other types than 32-bit floats.
pub fn read_channels(path: &Path) -> Result<([u32; 2], Vec<Channel>), Error> {
    let (size, Content { floats, words }) = read_content(path)?;
    match words.first() {
        None => Ok((size, floats)),
        Some(Words { name, .. }) => Err(cannot_read(path, &format!("channel {name} is not of 32-bit floats"))),
    }
}

/// The channels of the first part of a file, by name, of either kind.
///
/// # Errors
/// When it cannot be read, or has channels of 16-bit floats.
pub fn read_content(path: &Path) -> Result<([u32; 2], Content), Error> {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let layer = reader.from_file(path).map_err(|e| cannot_read(path, &e))?.layer_data;
    let mut content = Content::default();
    for channel in layer.channel_data.list {
        let name = channel.name.to_string();
        match channel.sample_data {
            FlatSamples::F32(values) => content.floats.push(Channel { name, values }),
            FlatSamples::U32(values) => content.words.push(Words { name, values }),
            FlatSamples::F16(_) => return Err(cannot_read(path, &format!("channel {name} is not of 32-bit floats"))),
        }
    }
    Ok(([layer.size.0 as u32, layer.size.1 as u32], content))
}

/// The text that a file has as an attribute of this name, if it has; channels are not looked at.
///
/// # Errors
/// When it cannot be read.
pub fn read_text(path: &Path, name: &str) -> Result<Option<String>, Error> {
    let meta = MetaData::read_from_file(path, false).map_err(|e| cannot_read(path, &e))?;
    let attribute = meta.headers.first().and_then(|header| header.own_attributes.other.get(&Text::from(name)));
    Ok(match attribute {
        Some(AttributeValue::Text(text)) => Some(String::from_utf8_lossy(text.as_slice()).into_owned()),
        _ => None,
    })
}

fn cannot_read(path: &Path, why: &dyn std::fmt::Display) -> Error {
    Error::new(format!("cannot read {}: {why}", path.display()))
}
