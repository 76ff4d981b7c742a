//! Elements of OSL text: numbers in single precision, arrays, comments.

/// Placeholder in a shader's text for a number beyond single precision; no name in a shader resembles it.
const BEYOND: &str = "beyond_single_precision";

/// Whether all numbers of a shader's text are in range.
pub fn is_complete(text: &str) -> bool {
    !text.contains(BEYOND)
}

/// Formats a number so that OSL (and C) reads back the same single-precision bits; a negative number is in
/// parentheses.
pub fn number(value: f64) -> String {
    let is_negative = (value as f32) < 0.0;
    if is_negative { format!("({})", single(value)) } else { single(value.abs()) }
}

/// Formats a number in single precision.
fn single(value: f64) -> String {
    let single = value as f32;
    if single.is_finite() { format!("{single:?}") } else { BEYOND.to_owned() }
}

/// Formats a constant array of these numbers, several per line.
pub fn array(name: &str, values: impl IntoIterator<Item = f64>) -> String {
    let values: Vec<String> = values.into_iter().map(single).collect();
    let lines: Vec<String> = values.chunks(12).map(|line| line.join(", ")).collect();
    format!("  float {name}[{}] = {{\n    {}}};\n", values.len(), lines.join(",\n    "))
}

/// Replaces characters that may not occur in a comment or a string of OSL.
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
        assert!(is_complete(&number(3.4e38)) && is_complete(&array("a", [-3.4e38])));
        for value in [1e39, -1e39, f64::NAN, f64::INFINITY] {
            assert!(!is_complete(&number(value)) && !is_complete(&array("a", [1.0, value])), "{value}");
        }
        assert_eq!(array("a", [1.0, -2.0]), "  float a[2] = {\n    1.0, -2.0};\n");
    }
}
