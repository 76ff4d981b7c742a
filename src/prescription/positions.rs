//! Groups that move: the gaps of a lens that change as it zooms or focuses, at each of the positions that its table lists,
//! and how such a table is read: which columns are zoom positions, and which the same positions focused nearer.

use thiserror::Error;

use crate::message::short;

/// The positions of a lens with moving groups, in the order of its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Positions {
    /// The interfaces behind which the gap changes, counted from 0 at the scene side, in ascending order. The last
    /// interface's gap is the distance to the film.
    pub gaps: Vec<usize>,
    /// The positions; at least one.
    pub columns: Vec<Position>,
}

/// One position of the groups: a column of the table. What the table does not state is `None`, and nothing but the gaps
/// and the stop is ever computed from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Position {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// The gaps in mm, 0 or more, as many as [`Positions::gaps`].
    pub gaps: Vec<f64>,
    /// Clear diameter of the stop, mm, where it changes.
    pub stop_diameter: Option<f64>,
    /// Focal length as the file states it, mm.
    pub focal_length: Option<f64>,
    /// F-number as the file states it.
    pub fnumber: Option<f64>,
    /// Distance from the object to the first vertex, mm; `None` is infinity.
    pub object_distance: Option<f64>,
}

/// Which column of a table is which zoom position, and focused how near.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Zoom positions; 1 for a lens with one focal length.
    pub zooms: usize,
    /// Distances at which each of them is given, the farthest first.
    pub steps: usize,
}

impl Layout {
    /// The column of a zoom position at a step of focus.
    pub fn column(&self, zoom: usize, step: usize) -> usize {
        step * self.zooms + zoom
    }
}

/// Why a table's columns cannot be told into zoom positions and steps of focus. Columns count from 1.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LayoutError {
    /// The zoom positions are not all given at the same number of distances.
    #[error(
        "the first {zooms} of its {columns} positions have the same object distance and so are zoom positions; the others \
         must be as many, or a multiple of it, each of them nearer and in the same order"
    )]
    Uneven {
        /// Columns of the table.
        columns: usize,
        /// Those at the object distance of the first.
        zooms: usize,
    },
    /// A zoom position does not come nearer from one step of focus to the next.
    #[error(
        "position {column} has its object at {}, which is not nearer than that of position {before}, the same zoom position: \
         state the positions of an object at infinity first, then as many, in the same order, for each nearer object",
        distance.map_or_else(|| "infinity".to_owned(), |distance| short(distance) + " mm")
    )]
    NotNearer {
        /// The column.
        column: usize,
        /// Its object distance, mm; `None` is infinity.
        distance: Option<f64>,
        /// The column of the same zoom position one step farther.
        before: usize,
    },
}

impl Position {
    /// 1 over the object's distance from the first vertex, 1/mm; 0 for infinity.
    pub fn vergence(&self) -> f64 {
        self.object_distance.map_or(0.0, f64::recip)
    }
}

impl Positions {
    /// How the columns are ordered, as Optical Bench's tables and patents have them: the leading columns with the object
    /// distance of the first, which is mostly infinity, are the zoom positions; then come as many, in the same order,
    /// for a nearer object, and so on.
    ///
    /// # Errors
    /// The columns are in no such order.
    pub fn layout(&self) -> Result<Layout, LayoutError> {
        let (columns, first) = (self.columns.len(), self.columns[0].vergence());
        let zooms = self.columns.iter().take_while(|column| column.vergence() == first).count();
        if columns % zooms != 0 {
            return Err(LayoutError::Uneven { columns, zooms });
        }
        for column in zooms..columns {
            let before = column - zooms;
            if !(self.columns[column].vergence() > self.columns[before].vergence()) {
                let distance = self.columns[column].object_distance;
                return Err(LayoutError::NotNearer { column: column + 1, distance, before: before + 1 });
            }
        }
        Ok(Layout { zooms, steps: columns / zooms })
    }

    /// The same positions with every length multiplied by `factor`, positive and finite.
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

    fn layout(objects: &[f64]) -> Result<Layout, LayoutError> {
        let column = |distance: &f64| Position {
            object_distance: Some(*distance).filter(|distance| distance.is_finite()),
            ..Position::default()
        };
        Positions { gaps: Vec::new(), columns: objects.iter().map(column).collect() }.layout()
    }

    #[test]
    fn columns_are_zoom_positions_and_then_the_same_nearer() {
        const FAR: f64 = f64::INFINITY;
        for (objects, zooms, steps) in [
            (&[FAR][..], 1, 1),
            (&[FAR, 2000.0, 171.0], 1, 3),
            (&[FAR, FAR, FAR], 3, 1),
            (&[FAR, FAR, 600.0, 900.0, 140.0, 150.0], 2, 3),
            (&[400.0, 400.0, 400.0], 3, 1),
        ] {
            let found = layout(objects).expect("in order");
            assert_eq!(found, Layout { zooms, steps });
            assert_eq!(found.column(zooms - 1, steps - 1), objects.len() - 1);
        }
        assert_eq!(layout(&[FAR, FAR, 500.0]), Err(LayoutError::Uneven { columns: 3, zooms: 2 }));
        let text = layout(&[FAR, 500.0, FAR, 500.0]).expect_err("wide, wide, tele, tele").to_string();
        assert!(
            text.contains("position 3 has its object at infinity") && text.contains("position 2"),
            "{text}"
        );
        assert!(layout(&[FAR, 500.0, 600.0]).expect_err("farther").to_string().contains("at 600 mm"));
    }
}
