//! Tables of results, and their comma-separated files (RFC 4180).

/// An entry of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// A number; NaN for a missing one.
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
        Self::from(if holds { "yes" } else { "no" })
    }
}

/// A table with a file name and a heading for each column, which includes the unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// File name without extension.
    pub name: &'static str,
    /// Headings, such as `time_ns`.
    pub columns: Vec<&'static str>,
    /// Rows, each as long as the headings.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// Builds a table from rows; `columns` are its headings, separated by spaces.
    pub fn of(name: &'static str, columns: &'static str, rows: impl Iterator<Item = Vec<Cell>>) -> Self {
        Self { name, columns: columns.split_whitespace().collect(), rows: rows.collect() }
    }

    /// Returns the table as CSV: a header line, six digits of every number, and quotes around text
    /// that contains a comma or a quote.
    pub fn to_csv(&self) -> String {
        let text = |cell: &Cell| match cell {
            Cell::Text(word) if word.contains([',', '"', '\n']) => {
                format!("\"{}\"", word.replace('"', "\"\""))
            }
            Cell::Text(word) => word.clone(),
            // Counts are written in full; six digits are more than the accuracy of any measurement
            // here.
            Cell::Number(number) if number.fract() == 0.0 && number.abs() < 1e15 => number.to_string(),
            Cell::Number(number) => format!("{:?}", format!("{number:.5e}").parse().unwrap_or(*number)),
        };
        let rows = self.rows.iter().map(|row| row.iter().map(text).collect::<Vec<_>>().join(","));
        [self.columns.join(",")].into_iter().chain(rows).map(|line| line + "\n").collect()
    }
}

/// Builds a row of a [`Table`] from values that convert to a [`Cell`].
macro_rules! row {
    ($($cell:expr),*) => { vec![$($crate::results::table::Cell::from($cell)),*] };
}
pub(crate) use row;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_keeps_six_digits_of_its_numbers_and_its_commas() {
        let rows = [
            row!["a, \"b\"", 0.1 + 0.2],
            row!["c", 1e-300],
            row!["d", 1234567.8],
            row!["f", 1_234_567.0],
            row!["e", f64::NAN],
        ];
        assert_eq!(
            Table::of("t", "name error_rad", rows.into_iter()).to_csv(),
            "name,error_rad\n\"a, \"\"b\"\"\",0.3\nc,1e-300\nd,1234570.0\nf,1234567\ne,NaN\n"
        );
    }
}
