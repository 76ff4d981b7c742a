//! Numbers of a shader that change as the lens zooms. A constant becomes a literal. Any other number becomes an
//! element of an array, which the shader computes for its focal length by parabolas through three stations.

use super::text::{array, number};

/// A collection of numbers.
#[derive(Debug)]
pub struct Numbers {
    stations: usize,
    columns: Vec<Vec<f64>>,
}

impl Numbers {
    /// Makes an empty collection for a lens with this number of stations.
    pub fn new(stations: usize) -> Self {
        Self { stations, columns: Vec::new() }
    }

    /// Returns the text of a number with the given values at the stations.
    pub fn text(&mut self, values: impl IntoIterator<Item = f64>) -> String {
        let values: Vec<f64> = values.into_iter().collect();
        debug_assert_eq!(values.len(), self.stations, "one per station");
        if values.iter().all(|value| *value as f32 == values[0] as f32) {
            return number(values[0]);
        }
        self.columns.push(values);
        format!("C[{}]", self.columns.len() - 1)
    }

    /// Adds a block of numbers and returns the index of its first element in the array; each row belongs to a
    /// station.
    pub fn block(&mut self, rows: &[Vec<f64>]) -> usize {
        let start = self.columns.len();
        self.columns.extend((0..rows[0].len()).map(|i| rows.iter().map(|row| row[i]).collect()));
        start
    }

    /// Returns the text of a polynomial in `variable`; each row has the coefficients at one station, by rising power.
    pub fn polynomial(&mut self, rows: &[&[f64]], variable: &str) -> String {
        let most = (0..rows[0].len()).rev().find(|&i| rows.iter().any(|row| row[i] != 0.0)).unwrap_or(0);
        let highest = self.text(rows.iter().map(|row| row[most]));
        (0..most).rev().fold(highest, |sum, i| {
            let term = self.text(rows.iter().map(|row| row[i]));
            format!("({sum}*{variable} + {term})")
        })
    }

    /// Declares the array and `zoomed`, the position between the nodes of the zoom. `zooms` are the focal lengths of
    /// the stations. Returns an empty text for a lens that does not zoom.
    pub fn declarations(&self, zooms: &[f64]) -> String {
        if self.stations == 1 {
            return String::new();
        }
        let count = self.columns.len();
        let nodes: Vec<f64> = zooms.iter().step_by(2).map(|zoom| zoom.ln()).collect();
        let last = nodes.len() - 1;
        let all = (0..self.stations).flat_map(|k| self.columns.iter().map(move |column| column[k]));
        format!(
            "  /* The zoom: the logarithms of its nodes' focal lengths, and its numbers at the nodes and between them. */\n\
             {}{}  \
               float place = log(clamp(zoom, {}, {}));\n  \
               int node = 0;\n  \
               while (node < {} && place > Z[node + 1])\n    node++;\n  \
               float part = clamp((place - Z[node])/(Z[node + 1] - Z[node]), 0.0, 1.0);\n  \
               float zoomed = node + part;\n  \
               float C[{count}];\n  \
               for (int k = 0; k < {count}; k++) {{\n    \
                 int at = 2*node*{count} + k;\n    \
                 C[k] = (1 - part)*((1 - 2*part)*M[at] + 4*part*M[at + {count}]) + part*(2*part - 1)*M[at + {}];\n  }}\n\n",
            array("Z", nodes.iter().copied()),
            array("M", all),
            number(zooms[0]),
            number(zooms[self.stations - 1]),
            last - 1,
            2 * count,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_literals_and_other_numbers_have_an_element() {
        let mut numbers = Numbers::new(3);
        assert_eq!(numbers.text([2.0, 2.0, 2.0]), "2.0");
        assert_eq!(numbers.text([1.0, 2.0, 3.0]), "C[0]");
        assert_eq!(numbers.block(&[vec![1.0, 4.0], vec![1.0, 5.0], vec![1.0, 6.0]]), 1);
        let rows: [&[f64]; 3] = [&[1.0, 2.0, 0.0], &[1.0, 3.0, 0.0], &[1.0, 4.0, 0.0]];
        assert_eq!(numbers.polynomial(&rows, "focus"), "(C[3]*focus + 1.0)");
        let text = numbers.declarations(&[10.0, 15.0, 20.0]);
        assert!(text.contains("float M[12]") && text.contains("float C[4];"), "{text}");
        assert_eq!(Numbers::new(1).declarations(&[50.0]), "");
    }
}
