//! The table of parameters, and the values that a caller gave.

use std::{
    iter,
    ops::Bound::{Excluded, Included},
};

use super::{
    error::ParameterError,
    named::{FocusBy, LensPlane, Pupil, Transmission, Weighting},
    range::{Interval, Range},
    value::{Kind, Setting, Value},
    zoom::Zoom,
};
use crate::{model::Model, placement::shutter::Shutter, plan::Precision, sampling::DiskMapping};
use realistic_base::message::nearest;
use realistic_optics::{lens::refraction::Refraction, prescription::glass::VALID_WAVELENGTHS};

/// One row of the parameter table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The name in every language.
    pub name: &'static str,
    /// Spellings of pbrt and of the course assignment, which scenes and `--param` accept, too.
    pub aliases: &'static [&'static str],
    /// The kind of value that the parameter accepts.
    pub kind: Kind,
    /// The unit of the numbers; empty for none.
    pub unit: &'static str,
    /// The values of that kind that the parameter accepts.
    pub range: Range,
    /// The default value, or words that state its origin; empty for none.
    pub default: &'static str,
    /// The models that use the parameter; other models warn that they do not.
    pub models: &'static [Model],
    /// The meaning of the parameter, in one sentence.
    pub help: &'static str,
}

impl Parameter {
    /// Returns the name, then the aliases.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + use<> {
        iter::once(self.name).chain(self.aliases.iter().copied())
    }

    /// Returns the meaning, the range with its unit, and the default in one line.
    pub fn description(&self) -> String {
        let mut text = self.help.to_owned();
        let range = self.range.in_words(self.unit);
        if !range.is_empty() {
            text += &format!(": {range}");
        }
        match self.default {
            "" => text,
            name if self.kind == Kind::Text => text + &format!("; default \"{name}\""),
            words => text + &format!("; default {words}"),
        }
    }

    /// Checks that a number is in the range.
    ///
    /// # Errors
    /// The number is out of range.
    pub fn check(&self, number: f64) -> Result<f64, ParameterError> {
        match &self.range {
            Range::Numbers(interval) if !interval.contains(number) => {
                Err(ParameterError::out_of_range(self.name, number, &self.range.in_words(self.unit)))
            }
            _ => Ok(number),
        }
    }

    /// Returns the default number.
    fn default_number(&self) -> f64 {
        self.default.parse().expect("a test reads every default that is a number")
    }
}

use Model::{Environment, Lens, Orthographic, Perspective, Thick, Thin};
const EVERY: &[Model] = &[Lens, Thick, Thin, Perspective, Orthographic, Environment];
const LENSES: &[Model] = &[Lens, Thick, Thin];
const TRACED: &[Model] = &[Lens];
const PERSPECTIVE: &[Model] = &[Perspective];
const THIN_LENSES: &[Model] = &[Perspective, Orthographic];
const SAMPLED: &[Model] = &[Lens, Thick, Thin, Perspective, Orthographic];

use Interval as I;
const POSITIVE: I = I::POSITIVE;
const NOT_NEGATIVE: I = I::new(Included(0.0), Excluded(f64::INFINITY));
const DISTANCE: I = I::new(Excluded(0.0), Included(f64::INFINITY));
const NEAR: I = NOT_NEGATIVE.single();
const FAR: I = I::between(0.0, f64::INFINITY).single();
const TIME: I = I::FINITE.single();
const WAVELENGTH: I = I::between(*VALID_WAVELENGTHS.start(), *VALID_WAVELENGTHS.end());
/// Ranges from the size of an electron to that of the known universe; beyond it, a ray's origin could leave
/// the range of floats.
const MM_PER_UNIT: I = I::between(1e-15, 1e30);
const PIXELS: I = NOT_NEGATIVE.where_zero_is("exact");
const LEAF_SHARE: I = I::new(Excluded(0.0), Included(0.5));
const SLIT_SHARE: I = I::new(Excluded(0.0), Included(1.0));
const ANGLE: I = I::new(Included(1e-4), Excluded(180.0)).single();
/// Largest coordinate of a screen window and largest lens radius; within these limits, products of floats
/// stay in range.
const LARGEST_SIDE: f64 = 1e15;
const SIDE: I = I::between(-LARGEST_SIDE, LARGEST_SIDE);
const ASPECT: I = I::between(1.0 / LARGEST_SIDE, LARGEST_SIDE);
const RADIUS: I = I::between(0.0, LARGEST_SIDE).where_zero_is("a pinhole");
const BLADES: I = I::between(0.0, 32.0).where_zero_is("a round stop");
const TURN: I = I::FINITE;
/// Larger offsets would leave the range of single precision when squared.
const OFFSET: I = I::between(-LARGEST_SIDE, LARGEST_SIDE);
const TILT: I = I::between(-80.0, 80.0);
const STOPS: I = I::between(-100.0, 100.0);
const SHARE: I = I::between(0.0, 1.0);
const ANY: I = I::between(f64::NEG_INFINITY, f64::INFINITY);

/// Generates the table, the structure of values and its accessors.
macro_rules! parameters {
    ({} $($field:ident $(or $($alias:literal)+)?: $type:tt $(in $range:ident)?, $unit:tt, $how:tt $default:literal, $models:ident, $help:literal;)*) => {
        /// Every parameter, in the order in which help texts list them.
        pub const PARAMETERS: &[Parameter] = &[$(Parameter {
            name: stringify!($field),
            aliases: &[$($($alias),+)?],
            kind: <$type as Setting>::KIND,
            unit: $unit,
            range: parameters!(@range $type $($range)?),
            default: $default,
            models: $models,
            help: $help,
        },)*];

        /// The values that a caller gave; `None` means the default. They are checked when a camera is built.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Parameters {
            $(#[doc = $help] pub $field: Option<$type>,)*
            /// The aliases under which parameters were given.
            #[doc(hidden)]
            pub by_alias: Vec<&'static str>,
        }

        impl Parameters {
            $(parameters!(@read $how $field $type $($range)?);)*

            fn store(&mut self, name: &'static str, value: Value<'_>) -> Result<(), ParameterError> {
                match name {
                    $(stringify!($field) => self.$field = Some(Setting::of(name, value)?),)*
                    _ => unreachable!("the name comes from the table"),
                }
                Ok(())
            }

            fn is_set(&self, name: &str) -> bool {
                match name {
                    $(stringify!($field) => self.$field.is_some(),)*
                    _ => false,
                }
            }
        }
    };
    (@range $type:tt) => { <$type as Setting>::RANGE };
    (@range $type:tt $interval:ident) => { Range::Numbers($interval) };

    (@read = $field:ident f64 $interval:ident) => {
        /// Returns the checked number, or the default.
        pub fn $field(&self) -> Result<f64, ParameterError> {
            let row = Self::row(stringify!($field));
            self.$field.map_or_else(|| Ok(row.default_number()), |number| row.check(number))
        }
    };
    (@read or $field:ident f64 $interval:ident) => {
        /// Returns the checked number, if one is given.
        pub fn $field(&self) -> Result<Option<f64>, ParameterError> {
            self.$field.map(|number| Self::row(stringify!($field)).check(number)).transpose()
        }
    };
    (@read = $field:ident $choice:ident) => {
        /// Returns the choice, or the default.
        pub fn $field(&self) -> $choice {
            self.$field.unwrap_or_default()
        }
    };
    (@read or $($other:tt)*) => {};
}

/// A precision, or `None` for "auto".
pub type RequestedPrecision = Option<Precision>;

/// Calls `$make` with `$first` and the rows of the table. The rows generate the table itself and the
/// structure of values (here), the methods of the builder (`camera/builder.rs`), and the C options
/// (`abi/options.rs`). A test generates from them the options in the header, the Python package's types and
/// the table of docs/parameters.md.
///
/// A row consists of the name, optionally with aliases; the type, optionally with an interval; the unit; `=`
/// and a default of that type, or `or` and words that state where the value comes from; the models; and the
/// help. The C options follow the order of the rows, so once a version is released, new rows go to the end.
#[doc(hidden)]
#[macro_export]
macro_rules! for_each_parameter {
    ($make:ident { $($first:tt)* }) => {
        $make! {
            { $($first)* }
            model: Model, "", = "lens", EVERY, "kind of camera";
            lens_file or "lensfile" "specfile": String, "", or "dgauss.50mm", LENSES, "lens file, or a catalogue name such as \"wide.22mm\" or \"wide.22mm@35mm\"";
            glass_catalog or "glasscatalog": String, "", or "", LENSES, "glass catalogue (AGF) to search first for the glasses of a lens file, before the catalogues beside the file and the built-in glasses";
            strict: bool, "", or "false", LENSES, "whether to refuse a lens file of which a statement is replaced or left out that may change the picture";
            film_distance or "filmdistance": f64 in POSITIVE, "mm", or "the lens file's, or focused at `focus_distance`", LENSES, "distance from the last vertex to the film";
            focus_distance or "focusdistance": f64 in DISTANCE, "units of camera space", or "infinity", LENSES, "distance from the film plane to the plane in focus, or inf, instead of `film_distance`";
            focus_by or "focusby": FocusBy, "", = "film", LENSES, "part that moves to focus, the film or groups of the lens; the groups leave the film where the lens file has it";
            zoom: Zoom, "", or "", LENSES, "focal length of a zoom lens in mm, or the name of one of its positions; without it the lens file's first position";
            aperture_diameter or "aperturediameter": f64 in POSITIVE, "mm", or "the file's", LENSES, "clear diameter of the stop";
            fnumber: f64 in POSITIVE, "", or "", LENSES, "focal length over the diameter of the axial beam, instead of `aperture_diameter`";
            blades: f64 in BLADES, "", or "the lens file's, or 0", TRACED, "number of blades of the stop, 3 or more; their corners lie on the circle of its clear diameter";
            blade_rotation or "bladerotation": f64 in TURN, "degrees", or "the lens file's, or 0", TRACED, "angle of the blades' first corner, from image right toward image up";
            blade_curvature or "bladecurvature": f64 in SHARE, "", or "the lens file's, or 0", TRACED, "curvature of the blades' edges relative to that of the circle: 0 is straight, 1 the circle";
            stop_picture or "stoppicture": String, "", or "", TRACED, "PNG or EXR picture of the stop's transmission, centred on the axis and as wide as the stop; 8-bit values are sRGB, all others linear";
            stop_picture_gain or "stoppicturegain": bool, "", or "false", TRACED, "whether the picture's mean transmission over the stop is scaled to 1";
            film_diagonal or "filmdiag" "filmdiagonal": f64 in POSITIVE, "mm", = "35", LENSES, "diagonal of the film";
            film_shift_x or "filmshiftx": f64 in OFFSET, "mm", = "0", LENSES, "shift of the film from the axis toward image right; the picture shows more of what lies on the left";
            film_shift_y or "filmshifty": f64 in OFFSET, "mm", = "0", LENSES, "shift of the film from the axis toward image up; the picture shows more of what lies below";
            film_tilt_x or "filmtiltx": f64 in TILT, "degrees", = "0", TRACED, "tilt of the film about its own x axis, after the shift; turns the film's normal from the axis toward image down";
            film_tilt_y or "filmtilty": f64 in TILT, "degrees", = "0", TRACED, "tilt of the film about its own y axis, after that about x; turns the film's normal from the axis toward image right";
            film_curvature_radius or "filmcurvatureradius": f64 in ANY, "mm", or "flat", TRACED, "radius of a film that is curved like a sphere, positive with the centre behind the film; the raster is projected along the film's axis";
            hither: f64 in NEAR, "units of camera space", = "1e-3", EVERY, "distance along a ray at which it begins";
            yon: f64 in FAR, "units of camera space", = "1e30", EVERY, "distance along a ray at which it ends, beyond `hither`";
            shutter_open or "shutteropen": f64 in TIME, "", = "0", EVERY, "time at which the shutter opens";
            shutter_close or "shutterclose": f64 in TIME, "", = "1", EVERY, "time at which the shutter closes; before `shutter_open`, time runs backward, as in pbrt";
            weighting: Weighting, "", or "radiometric", LENSES, "definition of a ray's weight";
            simple_weighting or "simpleweighting": bool, "", or "", LENSES, "pbrt-v3's name for `weighting`, true for \"relative\" and false for \"radiometric\"";
            iso: f64 in POSITIVE, "", or "100, if another of the exposure is given", LENSES, "sensitivity of the film, a factor of iso/100 of radiometric weights";
            exposure_time or "exposuretime": f64 in POSITIVE, "s", or "1, if another of the exposure is given", LENSES, "time for which the film is exposed, a factor of radiometric weights; does not depend on the shutter's times";
            exposure: f64 in STOPS, "stops", or "0, if another of the exposure is given", LENSES, "exposure compensation, a factor of 2 to this power of radiometric weights";
            responsivity: f64 in POSITIVE, "", or "1, if another of the exposure is given", LENSES, "response of the film to light, a factor of radiometric weights";
            transmission: Transmission, "", = "none", TRACED, "transmission of the surfaces, as a factor of every weight: 1, or that of surfaces without a coating, with one, two or three layers for 550 nm between air and glass, or with the coatings that the lens file names";
            ghosts: f64 in SHARE, "of the samples", = "0", TRACED, "share of the lens samples for paths with two reflections, whose strength follows from `transmission`; 1 for the light of those paths alone";
            pupil: Pupil, "", = "warped", TRACED, "region of the lens samples, the true pupil of each film point, the rear element's disk, or the thick-lens exit pupil";
            disk: DiskMapping, "", = "concentric", SAMPLED, "mapping of lens samples to the disk";
            refraction: Refraction, "", = "fused", TRACED, "method of refraction";
            wavelength: f64 in WAVELENGTH, "nm", or "the lens file's, or 587.56", LENSES, "wavelength of the rays, for lenses with V-numbers or dispersion formulas; below 300 only with glasses whose data reach there";
            mm_per_unit or "mmperunit": f64 in MM_PER_UNIT, "mm", = "1", LENSES, "length of a unit of camera space; world units have the same length unless the camera transform scales";
            precision: RequestedPrecision, "", = "auto", TRACED, "precision of the trace; \"auto\" is double, or what `tolerance` allows";
            tolerance: f64 in PIXELS, "pixels", = "0", TRACED, "largest error of 99.9 % of the rays, which allows a faster model of the lens";
            shutter: Shutter, "", = "global", EVERY, "type of shutter";
            shutter_ramp or "shutterramp": f64 in LEAF_SHARE, "of the interval", or "0.25", EVERY, "share of the shutter's interval in which a leaf shutter opens, and in which it closes";
            shutter_slit or "shutterslit": f64 in SLIT_SHARE, "of the interval", or "0.25", EVERY, "share of the shutter's interval for which a focal-plane shutter exposes each row";
            crop: [f64; 4] in NOT_NEGATIVE, "pixels", or "the whole picture", EVERY, "part of the picture that the host renders, which changes no ray: x from, y from, x to, y to in whole pixels, the last two one past the last pixel";
            fov: f64 in ANGLE, "degrees", = "90", PERSPECTIVE, "angle across the shorter side of the image";
            screen_window or "screenwindow": [f64; 4] in SIDE, "", or "by the aspect ratio", THIN_LENSES, "part of the screen that becomes the image: x from, x to, y from, y to";
            frame_aspect_ratio or "frameaspectratio": f64 in ASPECT, "", or "the image's", THIN_LENSES, "width over height of the screen window";
            lens_radius or "lensradius": f64 in RADIUS, "units of camera space", = "0", THIN_LENSES, "radius of the projection's thin lens";
            focal_distance or "focaldistance": f64 in ANY, "units of camera space", = "1e30", THIN_LENSES, "distance from the eye to the plane of focus, beyond `hither`, of a lens of `lens_radius`";
            lens_plane or "lensplane": LensPlane, "", = "eye", THIN_LENSES, "plane of the projection's thin lens, the eye's as in pbrt 1.05, or the near plane as in older versions and on the lecture's slide";
        }
    };
}
for_each_parameter! { parameters {} }

/// Words that other programs use, in lower case, and the parameters that they mean.
const OTHER_WORDS: [(&str, &str); 24] = [
    ("fstop", "fnumber"),
    ("fno", "fnumber"),
    ("aperture", "fnumber"),
    ("iris", "fnumber"),
    ("focus", "focus_distance"),
    ("focallength", "zoom"),
    ("focal", "zoom"),
    ("sensor", "film_diagonal"),
    ("sensorsize", "film_diagonal"),
    ("filmsize", "film_diagonal"),
    ("diagonal", "film_diagonal"),
    ("format", "film_diagonal"),
    ("units", "mm_per_unit"),
    ("scale", "mm_per_unit"),
    ("near", "hither"),
    ("far", "yon"),
    ("clipstart", "hither"),
    ("clipend", "yon"),
    ("fieldofview", "fov"),
    ("coating", "transmission"),
    ("coatings", "transmission"),
    ("lambda", "wavelength"),
    ("colour", "wavelength"),
    ("bokeh", "blades"),
];

impl Parameters {
    /// Returns the table's row for a name or an alias.
    pub fn find(name: &str) -> Option<&'static Parameter> {
        PARAMETERS.iter().find(|row| row.names().any(|own| own == name))
    }

    /// Returns the row of a name that is in the table.
    pub fn row(name: &str) -> &'static Parameter {
        Self::find(name).expect("the name comes from the table")
    }

    /// Returns the rows of the parameters that the caller gave.
    pub fn given(&self) -> impl Iterator<Item = &'static Parameter> {
        PARAMETERS.iter().filter(|row| self.is_set(row.name))
    }

    /// Returns the weighting, which has two parameter names, or the default.
    ///
    /// # Errors
    /// Both names are given.
    pub fn weighting(&self) -> Result<Weighting, ParameterError> {
        match (self.weighting, self.simple_weighting) {
            (Some(_), Some(_)) => {
                Err(ParameterError::Both { first: "weighting", second: "simple_weighting" })
            }
            (None, Some(true)) => Ok(Weighting::Relative),
            (weighting, _) => Ok(weighting.unwrap_or_default()),
        }
    }

    /// Checks that the camera's model is a real lens.
    ///
    /// # Errors
    /// The camera has another model.
    pub fn require_lens(&self) -> Result<(), ParameterError> {
        match self.model() {
            Model::Lens => Ok(()),
            model => Err(ParameterError::Range {
                name: "model",
                value: format!("\"{model}\""),
                range: format!("\"{}\"", Model::Lens),
            }),
        }
    }

    /// Returns every name and alias.
    fn names() -> impl Iterator<Item = &'static str> {
        PARAMETERS.iter().flat_map(Parameter::names)
    }

    /// Returns the known name that an unknown one probably means: a name with the same letters, the name for
    /// another program's word, or a name with a similar spelling.
    pub fn nearest(name: &str) -> Option<&'static str> {
        let letters = name.replace(['-', '_', ' '], "").to_ascii_lowercase();
        let is_same = |own: &&str| own.replace('_', "") == letters;
        let of_others = || OTHER_WORDS.iter().find(|(word, _)| *word == letters).map(|(_, own)| *own);
        let spelling =
            Self::names().find(is_same).or_else(of_others).or_else(|| nearest(name, Self::names()));
        spelling.and_then(Self::find).map(|row| row.name)
    }

    /// Returns the error of an unknown name.
    pub fn unknown(name: &str) -> ParameterError {
        let known = match Self::nearest(name) {
            Some(own) => format!("did you mean \"{own}\"?"),
            None => {
                let names: Vec<&str> = PARAMETERS.iter().map(|row| row.name).collect();
                format!("the names are {}", names.join(", "))
            }
        };
        ParameterError::Unknown { name: name.to_owned(), known }
    }

    /// Sets one parameter by name or alias.
    ///
    /// # Errors
    /// The name is unknown; the value is of another kind, NaN or an unknown name; or the parameter was
    /// already given under its other name. If a parameter is given again under the same name, the last value
    /// wins.
    pub fn set(&mut self, name: &str, value: Value<'_>) -> Result<(), ParameterError> {
        let row = Self::find(name).ok_or_else(|| Self::unknown(name))?;
        let second = row.names().find(|own| *own == name).expect("a name of this row");
        let first = row.aliases.iter().find(|alias| self.by_alias.contains(alias)).unwrap_or(&row.name);
        if self.is_set(row.name) && *first != second {
            return Err(ParameterError::Both { first, second });
        }
        if value.has_nan() {
            return Err(ParameterError::Range {
                name: row.name,
                value: "not a number".to_owned(),
                range: "a number".to_owned(),
            });
        }
        self.store(row.name, value)?;
        if second != row.name && *first != second {
            self.by_alias.push(second);
        }
        Ok(())
    }

    /// Sets one parameter from text, as in `--param name=value`.
    ///
    /// # Errors
    /// The errors of [`Parameters::set`]; also if the text is not a value of the parameter's kind.
    pub fn set_from_text(&mut self, name: &str, text: &str) -> Result<(), ParameterError> {
        let kind = Self::find(name).map_or(Kind::Text, |row| row.kind);
        self.set(name, Value::from_text(kind, text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::value::Written;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn an_unknown_name_is_answered_by_letters_and_by_meaning() {
        for (given, own) in [
            ("Film_Distance", "film_distance"),
            ("aperture-diameter", "aperture_diameter"),
            ("f-stop", "fnumber"),
            ("sensor_size", "film_diagonal"),
            ("fokusdistance", "focus_distance"),
        ] {
            assert_eq!(Parameters::nearest(given), Some(own), "{given}");
        }
        assert_eq!(Parameters::nearest("saturation"), None);
        for (word, own) in OTHER_WORDS {
            assert!(Parameters::find(own).is_some() && Parameters::find(word).is_none(), "{word}");
        }
    }

    #[test]
    fn every_default_is_a_value_that_the_parameter_takes() {
        let unset = Parameters::default();
        assert_eq!(unset.given().count(), 0);
        for row in PARAMETERS {
            let mut given = Parameters::default();
            let is_number = row.default.parse::<f64>().is_ok();
            if is_number || row.kind == Kind::Text && !row.default.is_empty() {
                given.set_from_text(row.name, row.default).expect("the default");
                assert_eq!(given.given().map(|row| row.name).collect::<Vec<_>>(), [row.name]);
            }
            if is_number {
                let number = row.default.parse().expect("a number");
                assert_eq!(row.check(number), Ok(number), "{}", row.name);
            }
        }
        let numbers = [
            unset.film_diagonal(),
            unset.hither(),
            unset.yon(),
            unset.shutter_open(),
            unset.shutter_close(),
            unset.mm_per_unit(),
            unset.tolerance(),
            unset.fov(),
            unset.lens_radius(),
            unset.focal_distance(),
        ];
        let expected = [35.0, 1e-3, 1e30, 0.0, 1.0, 1.0, 0.0, 90.0, 0.0, 1e30];
        assert_eq!(numbers.map(|number| number.expect("in range")), expected);
        assert_eq!((unset.model(), unset.pupil(), unset.precision()), (Model::Lens, Pupil::Warped, None));
    }

    #[test]
    fn a_name_that_is_not_given_is_the_default_of_the_table() {
        let unset = Parameters::default();
        let names = [
            ("model", unset.model().to_string()),
            ("lens_file", catalogue::DEFAULT.to_owned()),
            ("focus_by", unset.focus_by().to_string()),
            ("weighting", unset.weighting().expect("one name").to_string()),
            ("transmission", unset.transmission().to_string()),
            ("pupil", unset.pupil().to_string()),
            ("disk", unset.disk().to_string()),
            ("refraction", crate::parameters::Written::written(&unset.refraction())),
            ("precision", unset.precision().written()),
            ("shutter", unset.shutter().to_string()),
            ("lens_plane", unset.lens_plane().to_string()),
        ];
        for (name, counts) in &names {
            assert_eq!(Parameters::row(name).default, counts, "{name}");
        }
        let rows = PARAMETERS.iter().filter(|row| row.kind == Kind::Text && !row.default.is_empty());
        assert!(rows.map(|row| row.name).eq(names.iter().map(|(name, _)| *name)));
        assert_eq!(catalogue::names().next(), Some(catalogue::DEFAULT));
    }

    #[test]
    fn names_and_aliases_are_each_one_parameters() {
        let names: Vec<&str> = Parameters::names().collect();
        for (i, name) in names.iter().enumerate() {
            assert!(!names[..i].contains(name), "{name}");
        }
        for row in PARAMETERS {
            // pbrt's style has no underscores, and neither have existing scenes.
            let plain = row.name.replace('_', "");
            assert!(row.names().all(|name| Parameters::find(name) == Some(row)));
            assert!(plain == row.name || row.aliases.contains(&plain.as_str()), "{}", row.name);
        }
    }
}
