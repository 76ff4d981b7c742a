//! Which part of the picture a host renders: `crop` and the raster in, whole pixels out.
//!
//! It is for hosts alone. Film, plan, pupil and weights are those of the whole picture, and samples keep its raster
//! coordinates, so that a ray has the same bits whatever the crop.

use crate::{
    camera::{
        film::Raster,
        parameters::{ParameterError, Parameters},
    },
    message::as_given,
};

/// Pixels of a picture: columns from `from[0]` to before `to[0]`, rows from `from[1]` to before `to[1]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// The top left pixel: column and row, from 0.
    pub from: [u32; 2],
    /// The column to the right of the last, and the row below.
    pub to: [u32; 2],
}

impl Crop {
    /// The part that is asked for, or the whole raster.
    ///
    /// # Errors
    /// Not whole pixels, none of them, or some outside the raster.
    pub(crate) fn of(given: &Parameters, Raster { xres, yres }: Raster) -> Result<Self, ParameterError> {
        let Some(sides @ [x0, y0, x1, y1]) = given.crop else {
            return Ok(Self { from: [0; 2], to: [xres, yres] });
        };
        let are_pixels = sides.iter().all(|side| side.fract() == 0.0);
        let within = |from: f64, to: f64, most: u32| 0.0 <= from && from < to && to <= f64::from(most);
        if !are_pixels || !within(x0, x1, xres) || !within(y0, y1, yres) {
            return Err(ParameterError::Range {
                name: Parameters::row("crop").name,
                value: sides.map(as_given).join(","),
                range: format!(
                    "x from, y from, x to, y to in whole pixels of the {xres} x {yres} picture, with some width and \
                     height: 0 <= x from < x to <= {xres} and 0 <= y from < y to <= {yres}"
                ),
            });
        }
        let [x0, y0, x1, y1] = sides.map(|side| side as u32);
        Ok(Self { from: [x0, y0], to: [x1, y1] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RASTER: Raster = Raster { xres: 48, yres: 32 };

    fn crop(sides: [f64; 4]) -> Result<Crop, String> {
        let given = Parameters { crop: Some(sides), ..Parameters::default() };
        Crop::of(&given, RASTER).map_err(|error| error.to_string())
    }

    #[test]
    fn a_crop_is_whole_pixels_of_the_picture() {
        let whole = Crop { from: [0, 0], to: [48, 32] };
        assert_eq!(Crop::of(&Parameters::default(), RASTER), Ok(whole));
        assert_eq!(crop([0.0, -0.0, 48.0, 32.0]), Ok(whole));
        assert_eq!(crop([47.0, 3.0, 48.0, 4.0]), Ok(Crop { from: [47, 3], to: [48, 4] }));
        for bad in [
            [0.0, 0.0, 49.0, 32.0],
            [0.0, 0.0, 48.0, 33.0],
            [-1.0, 0.0, 48.0, 32.0],
            [0.0, -1.0, 48.0, 32.0],
            [5.0, 0.0, 5.0, 32.0],
            [0.0, 9.0, 48.0, 8.0],
            [0.5, 0.0, 48.0, 32.0],
            [0.0, 0.0, f64::INFINITY, 32.0],
            [0.0, f64::NAN, 48.0, 32.0],
            [0.0, 0.0, 1e300, 32.0],
        ] {
            let message = crop(bad).expect_err("no part of the picture");
            let given = bad.map(as_given).join(",");
            assert!(given.len() < 30, "{given}");
            for words in [&format!("\"crop\" is {given};"), "48 x 32", "y to <= 32"] {
                assert!(message.contains(words), "{bad:?}: {message}");
            }
        }
    }
}
