//! Outlines of a lens's elements, as closed lines of points (z, y) in mm.

use realistic_optics::lens::{Lens, Surface};
use realistic_optics::prescription::CoordinateBreak;

/// Returns a point of a surface in the plane x = 0, at a height above the axis of the surface, as (z, y) in lens space.
/// `frame` is that of the surface. The sagitta is that at the height `at`.
fn placed(surface: &Surface, frame: &CoordinateBreak, height: f64, at: f64) -> [f64; 2] {
    // The direction on the surface that lies in the plane.
    let [across, up, _] = frame.rotation[0];
    let length = across.hypot(up);
    let [x, y] = if length > 1e-9 { [-up / length, across / length] } else { [0.0, 1.0] };
    let sagitta = match &surface.unsymmetric {
        Some(figure) => -figure.sagitta([x * at, y * at]),
        None => surface.sagitta(at.abs()),
    };
    let [_, y, z] = frame.point([x * height, y * height, -sagitta]);
    [-z, y]
}

/// Returns points of the arcs of all surfaces, each from its lower edge to the upper one.
pub fn arcs(lens: &Lens) -> Vec<Vec<[f64; 2]>> {
    lens.surfaces.iter().zip(&lens.frames()).map(|(surface, frame)| arc(surface, frame)).collect()
}

/// Returns points of a surface's arc.
fn arc(surface: &Surface, frame: &CoordinateBreak) -> Vec<[f64; 2]> {
    const HALF: i32 = 48;
    (-HALF..=HALF)
        .map(|i| {
            // Steps are even in angle, so that the edge of a hemisphere is as smooth as its middle.
            let y =
                surface.semi_diameter * (f64::from(i) / f64::from(HALF) * std::f64::consts::FRAC_PI_2).sin();
            placed(surface, frame, y, y)
        })
        .collect()
}

/// Returns the two ends of the bars of the stop, from the aperture to `outer` mm from the axis.
pub fn stop_bars(lens: &Lens, stop: usize, outer: f64) -> [[[f64; 2]; 2]; 2] {
    let (frame, surface) = (lens.frames()[stop], &lens.surfaces[stop]);
    let end = |height: f64| placed(surface, &frame, height, 0.0);
    [-1.0, 1.0].map(|side| [end(side * surface.semi_diameter), end(side * outer)])
}

/// Returns the ends of the film, whose half height is `half`, at z = `film` in image space, as (z, y).
pub fn film_ends(lens: &Lens, film: f64, half: f64) -> [[f64; 2]; 2] {
    [-half, half].map(|y| {
        let [_, y, z] = lens.from_image_space([0.0, y, film]);
        [z, y]
    })
}

/// Returns the outline of every element: the glass between two surfaces, with a cylindrical edge as wide as the wider
/// surface.
pub fn elements(lens: &Lens) -> Vec<Vec<[f64; 2]>> {
    let frames = lens.frames();
    std::iter::zip(lens.surfaces.windows(2), frames.windows(2))
        .filter(|(pair, _)| pair[0].n_film != 1.0 && !pair[1].is_mirror)
        .map(|(pair, frames)| {
            let radius = pair[0].semi_diameter.max(pair[1].semi_diameter);
            let mut outline = arc(&pair[0], &frames[0]);
            let edge_point = |i: usize, y: f64| placed(&pair[i], &frames[i], y, pair[i].semi_diameter);
            outline.extend([edge_point(0, radius), edge_point(1, radius)]);
            outline.extend(arc(&pair[1], &frames[1]).into_iter().rev());
            outline.extend([edge_point(1, -radius), edge_point(0, -radius)]);
            outline
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::{catalogue, read};

    #[test]
    fn an_element_is_closed_by_its_edge() {
        let lens = Lens::at_d_line(&read("t", b"10 4 1.5 8\n-20 0 1 12\n").unwrap());
        let [outline] = &elements(&lens)[..] else { panic!("one element") };
        let highest = outline.iter().map(|point| point[1]).fold(0.0, f64::max);
        assert_eq!(highest, 6.0);
        // The narrower surface ends at height 4, on its sphere.
        let corner = [10.0_f64.mul_add(-1.0, (100.0_f64 - 16.0).sqrt()), 4.0];
        assert!(outline.iter().any(|p| (p[0] - corner[0]).abs() < 1e-12 && (p[1] - corner[1]).abs() < 1e-12));
    }

    #[test]
    fn cemented_elements_are_two() {
        let count = |name: &str| elements(&Lens::at_d_line(&catalogue::find(name).unwrap())).len();
        // The designs' tables state the number of interfaces with glass behind them.
        assert_eq!((count("dgauss.50mm"), count("telephoto.250mm"), count("wide.22mm")), (6, 4, 7));
    }
}
