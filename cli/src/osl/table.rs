//! The pupil at the widest stop as a table that a shader interpolates, so made that the interpolated region contains the
//! true one.
//!
//! A region lies between x = `low` and `high`, and at X = (2 x - low - high)/(high - low) reaches up to
//! |y| = g(X) √(1 - X²): for an ellipse g is constant. A node of the table has low, high and g at equal steps of X; nodes
//! stand at equal steps of the field σ (where its end is dark, of √(1 - σ/σ_end), as the last pupils' heights go) and of 1/B, B being the distance from the film to the sampling plane, and everything
//! is interpolated linearly. Regions between the nodes
//! are traced, too, and where an interpolated region leaves out a part of one, the nodes around it are widened by what is
//! missing.

use super::field::Field;
use super::optics::Optics;
use super::region::Region;
use realistic::lens::Lens;

/// Places of g.
pub const PLACES: usize = 13;
/// Nodes along the field, and along 1/B, from the film's place for infinity to that for the nearest object.
pub const FIELDS: usize = 25;
pub const FOCI: usize = 4;

/// Traced fields and foci per step of the table.
const FIELD_PARTS: usize = 3;
const FOCUS_PARTS: usize = 2;
/// Where between two places heights are looked at.
const PLACE_PARTS: usize = 6;
/// What a region is widened by at last, as a share of its width and height: what lies between the regions traced.
const MARGIN: f64 = 0.0015;
/// The first steps in looking for the field from which on film is dark, and to which share it is found.
const BRIGHT_STEPS: f64 = 24.0;
const DARK_WIDTH: f64 = 1e-3;

/// One region.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    pub low: f64,
    pub high: f64,
    pub g: [f64; PLACES],
}

/// The table.
#[derive(Debug)]
pub struct Table {
    /// By 1/B, then by field.
    pub nodes: Vec<Node>,
    /// The field of the last nodes: beyond it the shader has no light.
    pub widest_field: f64,
    /// Whether the film is dark there, rather than out of reach.
    pub ends_dark: bool,
    /// The pupil's radius for the film's centre at each 1/B.
    pub on_axis: [f64; FOCI],
    /// The distances B of the nodes, mm.
    pub distances: [f64; FOCI],
}

/// A traced region and where in the table it belongs, in steps.
struct Traced {
    field: f64,
    focus: f64,
    region: Region,
}

impl Table {
    /// The table for film points up to `reach` mm from the axis; `None` where the film's centre is dark. `others` are the
    /// lens at other wavelengths, whose pupils are to be contained, too.
    pub fn of(optics: &Optics, others: &[Lens], reach: f64) -> Option<Self> {
        let [shortest, longest] = optics.distances();
        let distance = |focus: f64| {
            let share = focus / (FOCI - 1) as f64;
            ((1.0 - share) / shortest + share / longest).recip()
        };
        let distances = std::array::from_fn(|focus| distance(focus as f64));
        let (widest_field, ends_dark) = widest_field(optics, &distances, reach)?;
        let steps = (FIELDS - 1) * FIELD_PARTS;
        let fields: Vec<f64> =
            (0..=steps).map(|i| field_at(i as f64 / steps as f64, widest_field, ends_dark)).collect();
        let mut traced = Vec::new();
        for step in 0..=(FOCI - 1) * FOCUS_PARTS {
            let focus = step as f64 / FOCUS_PARTS as f64;
            let lenses = others.iter().filter(|_| step % FOCUS_PARTS == 0);
            for lens in [&optics.lens].into_iter().chain(lenses) {
                let pupils = Field::of(optics, lens, distance(focus)).pupils(&fields);
                let place = |(i, region)| Traced { field: i as f64 / FIELD_PARTS as f64, focus, region };
                traced.extend(pupils.into_iter().enumerate().map(place));
            }
        }
        let mut table =
            Self { nodes: at_nodes(&traced), widest_field, ends_dark, on_axis: [0.0; FOCI], distances };
        for (focus, radius) in table.on_axis.iter_mut().enumerate() {
            *radius = table.nodes[focus * FIELDS].high;
        }
        table.widen_reach(&traced);
        table.widen_heights(&traced);
        Some(table)
    }

    /// The field of a node, or between two.
    pub fn field(&self, node: f64) -> f64 {
        field_at(node / (FIELDS - 1) as f64, self.widest_field, self.ends_dark)
    }

    /// The four nodes around a place, with their weights.
    fn around(field: f64, focus: f64) -> [(usize, f64); 4] {
        let (i, j) = ((field as usize).min(FIELDS - 2), (focus as usize).min(FOCI - 2));
        let (a, b) = (field - i as f64, focus - j as f64);
        let node = |di: usize, dj: usize| (j + dj) * FIELDS + i + di;
        [
            (node(0, 0), (1.0 - a) * (1.0 - b)),
            (node(1, 0), a * (1.0 - b)),
            (node(0, 1), (1.0 - a) * b),
            (node(1, 1), a * b),
        ]
    }

    fn interpolated(&self, nodes: &[(usize, f64); 4], value: impl Fn(&Node) -> f64) -> f64 {
        nodes.iter().map(|&(node, weight)| weight * value(&self.nodes[node])).sum()
    }

    fn widen_reach(&mut self, traced: &[Traced]) {
        for Traced { field, focus, region } in traced {
            let nodes = Self::around(*field, *focus);
            let [low, high] = region.reach();
            let squares: f64 = nodes.iter().map(|(_, weight)| weight * weight).sum();
            let below = (self.interpolated(&nodes, |node| node.low) - low).max(0.0) / squares;
            let above = (high - self.interpolated(&nodes, |node| node.high)).max(0.0) / squares;
            for (node, weight) in nodes {
                self.nodes[node].low -= weight * below;
                self.nodes[node].high += weight * above;
            }
        }
        for node in &mut self.nodes {
            let margin = MARGIN * (node.high - node.low) / 2.0;
            (node.low, node.high) = (node.low - margin, node.high + margin);
        }
    }

    fn widen_heights(&mut self, traced: &[Traced]) {
        let last = (PLACES - 1) as f64;
        for Traced { field, focus, region } in traced {
            let nodes = Self::around(*field, *focus);
            let low = self.interpolated(&nodes, |node| node.low);
            let half = (self.interpolated(&nodes, |node| node.high) - low) / 2.0;
            for part in 1..(PLACES - 1) * PLACE_PARTS {
                let place = part as f64 / PLACE_PARTS as f64;
                let x = 2.0 * place / last - 1.0;
                let Some(height) = region.height(low + half * (1.0 + x)) else { continue };
                let needed = height / (1.0 - x * x).sqrt();
                let k = (place as usize).min(PLACES - 2);
                let share = place - k as f64;
                let g = |node: &Node| (1.0 - share) * node.g[k] + share * node.g[k + 1];
                let missing = needed - self.interpolated(&nodes, g);
                if missing > 0.0 {
                    let of_place = (1.0 - share).powi(2) + share * share;
                    let squares: f64 =
                        of_place * nodes.iter().map(|(_, weight)| weight * weight).sum::<f64>();
                    for (node, weight) in nodes {
                        self.nodes[node].g[k] += (1.0 - share) * weight * missing / squares;
                        self.nodes[node].g[k + 1] += share * weight * missing / squares;
                    }
                }
            }
        }
        self.nodes.iter_mut().flat_map(|node| &mut node.g).for_each(|g| *g *= 1.0 + MARGIN);
    }
}

/// The nodes whose regions were traced as these have them; a dark one as a point where the last bright one before it is.
fn at_nodes(traced: &[Traced]) -> Vec<Node> {
    let mut nodes = Vec::new();
    for focus in 0..FOCI {
        let mut last = Node::default();
        for field in 0..FIELDS {
            let found = traced.iter().find(|at| at.field == field as f64 && at.focus == focus as f64);
            last = match found {
                Some(Traced { region, .. }) => node(region),
                None => Node {
                    low: f64::midpoint(last.low, last.high),
                    high: f64::midpoint(last.low, last.high),
                    ..last
                },
            };
            nodes.push(last);
        }
    }
    nodes
}

fn node(region: &Region) -> Node {
    let [low, high] = region.reach();
    let place = |k: usize| 2.0 * k as f64 / (PLACES - 1) as f64 - 1.0;
    // At the ends g is a limit, for which the neighbours stand.
    let g = std::array::from_fn(|k| {
        let x = place(k.clamp(1, PLACES - 2));
        region.height(f64::midpoint(low, high) + (high - low) / 2.0 * x).unwrap_or(0.0) / (1.0 - x * x).sqrt()
    });
    Node { low, high, g }
}

/// The field at a share of the table's length.
fn field_at(share: f64, widest: f64, ends_dark: bool) -> f64 {
    widest * if ends_dark { share * (2.0 - share) } else { share }
}

/// The field up to which film within `reach` mm of the axis gets light; `None` where its centre gets none. And
/// whether it is dark from there on.
fn widest_field(optics: &Optics, distances: &[f64], reach: f64) -> Option<(f64, bool)> {
    let (mut widest, mut ends_dark): (f64, bool) = (0.0, true);
    for &distance in distances {
        let field = Field::of(optics, &optics.lens, distance);
        let end = reach / distance;
        let mut last = field.pupil(0.0, field.widest())?;
        let (mut bright, mut step) = (0.0, end / BRIGHT_STEPS);
        // From pupil to pupil; where one is lost, by shorter steps.
        while bright < end && step > DARK_WIDTH * bright.max(0.1 * field.in_rear) {
            match field.pupil((bright + step).min(end), last.frame()) {
                Some(pupil) => (bright, last) = ((bright + step).min(end), pupil),
                None => step /= 2.0,
            }
        }
        ends_dark &= bright < end;
        widest = widest.max(bright);
    }
    Some((widest * (1.0 + DARK_WIDTH), ends_dark))
}
