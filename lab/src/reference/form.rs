//! The formulas of surfaces, z toward the film, with their gradients. They share nothing with the walk's.

use std::ops::{Add, Div, Mul, Sub};

use realistic_optics::{
    prescription::{Asphere, Biconic, FIRST_POWER, Meridian, Toroid, Unsymmetric},
    trace::Real,
};

/// A number in a formula: a real number, or an interval with its derivative.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    fn constant(number: f64) -> Self;
    fn root(self) -> Self;
}

impl<R: Real> Number for R {
    fn constant(number: f64) -> Self {
        R::from_f64(number)
    }

    fn root(self) -> Self {
        self.sqrt()
    }
}

/// Returns 1/radius, and 0 for an infinite radius.
pub(super) fn curvature<N: Number>(radius: f64) -> N {
    if radius.is_infinite() { N::constant(0.0) } else { N::constant(1.0) / N::constant(radius) }
}

/// Returns c u/(1 + √(1 - κ c² u)), the height of a conic at the squared distance u, and the square root.
fn conic<N: Number>(radius: f64, conic: f64, u: N) -> [N; 2] {
    let (one, c) = (N::constant(1.0), curvature::<N>(radius));
    let root = (one - (one + N::constant(conic)) * c * c * u).root();
    [c * u / (one + root), root]
}

/// Returns the height of a surface that is not symmetric about its axis.
///
/// A toroid satisfies (R - z)² + x² = (R - f)²: its points lie as far from the axis of rotation as those of the profile
/// f(y). With q = R - f this is z = f + x²/(q ± √(q² - x²)), where the sign is that of R.
pub(super) fn height<N: Number>(surface: &Unsymmetric, [x, y]: [N; 2]) -> N {
    match surface {
        Unsymmetric::Toroid(toroid) => {
            let [x, y] = along_profile(toroid, [x, y]);
            let f = profile(toroid, y * y);
            if toroid.rotation_radius.is_infinite() {
                return f;
            }
            let q = N::constant(toroid.rotation_radius) - f;
            f + x * x / (q + signed(toroid, (q * q - x * x).root()))
        }
        Unsymmetric::Biconic(own) => {
            let [sum, root] = biconic(own, [x * x, y * y]);
            sum / (N::constant(1.0) + root)
        }
    }
}

/// Returns the derivatives of the height with respect to x and y.
pub(super) fn gradient<R: Real>(surface: &Unsymmetric, at: [R; 2]) -> [R; 2] {
    match surface {
        Unsymmetric::Toroid(toroid) => {
            let [x, y] = along_profile(toroid, at);
            let [_, root] = conic::<R>(toroid.radius, toroid.conic, y * y);
            let mut slope = curvature::<R>(toroid.radius) * y / root;
            let mut power = y;
            for (i, term) in (1..).zip(toroid.terms) {
                slope = slope + R::from_f64(2.0 * f64::from(i)) * R::from_f64(term) * power;
                power = power * y * y;
            }
            if toroid.rotation_radius.is_infinite() {
                return along_profile(toroid, [R::ZERO, slope]);
            }
            // The equation of the toroid, differentiated.
            let radius = R::from_f64(toroid.rotation_radius);
            let q = radius - profile(toroid, y * y);
            let across = signed(toroid, (q * q - x * x).sqrt());
            along_profile(toroid, [x / across, q * slope / across])
        }
        Unsymmetric::Biconic(own) => {
            let [sum, root] = biconic(own, at.map(|part| part * part));
            let one = R::ONE;
            std::array::from_fn(|i| {
                let c = curvature::<R>(own.radii[i]);
                let bend = (one + R::from_f64(own.conics[i])) * c * c;
                let whole = one + root;
                (c + c) * at[i] / whole + sum * bend * at[i] / (root * whole * whole)
            })
        }
    }
}

/// Exchanges x and y if the profile lies in the meridian x.
fn along_profile<N: Copy>(toroid: &Toroid, [x, y]: [N; 2]) -> [N; 2] {
    if toroid.meridian == Meridian::X { [y, x] } else { [x, y] }
}

/// Gives a square root the sign of a toroid's radius of rotation.
fn signed<N: Number>(toroid: &Toroid, root: N) -> N {
    N::constant(toroid.rotation_radius.signum()) * root
}

/// Returns the height of a toroid's profile at y².
fn profile<N: Number>(toroid: &Toroid, v: N) -> N {
    let [height, _] = conic(toroid.radius, toroid.conic, v);
    let mut power = v;
    toroid.terms.iter().fold(height, |height, &term| {
        let term = N::constant(term) * power;
        power = power * v;
        height + term
    })
}

/// Returns c_x x² + c_y y² and √(1 - κ_x c_x² x² - κ_y c_y² y²) at x² and y².
fn biconic<N: Number>(own: &Biconic, squares: [N; 2]) -> [N; 2] {
    let (mut sum, mut under) = (N::constant(0.0), N::constant(1.0));
    for ((radius, conic), square) in own.radii.into_iter().zip(own.conics).zip(squares) {
        let c = curvature::<N>(radius);
        sum = sum + c * square;
        under = under - (N::constant(1.0) + N::constant(conic)) * c * c * square;
    }
    [sum, under.root()]
}

/// Returns the powers of the terms of a surface with the sizes of their coefficients.
pub(super) fn terms(asphere: &Asphere) -> impl Iterator<Item = (i32, f64)> + '_ {
    (FIRST_POWER as i32..).zip(asphere.terms)
}
