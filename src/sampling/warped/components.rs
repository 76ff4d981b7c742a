//! Whether a pupil is more, or less, than what its outline encloses: whether there is a hole within, or light beside it.

use std::f64::consts::PI;

use super::{outline::Outline, pencil::Pencil};
use crate::lens::pupil::SlopeDisk;

/// Half-lines with probe rays: fewer miss components, more take rays; the same of the next two.
const RAYS: usize = 12;
/// Probe rays along each of them within the outline, and from there to the cover's edge.
const WITHIN: usize = 5;
const BEYOND: usize = 8;
/// Distance from the middle over the edge's from which light that gets through is another component's: more than what edges,
/// and corners between the half-lines, are off.
const BESIDE: f64 = 1.02;
/// Steps of a search for a component between the probe rays.
const STEPS: u32 = 12;

/// What is probed: an outline, and a disk that holds all of the light.
struct Shape<'a> {
    outline: &'a Outline,
    cover: SlopeDisk,
}

/// Looks for holes within an outline and for light beside it: also between the probe rays, from each that is nearer to getting
/// through than its neighbours down to the least excess.
pub(super) fn has_components(pencil: &impl Pencil, outline: &Outline, cover: SlopeDisk) -> bool {
    let shape = Shape { outline, cover };
    let place = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
    let angle = |i: usize| PI * place(i, RAYS);
    // Denser near the outline.
    let outward = |k: usize| place(k, BEYOND).powf(1.5);
    let probes = |count: usize| (0..RAYS * count).map(move |probe| (probe / count, probe % count));
    let within = probes(WITHIN).map(|(i, k)| shape.at(angle(i), place(k, WITHIN) * shape.edge(angle(i))));
    let beyond = probes(BEYOND).map(|(i, k)| shape.beyond([angle(i), outward(k)]));
    let found = pencil.excesses(&within.chain(beyond).collect::<Vec<_>>());
    let (within, beyond) = found.split_at(RAYS * WITHIN);
    let is_component = |place: [f64; 2]| shape.distance(place) > BESIDE * shape.edge(place[0]);
    let excess = |i: usize, k: usize| beyond[i * BEYOND + k].value;
    if within.iter().any(|excess| excess.value > 0.0)
        || probes(BEYOND).any(|(i, k)| excess(i, k) <= 0.0 && is_component([angle(i), outward(k)]))
    {
        return true;
    }
    let is_least = |&(i, k): &(usize, usize)| {
        let own = excess(i, k);
        k > 0
            && own < excess(i, k - 1)
            && (k + 1 == BEYOND || own <= excess(i, k + 1))
            && (i == 0 || own <= excess(i - 1, k))
            && (i + 1 == RAYS || own <= excess(i + 1, k))
    };
    // The least found so far, where, and how far around that is probed next.
    let mut descents: Vec<(f64, [f64; 2], f64)> =
        probes(BEYOND).filter(is_least).map(|(i, k)| (excess(i, k), [angle(i), outward(k)], 1.0)).collect();
    for _ in 0..STEPS {
        let around = |&(_, [angle, part], step): &(f64, [f64; 2], f64)| {
            let (turn, way) = (step * PI / (2 * RAYS) as f64, step * 0.5 / BEYOND as f64);
            [[angle + turn, part], [angle - turn, part], [angle, part + way], [angle, part - way]]
                .map(|[angle, part]| [angle.clamp(0.0, PI), part.clamp(0.0, 1.0)])
        };
        let places: Vec<[f64; 2]> = descents.iter().flat_map(around).collect();
        if places.is_empty() {
            return false;
        }
        let found = pencil.excesses(&places.iter().map(|&place| shape.beyond(place)).collect::<Vec<_>>());
        let probes = places.as_chunks::<4>().0.iter().zip(found.as_chunks::<4>().0);
        for ((least, at, step), (places, found)) in descents.iter_mut().zip(probes) {
            let before = *least;
            for (place, excess) in places.iter().zip(found) {
                if excess.value < *least {
                    (*least, *at) = (excess.value, *place);
                }
            }
            if *least == before {
                *step /= 2.0;
            }
        }
        if descents.iter().any(|&(least, at, _)| least <= 0.0 && is_component(at)) {
            return true;
        }
        // Toward the outline everything leads inside.
        descents.retain(|&(least, ..)| least > 0.0);
    }
    false
}

impl Shape<'_> {
    /// The edge's distance in a direction of the frame.
    fn edge(&self, angle: f64) -> f64 {
        self.outline.radius(angle)
    }

    /// The distance at `part` of the way from the outline to the cover's edge.
    fn distance(&self, [angle, part]: [f64; 2]) -> f64 {
        let (frame, cover, edge) = (self.outline.frame, self.cover, self.edge(angle));
        let (sin, cos) = angle.sin_cos();
        let (offset, x, y) = (frame.center - cover.center[0], frame.width * cos, frame.height * sin);
        let (along, square) = (offset * x, x * x + y * y);
        let inside = cover.radius.powi(2) - offset * offset;
        let end = ((along * along + square * inside).max(0.0).sqrt() - along) / square;
        edge + part * (end.max(edge) - edge)
    }

    fn beyond(&self, place: [f64; 2]) -> [f64; 2] {
        self.at(place[0], self.distance(place))
    }

    fn at(&self, angle: f64, distance: f64) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        self.outline.frame.point([distance * cos, distance * sin])
    }
}
