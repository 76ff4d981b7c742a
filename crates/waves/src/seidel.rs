//! Seidel sums: the third-order path differences of a lens that is symmetric about its axis, by surface.

use crate::object::ObjectPoint;
use realistic_optics::{
    imaging::axial_beam::stop_or_limiting,
    lens::{Lens, Surface, pupil::EntrancePupil},
};

/// The sums S_I to S_V of a surface or a lens, mm: spherical aberration, coma, astigmatism, field curvature (Petzval) and
/// distortion.
pub type Sums = [f64; 5];

/// Returns the sums of each surface for an object point, from the scene on; `None` for a lens that is not round, that has
/// terms of r or r³, or whose entrance pupil lies at infinity. At the edge of the pupil of the point, the wavefront has the
/// spherical aberration -S_I/8, the coma -S_II/2, the astigmatism -S_III/2 and the field curvature -(S_III + S_IV)/4, in the
/// sign of [`Wavefront`](crate::Wavefront) and over heights in the pupil; the higher a ray is there, the lower is its q (W. T.
/// Welford, *Aberrations of Optical Systems*, 1986, chapter 8).
pub fn sums(lens: &Lens, object: &ObjectPoint) -> Option<Vec<Sums>> {
    if !lens.is_round() {
        return None;
    }
    let pupil = EntrancePupil::of_surface(lens, stop_or_limiting(lens));
    let (z, radius) = (pupil.position()?, pupil.diameter() / 2.0);
    // Heights and slopes dy/ds at the front vertex, with s along the light.
    let [mut marginal, mut chief] = match *object {
        ObjectPoint::At([x, y, far]) => {
            let (height, gap) = (x.hypot(y), far - z);
            [[radius * far / gap, radius / gap], [height - height * far / gap, -height / gap]]
        }
        ObjectPoint::Toward { direction: [dx, dy, dz], .. } => {
            let slope = -dx.hypot(dy) / dz;
            [[radius, 0.0], [slope * z, slope]]
        }
    };
    let mut sums = Vec::with_capacity(lens.surfaces.len());
    for surface in &lens.surfaces {
        let (n, n_behind, c) = (surface.n_scene, surface.n_film, surface.curvature);
        let [[h, u], [h_chief, u_chief]] = [marginal, chief];
        let [a, a_chief] = [n * (h * c + u), n * (h_chief * c + u_chief)];
        let invariant = a * h_chief - a_chief * h;
        let behind = |[h, u]: [f64; 2]| (n * u - h * c * (n_behind - n)) / n_behind;
        let [u_behind, u_chief_behind] = [behind(marginal), behind(chief)];
        let step = u_behind / n_behind - u / n;
        let inverse = n_behind.recip() - n.recip();
        let inverse_squares = n_behind.powi(-2) - n.powi(-2);
        let fourth = deformation(surface)? * (n_behind - n) * 8.0;
        sums.push([
            -a * a * h * step + fourth * h.powi(4),
            -a * a_chief * h * step + fourth * h.powi(3) * h_chief,
            -a_chief * a_chief * h * step + fourth * h * h * h_chief * h_chief,
            -invariant * invariant * c * inverse,
            // (A'/A)(S_III + S_IV), without the quotient.
            -a_chief
                * (a_chief * a_chief * h * inverse_squares
                    + h_chief * c * inverse * (invariant - a_chief * h))
                + fourth * h * h_chief.powi(3),
        ]);
        let onward = |[h, _]: [f64; 2], u: f64| [h + surface.thickness * u, u];
        (marginal, chief) = (onward(marginal, u_behind), onward(chief, u_chief_behind));
    }
    Some(sums)
}

/// Returns the coefficient of r⁴ by which a surface differs from the sphere of its vertex; `None` with a term of r or
/// r³.
fn deformation(surface: &Surface) -> Option<f64> {
    let Some(figure) = &surface.figure else { return Some(0.0) };
    let asphere = &figure.asphere;
    let conic = (1.0 + asphere.conic) * asphere.radius.recip().powi(3) / 8.0;
    let has_odd = asphere.term(1) != 0.0 || asphere.term(3) != 0.0;
    (!has_odd).then_some(conic + asphere.term(4) - figure.vertex_curvature().powi(3) / 8.0)
}
