//! Number and type of the steps that Newton's iteration takes at a surface, chosen by sample rays when the lens is
//! compiled.
//!
//! The first steps need only low precision: they use a polynomial in s that approximates the whole profile, at a
//! fraction of the cost. The last steps use the surface itself. The plan is the cheapest that converges within the
//! tolerance for rays to a grid of points, at incidences usual in lenses. Afterwards every ray is tested, and a ray
//! that needs more steps gets them.

use realistic_optics::trace::Aspheric;

/// The steps of Newton's iteration for every ray.
#[derive(Clone, Debug)]
pub struct NewtonPlan {
    /// Polynomials that approximate twice the profile, with coefficients of s^0, s^1, …; one step is taken with each.
    pub approximants: Vec<Vec<f64>>,
    /// Number of steps with the surface itself.
    pub exact: usize,
}

/// Degrees of the polynomials for the first steps, each with the cost of a step relative to that of a step with a
/// surface of 8 terms.
const DEGREES: [(usize, f64); 2] = [(2, 0.6), (5, 0.75)];
/// Maximum number of steps with the surface.
const MOST_EXACT: usize = 8;
/// Sines of the sample rays' angles to the axis in the medium before the surface.
const SINES: [f64; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];
/// Fractions of the semi-diameter at which the sample rays meet the surface.
const FRACTIONS: [f64; 6] = [0.0, 0.3, 0.5, 0.7, 0.85, 1.0];

impl NewtonPlan {
    /// Chooses the plan for rays that start on the plane z = `start` and must reach |G| <= `tolerance`.
    pub fn of(aspheric: &Aspheric<f64>, start: f64, tolerance: f64) -> Self {
        let approximants: Vec<Vec<f64>> = DEGREES.iter().map(|&(degree, _)| near(aspheric, degree)).collect();
        let rays = samples(aspheric, start);
        let costs = (0..=approximants.len()).map(|used| {
            let exact = exact_steps(aspheric, start, &approximants[..used], &rays, tolerance);
            let cost: f64 = DEGREES[..used].iter().map(|(_, cost)| cost).sum();
            (cost + exact as f64, used, exact)
        });
        let (_, used, exact) = costs.min_by(|a, b| a.0.total_cmp(&b.0)).expect("none may be used");
        Self { approximants: approximants.into_iter().take(used).collect(), exact }
    }
}

/// Returns the number of steps with the surface, at least 1, that bring |G| to at most `tolerance` on all the rays,
/// after one step with each of the approximants.
fn exact_steps(
    aspheric: &Aspheric<f64>,
    start: f64,
    approximants: &[Vec<f64>],
    rays: &[ProfileSample],
    tolerance: f64,
) -> usize {
    let residual = |ProfileSample { point: [x, y], v }: &ProfileSample, t: f64| {
        aspheric.residual([*x, *y, start], *v, t)
    };
    // t, and G and N·V at t, for each ray.
    let mut iterates: Vec<(f64, [f64; 2])> = rays
        .iter()
        .map(|ray| {
            let t = approached(aspheric, start, approximants, ray);
            (t, residual(ray, t))
        })
        .collect();
    for exact in 1..MOST_EXACT {
        let mut converged = true;
        for (ray, (t, [residual_there, facing])) in rays.iter().zip(&mut iterates) {
            *t += *residual_there / *facing;
            [*residual_there, *facing] = residual(ray, *t);
            converged &= residual_there.abs() <= tolerance;
        }
        if converged {
            return exact;
        }
    }
    MOST_EXACT
}

/// Returns t after one step with each of the approximants.
fn approached(
    aspheric: &Aspheric<f64>,
    start: f64,
    approximants: &[Vec<f64>],
    ProfileSample { point: [x, y], v }: &ProfileSample,
) -> f64 {
    let mut t = 0.0;
    for coefficients in approximants {
        let (at, along) = ([x + t * v[0], y + t * v[1]], |[x, y]: [f64; 2]| x * v[0] + y * v[1]);
        let u = at[0] * at[0] + at[1] * at[1];
        let [twice, slope] = polynomial(coefficients, u.min(aspheric.rim) / aspheric.unit);
        t -= (start + t * v[2] - twice / 2.0) / (v[2] - slope * along(at) / aspheric.unit);
    }
    t
}

/// A sample ray from its start plane.
struct ProfileSample {
    /// x and y on that plane.
    point: [f64; 2],
    v: [f64; 3],
}

/// Returns rays in the meridional plane and inclined to it.
fn samples(aspheric: &Aspheric<f64>, start: f64) -> Vec<ProfileSample> {
    let mut samples = Vec::new();
    for fraction in FRACTIONS {
        let r = fraction * aspheric.size;
        let z = aspheric.height(r * r);
        for sine in SINES {
            let cosine = (1.0_f64 - sine * sine).sqrt();
            for [across, along] in [[sine, 0.0], [-sine, 0.0], [0.0, sine]] {
                // Lengths are in units of n, which only scales t.
                let back = (start - z) / cosine;
                samples.push(ProfileSample {
                    point: [r + back * across, back * along],
                    v: [across, along, cosine],
                });
            }
        }
    }
    samples
}

/// Returns a polynomial of this degree in s that interpolates twice the profile at Chebyshev nodes from the axis to
/// the edge of the clear aperture (Newton's divided differences).
fn near(aspheric: &Aspheric<f64>, degree: usize) -> Vec<f64> {
    let count = degree + 1;
    let node = |i: usize| {
        let angle = std::f64::consts::PI * (i as f64 + 0.5) / count as f64;
        aspheric.rim / aspheric.unit * (1.0 - angle.cos()) / 2.0
    };
    let nodes: Vec<f64> = (0..count).map(node).collect();
    let mut differences: Vec<f64> = nodes.iter().map(|&s| 2.0 * aspheric.height(s * aspheric.unit)).collect();
    for order in 1..count {
        for i in (order..count).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (nodes[i] - nodes[i - order]);
        }
    }
    // Horner's rule for the sum of differences times products of (s - node).
    let mut coefficients = vec![0.0; count];
    for (difference, node) in differences.iter().zip(&nodes).rev() {
        for i in (0..count).rev() {
            coefficients[i] = if i > 0 { coefficients[i - 1] } else { 0.0 } - node * coefficients[i];
        }
        coefficients[0] += difference;
    }
    coefficients
}

fn polynomial(coefficients: &[f64], s: f64) -> [f64; 2] {
    coefficients.iter().rev().fold([0.0; 2], |[value, slope], a| [value * s + a, slope * s + value])
}
