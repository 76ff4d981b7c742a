//! The parameters of a camera: one table of names, kinds, units and help that the
//! pbrt `ParamSet`, the C options and the command line all read, and the values given.

use thiserror::Error;

/// What a parameter's value is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One finite number.
    Float,
    /// One string.
    Text,
    /// `true` or `false`.
    Bool,
    /// Four numbers.
    Four,
}

/// One row of the parameter table.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// The name as pbrt's scene files, the C options and `--param` spell it.
    pub name: &'static str,
    /// A second name for the same thing, kept for files written for other hosts.
    pub alias: Option<&'static str>,
    /// What kind of value it takes.
    pub kind: Kind,
    /// Unit, default and meaning in one line.
    pub help: &'static str,
}

/// A value on its way into [`Parameters::set`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// For [`Kind::Float`].
    Float(f64),
    /// For [`Kind::Text`].
    Text(&'a str),
    /// For [`Kind::Bool`].
    Bool(bool),
    /// For [`Kind::Four`].
    Four([f64; 4]),
}

/// Why a parameter was refused. The text names the parameter, the value and the range.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ParameterError {
    /// No parameter has this name.
    #[error("no parameter is called \"{name}\"; the names are {names}")]
    Unknown {
        /// The name that was given.
        name: String,
        /// Every known name.
        names: String,
    },
    /// The value is of another kind.
    #[error("parameter \"{name}\" takes {expected}, not {given}")]
    Kind {
        /// The parameter.
        name: &'static str,
        /// What it takes.
        expected: &'static str,
        /// What was given.
        given: String,
    },
    /// The value is of the right kind and outside the range.
    #[error("parameter \"{name}\" is {value}; it must be {range}")]
    Range {
        /// The parameter.
        name: &'static str,
        /// The value given.
        value: String,
        /// The valid range in words, with the unit.
        range: String,
    },
    /// Two names for one thing were given together.
    #[error("\"{first}\" and \"{second}\" say the same thing in two ways; give one of them")]
    Both {
        /// One of the two.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
}

macro_rules! parameters {
    ($($(#[$doc:meta])* $field:ident: $kind:ident $(alias $alias:literal)?, $help:literal;)*) => {
        /// Every parameter, in the order in which help texts list them.
        pub const PARAMETERS: &[Parameter] = &[$(Parameter {
            name: stringify!($field),
            alias: parameters!(@alias $($alias)?),
            kind: Kind::$kind,
            help: $help,
        },)*];

        /// The values a caller gave. `None` keeps the default.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Parameters {
            $(#[doc = $help] pub $field: Option<parameters!(@type $kind)>,)*
            /// Parameters that were set by their alias.
            #[doc(hidden)]
            pub by_alias: Vec<&'static str>,
        }

        impl Parameters {
            fn store(&mut self, name: &'static str, value: Value<'_>) -> Result<(), ParameterError> {
                match name {
                    $(stringify!($field) => self.$field = Some(parameters!(@take $kind name value)),)*
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
    (@alias) => { None };
    (@alias $alias:literal) => { Some($alias) };
    (@type Float) => { f64 };
    (@type Text) => { String };
    (@type Bool) => { bool };
    (@type Four) => { [f64; 4] };
    (@take Float $name:ident $value:ident) => {
        match $value {
            Value::Float(number) => number,
            other => return Err(other.refused($name, "a number")),
        }
    };
    (@take Text $name:ident $value:ident) => {
        match $value {
            Value::Text(text) => text.to_owned(),
            other => return Err(other.refused($name, "a string")),
        }
    };
    (@take Bool $name:ident $value:ident) => {
        match $value {
            Value::Bool(truth) => truth,
            other => return Err(other.refused($name, "true or false")),
        }
    };
    (@take Four $name:ident $value:ident) => {
        match $value {
            Value::Four(numbers) => numbers,
            other => return Err(other.refused($name, "four numbers")),
        }
    };
}

parameters! {
    model: Text, "what to build: \"lens\" (default), \"thick\", \"thin\", \"perspective\", \"orthographic\" or \"environment\"";
    specfile: Text alias "lensfile", "lens file, or a catalogue name such as \"dgauss.50mm\" (default) or \"wide.22mm@35mm\"";
    filmdistance: Float, "mm from the last vertex to the film (default: focus at `focusdistance`)";
    focusdistance: Float, "world units from the film plane to the plane in focus (default: infinity)";
    aperture_diameter: Float alias "aperturediameter", "mm, clear diameter of the stop (default: the file's)";
    fnumber: Float, "focal length over entrance pupil diameter, instead of `aperture_diameter`";
    filmdiag: Float, "mm, diagonal of the film (default 35)";
    hither: Float, "world units along the ray where it begins (default 1e-3)";
    yon: Float, "world units along the ray where it ends (default 1e30)";
    shutteropen: Float, "time at which the shutter opens (default 0)";
    shutterclose: Float, "time at which the shutter closes (default 1); before `shutteropen`, time runs backward, as in pbrt";
    weighting: Text, "\"radiometric\" (default), \"assignment\" (over the area of `pupil`'s disk; with \"warped\" of the paraxial exit pupil), \"relative\" or \"none\"";
    simpleweighting: Bool, "pbrt-v3's name: true is weighting \"relative\", false is \"radiometric\"";
    pupil: Text, "where lens samples are drawn: \"warped\" (default: the true pupil of each film point), \"rear\" or \"disk\"";
    disk: Text, "how lens samples map to the disk: \"concentric\" (default), \"polar\" or \"rejection\"";
    refraction: Text, "\"fused\" (default), \"heckbert\", \"whitted\" or \"other\"";
    wavelength: Float, "nm (default 587.56), for lenses with V-numbers or Sellmeier's constants";
    mmperunit: Float, "millimetres a world unit (default 1)";
    precision: Text, "arithmetic of the trace: \"auto\" (default), \"f64\" (or \"double\"), \"f32\" (or \"single\")";
    tolerance: Float, "pixels that 99.9 % of the rays may be off, for a faster model of the lens (0: exact)";
    shutter: Text, "\"global\" (default), \"leaf\" or \"focal-plane\": what it lets through, by film point and time";
    shutterramp: Float, "share of the shutter's interval in which a leaf shutter opens, and closes (default 0.25)";
    shutterslit: Float, "share of the shutter's interval that a focal-plane shutter exposes each row for (default 0.25)";
    fov: Float, "degrees across the shorter side of the image, perspective (default 90)";
    screenwindow: Four, "x from, x to, y from, y to: the part of the screen that becomes the image (default: by the aspect ratio)";
    frameaspectratio: Float, "width over height of the screen window (default: the image's)";
    lensradius: Float, "world units, of the thin lens of perspective and orthographic (default 0: a pinhole)";
    focaldistance: Float, "world units from the eye to the plane of focus, with `lensradius` (default 1e30)";
    lensplane: Text, "where that thin lens lies: \"eye\" (default, as in pbrt 1.05) or \"hither\" (older, and the lecture's slide)";
    af_zones: Text, "accepted from course scenes and not used: this host offers no autofocus";
}

impl Value<'_> {
    fn refused(self, name: &'static str, expected: &'static str) -> ParameterError {
        let given = match self {
            Value::Float(number) => format!("the number {number}"),
            Value::Text(text) => format!("the string \"{text}\""),
            Value::Bool(truth) => format!("the boolean {truth}"),
            Value::Four(numbers) => format!("the numbers {numbers:?}"),
        };
        ParameterError::Kind { name, expected, given }
    }
}

impl Parameters {
    /// The names of the parameters that are given.
    pub fn given(&self) -> impl Iterator<Item = &'static str> {
        PARAMETERS.iter().map(|row| row.name).filter(|name| self.is_set(name))
    }

    /// The table's row for a name or an alias.
    pub fn find(name: &str) -> Option<&'static Parameter> {
        PARAMETERS.iter().find(|row| row.name == name || row.alias == Some(name))
    }

    /// Sets one parameter by name or alias.
    ///
    /// # Errors
    /// The name is unknown, the value is of another kind or not finite, or the parameter
    /// was given already under its other name. Given again under the same name, the last one counts.
    pub fn set(&mut self, name: &str, value: Value<'_>) -> Result<(), ParameterError> {
        let row = Self::find(name).ok_or_else(|| ParameterError::Unknown {
            name: name.to_owned(),
            names: PARAMETERS.iter().map(|row| row.name).collect::<Vec<_>>().join(", "),
        })?;
        if let Some(alias) = row.alias
            && self.is_set(row.name)
            && self.by_alias.contains(&row.name) != (name == alias)
        {
            return Err(ParameterError::Both { first: row.name, second: alias });
        }
        let not_a_number = match value {
            Value::Float(number) => number.is_nan(),
            Value::Four(numbers) => numbers.iter().any(|number| number.is_nan()),
            Value::Text(_) | Value::Bool(_) => false,
        };
        if not_a_number {
            return Err(ParameterError::Range {
                name: row.name,
                value: "not a number".to_owned(),
                range: "a number".to_owned(),
            });
        }
        self.store(row.name, value)?;
        if name != row.name && !self.by_alias.contains(&row.name) {
            self.by_alias.push(row.name);
        }
        Ok(())
    }

    /// Sets one parameter from text, as `--param name=value` gives it.
    ///
    /// # Errors
    /// As [`Parameters::set`]; also when the text is not a value of the parameter's kind.
    pub fn set_from_text(&mut self, name: &str, text: &str) -> Result<(), ParameterError> {
        let value = match Self::find(name).map(|row| row.kind) {
            Some(Kind::Float) => match text.parse() {
                Ok(number) => Value::Float(number),
                Err(_) => Value::Text(text),
            },
            Some(Kind::Bool) => match text {
                "true" => Value::Bool(true),
                "false" => Value::Bool(false),
                _ => Value::Text(text),
            },
            Some(Kind::Four) => {
                let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
                match numbers.map(<[f64; 4]>::try_from) {
                    Ok(Ok(numbers)) => Value::Four(numbers),
                    _ => Value::Text(text),
                }
            }
            Some(Kind::Text) | None => Value::Text(text),
        };
        self.set(name, value)
    }
}
