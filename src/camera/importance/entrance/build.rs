//! Making the table: how far each row goes, an outline at each node, and how much larger they are made for what
//! interpolation leaves out halfway between them.

use super::{
    super::fan::{Fan, SECTORS},
    detail::WIDEST,
    fit::fit,
    outline::Outline,
    probe::Probe,
    sight::Sight,
    spot::Spot,
    table::{Cell, Entrance, Node, Row},
};
use crate::numeric::on_broken_line;

/// Rows are even in the root of that degree of nearness: field angles, which are those of sharp images far away and those
/// of the whole lens nearby, change most there.
const DENSER: i32 = 2;
/// Of the last row: hardly before the glass.
const NEAREST: f64 = 0.999;
/// Field angle from one look to the next in the search for a row's end, radians.
const STEP: f64 = 0.06;
/// How far a pupil walks that is followed, over its half width.
const WALK: f64 = 60.0;
/// What halfway between neighbours is asked for is made larger by that, for what lies between there and them.
const BETWEEN: f64 = 1.6;
/// The same of how far off images may be.
const SPREAD: f64 = 1.1;

/// A row's spots while it is made: its distance, where it ends, and whether the lens ends it or the film.
struct Span {
    nearness: f64,
    end: f64,
    vanishes: bool,
    /// Angles at which rays were found, from 0 to the last, and the middles of their outlines.
    path: Vec<[f64; 2]>,
}

impl Span {
    /// Where the middle of the outline at an angle may be.
    fn hint(&self, angle: f64) -> f64 {
        on_broken_line(&self.path, angle)
    }
}

/// Tabulates a lens. `None` for a lens that no light gets through to such film.
pub(in crate::camera::importance) fn build(probe: &Probe<'_>) -> Option<Entrance> {
    let sight = Sight::new(&centers(probe), &probe.cap);
    probe.work.choose_again();
    let rows = probe.detail().rows;
    let nearness = |row: usize| NEAREST * (row as f64 / rows as f64).powi(DENSER);
    let spans: Vec<Span> = (0..=rows).map_while(|row| span(probe, &sight, nearness(row))).collect();
    if spans.len() < 2 {
        return None;
    }
    let mut table = Entrance { sight, vanishes: spans.iter().any(|span| span.vanishes), rows: Vec::new() };
    for span in &spans {
        let nodes = row(probe, &table, span)?;
        table.rows.push(Row { nearness: span.nearness, end: span.end, nodes });
    }
    grow(probe, &mut table);
    Some(table)
}

/// The points of the axis that spots are seen from, by angle and z: one, or where a pupil walks far over its own size those
/// at which the chief rays of spots infinitely far away cross the axis.
fn centers(probe: &Probe<'_>) -> Vec<[f64; 2]> {
    let first = probe.pupil;
    let mut centers = vec![[0.0, first]];
    let look = |angle: f64, hints: &[f64], nearby: Option<&Fan>| {
        let spot = Spot::on_meridian(first, angle, 0.0);
        let found = probe.outline(&spot, probe.detail().rough, hints, nearby);
        found.filter(|found| found.nearest() <= probe.reach).map(|found| found.fan)
    };
    let (mut nearby, mut before, mut walk) = (None, 0.0, 0.0_f64);
    for step in 1..(WIDEST / probe.detail().stride) as usize {
        let angle = step as f64 * probe.detail().stride;
        let hint = nearby.map_or(0.0, |fan: Fan| fan.center);
        let Some(fan) = look(angle, &[2.0 * hint - before, hint], nearby.as_ref()) else { break };
        (before, nearby) = (hint, Some(fan));
        walk = walk.max(fan.center.abs() / fan.extent[0]);
        centers.push([angle, (first - fan.center / angle.sin()).min(probe.foremost)]);
    }
    if walk > WALK { centers } else { vec![[0.0, probe.still]] }
}

/// The field angles of a row: from the axis to where no ray gets to the film any more. Where none is found the next look is
/// at half the step, from where a narrow pupil that walks far is not lost.
fn span(probe: &Probe<'_>, sight: &Sight, nearness: f64) -> Option<Span> {
    let look = |angle: f64, hints: &[f64], nearby: Option<&Fan>| {
        probe.outline(&sight.on_meridian(angle, nearness), probe.detail().rough, hints, nearby)
    };
    let (mut angle, mut fan) = (0.0, look(0.0, &[0.0], None)?.fan);
    let mut path = vec![[angle, fan.center]];
    let (mut step, mut slope, mut in_a_row) = (STEP, 0.0, 0);
    let mut vanishes = false;
    for _ in 0..probe.detail().looks {
        if !(step > STEP * 0.5_f64.powi(probe.detail().closer) && angle < WIDEST) {
            break;
        }
        match look(angle + step, &[fan.center + slope * step, fan.center], Some(&fan)) {
            Some(found) if found.nearest() <= probe.reach => {
                slope = (found.fan.center - fan.center) / step;
                (angle, fan) = (angle + step, found.fan);
                path.push([angle, fan.center]);
                in_a_row += 1;
                if in_a_row > 1 {
                    step = (2.0 * step).min(STEP);
                }
            }
            other => {
                vanishes = other.is_none();
                in_a_row = 0;
                step /= 2.0;
            }
        }
    }
    Some(Span { nearness, end: angle + 2.0 * step, vanishes, path })
}

/// A row's outlines; where the lens ends it the last is that of the last angle at which there is one.
fn row(probe: &Probe<'_>, table: &Entrance, span: &Span) -> Option<Vec<Node>> {
    let (last, around) = (probe.detail().nodes, probe.detail().around);
    let mut nodes: Vec<Node> = Vec::with_capacity(last + 1);
    let mut nearby: Option<Fan> = None;
    for number in 0..=last {
        let mut angle = span.end * table.part(number as f64 / last as f64);
        if number == last && span.vanishes {
            angle = span.path.last()?[0];
        }
        let spot = table.sight.on_meridian(angle, span.nearness);
        match probe.outline(&spot, around, &[span.hint(angle)], nearby.as_ref()) {
            Some(Outline { fan, within, .. }) => {
                let image = fit(&fan, &within);
                let crossings = probe.crossings(&spot, &within);
                let stop = if crossings.is_empty() { image } else { fit(&fan, &crossings) };
                nodes.push(Node { fan, image, stop });
                nearby = Some(fan);
            }
            None => {
                let mut last = *nodes.last()?;
                last.fan.extent = last.fan.extent.map(|extent| 0.3 * extent);
                nodes.push(last);
            }
        }
    }
    Some(nodes)
}

/// Makes the outlines hold what is found halfway between any two neighbours.
fn grow(probe: &Probe<'_>, table: &mut Entrance) {
    let rows = table.rows.len();
    let (last, margin) = (probe.detail().nodes, probe.detail().margin);
    // Of each node, what the neighbours along its row and those of the next rows ask for.
    let mut needed = vec![[Need::NONE; 2]; rows * (last + 1)];
    for row in 0..rows {
        for node in 0..=last {
            for (way, [down, along]) in [[0.0, 0.5], [0.5, 0.0]].into_iter().enumerate() {
                let (more_down, more_along) = (usize::from(down > 0.0), usize::from(along > 0.0));
                if row + more_down >= rows || node + more_along > last {
                    continue;
                }
                // A cell has a node and a row after it, also on the table's last lines.
                let (first, before) = (row.min(rows - 2), node.min(last - 1));
                let cell =
                    table.cell_at(first, before, down + (row - first) as f64, along + (node - before) as f64);
                let need = halfway(probe, table, &cell);
                for place in [row * (last + 1) + node, (row + more_down) * (last + 1) + node + more_along] {
                    needed[place][way].take(&need);
                }
            }
        }
    }
    let nodes = table.rows.iter_mut().flat_map(|row| &mut row.nodes);
    for (node, [along, down]) in nodes.zip(needed) {
        for (reach, (a, b)) in node.fan.reach.iter_mut().zip(along.growth.iter().zip(down.growth)) {
            *reach *= margin + BETWEEN * (a + b);
        }
        node.image.spread = SPREAD * (node.image.spread + along.spread + down.spread);
        node.stop.spread = SPREAD * (node.stop.spread + along.stop_spread + down.stop_spread);
    }
}

/// By how much an outline is too small at its corners, relative, and how far off images are on film and stop, mm.
#[derive(Clone, Copy)]
struct Need {
    growth: [f64; SECTORS + 1],
    spread: f64,
    stop_spread: f64,
}

impl Need {
    const NONE: Self = Self { growth: [0.0; SECTORS + 1], spread: 0.0, stop_spread: 0.0 };

    fn take(&mut self, other: &Self) {
        for (own, other) in self.growth.iter_mut().zip(other.growth) {
            *own = own.max(other);
        }
        self.spread = self.spread.max(other.spread);
        self.stop_spread = self.stop_spread.max(other.stop_spread);
    }
}

/// What the outline that the table has for a cell leaves out.
fn halfway(probe: &Probe<'_>, table: &Entrance, cell: &Cell) -> Need {
    let Node { fan, image, stop } = table.at(cell);
    let ends = [0, 1].map(|row| table.rows[cell.row + row].end);
    let end = ends[0] + cell.down * (ends[1] - ends[0]);
    let part = table.part((cell.node as f64 + cell.along) / probe.detail().nodes as f64);
    let [far, near] = [0, 1].map(|row| table.rows[cell.row + row].nearness);
    let nearness = far + cell.down * (near - far);
    let spot = table.sight.on_meridian(end * part, nearness);
    let mut need = Need::NONE;
    let found = probe.outline(&spot, probe.detail().between, &[fan.center], Some(&fan));
    let Some(outline) = found else { return need };
    for (point, at) in &outline.within {
        need.spread = need.spread.max(image.off(&fan, *point, *at) - image.spread);
    }
    for (point, at) in &probe.crossings(&spot, &outline.within) {
        need.stop_spread = need.stop_spread.max(stop.off(&fan, *point, *at) - stop.spread);
    }
    for (point, _) in &outline.edge {
        let (ratio, sector) = fan.ratio(*point);
        let growth = (ratio - 1.0).clamp(0.0, 2.0);
        for corner in &mut need.growth[sector..=sector + 1] {
            *corner = corner.max(growth);
        }
    }
    need
}
