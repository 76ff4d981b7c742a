//! What names of glasses and of their catalogues are compared by.

/// A name without dashes, underscores and spaces, in capitals.
pub fn loose(name: &str) -> String {
    let counts = |c: &char| !matches!(c, '-' | '_' | ' ');
    name.chars().filter(counts).map(|c| c.to_ascii_uppercase()).collect()
}
