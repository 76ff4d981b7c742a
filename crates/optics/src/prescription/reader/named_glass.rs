//! Glasses that a file names, perhaps with their n_d and V. The name and these two numbers select the medium. Warnings
//! about glasses that are unknown, belong to another maker or have other numbers are collected, one sentence for each
//! kind.

use crate::prescription::{
    glass::{C_LINE, D_LINE, F_LINE, Found, GlassLibrary, by_word, refractive_index},
    interfaces::{Glass, Medium},
    reader::surface_rows::MediumBehind,
};
use realistic_base::message::{cut, some_of};

/// The largest accepted difference between a file's n_d and the n_d of the glass that the file names. Patents and
/// catalogues round, and melts vary.
const INDEX_APART: f64 = 5e-4;
/// The largest accepted difference between the two values of V, relative to V.
const ABBE_APART: f64 = 0.015;

/// The glasses of a file.
#[derive(Debug)]
pub(super) struct NamedGlasses<'a> {
    library: &'a GlassLibrary,
    /// The catalogues that the file names, as [`loose`](crate::prescription::glass::loose) words. Glasses of these
    /// catalogues precede other glasses of the same name.
    first: Vec<String>,
    named: Vec<(String, Glass)>,
    /// Names of unknown glasses.
    unknown: Vec<String>,
    /// Names of known glasses whose numbers differ from those in the file, where the numbers in the file are used.
    other: Vec<String>,
    /// Names of known glasses whose numbers differ from those in the file, where the numbers of the known glass are
    /// used.
    differs: Vec<String>,
    /// Names of glasses that are in none of the file's catalogues, with the catalogues that have them.
    foreign: Vec<String>,
}

impl<'a> NamedGlasses<'a> {
    pub(super) fn new(library: &'a GlassLibrary, first: Vec<String>) -> Self {
        let [unknown, other, differs, foreign] = [(); 4].map(|()| Vec::new());
        Self { library, first, named: Vec::new(), unknown, other, differs, foreign }
    }

    /// Returns the medium of a glass that the file calls `name` (may be empty), with n_d, more than 1, and V, positive.
    /// The result is the known glass of that name if its numbers agree, otherwise a medium with the numbers in the
    /// file.
    pub(super) fn checked(&mut self, name: &str, n_d: f64, abbe: Option<f64>) -> MediumBehind {
        let mut is_known = false;
        let glasses = self.library.candidates(name, &self.first).filter_map(|found| found.glass.ok());
        let own = glasses.inspect(|_| is_known = true).find(|glass| is_of(glass.medium, n_d, abbe));
        match own {
            Some(glass) => self.use_as(name, glass),
            None => {
                // The numbers are more precise than a six-digit code, which rounds them.
                if !name.is_empty() && by_word(name).is_none() {
                    note(if is_known { &mut self.other } else { &mut self.unknown }, name);
                }
                self.by_numbers(name, n_d, abbe)
            }
        }
    }

    /// Returns the medium with these numbers, regardless of the name.
    pub(super) fn by_numbers(&mut self, name: &str, n_d: f64, abbe: Option<f64>) -> MediumBehind {
        let medium = Medium::Glass { n_d, abbe };
        if name.is_empty() { medium.into() } else { self.use_as(name, Glass::new(medium, None)) }
    }

    /// Returns the medium that the file defines under this name.
    pub(super) fn by_medium(&mut self, name: &str, medium: Medium) -> MediumBehind {
        self.use_as(name, Glass::new(medium, None))
    }

    /// Returns the medium of the glass `name`, regardless of the numbers in the file.
    ///
    /// # Errors
    /// The glass is unknown or unusable; the text gives the reason and a remedy.
    pub(super) fn by_name(
        &mut self,
        name: &str,
        n_d: Option<f64>,
        abbe: Option<f64>,
    ) -> Result<MediumBehind, String> {
        match self.library.candidates(name, &self.first).next() {
            Some(Found { catalogue, is_foreign, glass: Ok(glass) }) => {
                if is_foreign {
                    note(&mut self.foreign, &format!("{} of {}", cut(name), cut(&catalogue)));
                }
                if n_d.is_some_and(|n_d| !is_of(glass.medium, n_d, abbe)) {
                    note(&mut self.differs, name);
                }
                Ok(self.use_as(name, glass))
            }
            found => match (by_word(name), found) {
                (Some(Medium::Air), _) => Ok(Medium::Air.into()),
                (Some(medium), _) => Ok(self.use_as(name, Glass::new(medium, None))),
                (None, Some(Found { glass: Err(why), .. })) => Err(format!("glass \"{}\": {why}", cut(name))),
                (None, _) => {
                    Err(format!("glass \"{}\" is not known; {}", cut(name), self.library.unknown(name)))
                }
            },
        }
    }

    /// Returns the medium of a glass `NAME_MAKER` or `NAME`, and a remark if another maker's glass is taken.
    ///
    /// # Errors
    /// No maker's glass of that name is known; the text gives the reason and a remedy.
    pub(super) fn of_maker(&mut self, name: &str) -> Result<(MediumBehind, Option<String>), String> {
        let Some((plain, maker)) = name.rsplit_once('_') else {
            return Ok((self.by_name(name, None, None)?, None));
        };
        if let Ok(medium) = self.by_name(&format!("{maker}:{plain}"), None, None) {
            return Ok((medium, None));
        }
        let medium = self.by_name(plain, None, None)?;
        let remark =
            format!("no glass {} of {} is known; that of another maker is used", cut(plain), cut(maker));
        Ok((medium, Some(remark)))
    }

    /// Returns the medium of a glass that the file defines under this name.
    pub(super) fn use_as(&mut self, name: &str, glass: Glass) -> MediumBehind {
        MediumBehind::named(name, glass, &mut self.named)
    }

    /// Returns the named glasses and the warnings.
    pub(super) fn glasses_and_warnings(self, file: &str) -> (Vec<(String, Glass)>, Vec<String>) {
        let others =
            "in none of the catalogues that the file names; glasses of one name differ from maker to maker";
        let warnings = [
            (self.foreign, others),
            (self.unknown, "not known; n_d and V of the file are used"),
            (self.differs, "the file gives another n_d or V; those of the name are used"),
            (self.other, "known with another n_d or V; those of the file are used"),
        ];
        let warnings = warnings.iter().filter(|(names, _)| !names.is_empty()).map(|(names, what)| {
            let names: Vec<String> = names.iter().map(|name| cut(name)).collect();
            format!("{file}: glasses {}: {what}", some_of(&names))
        });
        (self.named, warnings.collect())
    }
}

/// Returns whether a glass has these numbers, within the tolerances.
fn is_of(medium: Medium, n_d: f64, abbe: Option<f64>) -> bool {
    let [d, f, c] = [D_LINE, F_LINE, C_LINE].map(|line| refractive_index(medium, line));
    let own = (d - 1.0) / (f - c);
    (d - n_d).abs() <= INDEX_APART && abbe.is_none_or(|abbe| (abbe - own).abs() <= ABBE_APART * own)
}

fn note(names: &mut Vec<String>, name: &str) {
    if names.iter().all(|known| known != name) {
        names.push(name.to_owned());
    }
}
