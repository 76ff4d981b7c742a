//! A tile: part of a picture, with its place in the whole and what the whole is of, as the two kinds of file keep them.
//!
//! Both files have a text of it, which [`Origin`] writes and reads. For other programs the place stands where its format has
//! one: in an EXR file's data and display window, in a PNG file's oFFs chunk (PNG extensions 1.6).

use super::picture::{Format, LARGEST_SIDE, Picture};
use super::srgb::{Colours, SrgbImage};
use crate::failure::Failure;
use crate::files;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use exr::prelude::{
    Image, Layer, LayerAttributes, ReadChannels as _, ReadLayers as _, SpecificChannels, WritableImage as _,
};
use std::fmt::{self, Display};
use std::fs::File;
use std::io::{self, BufReader, Cursor};
use std::path::{Path, PathBuf};

/// Where a tile lies and what it is a part of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Width and height of the whole picture.
    pub whole: [u32; 2],
    /// The tile's columns and rows: x from, y from, x to, y to.
    pub crop: [u32; 4],
    /// What the picture is of and how it was made, a name with its value each; tiles of one picture have the same.
    pub settings: Vec<(String, String)>,
}

/// A tile that was read.
pub struct Tile<P> {
    /// Its file.
    pub path: PathBuf,
    /// Where it lies, and what it is a part of.
    pub origin: Origin,
    /// Rows from the top, each from the left.
    pub pixels: Vec<P>,
}

/// What PNG's text chunk and EXR's attribute are called.
const PNG_KEYWORD: &str = "realistic tile";
const EXR_ATTRIBUTE: &str = "realisticTile";

impl Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([width, height], [x0, y0, x1, y1]) = (self.whole, self.crop);
        write!(f, "{width},{height} {x0},{y0},{x1},{y1}")?;
        self.settings.iter().try_for_each(|(name, value)| write!(f, "\n{name}: {value}"))
    }
}

impl Origin {
    /// What a text says; `None` where it is none of ours.
    fn read(text: &str) -> Option<Self> {
        fn numbers<const N: usize>(text: &str) -> Option<[u32; N]> {
            let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.parse().ok()).collect();
            numbers?.try_into().ok()
        }
        let (place, settings) = text.split_once('\n').unwrap_or((text, ""));
        let (whole, crop) = place.split_once(' ')?;
        let (whole @ [width, height], crop @ [x0, y0, x1, y1]) = (numbers(whole)?, numbers(crop)?);
        let is_inside = x0 < x1 && x1 <= width && y0 < y1 && y1 <= height;
        if !is_inside || width.max(height) > LARGEST_SIDE {
            return None;
        }
        let setting = |line: &str| line.split_once(": ").map(|(name, value)| (name.into(), value.into()));
        Some(Self { whole, crop, settings: settings.lines().map(setting).collect::<Option<_>>()? })
    }

    /// Width and height of the tile.
    pub fn size(&self) -> [u32; 2] {
        let [x0, y0, x1, y1] = self.crop;
        [x1 - x0, y1 - y0]
    }
}

/// Writes a picture as a tile. `scale` takes its values to the screen's: PNG only.
///
/// # Errors
/// The file cannot be written; the message names it.
pub fn write(picture: &Picture, path: &Path, scale: f32, origin: &Origin) -> Result<(), Failure> {
    let failed = |error: &dyn Display| Failure::cannot_write(path, error);
    let bytes = match Format::of(path).map_err(Failure::Usage)? {
        Format::Png => {
            let [left, top, ..] = origin.crop;
            let place = [left.to_be_bytes(), top.to_be_bytes()].concat();
            let text = (PNG_KEYWORD, origin.to_string());
            // The last byte says that the unit is a pixel.
            let place = (*b"oFFs", [&place[..], &[0]].concat());
            picture.shown(scale).png_with(Colours::All, Some(text), Some(place))
        }
        Format::Exr => exr(picture, origin).map_err(|error| failed(&error))?,
    };
    files::save(path, &bytes).map_err(|error| failed(&error))
}

fn exr(picture: &Picture, origin: &Origin) -> exr::error::Result<Vec<u8>> {
    let [width, height] = picture.size.map(|side| side as usize);
    let channels = SpecificChannels::rgb(|Vec2(x, y)| <(f32, f32, f32)>::from(picture.pixels[y * width + x]));
    let mut attributes = LayerAttributes::default();
    let [left, top, ..] = origin.crop.map(|at| at as i32);
    attributes.layer_position = Vec2(left, top);
    // Any bytes may stand in an attribute's text: these are UTF-8.
    let text = Text::from_slice_unchecked(origin.to_string().as_bytes());
    attributes.other.insert(Text::new_or_panic(EXR_ATTRIBUTE), AttributeValue::Text(text));
    let layer = Layer::new((width, height), attributes, exr::image::Encoding::FAST_LOSSLESS, channels);
    let mut image = Image::from_layer(layer);
    let [width, height] = origin.whole.map(|side| side as usize);
    image.attributes.display_window = IntegerBounds::new((0, 0), (width, height));
    let mut file = Cursor::new(Vec::new());
    image.write().to_buffered(&mut file)?;
    Ok(file.into_inner())
}

/// Reads a tile of a PNG file: 8-bit sRGB.
///
/// # Errors
/// No such file, one of another kind, no tile, or one that another program has cut; the message names it.
pub fn read_png(path: &Path) -> Result<Tile<[u8; 3]>, Failure> {
    let read = png_pixels(open(path)?);
    let (text, SrgbImage { size, pixels }) = read.map_err(|error| damaged(path, "PNG", &error))?;
    tile(path, text, size, pixels)
}

/// Reads a tile of an EXR file: linear.
///
/// # Errors
/// As of [`read_png`].
pub fn read_exr(path: &Path) -> Result<Tile<[f32; 3]>, Failure> {
    let read = exr_pixels(open(path)?);
    let (text, Picture { size, pixels }) = read.map_err(|error| damaged(path, "EXR", &error))?;
    tile(path, text, size, pixels)
}

fn open(path: &Path) -> Result<BufReader<File>, Failure> {
    let failed = |error| Failure::Other(format!("cannot read {}: {error}", path.display()));
    File::open(path).map(BufReader::new).map_err(failed)
}

fn damaged(path: &Path, kind: &str, error: &dyn Display) -> Failure {
    Failure::Other(format!("{} is no whole {kind} file: {error}; render it again", path.display()))
}

fn tile<P>(path: &Path, text: Option<String>, size: [u32; 2], pixels: Vec<P>) -> Result<Tile<P>, Failure> {
    let name = path.display();
    let origin = text.as_deref().and_then(Origin::read).ok_or_else(|| {
        Failure::Other(format!(
            "{name} is no tile; `realistic render --crop X0,Y0,X1,Y1 --out FILE` writes tiles"
        ))
    })?;
    if origin.size() != size {
        let ([width, height], [crop_width, crop_height]) = (size, origin.size());
        return Err(Failure::Other(format!(
            "{name} was a tile of {crop_width} x {crop_height} pixels and has {width} x {height} now: another program \
             has changed it; render it again"
        )));
    }
    Ok(Tile { path: path.to_owned(), origin, pixels })
}

fn png_pixels(file: BufReader<File>) -> Result<(Option<String>, SrgbImage), png::DecodingError> {
    let mut reader = png::Decoder::new(file).read_info()?;
    let unfit =
        || io::Error::new(io::ErrorKind::InvalidData, "its pixels are not of 8-bit red, green and blue");
    if reader.output_color_type() != (png::ColorType::Rgb, png::BitDepth::Eight) {
        return Err(unfit().into());
    }
    let mut bytes = vec![0; reader.output_buffer_size().ok_or_else(unfit)?];
    let frame = reader.next_frame(&mut bytes)?;
    let pixels = bytes.as_chunks::<3>().0.to_vec();
    let mut texts = reader.info().utf8_text.iter();
    let text = texts.find(|text| text.keyword == PNG_KEYWORD).and_then(|text| text.get_text().ok());
    Ok((text, SrgbImage { size: [frame.width, frame.height], pixels }))
}

fn exr_pixels(file: BufReader<File>) -> exr::error::Result<(Option<String>, Picture)> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Picture::plain([size.width(), size.height()].map(|side| side as u32), [0.0; 3]),
            |picture: &mut Picture, at, (r, g, b): (f32, f32, f32)| {
                let width = picture.size[0] as usize;
                picture.pixels[at.y() * width + at.x()] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(file)?;
    let attributes = &image.layer_data.attributes.other;
    let text = match attributes.get(&Text::new_or_panic(EXR_ATTRIBUTE)) {
        Some(AttributeValue::Text(text)) => String::from_utf8(text.as_slice().to_vec()).ok(),
        _ => None,
    };
    Ok((text, image.layer_data.channel_data.pixels))
}

#[cfg(test)]
mod tests {
    use super::Origin;

    #[test]
    fn a_place_is_read_where_it_lies_in_a_picture_of_a_size_that_there_is() {
        let origin =
            Origin { whole: [50, 34], crop: [25, 0, 50, 34], settings: vec![("a".into(), "b: c".into())] };
        assert_eq!(Origin::read(&origin.to_string()), Some(origin));
        for text in [
            "",
            "50,34",
            "50,34 0,0,0,34",
            "50,34 0,0,51,34",
            "50,34 0,9,5,9",
            "50,-34 0,0,5,5",
            "50,34 0,0,5,5\nno setting",
        ] {
            assert_eq!(Origin::read(text), None, "{text}");
        }
        // Room for all of it would not be had.
        assert_eq!(Origin::read("4000000000,4000000000 0,0,25,34"), None);
    }
}
