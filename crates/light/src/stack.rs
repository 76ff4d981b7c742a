//! Thin films on a surface: reflection and transmission of a stack of layers between two media at an angle, computed by
//! the transfer matrix (F. Abelès, "Recherches sur la propagation des ondes électromagnétiques sinusoïdales dans les
//! milieux stratifiés", *Annales de Physique* 12, 1950; H. A. Macleod, *Thin-Film Optical Filters*, chapter 2).
//!
//! A layer of index n and thickness d changes the phase of the tangential fields by δ = 2π n d cos θ/λ. With the tilted
//! admittance η = n cos θ (s) or η = n/cos θ (p), the matrix of the layer is
//!
//! M = [[cos δ, i sin δ/η], [i η sin δ, cos δ]].
//!
//! The product of all matrices times (1, η') is (B, C), and r = (η B - C)/(η B + C), t = 2 η/(η B + C). R = |r|² and T
//! = Re(η') |t|²/η are computed separately, so R + T = 1 can be used as a test. No layer absorbs.

use std::{
    f64::consts::TAU,
    ops::{Add, Div, Mul, Sub},
};

use realistic_optics::prescription::Layer;

/// Effect of a surface on reflected or on transmitted light: on the amplitudes of the component perpendicular to the
/// plane of incidence (s) and of the component in this plane (p).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Share of the power of s.
    pub s: f64,
    /// Share of the power of p.
    pub p: f64,
    /// Product `a_s a_p*` of the amplitudes, whose squared magnitudes are the shares of the power. It transforms light
    /// that is neither s nor p alone. The amplitude of p is that of its component along the surface.
    pub cross: [f64; 2],
}

impl Share {
    /// Returns the share of unpolarised light.
    pub fn mean(self) -> f64 {
        f64::midpoint(self.s, self.p)
    }

    /// The identity, which leaves all light unchanged.
    pub const WHOLE: Self = Self { s: 1.0, p: 1.0, cross: [1.0, 0.0] };
}

/// Effect of a surface on light at one angle of incidence.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Split {
    /// Reflected share.
    pub reflected: Share,
    /// Transmitted share; 0 beyond the critical angle.
    pub transmitted: Share,
}

impl Split {
    /// Returns the reflected or the transmitted share.
    pub fn share(self, is_reflected: bool) -> Share {
        if is_reflected { self.reflected } else { self.transmitted }
    }
}

/// Computes the reflected and the transmitted share of light of a wavelength, nm, that meets `layers`, in this order,
/// between two media, given by their refractive indices. `cosine` is that of the angle of incidence.
pub fn split(layers: &[Layer], media: [f64; 2], cosine: f64, wavelength: f64) -> Split {
    split_from_behind(layers.iter().rev(), media, cosine, wavelength)
}

/// Computes [`split`] for layers in reverse order, from the last that light meets to the first.
pub(super) fn split_from_behind<'a>(
    layers: impl Iterator<Item = &'a Layer> + Clone,
    [n, n_behind]: [f64; 2],
    cosine: f64,
    wavelength: f64,
) -> Split {
    // n sin θ is the same in every layer.
    let invariant = n * n * (1.0 - cosine * cosine);
    let cosine_in = |index: f64| Complex::root(1.0 - invariant / (index * index));
    let last = cosine_in(n_behind);
    let amplitudes = |admittance: &dyn Fn(f64, Complex) -> Complex| {
        let (first, behind) = (admittance(n, Complex::real(cosine)), admittance(n_behind, last));
        let [mut b, mut c] = [Complex::real(1.0), behind];
        for layer in layers.clone() {
            let cosine = cosine_in(layer.index);
            let turn = cosine * Complex::real(TAU * layer.index * layer.thickness / wavelength);
            let (cos, sin, admittance) = (turn.cos(), turn.sin(), admittance(layer.index, cosine));
            [b, c] = [cos * b + I * (sin / admittance) * c, I * (admittance * sin) * b + cos * c];
        }
        let sum = first * b + c;
        let passing = Complex::real(behind.re.max(0.0) / first.re).re.sqrt();
        let r = (first * b - c) / sum;
        let t = Complex::real(2.0 * passing) * first / sum;
        [r, t]
    };
    let s = amplitudes(&|index, cosine| cosine * Complex::real(index));
    let p = amplitudes(&|index, cosine| Complex::real(index) / cosine);
    let share = |part: usize| {
        let product = s[part] * p[part].conjugate();
        Share { s: s[part].square(), p: p[part].square(), cross: [product.re, product.im] }
    };
    Split { reflected: share(0), transmitted: share(1) }
}

const I: Complex = Complex { re: 0.0, im: 1.0 };

/// A complex number.
#[derive(Clone, Copy)]
struct Complex {
    re: f64,
    im: f64,
}

impl Complex {
    fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }

    /// Returns the square root of a real number, which is positive or positive imaginary. The result is never 0,
    /// because at exactly grazing incidence p would have no admittance.
    fn root(square: f64) -> Self {
        const LEAST: f64 = 1e-60;
        if square == 0.0 {
            Self::real(LEAST)
        } else if square > 0.0 {
            Self::real(square.sqrt())
        } else {
            Self { re: 0.0, im: (-square).sqrt() }
        }
    }

    fn conjugate(self) -> Self {
        Self { im: -self.im, ..self }
    }

    fn square(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    fn cos(self) -> Self {
        Self { re: self.re.cos() * self.im.cosh(), im: -self.re.sin() * self.im.sinh() }
    }

    fn sin(self) -> Self {
        Self { re: self.re.sin() * self.im.cosh(), im: self.re.cos() * self.im.sinh() }
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { re: self.re + b.re, im: self.im + b.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self { re: self.re - b.re, im: self.im - b.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self { re: self.re * b.re - self.im * b.im, im: self.re * b.im + self.im * b.re }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let square = b.square();
        let product = self * b.conjugate();
        Self { re: product.re / square, im: product.im / square }
    }
}
