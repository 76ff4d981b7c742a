//! The amplitudes of a surface, bare or with one film, including total reflection: Fresnel's equations and Airy's sum
//! (M. Born and E. Wolf, *Principles of Optics*, sections 1.5.2 and 1.6.4).

use super::complex::C;

/// The film on every surface between air and glass: its index and its thickness, nm.
pub type Film = Option<(f64, f64)>;

/// Returns the amplitudes r and t of the field, s or p polarised, between media with these indices and cosines.
fn fresnel(n: f64, cos: C, n_behind: f64, cos_behind: C, is_p: bool) -> [C; 2] {
    let scaled = |index: f64, cos: C| C(index, 0.0) * cos;
    let (a, b) = if is_p {
        (scaled(n_behind, cos), scaled(n, cos_behind))
    } else {
        (scaled(n, cos), scaled(n_behind, cos_behind))
    };
    let twice = C(2.0, 0.0) * scaled(n, cos);
    [(a - b).over(a + b), twice.over(a + b)]
}

/// Returns the amplitudes r and t of a surface at a cosine of incidence; t is scaled so that its square is the
/// transmitted power. They are for s, or for p with the field along s × k.
pub fn amplitudes(n: f64, film: Film, n_behind: f64, cos: f64, wavelength: f64, is_p: bool) -> [C; 2] {
    let inside = |index: f64| C::root(1.0 - (n / index).powi(2) * (1.0 - cos * cos));
    let (first, behind) = (C(cos, 0.0), inside(n_behind));
    let [r, t] = match film {
        None => fresnel(n, first, n_behind, behind, is_p),
        Some((index, thickness)) => {
            let within = inside(index);
            let [r1, t1] = fresnel(n, first, index, within, is_p);
            let [r2, t2] = fresnel(index, within, n_behind, behind, is_p);
            let phase = C(std::f64::consts::TAU * index * thickness / wavelength, 0.0) * within;
            let (once, twice) = (phase.turned(), (phase + phase).turned());
            let below = C(1.0, 0.0) + r1 * r2 * twice;
            [(r1 + r2 * twice).over(below), (t1 * t2 * once).over(below)]
        }
    };
    let power = (n_behind * behind.0 / (n * cos)).max(0.0).sqrt();
    [r, t * C(power, 0.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_reflected_goes_on() {
        for film in [None, Some((1.38, 99.6))] {
            for (n, behind) in [(1.0, 1.6), (1.6, 1.0), (1.5, 1.7)] {
                for i in 1..=40 {
                    let cos = f64::from(i) / 40.0;
                    for is_p in [false, true] {
                        let [r, t] = amplitudes(n, film, behind, cos, 550.0, is_p);
                        assert!((r.square() + t.square() - 1.0).abs() < 1e-12, "{film:?} {n} {behind} {cos}");
                    }
                }
            }
        }
    }
}
