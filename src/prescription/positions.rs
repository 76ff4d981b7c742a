//! Groups that move: the gaps of a lens that change as it zooms or focuses, at each of the positions that its table lists.

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

impl Positions {
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
