//! Pieces of OSL text: numbers in single precision, arrays, comments.

/// A number as OSL (and C) reads it back to the same single-precision bits; in brackets where it is negative.
///
/// # Panics
/// It is not finite in single precision: no part of a lens that a shader is made for is.
pub fn number(value: f64) -> String {
    let single = value as f32;
    assert!(single.is_finite(), "{value} cannot stand in a shader");
    if single.is_sign_negative() && single != 0.0 {
        format!("({single:?})")
    } else {
        format!("{:?}", single.abs())
    }
}

/// A constant array of these numbers, several per line.
pub fn array(name: &str, values: impl IntoIterator<Item = f64>) -> String {
    let values: Vec<String> = values.into_iter().map(|value| format!("{:?}", value as f32)).collect();
    let lines: Vec<String> = values.chunks(12).map(|line| line.join(", ")).collect();
    format!("  float {name}[{}] = {{\n    {}}};\n", values.len(), lines.join(",\n    "))
}

/// Words that may stand in a comment and in a string of OSL.
pub fn plain(words: &str) -> String {
    words.chars().map(|c| if c.is_control() || "\"\\*".contains(c) { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_bits_and_comments_stay_closed() {
        for value in [0.0, -0.0, 1.0, -1.5, 1e-30, 0.1, -123_456.79, 3.4e38] {
            let text = number(value);
            let read: f32 = text.trim_matches(['(', ')']).parse().expect("a number");
            assert!(read == value as f32 && text.starts_with('(') == (value < 0.0), "{text}");
        }
        assert_eq!(plain("a */ \"b\"\\\n"), "a  /  b   ");
        assert_eq!(array("a", [1.0, -2.0]), "  float a[2] = {\n    1.0, -2.0};\n");
    }
}
