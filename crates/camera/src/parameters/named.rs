//! The values of parameters that are chosen by name. Each type has a single list of names, with the default
//! first.
//!
//! `Display` writes the name that users write, and `FromStr` reads it. The lists of [`DiskMapping`],
//! [`Refraction`], [`Shutter`] and [`Precision`] are in the modules that define these types.

use std::{fmt, mem::discriminant, str::FromStr};

use super::{
    error::{ParameterError, UnknownName},
    range::Range,
    value::{Kind, Setting, Value, Written},
};
use crate::{model::Model, placement::shutter::Shutter, plan::Precision, sampling::DiskMapping};
use realistic_optics::{lens::refraction::Refraction, prescription::Coating};

/// The region of the lens in which the second point of a ray is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pupil {
    /// The true pupil of each film point.
    #[default]
    Warped,
    /// The rear element's disk.
    Rear,
    /// The thick-lens exit pupil.
    Disk,
}

impl Pupil {
    /// Every pupil with its name.
    pub const NAMES: [(&'static str, Self); 3] =
        [("warped", Self::Warped), ("rear", Self::Rear), ("disk", Self::Disk)];
}

/// The kind of weight that a ray receives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// A cos⁴θ'/Z²: the mean weight over lens samples is the film irradiance for unit scene radiance.
    #[default]
    Radiometric,
    /// The assignment's cos⁴/Z²: the radiometric weight divided by an area that depends neither on the film
    /// point nor on the film. For the rear element, this is the area of its clear aperture; if a larger disk
    /// is sampled so that no ray of the film is missed, the weight compensates for the enlargement. For the
    /// exit pupil's disk, and for the warped pupil, whose area varies, it is the area of the paraxial exit
    /// pupil.
    Assignment,
    /// The radiometric weight divided by its mean on the axis.
    Relative,
    /// Weight 1 for every ray that passes the lens.
    None,
}

impl Weighting {
    /// Every weighting with its name.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("radiometric", Self::Radiometric),
        ("assignment", Self::Assignment),
        ("relative", Self::Relative),
        ("none", Self::None),
    ];
}

/// The coatings whose transmission a ray's weight includes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transmission {
    /// The surfaces transmit all light.
    #[default]
    None,
    /// Transmission of uncoated surfaces.
    Bare,
    /// Transmission of surfaces with a quarter wave of magnesium fluoride between air and glass.
    QuarterWave,
    /// Transmission of surfaces with two quarter waves between air and glass.
    VCoat,
    /// Transmission of surfaces with three layers between air and glass.
    ThreeLayer,
    /// Transmission of surfaces with the coatings that the lens file names.
    File,
}

impl Transmission {
    /// Every choice with its name.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("none", Self::None),
        ("bare", Self::Bare),
        ("quarter-wave", Self::QuarterWave),
        ("v-coat", Self::VCoat),
        ("three-layer", Self::ThreeLayer),
        ("file", Self::File),
    ];

    /// Returns the coating that all surfaces share; `None` if the surfaces lose no light or each has its own
    /// coating.
    pub fn of_all(self) -> Option<Coating> {
        match self {
            Self::None | Self::File => None,
            Self::Bare => Some(Coating::Bare),
            Self::QuarterWave => Some(Coating::QuarterWave),
            Self::VCoat => Some(Coating::VCoat),
            Self::ThreeLayer => Some(Coating::ThreeLayer),
        }
    }
}

/// The part that moves when the camera is focused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FocusBy {
    /// The film, behind a lens that does not move.
    #[default]
    Film,
    /// The lens's own groups, which move along the positions of the lens file; the film stays at the lens
    /// file's distance.
    Group,
}

impl FocusBy {
    /// Both choices with their names.
    pub const NAMES: [(&'static str, Self); 2] = [("film", Self::Film), ("group", Self::Group)];
}

/// The plane in which the thin lens of a projection lies. The two planes differ by the distance `hither`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LensPlane {
    /// The plane of the eye, z = 0, as in pbrt 1.05. In the near plane, a ray's distance from the central ray
    /// is (F - hither)/F times that of its lens point.
    #[default]
    Eye,
    /// The near plane itself, where rays begin, as in older versions of pbrt and on the lecture's slide.
    Hither,
}

impl LensPlane {
    /// Every plane with its name.
    pub const NAMES: [(&'static str, Self); 2] = [("eye", Self::Eye), ("hither", Self::Hither)];
}

/// Implements reading and writing an enum by the names in its `NAMES`.
macro_rules! named {
    ($($choice:ty),*) => {$(
        impl Setting for $choice {
            const KIND: Kind = Kind::Text;
            const RANGE: Range = Range::Names(&names(&Self::NAMES));

            fn of(name: &'static str, value: Value<'_>) -> Result<Self, ParameterError> {
                choose(&Self::NAMES, name, value)
            }
        }

        impl Written for $choice {
            fn written(&self) -> String {
                name(&Self::NAMES, self).to_owned()
            }
        }
    )*};
}

/// Implements `Display` and `FromStr`, by the same names, for an enum of this crate.
macro_rules! shown {
    ($($choice:ty),*) => {$(
        impl fmt::Display for $choice {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(name(&Self::NAMES, self))
            }
        }

        impl FromStr for $choice {
            type Err = UnknownName;

            fn from_str(given: &str) -> Result<Self, UnknownName> {
                find(&Self::NAMES, given)
            }
        }
    )*};
}

/// Returns the name of a choice.
fn name<T>(names: &[(&'static str, T)], own: &T) -> &'static str {
    let found = names.iter().find(|(_, choice)| discriminant(choice) == discriminant(own));
    found.map_or("", |(name, _)| *name)
}

named![Model, FocusBy, Pupil, Transmission, Weighting, LensPlane, DiskMapping, Refraction, Shutter];
shown![Model, FocusBy, Pupil, Transmission, Weighting, LensPlane, DiskMapping, Shutter];

/// Setting for a precision, with `None` for "auto".
impl Setting for Option<Precision> {
    const KIND: Kind = Kind::Text;
    const RANGE: Range = Range::Names(&names(&Precision::NAMES));

    fn of(name: &'static str, value: Value<'_>) -> Result<Self, ParameterError> {
        choose(&Precision::NAMES, name, value)
    }
}

impl Written for Option<Precision> {
    fn written(&self) -> String {
        self.map_or_else(|| "auto".to_owned(), |precision| precision.to_string())
    }
}

/// Returns the value with this name in a list.
fn find<T: Setting + Copy>(list: &[(&str, T)], given: &str) -> Result<T, UnknownName> {
    let choice = list.iter().find(|(name, _)| *name == given).map(|&(_, choice)| choice);
    choice.ok_or_else(|| UnknownName { given: given.to_owned(), known: T::RANGE.in_words("") })
}

/// Returns the choice from a list that the value of parameter `name` selects.
fn choose<T: Setting + Copy>(
    list: &[(&str, T)],
    name: &'static str,
    value: Value<'_>,
) -> Result<T, ParameterError> {
    match value {
        Value::Text(text) => find(list, text).map_err(|unknown| ParameterError::unknown(name, unknown)),
        other => Err(other.refused(name, T::KIND)),
    }
}

const fn names<T: Copy, const N: usize>(list: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = list[i].0;
        i += 1;
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_the_default_stands_first() {
        fn check<T>(names: &[(&str, T)])
        where
            T: Copy + Default + PartialEq + fmt::Debug + Setting + Written,
        {
            assert_eq!(names[0].1, T::default());
            for (name, choice) in names {
                assert_eq!(T::of("a parameter", Value::Text(name)), Ok(*choice));
                assert_eq!(T::of("a parameter", Value::Text(&choice.written())), Ok(*choice));
            }
            let error = T::of("a parameter", Value::Text("Odd")).expect_err("no such name").to_string();
            assert!(error.contains("\"Odd\"") && error.contains(names[1].0), "{error}");
        }
        check(&Model::NAMES);
        check(&FocusBy::NAMES);
        check(&Pupil::NAMES);
        check(&Transmission::NAMES);
        check(&Weighting::NAMES);
        check(&LensPlane::NAMES);
        check(&DiskMapping::NAMES);
        check(&Refraction::NAMES);
        check(&Shutter::NAMES);
        for (name, precision) in Precision::NAMES {
            assert_eq!(Setting::of("precision", Value::Text(name)), Ok(precision));
            assert_eq!(Setting::of("precision", Value::Text(&precision.written())), Ok(precision));
        }
        assert_eq!("warped".parse(), Ok(Pupil::Warped));
        let error = "Odd".parse::<Pupil>().expect_err("no such name").to_string();
        assert!(error.contains("\"Odd\" is not") && error.contains("warped"), "{error}");
        assert_eq!(LensPlane::Hither.to_string(), "hither");
        assert_eq!(Shutter::Leaf { ramp: 0.4 }.to_string(), "leaf");
    }
}
