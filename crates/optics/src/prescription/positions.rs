//! Moving groups: the gaps of a lens that change as it zooms or focuses, at each of the positions that its table lists.
//! Also the layout of such a table: which columns are zoom positions, and which columns repeat the zoom positions with
//! a nearer focus.

/// The positions of a lens with moving groups, in the order of its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Positions {
    /// The interfaces with a variable gap behind them, counted from 0 at the scene side, in ascending order. The gap
    /// behind the last interface is the distance to the film.
    pub gaps: Vec<usize>,
    /// The positions; at least one.
    pub columns: Vec<Position>,
}

/// One position of the groups: a column of the table. Values that the table does not state are `None`. A stated focal
/// length or f-number does not move the groups. A stated focal length only extends the range of a zoom by rounding; a
/// stated f-number sets a missing stop diameter of a zoom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Position {
    /// The name of the position, if it has one.
    pub name: Option<String>,
    /// The gaps in mm, one for each of [`Positions::gaps`]; negative only beside a plane that only limits rays.
    pub gaps: Vec<f64>,
    /// Clear diameter of the stop, mm, if it varies.
    pub stop_diameter: Option<f64>,
    /// Focal length as the file states it, mm.
    pub focal_length: Option<f64>,
    /// F-number as the file states it.
    pub fnumber: Option<f64>,
    /// Distance from the object to the first vertex, mm; `None` is infinity.
    pub object_distance: Option<f64>,
}

/// The arrangement of a table's columns: zoom positions and focus steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Number of zoom positions; 1 for a prime lens.
    pub zooms: usize,
    /// Number of focus distances for each zoom position; the first distance is the farthest.
    pub steps: usize,
}

impl Layout {
    /// Returns the column of a zoom position at a focus step.
    pub fn column(&self, zoom: usize, step: usize) -> usize {
        step * self.zooms + zoom
    }
}

impl Position {
    /// Returns the reciprocal of the object's distance from the first vertex, 1/mm; 0 for infinity.
    pub fn vergence(&self) -> f64 {
        self.object_distance.map_or(0.0, f64::recip)
    }
}

impl Positions {
    /// Returns the numbers of zoom positions and focus steps, for columns in the order that Optical Bench tables and
    /// patents use. The leading columns with the object distance of the first column, usually infinity, are the zoom
    /// positions. The same number of columns in the same order follows for each nearer object. Columns after the last
    /// complete step are ignored.
    pub fn layout(&self) -> Layout {
        let first = self.columns[0].vergence();
        let zooms = self.columns.iter().take_while(|column| column.vergence() == first).count();
        let is_nearer =
            |column: usize| self.columns[column].vergence() > self.columns[column - zooms].vergence();
        let is_step = |step: &usize| (step * zooms..(step + 1) * zooms).all(is_nearer);
        Layout { zooms, steps: 1 + (1..self.columns.len() / zooms).take_while(is_step).count() }
    }

    /// Returns the columns that pair zoom positions with focus steps, in the order of [`Self::layout`]. A table may
    /// also list each zoom position together with its nearer objects. For a table in any other order, only the zoom
    /// positions remain: the columns with the object distance of the first column.
    pub(super) fn paired(&self) -> Vec<usize> {
        let vergences: Vec<f64> = self.columns.iter().map(Position::vergence).collect();
        let count = vergences.len();
        let at_first: Vec<usize> = (0..count).filter(|&column| vergences[column] == vergences[0]).collect();
        let layout = self.layout();
        if layout.zooms == at_first.len() {
            return (0..layout.zooms * layout.steps).collect();
        }
        let steps = count / at_first.len();
        let is_block = |(zoom, &start): (usize, &usize)| {
            start == zoom * steps && vergences[start..start + steps].windows(2).all(|two| two[0] < two[1])
        };
        if count == steps * at_first.len() && at_first.iter().enumerate().all(is_block) {
            return (0..steps).flat_map(|step| at_first.iter().map(move |start| start + step)).collect();
        }
        at_first
    }

    /// Returns the positions with every length multiplied by `factor`, positive and finite.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        for column in &mut scaled.columns {
            let lengths = [&mut column.stop_diameter, &mut column.focal_length, &mut column.object_distance]
                .into_iter();
            for length in lengths.flatten().chain(&mut column.gaps) {
                *length *= factor;
            }
        }
        scaled
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAR: f64 = f64::INFINITY;

    fn positions(objects: &[f64]) -> Positions {
        let column = |distance: &f64| Position {
            object_distance: Some(*distance).filter(|distance| distance.is_finite()),
            ..Position::default()
        };
        Positions { gaps: Vec::new(), columns: objects.iter().map(column).collect() }
    }

    #[test]
    fn columns_are_zoom_positions_and_then_the_same_nearer() {
        for (objects, zooms, steps) in [
            (&[FAR][..], 1, 1),
            (&[FAR, 2000.0, 171.0], 1, 3),
            (&[FAR, FAR, FAR], 3, 1),
            (&[FAR, FAR, 600.0, 900.0, 140.0, 150.0], 2, 3),
            (&[400.0, 400.0, 400.0], 3, 1),
        ] {
            let positions = positions(objects);
            let found = positions.layout();
            assert_eq!(found, Layout { zooms, steps });
            assert_eq!(found.column(zooms - 1, steps - 1), objects.len() - 1);
            assert_eq!(positions.paired(), (0..objects.len()).collect::<Vec<_>>());
        }
    }

    #[test]
    fn columns_that_do_not_pair_leave_those_that_do() {
        for (objects, paired_columns) in [
            (&[FAR, FAR, FAR, 500.0][..], &[0, 1, 2][..]),
            (&[FAR, FAR, 600.0, 900.0, 140.0], &[0, 1, 2, 3]),
            (&[FAR, 500.0, 600.0], &[0, 1]),
            // The order is wide far, wide near, tele far, tele near.
            (&[FAR, 500.0, FAR, 300.0], &[0, 2, 1, 3]),
            (&[FAR, 500.0, FAR, 300.0, 200.0], &[0, 2]),
            (&[500.0, FAR, FAR], &[0]),
        ] {
            assert_eq!(positions(objects).paired(), paired_columns, "{objects:?}");
        }
    }
}
