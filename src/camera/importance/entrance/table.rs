//! The table of outlines: rows of one distance, in each outlines from the axis to where the film or the lens ends.

use super::{
    super::fan::{Fan, Image},
    sight::Sight,
    spot::Spot,
};

/// An outline, where its rays reach the film, and where they cross the stop if that is asked for.
#[derive(Clone, Copy, Debug)]
pub(in crate::camera::importance) struct Node {
    pub fan: Fan,
    pub image: Image,
    pub stop: Image,
}

/// Outlines of one distance.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// The distance of the front from the reference over that of the spots.
    pub nearness: f64,
    /// The field angle at which they end.
    pub end: f64,
    pub nodes: Vec<Node>,
}

/// What rows and nodes a spot lies between, and how far on the way from the first to the second of each: in vergence, and
/// along the row in angle and in place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub row: usize,
    pub node: usize,
    pub down: f64,
    pub turned: f64,
    pub along: f64,
}

/// The pupil of a lens as spots of the scene see it.
#[derive(Clone, Debug)]
pub(in crate::camera::importance) struct Entrance {
    /// Where spots are seen from.
    pub sight: Sight,
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

    /// Where a spot lies in the table, and what part of the row's end its angle is. Nearer than the last row it is as on that.
    pub(super) fn cell(&self, spot: &Spot) -> Option<(Cell, f64)> {
        let last = self.rows.len().checked_sub(2)?;
        let angle = spot.angle();
        let nearness = spot.vergence * self.sight.front(angle);
        let number = self.rows.partition_point(|row| row.nearness <= nearness).saturating_sub(1).min(last);
        let [low, high] = [&self.rows[number], &self.rows[number + 1]];
        let down = ((nearness - low.nearness) / (high.nearness - low.nearness)).min(1.0);
        let end = low.end + down * (high.end - low.end);
        let part = angle / end;
        let cells = low.nodes.len() - 1;
        let place = (self.place(part) * cells as f64).min(cells as f64);
        let node = (place as usize).min(cells - 1);
        Some((self.cell_at(number, node, down, place - node as f64), part))
    }

    /// The cell after a row and a node, at this part of the way to the next row, and to the next node in place.
    pub(super) fn cell_at(&self, row: usize, node: usize, down: f64, along: f64) -> Cell {
        let cells = (self.rows[row].nodes.len() - 1) as f64;
        let angle = |along: f64| self.part((node as f64 + along) / cells);
        let (from, to) = (angle(0.0), angle(1.0));
        Cell { row, node, down, turned: (angle(along) - from) / (to - from), along }
    }

    /// The outline that the table has for a cell. Where outlines vanish, all in the plane of the axis goes with the angle, and
    /// their heights across with its root, which is even in place.
    pub(super) fn at(&self, cell: &Cell) -> Node {
        let [low, high] = [0, 1].map(|row| &self.rows[cell.row + row].nodes[cell.node..]);
        let corners = [&low[0], &low[1], &high[0], &high[1]];
        let shares = |along: f64| {
            let down = cell.down;
            [(1.0 - down) * (1.0 - along), (1.0 - down) * along, down * (1.0 - along), down * along]
        };
        let (by_angle, by_place) = (shares(cell.turned), shares(cell.along));
        let mixed = |[a, b, c, d]: [f64; 4], [p, q, r, s]: [f64; 4]| a * p + b * q + c * r + d * s;
        let turned = |of: fn(&Node) -> f64| mixed(by_angle, corners.map(of));
        let image = |images: [&Image; 4]| {
            let turned = |of: fn(&Image) -> f64| mixed(by_angle, images.map(of));
            Image {
                place: turned(|image| image.place),
                along: turned(|image| image.along),
                across: turned(|image| image.across),
                bend: turned(|image| image.bend),
                spread: turned(|image| image.spread),
            }
        };
        let reaches = corners.map(|node| &node.fan.reach);
        Node {
            fan: Fan {
                center: turned(|node| node.fan.center),
                extent: [
                    turned(|node| node.fan.extent[0]),
                    mixed(by_place, corners.map(|node| node.fan.extent[1])),
                ],
                reach: std::array::from_fn(|knot| mixed(by_place, reaches.map(|reach| reach[knot]))),
            },
            image: image(corners.map(|node| &node.image)),
            stop: image(corners.map(|node| &node.stop)),
        }
    }

    /// The region that a spot sees, and where its points are imaged; `None` where it sees none.
    pub fn seen_from(&self, spot: &Spot) -> Option<Node> {
        let (cell, part) = self.cell(spot)?;
        (part <= 1.0).then(|| self.at(&cell))
    }
}
