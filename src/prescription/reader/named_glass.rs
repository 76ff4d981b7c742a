//! Glasses that a file names and may give n_d and V of, too. A name and two numbers in; the medium, and what is told of
//! glasses that are not known or have other numbers, once for all of them.

use crate::{
    message::cut,
    prescription::{
        glass::{C_LINE, D_LINE, F_LINE, GlassLibrary, refractive_index},
        interfaces::Medium,
    },
};

/// How far n_d and V of a file may be from those of the glass that it names: patents and catalogues round, and melts
/// differ.
const INDEX_APART: f64 = 5e-4;
/// The same for V, as a part of it.
const ABBE_APART: f64 = 0.015;

/// The glasses of a file.
#[derive(Debug)]
pub(super) struct NamedGlasses<'a> {
    library: &'a GlassLibrary,
    known: Vec<(String, Medium)>,
    /// Names that are not known.
    unknown: Vec<String>,
    /// Names of glasses with other numbers, which are used.
    other: Vec<String>,
    /// Names of glasses with other numbers, which are not used.
    differs: Vec<String>,
}

impl<'a> NamedGlasses<'a> {
    pub(super) fn new(library: &'a GlassLibrary) -> Self {
        Self { library, known: Vec::new(), unknown: Vec::new(), other: Vec::new(), differs: Vec::new() }
    }

    /// The medium of a glass that the file calls `name`, empty for none, with n_d, more than 1, and V, positive.
    pub(super) fn checked(&mut self, name: &str, n_d: f64, abbe: Option<f64>) -> Medium {
        let stated = Medium::Glass { n_d, abbe };
        if name.is_empty() {
            return stated;
        }
        match self.library.find(name) {
            Some(Ok(medium)) => {
                let [d, f, c] = [D_LINE, F_LINE, C_LINE].map(|line| refractive_index(medium, line));
                let own = (d - 1.0) / (f - c);
                if (d - n_d).abs() <= INDEX_APART
                    && abbe.is_none_or(|abbe| (abbe - own).abs() <= ABBE_APART * own)
                {
                    self.use_as(name, medium)
                } else {
                    note(&mut self.other, name);
                    stated
                }
            }
            Some(Err(_)) | None => {
                note(&mut self.unknown, name);
                stated
            }
        }
    }

    /// The medium of a glass that the file calls `name`, whatever numbers it gives of it; a glass that is not known is
    /// that of the numbers, if there are some.
    ///
    /// # Errors
    /// The glass is not known, and there are no numbers: what to do.
    pub(super) fn by_name(
        &mut self,
        name: &str,
        n_d: Option<f64>,
        abbe: Option<f64>,
    ) -> Result<Medium, String> {
        match (self.library.find(name), n_d) {
            (Some(Ok(medium)), _) => {
                if n_d.is_some_and(|n_d| !is_of(medium, n_d, abbe)) {
                    note(&mut self.differs, name);
                }
                Ok(self.use_as(name, medium))
            }
            (_, Some(n_d)) => {
                note(&mut self.unknown, name);
                Ok(Medium::Glass { n_d, abbe })
            }
            (Some(Err(why)), None) => Err(format!("glass \"{}\": {why}", cut(name))),
            (None, None) => {
                let nearest = self.library.suggestion(name);
                let name = cut(name);
                Err(format!(
                    "glass \"{name}\" is not known, and the file does not give its n_d{nearest}; put its maker's catalogue \
                     (AGF) beside the lens file or give it as \"glasscatalog\""
                ))
            }
        }
    }

    /// Keeps the name for reports.
    fn use_as(&mut self, name: &str, medium: Medium) -> Medium {
        if self.known.iter().all(|(known, _)| known != name) {
            self.known.push((name.to_owned(), medium));
        }
        medium
    }

    /// The glasses that are known, and what is told of the others.
    pub(super) fn told(self, file: &str) -> (Vec<(String, Medium)>, Vec<String>) {
        let told = [
            (self.unknown, "not known; n_d and V of the file are used"),
            (self.differs, "the file gives another n_d or V; those of the name are used"),
            (self.other, "known with another n_d or V; those of the file are used"),
        ];
        let told = told.iter().filter(|(names, _)| !names.is_empty()).map(|(names, what)| {
            let names: Vec<String> = names.iter().map(|name| cut(name)).collect();
            let some = names[..names.len().min(12)].join(", ");
            let more = if names.len() > 12 { ", …" } else { "" };
            format!("{file}: glasses {some}{more}: {what}")
        });
        (self.known, told.collect())
    }
}

/// Whether a glass has these numbers, or nearly.
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
