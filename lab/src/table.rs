//! Tables of results, and the comma-separated files that they go to.

use std::fmt::Write as _;

/// One entry.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A word.
    Text(String),
    /// A number; NaN where there is none.
    Number(f64),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<usize> for Cell {
    fn from(number: usize) -> Self {
        Self::Number(number as f64)
    }
}

impl From<bool> for Cell {
    fn from(holds: bool) -> Self {
        Self::Text(if holds { "yes" } else { "no" }.to_owned())
    }
}

/// A table with a name for its file and a heading a column, its unit in the name.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// File name without ending.
    pub name: String,
    /// Headings, such as `time_ns`.
    pub columns: Vec<&'static str>,
    /// Rows, each as long as the headings.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(name: &str, columns: &[&'static str]) -> Self {
        Self { name: name.to_owned(), columns: columns.to_vec(), rows: Vec::new() }
    }

    /// The table as CSV: a header line, six digits of every number, text in quotes where it
    /// holds a comma or a quote (RFC 4180).
    pub fn to_csv(&self) -> String {
        let mut text = self.columns.join(",") + "\n";
        for row in &self.rows {
            for (number, cell) in row.iter().enumerate() {
                if number > 0 {
                    text.push(',');
                }
                match cell {
                    Cell::Text(word) if word.contains([',', '"', '\n']) => {
                        let _ = write!(text, "\"{}\"", word.replace('"', "\"\""));
                    }
                    Cell::Text(word) => text.push_str(word),
                    Cell::Number(number) => text.push_str(&written(*number)),
                }
            }
            text.push('\n');
        }
        text
    }
}

/// A number to six digits, more than any measurement here is worth; counts as they are.
fn written(number: f64) -> String {
    if number.fract() == 0.0 && number.abs() < 1e15 {
        return format!("{number}");
    }
    let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
    format!("{rounded:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_keeps_six_digits_of_its_numbers_and_its_commas() {
        let mut table = Table::new("t", &["name", "error_rad"]);
        table.rows.push(vec!["a, \"b\"".into(), (0.1 + 0.2).into()]);
        table.rows.push(vec!["c".into(), 1e-300.into()]);
        table.rows.push(vec!["d".into(), 1234567.8.into()]);
        table.rows.push(vec!["f".into(), 1_234_567.0.into()]);
        table.rows.push(vec!["e".into(), f64::NAN.into()]);
        assert_eq!(
            table.to_csv(),
            "name,error_rad\n\"a, \"\"b\"\"\",0.3\nc,1e-300\nd,1234570.0\nf,1234567\ne,NaN\n"
        );
    }
}
