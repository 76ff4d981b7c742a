//! The reasons why a parameter is refused and why a camera cannot be built.

use std::path::PathBuf;

use thiserror::Error;

use super::{named::Weighting, units::Units};
use crate::placement::transform::TransformError;
use realistic_base::message::{as_given, cut, short, short_above};
use realistic_optics::{
    imaging::{focus::FocusError, moving::MovingError, open::OpenError},
    lens::{Lens, LensError},
    prescription::SourceError,
};

/// A name that is not in the list of choices.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("\"{}\" is not {known}", cut(given))]
pub struct UnknownName {
    /// The name that was given.
    pub given: String,
    /// The known names, in quotes.
    pub known: String,
}

/// The reason why a parameter is refused. The text states the parameter, the value and the range.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ParameterError {
    /// No parameter has this name.
    #[error("no parameter is called \"{}\"; {known}", cut(name))]
    Unknown {
        /// The name that was given.
        name: String,
        /// The name that was probably meant, as a question, or the list of all known names.
        known: String,
    },
    /// The value is not of the parameter's kind.
    #[error("parameter \"{name}\" takes {expected}, not {given}")]
    Kind {
        /// The parameter.
        name: &'static str,
        /// The kind of value that the parameter accepts.
        expected: &'static str,
        /// The value that was given.
        given: String,
    },
    /// The value is of the right kind but outside the range.
    #[error("parameter \"{name}\" is {value}; it must be {range}")]
    Range {
        /// The parameter.
        name: &'static str,
        /// The value given.
        value: String,
        /// The valid range in words, with the unit.
        range: String,
    },
    /// Two names of one parameter were given together.
    #[error("\"{first}\" and \"{second}\" say the same thing in two ways; give one of them")]
    Both {
        /// The first name.
        first: &'static str,
        /// The second name.
        second: &'static str,
    },
}

impl ParameterError {
    /// Returns the error of a number outside its range; `range` describes the range in words.
    pub fn out_of_range(name: &'static str, value: f64, range: &str) -> Self {
        Self::Range { name, value: as_given(value), range: range.to_owned() }
    }

    /// Returns the error of a name that is not in the list of choices of parameter `name`.
    pub(super) fn unknown(name: &'static str, UnknownName { given, known }: UnknownName) -> Self {
        Self::Range { name, value: format!("\"{}\"", cut(&given)), range: known }
    }
}

/// The reason why a camera cannot be built. The text says what to change.
#[derive(Debug, Error)]
pub enum CameraError {
    /// A parameter is wrong.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// No lens could be read.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The lens lacks a property that the camera needs.
    #[error(transparent)]
    Lens(#[from] LensError),
    /// The lens cannot focus at the requested distance.
    #[error(transparent)]
    Focus(#[from] FocusError),
    /// The groups of the lens cannot be placed as requested.
    #[error(transparent)]
    Moving(#[from] MovingError),
    /// The parameters request that the film moves and also that it stays in place.
    #[error(
        "\"film_distance\" moves the film, and \"focus_by\" \"group\" leaves it where the lens file has it; give \
         \"focus_distance\", or leave out \"focus_by\""
    )]
    FilmStays,
    /// A property of the blades was given, but there are no blades.
    #[error("\"{name}\" says what the stop's blades are like, and there are none; give \"blades\", how many")]
    NoBlades {
        /// The parameter.
        name: &'static str,
    },
    /// The lens has no stop for the shape of its opening.
    #[error("lens \"{lens}\" has no stop row for \"{name}\"; leave \"{name}\" out")]
    NoStopFor {
        /// The parameter.
        name: &'static str,
        /// The lens.
        lens: String,
    },
    /// A gain was given for a picture that is not.
    #[error("\"stop_picture_gain\" scales the \"stop_picture\", and none is given; give the picture's file")]
    GainWithoutPicture,
    /// The picture in the stop was not found or cannot be read.
    #[error("\"stop_picture\": {0}")]
    PictureFile(SourceError),
    /// The file is no picture for a stop.
    #[error("\"stop_picture\": \"{}\" {why}", path.display())]
    StopPicture {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// The coatings of the lens file were requested, but the lens file names none.
    #[error(
        "\"transmission\" is \"file\", and lens \"{lens}\" names no coatings; give it lines \"coating ROW NAME\", or another \
         \"transmission\", such as \"quarter-wave\""
    )]
    NoCoatings {
        /// The lens.
        lens: String,
    },
    /// Ghosts were requested on film that is tilted or curved.
    #[error(
        "\"ghosts\" are traced to flat film across the axis; leave out \"film_tilt_x\", \"film_tilt_y\" and \"film_curvature_radius\", or \"ghosts\""
    )]
    GhostsOnPosedFilm,
    /// Ghosts are requested of a lens that is not symmetric about an axis, or has mirrors.
    #[error(
        "\"ghosts\" are traced between surfaces that are symmetric about one axis and refract; lens \"{lens}\" has tilted, decentred \
         or cylindrical surfaces, or mirrors: leave \"ghosts\" out"
    )]
    GhostsOfGeneralLens {
        /// The lens.
        lens: String,
    },
    /// The film's corners lie beyond the sphere along which the film is curved.
    #[error(
        "\"film_curvature_radius\" is {} mm, and the film's corners lie {} mm from its centre; its magnitude must be more",
        as_given(*radius), short(*corner)
    )]
    FilmCurvature {
        /// The radius, mm.
        radius: f64,
        /// Half the film's diagonal, mm.
        corner: f64,
    },
    /// An exposure was given for weights that are not radiometric.
    #[error(
        "\"{name}\" scales radiometric weights, and \"weighting\" is \"{weighting}\"; leave one of them out"
    )]
    Exposure {
        /// The parameter.
        name: &'static str,
        /// The weighting that was requested.
        weighting: Weighting,
    },
    /// Ghosts were requested, but the surfaces reflect nothing.
    #[error(
        "\"ghosts\" is {}, and without \"transmission\" no surface reflects; give it, such as \"quarter-wave\" or \"bare\"",
        as_given(*share)
    )]
    NothingReflects {
        /// The share of the samples that was to follow ghost paths.
        share: f64,
    },
    /// The lens cannot focus so near; the distance may have been meant in other units.
    #[error("{error}; {}", units.of_focus(*given))]
    TooNear {
        /// The error that the lens returned.
        error: FocusError,
        /// The value of `focus_distance`.
        given: f64,
        /// The units of camera space and of the world.
        units: Units,
    },
    /// The lens cannot focus, and no film distance is given.
    #[error("{0}; \"film_distance\" puts the film behind it all the same")]
    NoFilmDistance(FocusError),
    /// The film would cut into the lens.
    #[error(
        "film distance {} mm: the film would touch the rear element, whose edge reaches \
         {} mm behind the last vertex; give a larger \"film_distance\"",
        short(*film_distance), short_above(*edge)
    )]
    FilmInLens {
        /// Film distance, mm.
        film_distance: f64,
        /// Distance by which the edge of the rear element's clear aperture lies behind the last vertex, mm.
        edge: f64,
    },
    /// The lens or the film reaches so far that the origins of rays do not fit in floats.
    #[error(
        "lens \"{lens}\" and film reach {} mm, {} units of camera space, and rays of that size are not representable; \
         check the units of the lens file, mm, its scale and \"mm_per_unit\"",
        short(*reach), short(*units)
    )]
    TooFar {
        /// The lens.
        lens: String,
        /// Largest distance of the lens or the film from the front vertex, mm.
        reach: f64,
        /// The distance in units of camera space.
        units: f64,
    },
    /// The requested weighting is undefined for this pupil, because the exit pupil is at infinity.
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
    /// The weight of a ray, or its factor, does not fit in a float.
    #[error(
        "a ray's weight would be made of {}, which is more than a float holds: the film is too large, too near or too far \
         for this lens; check \"film_diagonal\", \"film_distance\" and the units of the lens file, mm",
        short(*weight)
    )]
    Weight {
        /// The larger of a ray's weight and the factor of the weight.
        weight: f64,
    },
    /// The camera transform is not affine, or its motion is not defined.
    #[error("the camera transform {0}")]
    Transform(#[from] TransformError),
    /// The raster has no pixels.
    #[error("the image is {xres} x {yres} pixels; both must be 1 or more")]
    Raster {
        /// Number of pixel columns.
        xres: i32,
        /// Number of pixel rows.
        yres: i32,
    },
}

impl CameraError {
    /// Returns the error of film so near that it would touch the rear element.
    pub fn film_in_lens(lens: &Lens, film_distance: f64) -> Self {
        // The subtraction avoids `-0`: a plane reaches no farther than its vertex.
        let edge = 0.0 - lens.rear().sagitta_range()[0];
        Self::FilmInLens { film_distance, edge }
    }
}

impl From<OpenError> for CameraError {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::Source(error) => error.into(),
            OpenError::Lens(error) => error.into(),
            OpenError::Moving(error) => error.into(),
        }
    }
}
