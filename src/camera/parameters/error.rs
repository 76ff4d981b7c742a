//! Why a camera cannot be built.

use thiserror::Error;

use crate::camera::ParameterError;
use crate::{
    imaging::focus::FocusError,
    lens::LensError,
    message::{short, short_above},
    prescription::SourceError,
};

/// Why a camera cannot be built. The text says what to change.
#[derive(Debug, Error)]
pub enum CameraError {
    /// A parameter is wrong.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// No lens could be read.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The lens has no such property.
    #[error(transparent)]
    Lens(#[from] LensError),
    /// The lens cannot focus there.
    #[error(transparent)]
    Focus(#[from] FocusError),
    /// The lens cannot focus, and nobody says where the film is.
    #[error("{0}; \"filmdistance\" puts the film behind it all the same")]
    NoFilmDistance(FocusError),
    /// The film would cut into the lens.
    #[error(
        "film distance {} mm: the film would touch the rear element, whose rim reaches \
         {} mm behind the last vertex; give a larger \"filmdistance\"",
        short(*film_distance), short_above(*rim)
    )]
    FilmInLens {
        /// Film distance, mm.
        film_distance: f64,
        /// How far the rear rim lies behind the last vertex, mm.
        rim: f64,
    },
    /// A weight is asked for that does not exist for this pupil.
    #[error(
        "weighting \"assignment\" divides by the area of the exit pupil, which is at infinity; \
         give pupil \"rear\" or another weighting"
    )]
    PupilAtInfinity,
    /// No light reaches the centre of the film.
    #[error(
        "no light reaches the centre of the film through lens \"{lens}\"; weighting \"relative\" needs it"
    )]
    DarkAxis {
        /// The lens.
        lens: String,
    },
    /// The weight of a ray, or the factor that it is made with, is no float.
    #[error(
        "a ray's weight would be made of {}, which is more than a float holds: the film is too large, too near or too far \
         for this lens; check \"filmdiag\", \"filmdistance\" and the units of the lens file, mm",
        short(*weight)
    )]
    Weight {
        /// The larger of a ray's weight and of the factor it is made with.
        weight: f64,
    },
    /// The camera transform is no affine transform.
    #[error("the camera transform {0}")]
    Transform(&'static str),
    /// The raster has no pixels.
    #[error("the image is {xres} x {yres} pixels; both must be 1 or more")]
    Raster {
        /// Pixels across.
        xres: i32,
        /// Pixels down.
        yres: i32,
    },
}
