//! The wavelength for which a lens is described, and a check that the glasses of the lens have indices at another
//! wavelength.

use super::{
    glass::{D_LINE, ORDINARY_WAVELENGTHS, refractive_index, two_numbers},
    interfaces::{Glass, Medium, Prescription},
};
use realistic_base::message::{cut, short, some_of};

impl Prescription {
    /// Returns the wavelength for which the lens is described, nm: the wavelength that its file states, otherwise the d
    /// line.
    pub fn own_wavelength(&self) -> f64 {
        self.wavelength.unwrap_or(D_LINE)
    }

    /// Checks that every glass has an index at a wavelength, nm. Returns warnings about glasses whose data do not
    /// include this wavelength, or whose indices at this wavelength are only guesses.
    ///
    /// # Errors
    /// A glass has no index at the wavelength. The text names the first such glass, and the wavelengths at which it has
    /// an index.
    pub fn check_wavelength(&self, wavelength: f64) -> Result<Vec<String>, String> {
        let mut beyond: Vec<String> = Vec::new();
        let mut has_two_numbers = false;
        for (medium, glass) in self.media() {
            if !medium.is_dispersive() {
                continue;
            }
            let is_two_numbers = matches!(medium, Medium::Glass { .. });
            has_two_numbers |= is_two_numbers;
            let named = glass.and_then(|glass| self.glasses.get(glass));
            let name = named.map_or_else(|| "a glass".to_owned(), |(name, _)| format!("glass {}", cut(name)));
            let range = named.and_then(|(_, Glass { range, .. })| *range);
            let [from, to] = range.unwrap_or([*ORDINARY_WAVELENGTHS.start(), *ORDINARY_WAVELENGTHS.end()]);
            let index = refractive_index(medium, wavelength);
            if (from..=to).contains(&wavelength) {
                continue;
            }
            if ORDINARY_WAVELENGTHS.contains(&wavelength) && (1.0..5.0).contains(&index) {
                let glass_range = format!("{name} ({} to {} nm)", short(from), short(to));
                if !beyond.contains(&glass_range) {
                    beyond.push(glass_range);
                }
                continue;
            }
            let why = match (range, is_two_numbers) {
                (Some(_), _) => "has data",
                (None, true) => "is known by n_d and V and counts",
                (None, false) => "is defined without a range (from=, to=) and counts",
            };
            let (from, to, wavelength) = (short(from), short(to), short(wavelength));
            return Err(format!(
                "{name} {why} from {from} to {to} nm, and the wavelength is {wavelength} nm"
            ));
        }
        let nm = short(wavelength);
        let mut warnings = Vec::new();
        if !beyond.is_empty() {
            let (lens, some) = (&self.name, some_of(&beyond));
            warnings.push(format!(
                "lens \"{lens}\": {nm} nm is beyond the data of {some}; the formulas are continued"
            ));
        }
        if let Some([half, all]) = two_numbers::error(wavelength).filter(|_| has_two_numbers) {
            let lens = &self.name;
            warnings.push(format!(
                "lens \"{lens}\": the indices of glasses known by n_d and V alone are guesses at {nm} nm; half of the \
                 catalogues' glasses are met within {half} there, the worst within {all}"
            ));
        }
        Ok(warnings)
    }
}
