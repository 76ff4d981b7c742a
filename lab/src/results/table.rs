//! Tables of results, and the comma-separated files (RFC 4180) that they are written as.

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
        Self::from(if holds { "yes" } else { "no" })
    }
}

/// A table with a name for its file and a heading for each column, its unit in the name.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// File name without ending.
    pub name: &'static str,
    /// Headings, such as `time_ns`.
    pub columns: Vec<&'static str>,
    /// Rows, each as long as the headings.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table of these rows; `columns` are its headings with spaces between them.
    pub fn of(name: &'static str, columns: &'static str, rows: impl Iterator<Item = Vec<Cell>>) -> Self {
        Self { name, columns: columns.split_whitespace().collect(), rows: rows.collect() }
    }

    /// The table as CSV: a header line, six digits of every number, text in quotes where it
    /// holds a comma or a quote.
    pub fn to_csv(&self) -> String {
        let text = |cell: &Cell| match cell {
            Cell::Text(word) if word.contains([',', '"', '\n']) => {
                format!("\"{}\"", word.replace('"', "\"\""))
            }
            Cell::Text(word) => word.clone(),
            // Counts as they are; of measurements more than any here is worth.
            Cell::Number(number) if number.fract() == 0.0 && number.abs() < 1e15 => number.to_string(),
            Cell::Number(number) => format!("{:?}", format!("{number:.5e}").parse().unwrap_or(*number)),
        };
        let rows = self.rows.iter().map(|row| row.iter().map(text).collect::<Vec<_>>().join(","));
        [self.columns.join(",")].into_iter().chain(rows).map(|line| line + "\n").collect()
    }
}

/// A row of a [`Table`], of whatever a [`Cell`] is made from.
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
