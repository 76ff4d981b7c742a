//! The table of outlines: rows of one distance, in each outlines from the axis to where the film or the lens ends.

use super::{
    super::fan::{Fan, Image},
    spot::Spot,
};

/// An outline, and where its rays reach the film.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub fan: Fan,
    pub image: Image,
}

/// Outlines of one distance.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// 1/distance, 1/mm.
    pub vergence: f64,
    /// The field angle at which they end.
    pub end: f64,
    pub nodes: Vec<Node>,
}

/// What rows and nodes a spot lies between, and how far on the way from the first to the second of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub row: usize,
    pub node: usize,
    pub parts: [f64; 2],
}

/// The pupil of a lens as spots of the scene see it.
#[derive(Clone, Debug)]
pub(in crate::camera::importance) struct Entrance {
    /// z of the point of the axis that spots are seen from.
    pub reference: f64,
    /// Of the last row, 1/mm.
    pub nearest: f64,
    /// Whether the outlines vanish where rows end: then nodes get denser there, evenly in √(1 - θ/end).
    pub vanishes: bool,
    /// From infinity on.
    pub(super) rows: Vec<Row>,
}

impl Entrance {
    /// Where along a row a part of its end lies, as a number of nodes over all of them.
    pub(super) fn place(&self, part: f64) -> f64 {
        if self.vanishes { 1.0 - (1.0 - part).max(0.0).sqrt() } else { part }
    }

    /// The inverse of [`Entrance::place`].
    pub(super) fn part(&self, place: f64) -> f64 {
        if self.vanishes { place * (2.0 - place) } else { place }
    }

    /// Where a spot lies in the table, and what part of the row's end its angle is; `None` nearer than the last row.
    pub(super) fn cell(&self, spot: &Spot) -> Option<(Cell, f64)> {
        let last = self.rows.len().checked_sub(2)?;
        if !(spot.vergence <= self.nearest) {
            return None;
        }
        let number =
            self.rows.partition_point(|row| row.vergence <= spot.vergence).saturating_sub(1).min(last);
        let [low, high] = [&self.rows[number], &self.rows[number + 1]];
        let down = (spot.vergence - low.vergence) / (high.vergence - low.vergence);
        let end = low.end + down * (high.end - low.end);
        let part = spot.angle() / end;
        let cells = low.nodes.len() - 1;
        let place = self.place(part) * cells as f64;
        let node = (place as usize).min(cells - 1);
        let parts = [down, (place - node as f64).min(1.0)];
        Some((Cell { row: number, node, parts }, part))
    }

    /// The outline that the table has for a cell.
    pub(super) fn at(&self, cell: &Cell) -> Node {
        let [down, along] = cell.parts;
        let node = |row: usize, node: usize| &self.rows[cell.row + row].nodes[cell.node + node];
        let corners = [node(0, 0), node(0, 1), node(1, 0), node(1, 1)];
        let shares = [(1.0 - down) * (1.0 - along), (1.0 - down) * along, down * (1.0 - along), down * along];
        let mixed = |of: &dyn Fn(&Node) -> f64| -> f64 {
            corners.iter().zip(shares).map(|(node, share)| share * of(node)).sum()
        };
        Node {
            fan: Fan {
                center: mixed(&|node| node.fan.center),
                extent: [0, 1].map(|axis| mixed(&|node| node.fan.extent[axis])),
                reach: std::array::from_fn(|knot| {
                    corners.iter().zip(shares).map(|(node, share)| share * node.fan.reach[knot]).sum()
                }),
            },
            image: Image {
                place: mixed(&|node| node.image.place),
                along: mixed(&|node| node.image.along),
                across: mixed(&|node| node.image.across),
                bend: mixed(&|node| node.image.bend),
                spread: mixed(&|node| node.image.spread),
            },
        }
    }

    /// The region that a spot sees, and where its points are imaged; `None` where it sees none.
    pub fn seen_from(&self, spot: &Spot) -> Option<(Fan, Image)> {
        let (cell, part) = self.cell(spot)?;
        if !(part <= 1.0) {
            return None;
        }
        let Node { fan, image } = self.at(&cell);
        Some((fan, image))
    }
}
