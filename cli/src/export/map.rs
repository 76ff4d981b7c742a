//! Values per pixel: ST maps and fields of rays, and their files.

use super::field::ChiefField;
use super::model::PLANE_REACH;
use crate::failure::Failure;
use crate::files;
use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, WritableImage as _};
use rayon::prelude::*;
use std::io::Cursor;
use std::path::Path;

/// Values of every pixel as floats, in rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Width and height.
    pub size: [u32; 2],
    /// Names of a pixel's values.
    pub channels: Vec<&'static str>,
    /// Values, with those of one pixel next to each other.
    pub values: Vec<f32>,
}

impl Map {
    /// Makes a map from a function of the pixel centre's position relative to the film's centre, to the right and down,
    /// pixels.
    pub fn new<const N: usize>(
        size: [u32; 2],
        channels: [&'static str; N],
        at: impl Fn([f64; 2]) -> [f64; N] + Sync,
    ) -> Self {
        let [width, height] = size;
        let row = |y: u32| {
            let centre = |i: u32, side: u32| f64::from(i) + 0.5 - 0.5 * f64::from(side);
            (0..width)
                .flat_map(|x| at([centre(x, width), centre(y, height)]))
                .map(|value| value as f32)
                .collect()
        };
        let rows: Vec<Vec<f32>> = (0..height).into_par_iter().map(row).collect();
        Self { size, channels: channels.to_vec(), values: rows.concat() }
    }

    /// Writes the map in the format of the file's ending: .exr with 32-bit floats, or .npy, an array with the axes
    /// height, width and channel.
    ///
    /// # Errors
    /// The file cannot be written; the message names it.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        let bytes = if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npy")) {
            self.npy()
        } else {
            self.exr().map_err(|error| Failure::cannot_write(path, &error))?
        };
        files::save(path, &bytes).map_err(|error| Failure::cannot_write(path, &error))
    }

    fn exr(&self) -> exr::error::Result<Vec<u8>> {
        let [width, height] = self.size.map(|side| side as usize);
        let count = self.channels.len();
        let channel = |(i, name): (usize, &&str)| {
            let values = self.values.iter().skip(i).step_by(count).copied().collect();
            AnyChannel::new(*name, FlatSamples::F32(values))
        };
        let channels = AnyChannels::sort(self.channels.iter().enumerate().map(channel).collect());
        let mut file = Cursor::new(Vec::new());
        Image::from_encoded_channels((width, height), Encoding::FAST_LOSSLESS, channels)
            .write()
            .non_parallel()
            .to_buffered(&mut file)?;
        Ok(file.into_inner())
    }

    /// Formats the map as `NumPy`'s format, version 1.0.
    fn npy(&self) -> Vec<u8> {
        let [width, height] = self.size;
        let count = self.channels.len();
        let mut header =
            format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}, {count}), }}");
        // The data start at a multiple of 64 bytes.
        let padding = 63 - (10 + header.len()) % 64;
        header.push_str(&" ".repeat(padding));
        header.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(self.values.iter().flat_map(|value| value.to_le_bytes()));
        bytes
    }
}

/// Number of entries in the table of the inverse distortion.
const ENTRIES: usize = 4096;

/// Returns the maps from the lens's picture to a pinhole's and back, for Nuke's `STMap`. Red and green are the
/// coordinates in the other picture, as fractions of its width from the left and of its height from the bottom. Blue
/// is 1 where these coordinates are valid. The first map makes the pinhole's picture from the lens's picture, and the
/// second map does the reverse.
///
/// The pinhole has the lens's image scale in the middle of the film, and the same film.
pub fn st_maps(field: &ChiefField) -> [Map; 2] {
    let held = field.within(PLANE_REACH);
    let scale = field.central_scale();
    let undistorted = held.odd(|ring| scale * ring.angle.tan());
    let most = undistorted.at(held.lit);
    let distorted = undistorted.inverse(ENTRIES);
    let size = field.film.size;
    let map = |other: &(dyn Fn(f64) -> Option<f64> + Sync)| {
        Map::new(size, ["R", "G", "B"], |[x, y]| {
            let radius = x.hypot(y);
            let Some(found) = other(radius) else { return [-1.0, -1.0, 0.0] };
            // A film may have a pixel exactly in its middle.
            let stretch = if radius > 0.0 { found / radius } else { 1.0 };
            let [width, height] = size.map(f64::from);
            [0.5 + stretch * x / width, 0.5 - stretch * y / height, 1.0]
        })
    };
    [
        map(&|radius| (radius <= most).then(|| distorted.at(radius))),
        map(&|radius| (radius <= held.lit).then(|| undistorted.at(radius))),
    ]
}

/// Returns the chief ray of every pixel: the point at which it leaves the front surface, mm, and its unit direction, in
/// lens space. All values are 0 where the film is dark.
pub fn rays(field: &ChiefField) -> Map {
    let [h, dh] = [field.odd(|ring| ring.origin[0]), field.odd(|ring| ring.direction[0])];
    let [z, dz] = [field.even(|ring| ring.origin[1]), field.even(|ring| ring.direction[1])];
    let names = ["origin.X", "origin.Y", "origin.Z", "direction.X", "direction.Y", "direction.Z"];
    Map::new(field.film.size, names, |[x, y]| {
        let radius = x.hypot(y);
        if radius > field.lit {
            return [0.0; 6];
        }
        // Lens space has y up.
        let [right, up] = if radius > 0.0 { [x / radius, -y / radius] } else { [0.0; 2] };
        let ([h, z], [dh, dz]) = ([h.at(radius), z.at(radius)], [dh.at(radius), dz.at(radius)]);
        let length = dh.hypot(dz);
        let [dh, dz] = [dh / length, dz / length];
        [h * right, h * up, z, dh * right, dh * up, dz]
    })
}
