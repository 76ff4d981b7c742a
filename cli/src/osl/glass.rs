//! Dispersion in a shader: the index of each glass as a polynomial, and the colour of a wavelength.
//!
//! A wavelength of λ nm is represented by w, which is -1 at the red end, 1 at the blue end, and linear in 1/λ².

use super::polynomial::{Polynomial, fit};
use super::text::number;
use realistic_optics::lens::Lens;
use realistic_optics::prescription::Prescription;

/// Range of wavelengths of a spectral shader, nm.
pub const ENDS: [f64; 2] = [420.0, 680.0];
/// Number of wavelengths at which indices are sampled, and of terms of their fit.
const SAMPLES: usize = 27;
const TERMS: usize = 5;

/// Returns the polynomial in w for each medium from the scene's to the film's, one more than surfaces; `None` for air.
pub fn indices(prescription: &Prescription) -> Vec<Option<Polynomial<TERMS>>> {
    let numbers: Vec<f64> = (0..SAMPLES).map(|i| 2.0 * i as f64 / (SAMPLES - 1) as f64 - 1.0).collect();
    let lenses: Vec<Lens> = numbers.iter().map(|&w| Lens::new(prescription, wavelength(w))).collect();
    (0..=prescription.interfaces.len())
        .map(|medium| {
            let index = |lens: &Lens| match medium.checked_sub(1) {
                Some(surface) => lens.surfaces[surface].n_film,
                None => lens.front().n_scene,
            };
            let values: Vec<f64> = lenses.iter().map(index).collect();
            values.iter().any(|n| *n != 1.0).then(|| fit(&numbers, &values))
        })
        .collect()
}

/// Returns the wavelength that w represents, nm.
fn wavelength(w: f64) -> f64 {
    let [blue, red] = ENDS.map(|end| 1.0 / (end * end));
    ((red + blue) / 2.0 + w * (blue - red) / 2.0).sqrt().recip()
}

/// Declares the index of every medium but air at the wavelength `nm`; n0 is that of the scene, and n3 that behind the
/// third row.
pub fn declarations(indices: &[Option<Polynomial<TERMS>>]) -> String {
    let [blue, red] = ENDS.map(|end| 1.0 / (end * end));
    let (scale, shift) = (2.0 / (blue - red), -(blue + red) / (blue - red));
    let mut text = format!("  float w = {}/(nm*nm) + {};\n", number(scale), number(shift));
    for (row, polynomial) in indices.iter().enumerate() {
        if let Some(Polynomial(terms)) = polynomial {
            let horner = terms[..TERMS - 1]
                .iter()
                .rev()
                .fold(number(terms[TERMS - 1]), |sum, term| format!("({sum}*w + {})", number(*term)));
            text += &format!("  float n{row} = {horner};\n");
        }
    }
    text
}

/// Returns the functions of a spectral shader, which give the colour of a wavelength. The mean colour over equally
/// likely wavelengths is white. Red, green and blue are three smooth spectra that add up to 1, so a lens without
/// colour errors leaves the colours of the scene unchanged.
pub fn colour() -> String {
    // Ranges in nm over which one spectrum blends into the next.
    let (to_green, to_red) = ([470.0, 520.0], [565.0, 610.0_f64]);
    let [first, last] = ENDS;
    let middle = |ends: [f64; 2]| f64::midpoint(ends[0], ends[1]);
    let (green, red) = (middle(to_green), middle(to_red));
    let share = |width: f64| number((last - first) / width);
    format!(
        "/* What light of a wavelength, nm, adds to red, green and blue. */\n\
         color colour_of(float nm)\n{{\n  \
           float green = smoothstep({}, {}, nm);\n  \
           float red = smoothstep({}, {}, nm);\n  \
           return color({}*red, {}*(green - red), {}*(1.0 - green));\n}}\n\n",
        number(to_green[0]),
        number(to_green[1]),
        number(to_red[0]),
        number(to_red[1]),
        share(last - red),
        share(red - green),
        share(green - first),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn indices_of_the_catalogue_s_glasses_are_those_of_the_library() {
        let mut most: f64 = 0.0;
        for name in catalogue::round() {
            let prescription = catalogue::find(name).expect("listed");
            let indices = indices(&prescription);
            for step in 0..=40 {
                let w = f64::from(step) / 20.0 - 1.0;
                let lens = Lens::new(&prescription, wavelength(w));
                for (surface, fitted) in lens.surfaces.iter().zip(&indices[1..]) {
                    let fitted = fitted.map_or(1.0, |fitted| fitted.at(w));
                    most = most.max((fitted - surface.n_film).abs());
                }
            }
        }
        assert!((wavelength(-1.0) - ENDS[1]).abs() + (wavelength(1.0) - ENDS[0]).abs() < 1e-9);
        assert!(most < 2e-5, "{most}");
    }
}
