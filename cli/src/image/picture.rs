//! Pictures and their two file formats: PNG for viewing, EXR for numbers.

use super::srgb::{Colours, SrgbImage, decode, encode};
use crate::failure::Failure;
use crate::files;
use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage as _};
use std::fmt::Display;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// A picture in linear colour: rows from the top, each row from the left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// One colour per pixel.
    pub pixels: Vec<[f32; 3]>,
}

/// Largest width and largest height of a picture, pixels.
pub const LARGEST_SIDE: u32 = 16_384;

/// Checks that the memory for a picture of this size can be allocated, before work on it begins: a failed allocation
/// later would end the process.
///
/// # Errors
/// The memory is not available; the message states the size and the memory needed.
pub fn check_memory([width, height]: [u32; 2], bytes_per_pixel: u64) -> Result<(), Failure> {
    let bytes = (u64::from(width) * u64::from(height)).saturating_mul(bytes_per_pixel);
    let mut trial: Vec<u8> = Vec::new();
    let is_there = usize::try_from(bytes).is_ok_and(|bytes| trial.try_reserve_exact(bytes).is_ok());
    // The optimiser may remove an allocation that is never read.
    drop(std::hint::black_box(trial));
    if is_there {
        return Ok(());
    }
    Err(Failure::Other(format!(
        "a picture of {width} x {height} pixels takes {} MB of memory, and there is less; give a smaller --size",
        bytes.div_ceil(1_000_000)
    )))
}

/// The conversion from linear light to the value that a screen displays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// Factor, applied first.
    pub scale: f32,
    /// Curve for bright values, applied second.
    pub curve: Curve,
}

/// The tone curve below and above a screen's white, which is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// Clips above white.
    Straight,
    /// Compresses from [`KNEE`] on, so that no value reaches white: as on film, lamps keep their colour.
    Film,
}

/// Value at which the film's curve leaves the straight line.
const KNEE: f32 = 0.45;

impl Tone {
    /// No conversion, for values that are already the screen's.
    pub const SHOWN: Self = Self { scale: 1.0, curve: Curve::Straight };

    /// Returns the screen's value for a picture's value.
    pub fn shown(self, value: f32) -> f32 {
        let value = value * self.scale;
        match self.curve {
            Curve::Film if value > KNEE => {
                let over = (value - KNEE) / (1.0 - KNEE);
                KNEE + (1.0 - KNEE) * over / (1.0 + over)
            }
            _ => value,
        }
    }
}

/// The format of a picture file, known from the ending of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits per channel, sRGB, values above 1 clipped.
    Png,
    /// 32-bit floats, linear, unchanged.
    Exr,
}

impl Format {
    /// Returns the format for a path; standard output gets a PNG.
    ///
    /// # Errors
    /// The ending is neither .png nor .exr; the message states both.
    pub fn of(path: &Path) -> Result<Self, String> {
        if files::is_stdout(path) {
            return Ok(Self::Png);
        }
        let ending = path.extension().and_then(|ending| ending.to_str());
        match ending.map(str::to_ascii_lowercase).as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(format!("\"{}\" must end in .png (8-bit sRGB) or .exr (linear floats)", path.display())),
        }
    }
}

/// Parses a path with the ending of a picture format.
///
/// # Errors
/// The ending is neither of the two formats.
pub fn picture_path(text: &str) -> Result<PathBuf, String> {
    Format::of(Path::new(text)).map(|_| PathBuf::from(text))
}

impl From<&SrgbImage> for Picture {
    fn from(image: &SrgbImage) -> Self {
        Self { size: image.size, pixels: image.pixels.iter().map(|colour| colour.map(decode)).collect() }
    }
}

impl Picture {
    /// Makes a picture of one colour.
    pub fn plain(size: [u32; 2], colour: [f32; 3]) -> Self {
        Self { size, pixels: vec![colour; size[0] as usize * size[1] as usize] }
    }

    /// Copies another picture, which must fit, into this one with its top left corner at a pixel.
    pub fn paste(&mut self, other: &Self, [left, top]: [u32; 2]) {
        let [width, length] = [self.size[0] as usize, other.size[0] as usize];
        for (y, row) in other.pixels.chunks_exact(length.max(1)).enumerate() {
            let start = (top as usize + y) * width + left as usize;
            self.pixels[start..start + length].copy_from_slice(row);
        }
    }

    /// Adds another picture of the same size.
    pub fn add(&mut self, other: &Self) {
        for (sum, value) in self.pixels.as_flattened_mut().iter_mut().zip(other.pixels.as_flattened()) {
            *sum += value;
        }
    }

    /// Returns the picture at another width, with the same height: linear between the pixels of a row, and for a narrower
    /// picture a mean of them with weights that fall linearly from a pixel's middle to the next ones'.
    pub fn at_width(&self, width: u32) -> Self {
        let step = self.size[0] as f32 / width as f32;
        let reach = step.max(1.0);
        let last = self.size[0] as i64 - 1;
        let mut pixels = Vec::with_capacity(width as usize * self.size[1] as usize);
        for row in self.pixels.chunks_exact(self.size[0] as usize) {
            pixels.extend((0..width).map(|column| {
                let at = (column as f32 + 0.5) * step - 0.5;
                let (mut sum, mut whole) = ([0.0; 3], 0.0);
                for other in (at - reach).ceil() as i64..=(at + reach).floor() as i64 {
                    let weight = 1.0 - (other as f32 - at).abs() / reach;
                    let colour = row[other.clamp(0, last) as usize];
                    (sum, whole) = ([0, 1, 2].map(|i| sum[i] + weight * colour[i]), whole + weight);
                }
                sum.map(|part| part / whole)
            }));
        }
        Self { size: [width, self.size[1]], pixels }
    }

    /// Writes the file. For PNG only, `tone` converts the values to the screen's.
    ///
    /// # Errors
    /// The file cannot be written; the message names it.
    pub fn write(&self, path: &Path, tone: Tone) -> Result<(), Failure> {
        let failed = |error: &dyn Display| Failure::cannot_write(path, error);
        let bytes = match Format::of(path).map_err(Failure::Usage)? {
            Format::Png => self.shown(tone).png(Colours::All),
            Format::Exr => self.exr().map_err(|error| failed(&error))?,
        };
        files::save(path, &bytes).map_err(|error| failed(&error))
    }

    /// Encodes the picture as an EXR file.
    ///
    /// # Errors
    /// The encoder's error.
    pub fn exr(&self) -> exr::error::Result<Vec<u8>> {
        let [width, height] = self.size.map(|side| side as usize);
        let channels =
            SpecificChannels::rgb(|Vec2(x, y)| <(f32, f32, f32)>::from(self.pixels[y * width + x]));
        let mut file = Cursor::new(Vec::new());
        // One thread: several write the file's blocks in the order in which they come to be compressed, so that equal
        // pictures would not be equal bytes.
        Image::from_channels((width, height), channels).write().non_parallel().to_buffered(&mut file)?;
        Ok(file.into_inner())
    }

    /// Converts the picture to the screen's values.
    pub fn shown(&self, tone: Tone) -> SrgbImage {
        let encode = |colour: &[f32; 3]| colour.map(|value| encode(tone.shown(value)));
        SrgbImage { size: self.size, pixels: self.pixels.iter().map(encode).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    #[test]
    fn a_picture_without_room_is_an_error() {
        check_memory([480, 320], 80).unwrap();
        let Err(Failure::Other(message)) = check_memory([u32::MAX; 2], 80) else { panic!("no such memory") };
        assert!(
            message.contains("4294967295 x 4294967295 pixels takes") && message.contains("--size"),
            "{message}"
        );
    }

    fn sample() -> Picture {
        Picture {
            size: [3, 2],
            pixels: vec![
                [0.0, 0.5, 1.0],
                [2.0, -1.0, 0.25],
                [0.1, 0.2, 0.3],
                [1e-3, 0.0, 9.0],
                [0.7, 0.7, 0.7],
                [0.214, 0.0, 0.0],
            ],
        }
    }

    #[test]
    fn another_width_keeps_slopes_and_means() {
        let row = |values: &[f32]| Picture {
            size: [values.len() as u32, 2],
            pixels: values.repeat(2).into_iter().map(|value| [value, 2.0 * value, 1.0]).collect(),
        };
        let first =
            |picture: &Picture| -> Vec<f32> { picture.pixels.iter().map(|colour| colour[0]).collect() };
        let wide = row(&[0.0, 4.0, 8.0]).at_width(6);
        assert_eq!(wide.size, [6, 2]);
        assert_eq!(first(&wide), [0.0, 1.0, 3.0, 5.0, 7.0, 8.0].repeat(2));
        assert_eq!(wide.pixels[2], [3.0, 6.0, 1.0]);
        let narrow = row(&[0.0, 8.0, 0.0, 8.0, 0.0, 8.0, 0.0, 8.0]).at_width(4);
        assert_eq!(first(&narrow)[1..3], [4.0; 2]);
        assert_eq!(sample().at_width(3), sample());
    }

    #[test]
    fn png_comes_back() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.PNG");
        sample().write(&path, Tone { scale: 0.5, ..Tone::SHOWN }).unwrap();
        let file = std::io::BufReader::new(File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!([info.width, info.height], [3, 2]);
        assert_eq!(bytes[3..6], [255, 0, 99]);
        assert_eq!(bytes[11], 255);
        let expected: Vec<u8> = sample().pixels.as_flattened().iter().map(|v| encode(v * 0.5)).collect();
        assert_eq!(bytes, expected);
    }

    #[test]
    fn exr_keeps_the_values() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.exr");
        sample().write(&path, Tone { scale: 0.5, ..Tone::SHOWN }).unwrap();
        let read = exr::prelude::read_first_rgba_layer_from_file(
            &path,
            |size, _| vec![vec![[0.0_f32; 3]; size.width()]; size.height()],
            |rows, at, (r, g, b, _): (f32, f32, f32, f32)| rows[at.y()][at.x()] = [r, g, b],
        )
        .unwrap();
        assert_eq!(read.layer_data.channel_data.pixels.concat(), sample().pixels);
    }

    #[test]
    fn other_endings_are_refused_by_naming_the_two() {
        for path in ["a.jpg", "a", ".png"] {
            let message = Format::of(Path::new(path)).unwrap_err();
            assert!(message.contains(".png") && message.contains(".exr"), "{message}");
        }
    }
}
