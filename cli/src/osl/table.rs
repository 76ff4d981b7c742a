//! The pupil at the widest stop as a table that a shader interpolates. By construction, the interpolated region
//! contains the true region.
//!
//! A region lies between x = `low` and `high`, and at X = (2 x - low - high)/(high - low) it extends up to |y| = g(X)
//! √(1 - X²); for an ellipse, g is constant. A node of the table has low, high, and g at equal steps of X. Nodes have
//! equal steps of the field σ and of 1/B, where B is the distance from the film to the sampling plane. If the film is
//! dark beyond the last field, the steps are equal in √(1 - σ/σ_end) instead of σ, because the heights of the last
//! pupils fall in proportion to this root. All values are interpolated linearly, also between the nodes of a zoom.
//! The nodes of a lens whose groups focus have equal steps of the focus. Regions between the nodes are checked, too:
//! if an interpolated region does not cover such a region, the nodes around it are widened by the missing part.

use super::field::Field;
use super::optics::Optics;
use super::region::Region;
use realistic_optics::lens::Lens;

/// Number of values of g per node.
pub const HEIGHTS: usize = 13;
/// Number of nodes along the field, and along 1/B or the focus, from the film's position for infinity to its position
/// for the nearest object.
pub const FIELDS: usize = 25;
pub const FOCI: usize = 4;

/// Number of traced fields and foci per step of the table.
const FIELD_PARTS: usize = 3;
const FOCUS_PARTS: usize = 2;
/// Number of heights checked between two values of g.
const HEIGHT_PARTS: usize = 6;
/// Share of its width and height by which a region is widened at the end, to cover regions between the traced ones.
const MARGIN: f64 = 0.0015;

/// A region, as a node of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PupilNode {
    pub low: f64,
    pub high: f64,
    pub g: [f64; HEIGHTS],
}

/// The table of pupils.
#[derive(Debug)]
pub struct PupilTable {
    /// Nodes in order of zoom, then of 1/B, then of field.
    pub nodes: Vec<PupilNode>,
    /// Whether the film is dark at the field of the last nodes; otherwise, the film does not extend beyond it.
    pub ends_dark: bool,
    pub stations: Vec<Span>,
}

/// The part of the table for one station.
#[derive(Debug)]
pub struct Span {
    /// Field of the last nodes; beyond it, the shader has no light.
    pub widest_field: f64,
    /// Radius of the pupil of the film's centre at each 1/B.
    pub on_axis: [f64; FOCI],
    /// The lens at each node of the focus, and the distance B at that node, mm.
    pub foci: [(Lens, f64); FOCI],
}

/// A traced region and its position in the table, in steps.
struct TracedRegion {
    zoom: f64,
    field: f64,
    focus: f64,
    region: Region,
}

impl PupilTable {
    /// Makes the table for film points up to `reach` mm from the axis; `None` if the film's centre is dark. `others`
    /// are lenses with the same glasses at other wavelengths, whose pupils the table contains, too.
    pub fn of(stations: &[Optics], others: &[Lens], reach: f64) -> Option<Self> {
        // Each station has its own thread; most stations take equally long.
        let all: Option<Vec<Pupils>> = std::thread::scope(|scope| {
            let focused = |(station, optics)| scope.spawn(move || focused(optics, station, others, reach));
            let threads: Vec<_> = stations.iter().enumerate().map(focused).collect();
            threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        });
        let (foci, fields): (Vec<_>, Vec<_>) = all?.into_iter().map(|own| (own.foci, own.focused)).unzip();
        let widest: Vec<(f64, bool)> = fields.iter().map(|fields| widest_field(fields)).collect();
        let ends_dark = widest.iter().all(|(_, ends_dark)| *ends_dark);
        let traced: Vec<TracedRegion> = fields
            .iter()
            .zip(&widest)
            .enumerate()
            .flat_map(|(station, (fields, (widest, _)))| traced(fields, station, *widest, ends_dark))
            .collect();
        let radius = |station: usize, focus: usize| {
            let zoom = station as f64 / 2.0;
            let center = |at: &&TracedRegion| at.zoom == zoom && at.field == 0.0 && at.focus == focus as f64;
            traced.iter().find(center).map_or(0.0, |at| at.region.reach()[1])
        };
        let spans = widest.iter().zip(foci).enumerate().map(|(station, (&(widest_field, _), foci))| Span {
            widest_field,
            on_axis: std::array::from_fn(|focus| radius(station, focus)),
            foci,
        });
        let spans = spans.collect();
        let nodes = (0..=stations.len() / 2).flat_map(|zoom| at_nodes(&traced, zoom as f64)).collect();
        let mut table = Self { nodes, ends_dark, stations: spans };
        table.widen_reach(&traced);
        table.widen_heights(&traced);
        Some(table)
    }

    /// Returns the field of a node at a station, or of a position between two nodes.
    pub fn field(&self, station: usize, node: f64) -> f64 {
        field_at(node / (FIELDS - 1) as f64, self.stations[station].widest_field, self.ends_dark)
    }

    /// Returns the nodes around a position in the table, with their weights.
    fn around(&TracedRegion { zoom, field, focus, .. }: &TracedRegion) -> Vec<(usize, f64)> {
        let (i, j, k) = ((field as usize).min(FIELDS - 2), (focus as usize).min(FOCI - 2), zoom as usize);
        let (a, b, c) = (field - i as f64, focus - j as f64, zoom - k as f64);
        let corner = |n: usize| {
            let (di, dj, dk) = (n & 1, n >> 1 & 1, n >> 2);
            let share = |part: f64, d: usize| if d == 1 { part } else { 1.0 - part };
            (((k + dk) * FOCI + j + dj) * FIELDS + i + di, share(a, di) * share(b, dj) * share(c, dk))
        };
        (0..8).map(corner).filter(|(_, weight)| *weight > 0.0).collect()
    }

    fn interpolated(&self, nodes: &[(usize, f64)], value: impl Fn(&PupilNode) -> f64) -> f64 {
        nodes.iter().map(|&(node, weight)| weight * value(&self.nodes[node])).sum()
    }

    fn widen_reach(&mut self, traced: &[TracedRegion]) {
        for at in traced {
            let (nodes, region) = (Self::around(at), &at.region);
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

    fn widen_heights(&mut self, traced: &[TracedRegion]) {
        let last = (HEIGHTS - 1) as f64;
        for at in traced {
            let (nodes, region) = (Self::around(at), &at.region);
            let low = self.interpolated(&nodes, |node| node.low);
            let half = (self.interpolated(&nodes, |node| node.high) - low) / 2.0;
            for part in 1..(HEIGHTS - 1) * HEIGHT_PARTS {
                let position = part as f64 / HEIGHT_PARTS as f64;
                let x = 2.0 * position / last - 1.0;
                let Some(height) = region.height(low + half * (1.0 + x)) else { continue };
                let needed = height / (1.0 - x * x).sqrt();
                let k = (position as usize).min(HEIGHTS - 2);
                let share = position - k as f64;
                let g = |node: &PupilNode| (1.0 - share) * node.g[k] + share * node.g[k + 1];
                let missing = needed - self.interpolated(&nodes, g);
                if missing > 0.0 {
                    let position_squares = (1.0 - share).powi(2) + share * share;
                    let squares: f64 =
                        position_squares * nodes.iter().map(|(_, weight)| weight * weight).sum::<f64>();
                    for &(node, weight) in &nodes {
                        self.nodes[node].g[k] += (1.0 - share) * weight * missing / squares;
                        self.nodes[node].g[k + 1] += share * weight * missing / squares;
                    }
                }
            }
        }
        self.nodes.iter_mut().flat_map(|node| &mut node.g).for_each(|g| *g *= 1.0 + MARGIN);
    }
}

/// A station at a focus, in steps of the table.
struct Focused {
    focus: f64,
    field: Field,
}

/// The pupils of a station.
struct Pupils {
    /// The lens at each node of the focus, and the distance B at that node, mm.
    foci: [(Lens, f64); FOCI],
    focused: Vec<Focused>,
}

/// Traces a station at all foci, at nodes and between them; at the nodes also with the glasses of `others`. A station
/// between nodes of the zoom serves only to check the interpolation, and is traced only at the nodes of the focus.
/// `None` if the film's centre is dark.
fn focused(optics: &Optics, station: usize, others: &[Lens], reach: f64) -> Option<Pupils> {
    let is_between = station % 2 == 1;
    let at = |step: usize| optics.at_node(step as f64 / FOCUS_PARTS as f64, (FOCI - 1) as f64);
    let foci: Vec<(Lens, f64)> = (0..=(FOCI - 1) * FOCUS_PARTS).map(at).collect();
    // The reach is scaled in proportion to the distance, so that all foci have the same fields.
    let shortest = foci.iter().map(|(_, distance)| *distance).fold(f64::INFINITY, f64::min);
    let mut focused = Vec::new();
    for (step, (lens, distance)) in foci.iter().enumerate() {
        let is_node = step % FOCUS_PARTS == 0;
        if is_between && !is_node {
            continue;
        }
        let focus = step as f64 / FOCUS_PARTS as f64;
        let tinted = others.iter().filter(|_| is_node && !is_between).map(|other| with_indices(lens, other));
        for lens in std::iter::once(lens.clone()).chain(tinted) {
            let field = Field::of(optics, &lens, *distance, reach * distance / shortest)?;
            field.pupil(0.0)?;
            focused.push(Focused { focus, field });
        }
    }
    Some(Pupils { foci: std::array::from_fn(|node| foci[node * FOCUS_PARTS].clone()), focused })
}

/// Traces the regions of a station.
fn traced(fields: &[Focused], station: usize, widest_field: f64, ends_dark: bool) -> Vec<TracedRegion> {
    let (zoom, steps) = (station as f64 / 2.0, (FIELDS - 1) * FIELD_PARTS);
    let mut traced = Vec::new();
    for Focused { focus, field } in fields {
        let pupil = |i: usize| field.pupil(field_at(i as f64 / steps as f64, widest_field, ends_dark));
        let pupils = (0..=steps).map_while(pupil).enumerate();
        traced.extend(pupils.map(|(i, region)| TracedRegion {
            zoom,
            field: i as f64 / FIELD_PARTS as f64,
            focus: *focus,
            region,
        }));
    }
    traced
}

/// Returns the lens with its own geometry and the indices of the same lens at another wavelength.
pub fn with_indices(lens: &Lens, other: &Lens) -> Lens {
    let mut lens = lens.clone();
    for (surface, other) in lens.surfaces.iter_mut().zip(&other.surfaces) {
        (surface.n_scene, surface.n_film) = (other.n_scene, other.n_film);
    }
    lens
}

/// Returns the nodes from their traced regions. A dark node becomes a point in the middle of the last bright node
/// before it.
fn at_nodes(traced: &[TracedRegion], zoom: f64) -> Vec<PupilNode> {
    let own = |at: &&TracedRegion| at.zoom == zoom;
    let mut nodes = Vec::new();
    for focus in 0..FOCI {
        let mut last = PupilNode::default();
        for field in 0..FIELDS {
            let found =
                traced.iter().filter(own).find(|at| at.field == field as f64 && at.focus == focus as f64);
            last = match found {
                Some(TracedRegion { region, .. }) => node(region),
                None => PupilNode {
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

fn node(region: &Region) -> PupilNode {
    let [low, high] = region.reach();
    let position = |k: usize| 2.0 * k as f64 / (HEIGHTS - 1) as f64 - 1.0;
    // At either end, g is a limit; the neighbour's value replaces it.
    let g = std::array::from_fn(|k| {
        let x = position(k.clamp(1, HEIGHTS - 2));
        region.height(f64::midpoint(low, high) + (high - low) / 2.0 * x).unwrap_or(0.0) / (1.0 - x * x).sqrt()
    });
    PupilNode { low, high, g }
}

/// Returns the field at a share of the table's length.
fn field_at(share: f64, widest: f64, ends_dark: bool) -> f64 {
    widest * if ends_dark { share * (2.0 - share) } else { share }
}

/// Returns the largest field at which the film gets light at any focus, and whether the film is dark beyond it at all
/// foci.
fn widest_field(fields: &[Focused]) -> (f64, bool) {
    let ends = fields.iter().map(|focused| focused.field.end());
    ends.fold((0.0, true), |(widest, ends_dark), (end, is_dark)| (end.max(widest), ends_dark && is_dark))
}
