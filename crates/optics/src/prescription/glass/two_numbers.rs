//! The dispersion of a glass of which only n_d and the Abbe number V are known, modelled on the catalogue glasses with
//! that V. Also the six-digit code that states the two numbers.

use super::formula::{C_LINE, D_LINE, D_LINES, F_LINE, HERZBERGER};
use crate::prescription::interfaces::Medium;

/// The constants p0, p1, q0 and q1 of [`index`].
const FITTED: [f64; 4] = [-0.2555, 1.583, -0.2678, 25.43];
/// The Abbe numbers of the fitted glasses. Beyond this range the partial dispersions at its nearest end are used.
const RANGE: [f64; 2] = [17.0, 96.0];

/// The median and the largest error of the index in each band of wavelengths, nm, over the makers' catalogue glasses,
/// each within the range of its own data. The largest errors occur for dense flints and plastics at the violet end, and
/// below 365 nm for absorbing glasses. The first band runs from F to C.
pub(super) const ERRORS: [([f64; 2], [f64; 2]); 6] = [
    ([486.0, 656.0], [1.6e-5, 5e-4]),
    ([400.0, 710.0], [1.7e-4, 2.4e-3]),
    ([365.0, 400.0], [3.1e-4, 1.3e-2]),
    ([300.0, 365.0], [7.5e-4, 0.75]),
    ([710.0, 1014.0], [3.3e-4, 2.9e-3]),
    ([1014.0, 2000.0], [2.5e-3, 1.8e-2]),
];

/// Returns the [`ERRORS`] at a wavelength, nm; `None` in the visible, where the errors are small, and outside all
/// bands.
pub fn error(wavelength: f64) -> Option<[f64; 2]> {
    let within = |band: &[f64; 2]| (band[0]..=band[1]).contains(&wavelength);
    let [_, (visible, _), beyond @ ..] = &ERRORS;
    beyond.iter().find(|(band, _)| within(band) && !within(visible)).map(|(_, errors)| *errors)
}

/// Returns λ^-2, λ² and Herzberger's 1/(λ² - 0.028), with λ in µm.
fn basis(nanometres: f64) -> [f64; 3] {
    let square = (nanometres * 1e-3).powi(2);
    [square.recip(), square, (square - HERZBERGER).recip()]
}

/// Returns a, b and d of n(λ) = constant + a λ^-2 + b λ² + d/(λ² - 0.028), with λ in µm.
pub(super) fn terms(n_d: f64, abbe: f64) -> [f64; 3] {
    let inverse = abbe.clamp(RANGE[0], RANGE[1]).recip();
    let [f, c] = [F_LINE, C_LINE].map(basis);
    let between_f_and_c: [f64; 3] = std::array::from_fn(|i| f[i] - c[i]);
    let [p0, p1, q0, q1] = FITTED;
    let (line, pole) = (p0 + p1 * inverse, q0 + q1 * inverse);
    let cauchy = (1.0 - line * between_f_and_c[1] - pole * between_f_and_c[2]) / between_f_and_c[0];
    [cauchy, line, pole].map(|part| (n_d - 1.0) / abbe * part)
}

/// Returns the glass of a six-digit code. 517642, 517-642, 517/642 or 517.642 means n_d 1.517 and V 64.2. Digits that
/// follow a six-digit code and a point, as in 517642.251, are the density. First digits below 300 mean an index of
/// 2.0 to 2.299, because no glass has an index below 1.3. Returns `None` for any other word.
pub fn by_code(word: &str) -> Option<Medium> {
    let code = match word.split_once('.') {
        Some((code, density)) if code.len() == 6 && density.bytes().all(|byte| byte.is_ascii_digit()) => code,
        _ => word,
    };
    let (n, v) = match code.len() {
        6 => code.split_at_checked(3)?,
        7 => code.split_once(['-', '/', '.'])?,
        _ => return None,
    };
    let digits = |digits: &str| {
        let is_three = digits.len() == 3 && digits.bytes().all(|byte| byte.is_ascii_digit());
        is_three.then(|| digits.parse::<u32>().ok()).flatten()
    };
    let (n, v) = (digits(n)?, digits(v)?);
    let thousandths = if n < 300 { 2000 + n } else { 1000 + n };
    (v > 0).then(|| Medium::Glass { n_d: f64::from(thousandths) / 1e3, abbe: Some(f64::from(v) / 10.0) })
}

/// Returns the glass of a code with a point between two decimal fractions, as Code V and LensHH write it: 517.642 and
/// 516800.641700 mean n_d 1.517 and V 64.2, and n_d 1.5168 and V 64.17. A first fraction below 0.3 means an index from
/// 2.0, as in [`by_code`]. Returns `None` for any other word.
pub fn by_fractions(word: &str) -> Option<Medium> {
    let (n, v) = word.split_once('.')?;
    let is_fraction = |digits: &str, least: usize| {
        (least..=12).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    if !is_fraction(n, 3) || !is_fraction(v, 2) {
        return None;
    }
    let whole = if n < "3" { 2 } else { 1 };
    let n_d = format!("{whole}.{n}").parse().ok()?;
    let abbe = format!("{}.{}", &v[..2], &v[2..]).parse().ok()?;
    (abbe > 0.0).then_some(Medium::Glass { n_d, abbe: Some(abbe) })
}

/// Returns the glass of n_d and V with a colon between them, as 1.5168:64.17. Returns `None` for any other word.
pub fn by_pair(word: &str) -> Option<Medium> {
    let (n_d, abbe) = word.split_once(':')?;
    let number = |text: &str| text.parse().ok().filter(|number: &f64| number.is_finite());
    Some(Medium::Glass { n_d: number(n_d)?, abbe: Some(number(abbe)?).filter(|abbe| *abbe > 0.0) })
}

/// Returns n(λ) of the glass. At the d line, written with five digits or with seven, the index is exactly n_d. By the
/// definition of V, n_F - n_C is (n_d - 1)/V.
///
/// n = n_d + (n_d - 1)/V · (P + (p0 + p1/V) P1 + (q0 + q1/V) P2). P comes from λ^-2, P1 from λ² and P2 from
/// Herzberger's 1/(λ² - 0.028), with λ in µm. P is shifted and scaled so that it is 0 at the d line and its difference
/// between F and C is 1. P1 and P2 are 0 at the d line, and their difference between F and C is 0. The four constants
/// are a least-squares fit to 244 glasses of the makers' catalogues, from 380 to 1000 nm. Most glasses lie near the
/// normal line of partial dispersions; the error grows with a glass's distance from that line.
pub(super) fn index(n_d: f64, abbe: f64, wavelength: f64) -> f64 {
    if D_LINES.contains(&wavelength) {
        return n_d;
    }
    let inverse = abbe.clamp(RANGE[0], RANGE[1]).recip();
    let [here, d, f, c] = [wavelength, D_LINE, F_LINE, C_LINE].map(basis);
    let between_f_and_c: [f64; 3] = std::array::from_fn(|i| f[i] - c[i]);
    let cauchy = (here[0] - d[0]) / between_f_and_c[0];
    let [line, pole] = [1, 2].map(|i| here[i] - d[i] - between_f_and_c[i] * cauchy);
    let [p0, p1, q0, q1] = FITTED;
    n_d + (n_d - 1.0) / abbe * (cauchy + (p0 + p1 * inverse) * line + (q0 + q1 * inverse) * pole)
}
