//! The pupils of a lens that is symmetric in x and in y without being round: a table over a quarter of the film, and
//! the OSL text that samples it. By construction, an interpolated region contains the true region.
//!
//! A region lies between x = `low` and `high`. At X = (2 x - low - high)/(high - low) it extends up to |y - `middle` - `slope`
//! X| = g(X) √(1 - X²); for an ellipse, g is constant. A node of the table has these four numbers, and g at equal steps of X.
//! Nodes have equal steps of the fields x/B and y/B, of the focus and of the stop, where B is the distance from the film
//! to the sampling plane; at the stop 0 regions are points. All values are interpolated linearly. Pupils between the nodes
//! are traced, too: where an interpolated region does not cover such a pupil, the nodes around it are widened by the
//! missing part.

use super::optics::Optics;
use super::table::{FOCI, with_indices};
use super::text::{array, number};
use realistic_camera::sampling::PupilDisk;
use realistic_optics::lens::{Lens, film_ray, pupil::SlopeDisk};
use realistic_optics::trace::Path;
use std::f64::consts::TAU;

/// Numbers of nodes along x, y, focus and stop.
const NODES: [usize; 4] = [7, 7, FOCI, 5];
/// Number of values of g, and of all numbers of a node.
const HEIGHTS: usize = 7;
const NUMBERS: usize = 4 + HEIGHTS;
/// Numbers of traced directions: around a pupil; before its centroid is known; around the pupil of the film's centre,
/// which sets the exposure.
const DIRECTIONS: usize = 32;
const FIRST_DIRECTIONS: usize = 8;
const CENTER_DIRECTIONS: usize = 256;
/// Number of halvings of the interval in which the edge of a pupil lies in one direction.
const HALVINGS: u32 = 12;
/// Number of points along a side of the grid in which a pupil is searched for.
const SEARCHED: u32 = 32;
/// Share by which regions are widened at the end: the edge of a pupil is not traced everywhere.
const MARGIN: f64 = 0.006;
/// Largest |X| at which the first heights of a region are taken.
const OUTERMOST: f64 = 0.95;
/// Number of halvings, and of directions over the quarter, of the search for the end of the lit film.
const END_HALVINGS: u32 = 12;
const END_DIRECTIONS: u32 = 4;

/// A node: low, high, middle, slope and the values of g, mm.
type Node = [f64; NUMBERS];
/// Points around a pupil, mm.
type Outline = Vec<[f64; 2]>;

/// The table of pupils.
#[derive(Debug)]
pub struct QuarterTable {
    nodes: Vec<Node>,
    /// Semi-axes of the pupil of the film's centre, mm, in order of focus, then of stop, from the second stop on.
    centers: Vec<[f64; 2]>,
    /// Field of the last nodes; beyond it, the shader has no light.
    pub widest_field: f64,
    /// Distance from the axis up to which the film is lit in all directions, mm.
    pub reach: f64,
}

/// A traced pupil and its position in the table, in steps.
struct Traced {
    position: [f64; 4],
    outline: Outline,
}

/// A lens at one focus and stop.
struct View {
    path: Path,
    film: f64,
    distance: f64,
    /// The disk that contains every pupil.
    cover: PupilDisk,
}

impl View {
    /// Makes the view of a film `distance` mm from the sampling plane; `stop` is the stop's share of its widest size.
    fn of(optics: &Optics, lens: &Lens, distance: f64, stop: f64, reach: f64) -> Option<Self> {
        let mut lens = lens.clone();
        lens.surfaces[optics.stop].semi_diameter *= stop;
        let film = lens.rear().vertex - (distance - optics.plane);
        let cover = PupilDisk::rear(&lens, film, reach)?;
        Some(Self { path: Path::film_to_scene(&lens), film, distance, cover })
    }

    /// Whether the ray from a film point through a point of the sampling plane passes, mm.
    fn passes(&self, film: [f64; 2], point: [f64; 2]) -> bool {
        let slopes = [0, 1].map(|axis| (point[axis] - film[axis]) / self.distance);
        self.path.trace(film_ray(film, self.film, slopes)).is_ok()
    }

    /// Returns a point inside the pupil of a film point: one of `near`, or else the point of a grid that is nearest to
    /// the mean of those inside. `None` if the film point is dark.
    fn inside(&self, film: [f64; 2], near: &[[f64; 2]]) -> Option<[f64; 2]> {
        if let Some(point) = near.iter().find(|point| self.passes(film, **point)) {
            return Some(*point);
        }
        let SlopeDisk { center, radius } = self.cover.seen_from(film);
        let along = |i: u32| radius * (2.0 * f64::from(i) + 1.0 - f64::from(SEARCHED)) / f64::from(SEARCHED);
        let all = (0..SEARCHED * SEARCHED).map(|n| {
            let slopes = [center[0] + along(n % SEARCHED), center[1] + along(n / SEARCHED)];
            [0, 1].map(|axis| film[axis] + slopes[axis] * self.distance)
        });
        let inside: Outline = all.filter(|point| self.passes(film, *point)).collect();
        let mean = [0, 1].map(|axis| inside.iter().map(|p| p[axis]).sum::<f64>() / inside.len() as f64);
        let off = |p: &[f64; 2]| (p[0] - mean[0]).hypot(p[1] - mean[1]);
        inside.into_iter().min_by(|p, q| off(p).total_cmp(&off(q)))
    }

    /// Traces the edge of a pupil in equal directions from its centroid, or from another point inside it.
    fn outline(&self, film: [f64; 2], inside: [f64; 2], directions: usize) -> Outline {
        let (_, centroid, _) = moments(&self.edges(film, inside, FIRST_DIRECTIONS));
        let from = if self.passes(film, centroid) { centroid } else { inside };
        self.edges(film, from, directions)
    }

    /// Traces the edge of a pupil in equal directions from a point inside it.
    fn edges(&self, film: [f64; 2], inside: [f64; 2], directions: usize) -> Outline {
        let widest = 4.0 * self.cover.seen_from(film).radius * self.distance;
        let mut guess = widest / 16.0;
        let edge = |i: usize| {
            let (sin, cos) = (TAU * i as f64 / directions as f64).sin_cos();
            let at = |radius: f64| [inside[0] + radius * cos, inside[1] + radius * sin];
            let (mut low, mut high) = (0.0, guess);
            while high < widest && self.passes(film, at(high)) {
                (low, high) = (high, 1.25 * high);
            }
            for _ in 0..HALVINGS {
                let middle = f64::midpoint(low, high);
                if self.passes(film, at(middle)) { low = middle } else { high = middle }
            }
            guess = 1.1 * high;
            at(high)
        };
        (0..directions).map(edge).collect()
    }

    /// Returns the distance from the axis, up to `reach`, at which the lit film ends in a direction, mm.
    fn end(&self, [cos, sin]: [f64; 2], reach: f64) -> f64 {
        let is_lit = |radius: f64| self.inside([radius * cos, radius * sin], &[]).is_some();
        if is_lit(reach) {
            return reach;
        }
        let (mut low, mut high) = (0.0, reach);
        for _ in 0..END_HALVINGS {
            let middle = f64::midpoint(low, high);
            if is_lit(middle) { low = middle } else { high = middle }
        }
        high
    }
}

/// Returns the area of a polygon around a point, its centroid, and its second moments about the centroid by the area:
/// xx, xy and yy.
fn moments(outline: &[[f64; 2]]) -> (f64, [f64; 2], [f64; 3]) {
    let [ox, oy] = outline[0];
    let (mut area, mut first, mut second) = (0.0, [0.0; 2], [0.0; 3]);
    for (i, p) in outline.iter().enumerate() {
        let q = outline[(i + 1) % outline.len()];
        let ([px, py], [qx, qy]) = ([p[0] - ox, p[1] - oy], [q[0] - ox, q[1] - oy]);
        let part = (px * qy - py * qx) / 2.0;
        area += part;
        for (sum, value) in first.iter_mut().zip([px + qx, py + qy]) {
            *sum += part * value / 3.0;
        }
        let products = |ax: f64, ay: f64| [ax * ax, ax * ay, ay * ay];
        let all = [products(px, py), products(qx, qy), products(px + qx, py + qy)];
        for (k, sum) in second.iter_mut().enumerate() {
            *sum += part * all.iter().map(|products| products[k]).sum::<f64>() / 12.0;
        }
    }
    let [mx, my] = first.map(|sum| sum / area);
    let about = [mx * mx, mx * my, my * my];
    (area, [ox + mx, oy + my], std::array::from_fn(|k| second[k] / area - about[k]))
}

/// Returns the region of an outline.
fn region(outline: &[[f64; 2]]) -> Node {
    let (_, [cx, cy], [xx, xy, _]) = moments(outline);
    let [low, high] = reach(outline);
    let (half, per_x) = ((high - low) / 2.0, xy / xx);
    let at = |x: f64| cy + per_x * (x - cx);
    let mut node = [0.0; NUMBERS];
    node[..4].copy_from_slice(&[low, high, at(f64::midpoint(low, high)), per_x * half]);
    for (i, g) in node[4..].iter_mut().enumerate() {
        let along = (2.0 * i as f64 / (HEIGHTS - 1) as f64 - 1.0).clamp(-OUTERMOST, OUTERMOST);
        let x = low + half * (1.0 + along);
        let sides = outline.iter().zip(outline.iter().cycle().skip(1));
        let heights = sides
            .filter(|(p, q)| (p[0] <= x) != (q[0] <= x))
            .map(|(p, q)| (p[1] + (x - p[0]) / (q[0] - p[0]) * (q[1] - p[1]) - at(x)).abs());
        *g = heights.fold(0.0, f64::max) / (1.0 - along * along).sqrt();
    }
    node
}

/// Returns the least and the greatest x of an outline.
fn reach(outline: &[[f64; 2]]) -> [f64; 2] {
    let all = || outline.iter().map(|point| point[0]);
    [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
}

/// Returns the index of a node.
fn index(node: [usize; 4]) -> usize {
    node.iter().zip(NODES).rev().fold(0, |sum, (step, count)| sum * count + step)
}

/// Returns the nodes around a position in the table, with their weights.
fn around(position: [f64; 4]) -> Vec<(usize, f64)> {
    let first: [usize; 4] = std::array::from_fn(|axis| (position[axis] as usize).min(NODES[axis] - 2));
    let corner = |n: usize| {
        let mut weight = 1.0;
        let node = std::array::from_fn(|axis| {
            let (step, part) = (n >> axis & 1, position[axis] - first[axis] as f64);
            weight *= if step == 1 { part } else { 1.0 - part };
            first[axis] + step
        });
        (index(node), weight)
    };
    (0..16).map(corner).filter(|(_, weight)| *weight > 0.0).collect()
}

/// Traces the pupils of a lens at one focus, which may lie between two nodes. Pupils between nodes of the film are
/// traced at nodes of focus and stop; pupils between stops at nodes of film and focus. The second list has the pupils
/// of the film's centre.
fn traced(
    optics: &Optics,
    lens: &Lens,
    [focus, distance, widest]: [f64; 3],
) -> Option<(Vec<Traced>, Vec<Outline>)> {
    let last = |axis: usize| (NODES[axis] - 1) as f64;
    let (mut all, mut centers) = (Vec::new(), Vec::new());
    let film_side = 2 * NODES[0] - 1;
    let mut middles = vec![None; film_side * film_side];
    for half in (1..2 * NODES[3] - 1).rev() {
        let stop = half as f64 / 2.0;
        let is_node = focus.fract() == 0.0 && stop.fract() == 0.0;
        if focus.fract() != 0.0 && stop.fract() != 0.0 {
            continue;
        }
        let view =
            View::of(optics, lens, distance, stop / last(3), std::f64::consts::SQRT_2 * widest * distance)?;
        let step = if is_node { 1 } else { 2 };
        for j in (0..film_side).step_by(step) {
            for i in (0..film_side).step_by(step) {
                let at = [i as f64 / 2.0, j as f64 / 2.0];
                let film = [0, 1].map(|axis| at[axis] / last(axis) * widest * distance);
                let here = i + film_side * j;
                let neighbours = [
                    Some(here),
                    i.checked_sub(step).map(|_| here - step),
                    j.checked_sub(step).map(|_| here - film_side * step),
                ];
                let near: Outline =
                    neighbours.into_iter().flatten().filter_map(|at: usize| middles[at]).collect();
                let Some(inside) = view.inside(film, &near) else { continue };
                let outline = view.outline(film, inside, DIRECTIONS);
                middles[here] = Some(moments(&outline).1);
                if here == 0 && is_node {
                    centers.push(view.outline(film, inside, CENTER_DIRECTIONS));
                }
                all.push(Traced { position: [at[0], at[1], focus, stop], outline });
            }
        }
    }
    centers.reverse();
    Some((all, centers))
}

impl QuarterTable {
    /// Makes the table for film points up to `reach` mm from the axis; `None` if the film's centre is dark. `others`
    /// are lenses with the same glasses at other wavelengths, whose pupils the table contains, too.
    pub fn of(optics: &Optics, others: &[Lens], reach: f64) -> Option<Self> {
        let last = (FOCI - 1) as f64;
        let at = |step: usize| (step as f64 / 2.0, optics.at_node(step as f64 / 2.0, last));
        let foci: Vec<(f64, (Lens, f64))> = (0..2 * FOCI - 1).map(at).collect();
        let shortest = foci.iter().map(|(_, (_, distance))| *distance).fold(f64::INFINITY, f64::min);
        let wide = |(_, (lens, distance)): &(f64, (Lens, f64))| {
            View::of(optics, lens, *distance, 1.0, reach * distance / shortest)
        };
        let direction = |i: u32| (f64::from(i) / f64::from(END_DIRECTIONS) * TAU / 4.0).sin_cos();
        let mut ends = [f64::INFINITY, 0.0_f64];
        for focus in foci.iter().step_by(2) {
            let (view, distance) = (wide(focus)?, focus.1.1);
            for (sin, cos) in (0..=END_DIRECTIONS).map(direction) {
                let end = view.end([cos, sin], reach * distance / shortest) / distance;
                ends = [ends[0].min(end), ends[1].max(end)];
            }
        }
        let widest_field = ends[1];
        let work: Vec<(f64, Lens, f64)> = foci
            .iter()
            .flat_map(|(focus, (lens, distance))| {
                let tinted =
                    others.iter().filter(|_| focus.fract() == 0.0).map(|other| with_indices(lens, other));
                std::iter::once(lens.clone()).chain(tinted).map(|lens| (*focus, lens, *distance))
            })
            .collect();
        let found: Option<Vec<(Vec<Traced>, Vec<Outline>)>> = std::thread::scope(|scope| {
            let start = |(focus, lens, distance): &(f64, Lens, f64)| {
                let (focus, distance, lens) = (*focus, *distance, lens.clone());
                scope.spawn(move || traced(optics, &lens, [focus, distance, widest_field]))
            };
            let threads: Vec<_> = work.iter().map(start).collect();
            threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        });
        let found = found?;
        let of_own = |at: usize| at == 0 || work[at - 1].0 != work[at].0;
        let semi_axes = |outline: &Outline| {
            let (area, _, [xx, _, yy]) = moments(outline);
            // The semi-axes of an ellipse of this area.
            let scale = (area / (TAU / 2.0) / (xx * yy).sqrt()).sqrt();
            [xx, yy].map(|square| square.sqrt() * scale)
        };
        let own = found.iter().enumerate().filter(|(at, _)| of_own(*at));
        let centers: Vec<[f64; 2]> =
            own.flat_map(|(_, (_, centers))| centers.iter().map(semi_axes)).collect();
        let all: Vec<Traced> = found.into_iter().flat_map(|(traced, _)| traced).collect();
        if centers.len() != FOCI * (NODES[3] - 1) {
            return None;
        }
        let mut table = Self { nodes: nodes(&all)?, centers, widest_field, reach: ends[0] * shortest };
        table.widen_reach(&all);
        table.widen_heights(&all);
        Some(table)
    }

    /// Returns a number of a node, interpolated.
    fn interpolated(&self, nodes: &[(usize, f64)], k: usize) -> f64 {
        nodes.iter().map(|&(node, weight)| weight * self.nodes[node][k]).sum()
    }

    fn widen_reach(&mut self, all: &[Traced]) {
        for Traced { position, outline } in all {
            let (nodes, [low, high]) = (around(*position), reach(outline));
            let squares: f64 = nodes.iter().map(|(_, weight)| weight * weight).sum();
            let below = (self.interpolated(&nodes, 0) - low).max(0.0) / squares;
            let above = (high - self.interpolated(&nodes, 1)).max(0.0) / squares;
            for (node, weight) in nodes {
                self.nodes[node][0] -= weight * below;
                self.nodes[node][1] += weight * above;
            }
        }
        for node in &mut self.nodes {
            let margin = MARGIN * (node[1] - node[0]) / 2.0;
            (node[0], node[1]) = (node[0] - margin, node[1] + margin);
        }
    }

    fn widen_heights(&mut self, all: &[Traced]) {
        for Traced { position, outline } in all {
            let nodes = around(*position);
            let [low, high, middle, slope] = std::array::from_fn(|k| self.interpolated(&nodes, k));
            let squares: f64 = nodes.iter().map(|(_, weight)| weight * weight).sum();
            for [x, y] in outline {
                let along = (2.0 * x - low - high) / (high - low);
                let place = (along + 1.0) / 2.0 * (HEIGHTS - 1) as f64;
                let first = (place as usize).min(HEIGHTS - 2);
                let shares = [(first, 1.0 - place + first as f64), (first + 1, place - first as f64)];
                let g: f64 = shares.iter().map(|(i, share)| share * self.interpolated(&nodes, 4 + i)).sum();
                let needed = (y - middle - slope * along).abs() / (1.0 - along * along).sqrt();
                let missing = (needed - g).max(0.0)
                    / squares
                    / shares.iter().map(|(_, share)| share * share).sum::<f64>();
                for (node, weight) in &nodes {
                    for (i, share) in shares {
                        self.nodes[*node][4 + i] += share * weight * missing;
                    }
                }
            }
        }
        self.nodes.iter_mut().flat_map(|node| &mut node[4..]).for_each(|g| *g *= 1.0 + MARGIN);
    }

    /// Returns the function `pupil`.
    pub fn text(&self) -> String {
        let last = NODES.map(|count| number((count - 1) as f64));
        let [along, up, foci, _] = NODES;
        format!(
            "/* Samples the pupil that a film point sees. field_x, field_y: its distances from the axes, as shares of that of\n   \
                the farthest bright one; focus: in steps of the table; stop: as in trace. Gives a point of the plane in mm,\n   \
                and the area that it stands for over pi. 0: the point is dark. */\n\
             int pupil(float field_x, float field_y, float focus, float stop, float sample_1, float sample_2, output float px,\n          \
             output float py, output float patch)\n{{\n{}\
               float a = field_x;\n  float b = field_y;\n  \
               if (a*a + b*b >= 1)\n    return 0;\n  \
               a *= {};\n  b *= {};\n  float c = focus;\n  float d = {}*stop;\n  \
               int i = min(int(a), {});\n  int j = min(int(b), {});\n  int k = min(int(c), {});\n  int l = min(int(d), {});\n  \
               a -= i;\n  b -= j;\n  c -= k;\n  d -= l;\n  \
               int first = i + {along}*(j + {up}*(k + {foci}*l));\n  \
               int at[16];\n  float w[16];\n  \
               float low = 0, high = 0, middle = 0, slope = 0;\n  \
               for (int n = 0; n < 16; n++) {{\n    \
                 i = n % 2;\n    j = n/2 % 2;\n    k = n/4 % 2;\n    l = n/8;\n    \
                 w[n] = (i > 0 ? a : 1 - a)*(j > 0 ? b : 1 - b)*(k > 0 ? c : 1 - c)*(l > 0 ? d : 1 - d);\n    \
                 at[n] = {NUMBERS}*(first + i + {along}*(j + {up}*(k + {foci}*l)));\n    \
                 low += w[n]*T[at[n]];\n    high += w[n]*T[at[n] + 1];\n    \
                 middle += w[n]*T[at[n] + 2];\n    slope += w[n]*T[at[n] + 3];\n  }}\n  \
               float radius = sqrt(sample_1);\n  \
               float sine = 0, cosine = 0;\n  \
               sincos({}*sample_2, sine, cosine);\n  \
               float along = radius*cosine;\n  \
               a = {}*(along + 1);\n  \
               i = min(int(a), {});\n  \
               a -= i;\n  \
               float height = 0;\n  \
               for (int n = 0; n < 16; n++)\n    \
                 height += w[n]*((1 - a)*T[at[n] + 4 + i] + a*T[at[n] + 5 + i]);\n  \
               px = 0.5*(low + high + (high - low)*along);\n  \
               py = middle + slope*along + height*radius*sine;\n  \
               patch = 0.5*(high - low)*height;\n  \
               return 1;\n}}\n\n",
            array("T", self.nodes.iter().flatten().copied()),
            last[0],
            last[1],
            last[3],
            NODES[0] - 2,
            NODES[1] - 2,
            NODES[2] - 2,
            NODES[3] - 2,
            number(TAU),
            number((HEIGHTS - 1) as f64 / 2.0),
            HEIGHTS - 2,
        )
    }

    /// Returns the text that samples the pupil: the slopes `sx` and `sy`, and `centre`, the irradiance of the film's
    /// centre over pi.
    pub fn sampling(&self) -> String {
        let stops = NODES[3] - 1;
        // From the stop 0 on, at which the pupil is a point.
        let of_focus = |axes: &[[f64; 2]]| {
            std::iter::once([0.0; 2]).chain(axes.to_vec()).flatten().collect::<Vec<f64>>()
        };
        let axes = self.centers.chunks(stops).flat_map(of_focus);
        let field = number(1.0 / self.widest_field);
        let next = 2 * NODES[3];
        let axis = |k: usize| {
            format!(
                "(1 - c)*((1 - d)*R[at + {k}] + d*R[at + {}]) + c*((1 - d)*R[at + {}] + d*R[at + {}])",
                k + 2,
                k + next,
                k + next + 2
            )
        };
        format!(
            "  /* A quarter of the film stands for all of it. */\n  \
               if (!pupil(abs(fx)*far*{field}, abs(fy)*far*{field}, b, stop, lens_sample[0], lens_sample[1], px, py, patch))\n    \
                 return;\n  \
               float sx = ((fx < 0 ? -px : px) - fx)*far;\n  \
               float sy = ((fy < 0 ? -py : py) - fy)*far;\n\n  \
               /* The semi-axes of the pupil of the film's centre, and the irradiance there over pi. */\n{}  \
               int k = min(int(b), {});\n  int l = min(int({stops}*stop), {});\n  \
               float c = b - k;\n  float d = {stops}*stop - l;\n  \
               int at = 2*(l + {}*k);\n  \
               float ax = far*({});\n  float ay = far*({});\n  \
               float centre = ax*ay/sqrt((1 + ax*ax)*(1 + ay*ay));\n",
            array("R", axes),
            FOCI - 2,
            stops - 1,
            NODES[3],
            axis(0),
            axis(1),
        )
    }
}

/// Returns all nodes, from the pupils that were traced there. A dark node has the region of the nearest lit node with the
/// same focus and stop. `None` if all nodes of a focus and stop are dark.
fn nodes(all: &[Traced]) -> Option<Vec<Node>> {
    let mut own: Vec<Option<Node>> = vec![None; NODES.iter().product()];
    for Traced { position, outline } in all {
        if position.iter().all(|step| step.fract() == 0.0) {
            own[index(position.map(|step| step as usize))].get_or_insert_with(|| region(outline));
        }
    }
    let [along, up, foci, stops] = NODES;
    let mut nodes = vec![[0.0; NUMBERS]; own.len()];
    for (focus, stop) in (0..foci).flat_map(|focus| (1..stops).map(move |stop| (focus, stop))) {
        let film = || (0..up).flat_map(|j| (0..along).map(move |i| [i, j]));
        for [i, j] in film() {
            let lit = film().filter_map(|[x, y]| Some(([x, y], own[index([x, y, focus, stop])]?)));
            let off = |[x, y]: [usize; 2]| x.abs_diff(i).pow(2) + y.abs_diff(j).pow(2);
            let (_, nearest) = lit.min_by_key(|(at, _)| off(*at))?;
            nodes[index([i, j, focus, stop])] = nearest;
        }
    }
    // At the stop 0, the point in the middle of the region at the next stop.
    let film_and_focus = along * up * foci;
    for n in 0..film_and_focus {
        let [low, high, middle, ..] = nodes[n + film_and_focus];
        nodes[n][..3].copy_from_slice(&[f64::midpoint(low, high), f64::midpoint(low, high), middle]);
    }
    Some(nodes)
}
