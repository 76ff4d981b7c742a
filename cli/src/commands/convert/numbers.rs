//! Numbers as text: the shortest digits that read back to the same number.

/// Returns the shortest digits that read back to the same number.
pub fn number(number: f64) -> String {
    let digits = format!("{number:?}");
    digits.strip_suffix(".0").unwrap_or(&digits).to_owned()
}

/// Returns numbers with a space between each two.
pub fn numbers(all: impl IntoIterator<Item = f64>) -> String {
    all.into_iter().map(number).collect::<Vec<_>>().join(" ")
}

/// Returns a wavelength, nm, in µm: the shortest decimal number that reads back to the same number of nm.
pub fn micrometres(wavelength: f64) -> f64 {
    format!("{:.12e}", 1e-3 * wavelength).parse().unwrap_or(1e-3 * wavelength)
}

/// Returns the curvature of a radius, of which infinity means a plane. The reciprocal of the result is the radius to the
/// last bit if there is such a number.
pub fn curvature(radius: f64) -> f64 {
    let near = radius.recip();
    let all = [near, near.next_up(), near.next_down()];
    all.into_iter().find(|curvature| curvature.recip() == radius).unwrap_or(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curvatures_and_wavelengths_read_back() {
        for radius in [29.475, -40.77, 84.83, 1e-3, 437.065, 3.0] {
            let back = curvature(radius).recip();
            assert!((back - radius).abs() <= radius.abs() * f64::EPSILON, "{radius} {back}");
        }
        assert_eq!((curvature(f64::INFINITY), curvature(-50.0).recip()), (0.0, -50.0));
        assert_eq!(
            [587.56, 486.13, 248.0].map(|nm| number(micrometres(nm))),
            ["0.58756", "0.48613", "0.248"]
        );
    }
}
