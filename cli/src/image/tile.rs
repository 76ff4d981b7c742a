//! Tiles: parts of a picture, each with its position in the whole picture and a description of that picture, in both
//! file formats.
//!
//! Files of both formats hold a text, which [`Origin`] writes and reads. It ends in a checksum of the text and the
//! pixels, because EXR has no checksum of its own. For other programs, the position is also in the field that the
//! format provides: the data window and display window of an EXR file, or the oFFs chunk of a PNG file (PNG
//! extensions 1.6).

use super::picture::{Format, LARGEST_SIDE, Picture, Tone};
use super::srgb::Colours;
use crate::failure::Failure;
use crate::files;
use crc32fast::Hasher;
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use exr::prelude::{
    Image, Layer, LayerAttributes, ReadChannels as _, ReadLayers as _, SpecificChannels, WritableImage as _,
};
use std::cell::Cell;
use std::fmt::{self, Display};
use std::fs::File;
use std::io::{self, BufReader, Cursor};
use std::path::{Path, PathBuf};

/// The position of a tile and the description of its picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Width and height of the whole picture.
    pub whole: [u32; 2],
    /// Columns and rows of the tile: x from, y from, x to, y to.
    pub crop: [u32; 4],
    /// Subject and settings of the picture, as pairs of name and value; all tiles of one picture have the same ones.
    pub settings: Vec<(String, String)>,
}

/// A tile that was read.
pub struct Tile<P> {
    /// File of the tile.
    pub path: PathBuf,
    /// Position of the tile, and the description of its picture.
    pub origin: Origin,
    /// Pixels in rows from the top, each from the left.
    pub pixels: Vec<P>,
}

/// A value of a pixel, whose bytes go into the checksum.
pub trait Sample: Copy + Default {
    fn sum(self, sum: &mut Hasher);
}

impl Sample for u8 {
    fn sum(self, sum: &mut Hasher) {
        sum.update(&[self]);
    }
}

impl Sample for f32 {
    fn sum(self, sum: &mut Hasher) {
        sum.update(&self.to_bits().to_le_bytes());
    }
}

/// Names of PNG's text chunk and of EXR's attribute.
const PNG_KEYWORD: &str = "realistic tile";
const EXR_ATTRIBUTE: &str = "realisticTile";
/// Name of the checksum in the text.
const SUM: &str = "CRC-32";

impl Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([width, height], [x0, y0, x1, y1]) = (self.whole, self.crop);
        write!(f, "{width},{height} {x0},{y0},{x1},{y1}")?;
        self.settings.iter().try_for_each(|(name, value)| write!(f, "\n{name}: {value}"))
    }
}

impl Origin {
    /// Parses the text of a tile; `None` for any other text.
    fn read(text: &str) -> Option<Self> {
        fn numbers<const N: usize>(text: &str) -> Option<[u32; N]> {
            let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.parse().ok()).collect();
            numbers?.try_into().ok()
        }
        let (position, settings) = text.split_once('\n').unwrap_or((text, ""));
        let (whole, crop) = position.split_once(' ')?;
        let (whole @ [width, height], crop @ [x0, y0, x1, y1]) = (numbers(whole)?, numbers(crop)?);
        let is_inside = x0 < x1 && x1 <= width && y0 < y1 && y1 <= height;
        if !is_inside || width.max(height) > LARGEST_SIDE {
            return None;
        }
        let setting = |line: &str| line.split_once(": ").map(|(name, value)| (name.into(), value.into()));
        Some(Self { whole, crop, settings: settings.lines().map(setting).collect::<Option<_>>()? })
    }

    /// Returns the text of a tile with these pixels: the output of [`Display`], then a last line with the CRC-32 of
    /// that output and the pixels.
    fn with_sum<P: Sample>(&self, pixels: &[[P; 3]]) -> String {
        let text = self.to_string();
        let sum = checksum(&text, pixels);
        format!("{text}\n{SUM}: {sum:08x}")
    }

    /// Returns width and height of the tile.
    pub fn size(&self) -> [u32; 2] {
        let [x0, y0, x1, y1] = self.crop;
        [x1 - x0, y1 - y0]
    }
}

/// Returns the CRC-32 of a tile's text, without its last line, and of its pixels.
fn checksum<P: Sample>(text: &str, pixels: &[[P; 3]]) -> u32 {
    let mut sum = Hasher::new();
    sum.update(text.as_bytes());
    pixels.as_flattened().iter().for_each(|value| value.sum(&mut sum));
    sum.finalize()
}

/// Writes a picture as a tile. For PNG only, `tone` converts the values to the screen's.
///
/// # Errors
/// The file cannot be written; the message names it.
pub fn write(picture: &Picture, path: &Path, tone: Tone, origin: &Origin) -> Result<(), Failure> {
    let failed = |error: &dyn Display| Failure::cannot_write(path, error);
    let bytes = match Format::of(path).map_err(Failure::Usage)? {
        Format::Png => {
            let [left, top, ..] = origin.crop;
            let position = [left.to_be_bytes(), top.to_be_bytes()].concat();
            let shown = picture.shown(tone);
            let text = (PNG_KEYWORD, origin.with_sum(&shown.pixels));
            // The last byte selects the pixel as the unit.
            let position = (*b"oFFs", [&position[..], &[0]].concat());
            shown.png_with(Colours::All, Some(text), Some(position))
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
    // An attribute's text may hold any bytes; these are UTF-8.
    let text = Text::from_slice_unchecked(origin.with_sum(&picture.pixels).as_bytes());
    attributes.other.insert(Text::new_or_panic(EXR_ATTRIBUTE), AttributeValue::Text(text));
    let layer = Layer::new((width, height), attributes, exr::image::Encoding::FAST_LOSSLESS, channels);
    let mut image = Image::from_layer(layer);
    let [width, height] = origin.whole.map(|side| side as usize);
    image.attributes.display_window = IntegerBounds::new((0, 0), (width, height));
    let mut file = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut file)?;
    Ok(file.into_inner())
}

/// Reads a tile in 8-bit sRGB from a PNG file.
///
/// # Errors
/// No such file, a file of another kind, a picture that is not a tile, a tile cut by another program or damaged, or too
/// little memory; the message names the file.
pub fn read_png(path: &Path) -> Result<Tile<[u8; 3]>, Failure> {
    let damaged = |error: png::DecodingError| damaged(path, "PNG", &error);
    let mut reader = png::Decoder::new(open(path)?).read_info().map_err(damaged)?;
    let info = reader.info();
    let own = info.utf8_text.iter().find(|text| text.keyword == PNG_KEYWORD);
    let claim = Claim::read(path, own.and_then(text_of), [info.width, info.height])?;
    let mut pixels = claim.allocate::<u8>()?;
    let bytes = pixels.as_flattened_mut();
    if reader.output_buffer_size() != Some(bytes.len()) {
        let unfit = "its pixels are not of 8-bit red, green and blue";
        return Err(damaged(io::Error::new(io::ErrorKind::InvalidData, unfit).into()));
    }
    reader.next_frame(bytes).map_err(damaged)?;
    claim.tile(pixels)
}

/// Reads a tile in linear colour from an EXR file.
///
/// # Errors
/// As for [`read_png`].
pub fn read_exr(path: &Path) -> Result<Tile<[f32; 3]>, Failure> {
    let damaged = |error: exr::error::Error| damaged(path, "EXR", &error);
    // The header is checked first, because the reader would allocate memory for any claimed size.
    let meta = MetaData::read_from_buffered(open(path)?, false).map_err(damaged)?;
    let (text, Vec2(width, height)) = match &meta.headers[..] {
        [header] => {
            let text = match header.own_attributes.other.get(&Text::new_or_panic(EXR_ATTRIBUTE)) {
                Some(AttributeValue::Text(text)) => String::from_utf8(text.as_slice().to_vec()).ok(),
                _ => None,
            };
            (text, header.layer_size)
        }
        _ => (None, Vec2(0, 0)),
    };
    let claim = Claim::read(path, text, [width, height].map(|side| u32::try_from(side).unwrap_or(u32::MAX)))?;
    let allocate = Cell::new(claim.allocate()?);
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            move |_, _| allocate.take(),
            move |pixels: &mut Vec<[f32; 3]>, at, (r, g, b): (f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * width + at.x()) {
                    *pixel = [r, g, b];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(open(path)?)
        .map_err(damaged)?;
    claim.tile(image.layer_data.channel_data.pixels)
}

/// Largest size of the text of a tile after decompression, bytes.
const TEXT: usize = 1 << 20;

/// Returns the text of a PNG file's chunk; `None` if it is invalid or decompresses to more than [`TEXT`].
fn text_of(chunk: &png::text_metadata::ITXtChunk) -> Option<String> {
    let mut chunk = chunk.clone();
    chunk.decompress_text_with_limit(TEXT).ok()?;
    chunk.get_text().ok()
}

fn open(path: &Path) -> Result<BufReader<File>, Failure> {
    let failed = |error| Failure::Other(format!("cannot read {}: {error}", path.display()));
    files::open(path).map(BufReader::new).map_err(failed)
}

fn damaged(path: &Path, kind: &str, error: &dyn Display) -> Failure {
    Failure::Other(format!("{} is no whole {kind} file: {error}; render it again", path.display()))
}

/// The description in a file, before its pixels are read.
struct Claim<'a> {
    path: &'a Path,
    origin: Origin,
    /// The text without its checksum, and the checksum.
    text: String,
    sum: u32,
}

impl<'a> Claim<'a> {
    /// Parses the text of a file of this size.
    fn read(path: &'a Path, text: Option<String>, size: [u32; 2]) -> Result<Self, Failure> {
        let name = path.display();
        let parts = text.as_deref().and_then(|text| {
            let (text, last) = text.rsplit_once('\n')?;
            let sum = last.strip_prefix(SUM)?.strip_prefix(": ")?;
            Some((Origin::read(text)?, text.to_owned(), u32::from_str_radix(sum, 16).ok()?))
        });
        let (origin, text, sum) = parts.ok_or_else(|| {
            Failure::Other(format!(
                "{name} is no tile of this version; `realistic render --crop X0,Y0,X1,Y1 --out FILE` writes tiles"
            ))
        })?;
        if origin.size() != size {
            let ([width, height], [crop_width, crop_height]) = (size, origin.size());
            return Err(Failure::Other(format!(
                "{name} was a tile of {crop_width} x {crop_height} pixels and has {width} x {height} now: another \
                 program has changed it; render it again"
            )));
        }
        Ok(Self { path, origin, text, sum })
    }

    /// Allocates memory for the pixels.
    fn allocate<P: Sample>(&self) -> Result<Vec<[P; 3]>, Failure> {
        let size = self.origin.size();
        allocate(size).ok_or_else(|| {
            let ([width, height], name) = (size, self.path.display());
            Failure::Other(format!("there is no memory for the {width} x {height} pixels of {name}"))
        })
    }

    /// Returns the tile with its pixels, if their checksum is right.
    fn tile<P: Sample>(self, pixels: Vec<[P; 3]>) -> Result<Tile<[P; 3]>, Failure> {
        if checksum(&self.text, &pixels) != self.sum {
            return Err(Failure::Other(format!(
                "{} is not as it was written: its pixels and what it says of itself do not have its checksum; render it \
                 again",
                self.path.display()
            )));
        }
        Ok(Tile { path: self.path.to_owned(), origin: self.origin, pixels })
    }
}

/// Allocates memory for the pixels of a picture; `None` if there is too little.
pub fn allocate<P: Copy + Default>([width, height]: [u32; 2]) -> Option<Vec<P>> {
    let count = width as usize * height as usize;
    let mut pixels = Vec::new();
    pixels.try_reserve_exact(count).ok()?;
    pixels.resize(count, P::default());
    Some(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_unfolds_without_end_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("tile.png");
        // 64 MiB of one letter compress to some 64 kB.
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(png::ColorType::Rgb);
        let mut chunk = png::text_metadata::ITXtChunk::new(PNG_KEYWORD, "x".repeat(1 << 26));
        chunk.compressed = true;
        chunk.compress_text().unwrap();
        let mut writer = encoder.write_header().unwrap();
        writer.write_text_chunk(&chunk).unwrap();
        writer.write_image_data(&[0; 3]).unwrap();
        drop(writer);
        std::fs::write(&path, &bytes).unwrap();
        assert!(bytes.len() < 1 << 20, "{}", bytes.len());
        assert!(text_of(&chunk).is_none());
        assert!(format!("{:?}", read_png(&path).err().unwrap()).contains("is no tile of this version"));
        let small = png::text_metadata::ITXtChunk::new(PNG_KEYWORD, "a tile");
        assert_eq!(text_of(&small).as_deref(), Some("a tile"));
    }

    #[test]
    fn a_tiles_position_must_lie_in_its_picture() {
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
        // The picture would not fit into memory.
        assert_eq!(Origin::read("4000000000,4000000000 0,0,25,34"), None);
    }
    /// Writes a tile of noise to a file, and returns its bytes.
    fn noise(path: &Path) -> Vec<u8> {
        let value = |i: usize| (i as f32 * 0.618_034).fract();
        let pixels = (0..12 * 9).map(|i| [value(i), value(i + 1000), 40.0 * value(i + 2000)]).collect();
        let settings = vec![("lens".into(), "dgauss.50mm".into())];
        let origin = Origin { whole: [50, 34], crop: [25, 3, 37, 12], settings };
        write(&Picture { size: [12, 9], pixels }, path, Tone::SHOWN, &origin).unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn a_tile_with_a_changed_bit_is_as_it_was_or_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("tile.exr");
        let bytes = noise(&path);
        let whole = read_exr(&path).unwrap();
        let mut by_checksum = 0;
        for i in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[i] ^= 1 << (i % 8);
            std::fs::write(&path, changed).unwrap();
            match read_exr(&path) {
                Ok(tile) => assert!(tile.pixels == whole.pixels && tile.origin == whole.origin, "byte {i}"),
                Err(Failure::Other(why)) => by_checksum += usize::from(why.contains("checksum")),
                Err(other) => panic!("{other:?}"),
            }
        }
        // Pixels are most of the file.
        assert!(by_checksum > bytes.len() / 2, "{by_checksum} of {}", bytes.len());
    }
}
