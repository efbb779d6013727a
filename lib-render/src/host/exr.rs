//! OpenEXR files of any channels.

use std::io::{BufWriter, Cursor, Write};
use std::path::Path;

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

/// Write channels of 32-bit floats as one part, whole or not at all; every bit is kept.
///
/// # Errors
/// When the file cannot be written, or a channel has not `width`·`height` values.
pub fn write_channels(path: &Path, [width, height]: [u32; 2], channels: Vec<Channel>) -> Result<(), Error> {
    let fault = |e: &dyn std::fmt::Display| Error::new(format!("cannot write {}: {e}", path.display()));
    let area = width as usize * height as usize;
    if let Some(channel) = channels.iter().find(|c| c.values.len() != area) {
        return Err(fault(&format!("channel {} has {} values for {area} pixels", channel.name, channel.values.len())));
    }
    let channel = |c: Channel| AnyChannel::new(c.name.as_str(), FlatSamples::F32(c.values));
    let channels = AnyChannels::sort(channels.into_iter().map(channel).collect());
    let size = (width as usize, height as usize);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::FAST_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(|e| fault(&e))?;
    write_atomic(path, |file| {
        let mut file = BufWriter::new(file);
        file.write_all(bytes.get_ref())?;
        file.flush()
    })
}

/// The channels of the first part of a file, by name.
///
/// # Errors
/// When it cannot be read, or has channels of other types than 32-bit floats.
pub fn read_channels(path: &Path) -> Result<([u32; 2], Vec<Channel>), Error> {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let fault = |e: &dyn std::fmt::Display| Error::new(format!("cannot read {}: {e}", path.display()));
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let layer = reader.from_file(path).map_err(|e| fault(&e))?.layer_data;
    let size = [layer.size.0 as u32, layer.size.1 as u32];
    let channel = |c: AnyChannel<FlatSamples>| match c.sample_data {
        FlatSamples::F32(values) => Ok(Channel { name: c.name.to_string(), values }),
        _ => Err(fault(&format!("channel {} is not of 32-bit floats", c.name))),
    };
    Ok((size, layer.channel_data.list.into_iter().map(channel).collect::<Result<_, _>>()?))
}
