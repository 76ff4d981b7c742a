//! Outlines of a lens's elements, as closed lines of points (z, y) in mm.

use realistic_optics::lens::{Lens, Surface};

/// Returns points of a surface's arc, from its lower edge to the upper one.
pub fn arc(surface: &Surface) -> Vec<[f64; 2]> {
    const HALF: i32 = 48;
    (-HALF..=HALF)
        .map(|i| {
            // Steps are even in angle, so that the edge of a hemisphere is as smooth as its middle.
            let y =
                surface.semi_diameter * (f64::from(i) / f64::from(HALF) * std::f64::consts::FRAC_PI_2).sin();
            [surface.vertex + surface.sagitta(y), y]
        })
        .collect()
}

/// Returns the outline of every element: the glass between two surfaces, with a cylindrical edge as wide as the wider
/// surface.
pub fn elements(lens: &Lens) -> Vec<Vec<[f64; 2]>> {
    lens.surfaces
        .windows(2)
        .filter(|pair| pair[0].n_film != 1.0)
        .map(|pair| {
            let radius = pair[0].semi_diameter.max(pair[1].semi_diameter);
            let mut outline = arc(&pair[0]);
            let edge_point =
                |surface: &Surface, y: f64| [surface.vertex + surface.sagitta(surface.semi_diameter), y];
            outline.extend([edge_point(&pair[0], radius), edge_point(&pair[1], radius)]);
            outline.extend(arc(&pair[1]).into_iter().rev());
            outline.extend([edge_point(&pair[1], -radius), edge_point(&pair[0], -radius)]);
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
