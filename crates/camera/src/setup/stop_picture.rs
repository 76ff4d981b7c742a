//! The picture of `stop_picture`: its file, PNG or EXR, as the transmission of the stop.

use std::io::Cursor;

use exr::{meta::MetaData, prelude::ReadChannels as _, prelude::ReadLayers as _};

use crate::{
    host::Host,
    parameters::{CameraError, Parameters},
};
use realistic_base::message::{Level, Log, short};
use realistic_optics::prescription::{MAX_PICTURE_SIDE, Prescription, StopPicture, find_file};

/// Largest size of the file, bytes.
const MOST_BYTES: u64 = 64 << 20;
/// Memory, bytes, that decoding may take.
const MEMORY: usize = 128 << 20;
/// The shares of red, green and blue in the luminance (Recommendation ITU-R BT.709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Returns the picture in the stop of a lens; `None` if none is given.
///
/// # Errors
/// The file does not exist or is no such picture, a pixel is not a transmission, the lens has no stop, or
/// `stop_picture_gain` is given alone.
pub fn stop_picture(
    given: &Parameters,
    prescription: &Prescription,
    host: &Host,
    log: Log<'_>,
) -> Result<Option<StopPicture>, CameraError> {
    let Some(name) = &given.stop_picture else {
        return match given.stop_picture_gain {
            Some(true) => Err(CameraError::GainWithoutPicture),
            _ => Ok(None),
        };
    };
    if prescription.stop_index().is_none() {
        return Err(CameraError::NoStopFor { name: "stop_picture", lens: prescription.name.clone() });
    }
    let (path, bytes) =
        find_file("picture", name, &host.search, MOST_BYTES).map_err(CameraError::PictureFile)?;
    let refused = |why: String| CameraError::StopPicture { path: path.as_str().into(), why };
    let Pixels { size, values, is_srgb } = decoded(&bytes).map_err(refused)?;
    let check = |(i, value): (usize, &f32)| {
        let [x, y] = [i % size[0], i / size[0]];
        (!(value.is_finite() && *value >= 0.0)).then(|| {
            refused(format!("pixel ({x}, {y}) is {value}; a transmission is a finite number, 0 or more"))
        })
    };
    if let Some(error) = values.iter().enumerate().find_map(check) {
        return Err(error);
    }
    let picture = StopPicture::new(size, &values);
    let mean = picture.mean();
    if mean <= 0.0 {
        return Err(refused("is black inside the stop, so that no light would pass".to_owned()));
    }
    let decoding = if is_srgb { "decoded from 8-bit sRGB" } else { "taken as linear" };
    let [width, height] = size;
    let text = format!(
        "\"stop_picture\": {width} x {height} pixels, {decoding}; the stop passes {} of its light",
        short(mean)
    );
    log(Level::Info, &text);
    if given.stop_picture_gain == Some(true) {
        return Ok(Some(picture.times(mean.recip())));
    }
    let most = values.iter().copied().fold(0.0, f32::max);
    if most > 1.0 {
        let text = format!(
            "\"stop_picture\" has pixels of up to {}, which pass more light than comes: scale it to 1, or give \
             \"stop_picture_gain\" true",
            short(most.into())
        );
        log(Level::Warning, &text);
    }
    Ok(Some(picture))
}

/// A decoded picture.
struct Pixels {
    size: [usize; 2],
    /// Linear values, row by row from the top.
    values: Vec<f32>,
    /// Whether the file has 8-bit values, which are sRGB.
    is_srgb: bool,
}

/// Decodes a file in the format of its first bytes, PNG or EXR.
///
/// # Errors
/// The text says what the file is not.
fn decoded(bytes: &[u8]) -> Result<Pixels, String> {
    if bytes.len() as u64 > MOST_BYTES {
        return Err(format!("has more than {MOST_BYTES} bytes"));
    }
    if Vec::<u8>::new().try_reserve_exact(MEMORY).is_err() {
        return Err("needs more memory than there is".to_owned());
    }
    if bytes.starts_with(b"\x89PNG") {
        png(bytes).map_err(|error| error.unwrap_or_else(|error| format!("is no whole PNG file: {error}")))
    } else if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        exr(bytes).map_err(|error| error.unwrap_or_else(|error| format!("is no whole EXR file: {error}")))
    } else {
        Err("is neither a PNG nor an EXR file".to_owned())
    }
}

/// Returns why a size is refused.
fn refused_size(size: [usize; 2]) -> Option<String> {
    let [width, height] = size;
    (size.contains(&0) || width.max(height) > MAX_PICTURE_SIDE).then(|| {
        format!("has {width} x {height} pixels; scale it to at most {MAX_PICTURE_SIDE} on each side")
    })
}

/// Decodes a PNG file: 8-bit values are sRGB, 16-bit values are linear. The background of transparent pixels is black.
fn png(bytes: &[u8]) -> Result<Pixels, Result<String, png::DecodingError>> {
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: MEMORY });
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(Err)?;
    let size = [reader.info().width, reader.info().height].map(|side| side as usize);
    if let Some(why) = refused_size(size) {
        return Err(Ok(why));
    }
    let length = reader.output_buffer_size().ok_or_else(|| Ok("has too many pixels".to_owned()))?;
    let mut data = vec![0; length];
    reader.next_frame(&mut data).map_err(Err)?;
    let (kind, depth) = reader.output_color_type();
    let is_srgb = depth != png::BitDepth::Sixteen;
    let samples: Vec<f32> = match is_srgb {
        true => data.iter().map(|value| f32::from(*value) / 255.0).collect(),
        false => data
            .chunks_exact(2)
            .map(|pair| f32::from(u16::from_be_bytes([pair[0], pair[1]])) / 65535.0)
            .collect(),
    };
    let linear = |value: f32| if is_srgb { from_srgb(value) } else { value };
    let value = |pixel: &[f32]| match *pixel {
        [grey] => linear(grey),
        [grey, alpha] => linear(grey) * alpha,
        [r, g, b] => luminance([r, g, b].map(linear)),
        [r, g, b, alpha] => luminance([r, g, b].map(linear)) * alpha,
        _ => unreachable!("a PNG file has up to four channels"),
    };
    Ok(Pixels { size, values: samples.chunks_exact(kind.samples()).map(value).collect(), is_srgb })
}

/// Decodes the first layer of an EXR file: R, G and B, or else Y, or else the only channel.
fn exr(bytes: &[u8]) -> Result<Pixels, Result<String, exr::error::Error>> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(Err)?;
    for header in &meta.headers {
        let size = [header.layer_size.width(), header.layer_size.height()];
        if let Some(why) = refused_size(size) {
            return Err(Ok(why));
        }
        if header.channels.list.len() > 16 {
            return Err(Ok("has more than 16 channels; save the picture alone".to_owned()));
        }
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(Err)?;
    let layer = image.layer_data;
    let size = [layer.size.width(), layer.size.height()];
    let channels = &layer.channel_data.list;
    let named = |name: &str| channels.iter().find(|channel| channel.name.eq(name));
    if channels.iter().any(|channel| channel.sample_data.len() != size[0] * size[1]) {
        return Err(Ok("has channels of other sizes than the picture".to_owned()));
    }
    let values_of = |channel: &exr::prelude::AnyChannel<exr::prelude::FlatSamples>| -> Vec<f32> {
        channel.sample_data.values_as_f32().collect()
    };
    let values = match (["R", "G", "B"].map(named), named("Y"), &channels[..]) {
        ([Some(r), Some(g), Some(b)], ..) => {
            let [r, g, b] = [r, g, b].map(values_of);
            (0..r.len()).map(|i| luminance([r[i], g[i], b[i]])).collect()
        }
        (_, Some(only), _) | (_, None, [only]) => values_of(only),
        _ => {
            let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
            return Err(Ok(format!(
                "has the channels {}; it needs R, G and B, or Y, or one channel",
                names.join(", ")
            )));
        }
    };
    Ok(Pixels { size, values, is_srgb: false })
}

fn luminance(colour: [f32; 3]) -> f32 {
    (0..3).map(|i| LUMINANCE[i] * colour[i]).sum()
}

/// Decodes a value of sRGB (IEC 61966-2-1).
fn from_srgb(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
