//! The list of all methods to trace rays through a lens: first-order optics, polynomials, the compiled kernels in
//! every instance, and the walk with each refraction.

use realistic_optics::lens::refraction::Refraction;
use realistic_simd::Simd;

/// The number type of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// Single precision.
    F32,
    /// Double precision.
    F64,
    /// Double-double, 106 bits: the reference.
    DoubleDouble,
}

/// The algorithm of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Algorithm {
    /// Traces surface by surface.
    Walk(Refraction),
    /// Thin lens: both principal planes are placed at the rear principal plane.
    ThinLens,
    /// Thick lens, from principal plane to principal plane.
    ThickLens,
    /// A polynomial of the given order, one ray at a time.
    Polynomial(usize),
    /// A polynomial of the given order, many rays at once.
    PolynomialBatch(usize),
    /// The compiled kernel, one ray at a time, as in a camera.
    One,
    /// The compiled kernel, a ray and its two differentials at a time.
    Three,
    /// The compiled kernel, batches from a plane, with these instructions.
    Batch(Simd),
    /// The compiled kernel, batches from a plane, with the widest registers (`REALISTIC_SIMD`).
    Widest,
    /// The compiled kernel, batches of rays that each have their own origin.
    Anywhere,
}

/// A family of methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// First-order optics.
    Gaussian,
    /// Polynomials, one ray at a time.
    Polynomial,
    /// Polynomials, many rays at once.
    PolynomialBatch,
    /// The compiled kernels: one ray or three.
    Kernel,
    /// The compiled kernels in batches.
    KernelBatch,
    /// The walk over every surface, with any of the lecture's refractions, and the reference.
    Walk,
}

impl Family {
    /// Every family with its name.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("first-order optics", Self::Gaussian),
        ("polynomials", Self::Polynomial),
        ("polynomials in batches", Self::PolynomialBatch),
        ("compiled, single rays", Self::Kernel),
        ("compiled, in batches", Self::KernelBatch),
        ("plain loop", Self::Walk),
    ];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, family)| *family == self).map_or("", |(name, _)| name)
    }

    /// Whether the family traces many rays at once.
    pub fn in_batches(self) -> bool {
        matches!(self, Self::PolynomialBatch | Self::KernelBatch)
    }
}

/// A method to trace rays through a lens, in a number type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// Short name, for tables.
    pub name: &'static str,
    /// The algorithm.
    pub algorithm: Algorithm,
    /// The number type.
    pub number: Number,
    /// Name and one-line description of the method in `trace --method`; `None` if `trace` does not offer it.
    pub option: Option<(&'static str, &'static str)>,
}

impl Method {
    /// Returns the method's family.
    pub fn family(&self) -> Family {
        match self.algorithm {
            Algorithm::Walk(_) => Family::Walk,
            Algorithm::ThinLens | Algorithm::ThickLens => Family::Gaussian,
            Algorithm::Polynomial(_) => Family::Polynomial,
            Algorithm::PolynomialBatch(_) => Family::PolynomialBatch,
            Algorithm::One | Algorithm::Three => Family::Kernel,
            Algorithm::Batch(_) | Algorithm::Widest | Algorithm::Anywhere => Family::KernelBatch,
        }
    }

    /// Returns the methods that `trace` offers, the default first, each with its name and a one-line description.
    pub fn offered() -> impl Iterator<Item = (&'static str, &'static str, &'static Self)> {
        METHODS.iter().filter_map(|method| method.option.map(|(name, help)| (name, help, method)))
    }

    /// Finds the method that `trace` offers under a name.
    ///
    /// # Errors
    /// The name is unknown; the message lists the known names.
    pub fn find(name: &str) -> Result<&'static Self, String> {
        Self::offered().find(|offer| offer.0 == name).map(|offer| offer.2).ok_or_else(|| {
            let names: Vec<&str> = Self::offered().map(|offer| offer.0).collect();
            format!("the methods are {}", names.join(", "))
        })
    }

    const fn new(name: &'static str, algorithm: Algorithm, number: Number) -> Self {
        Self { name, algorithm, number, option: None }
    }

    /// Builds a method that `trace` offers.
    const fn offer(
        name: &'static str,
        algorithm: Algorithm,
        number: Number,
        option: &'static str,
        help: &'static str,
    ) -> Self {
        Self { option: Some((option, help)), ..Self::new(name, algorithm, number) }
    }
}

const WIDEST: &str = "the kernel's batches in double precision, on the widest registers (REALISTIC_SIMD)";
const ONE: &str = "the kernel's single ray in double precision, as a camera traces one";
const OTHER: &str = "as f64, refracted by the \"other method\" of the same comparison";
const THICK: &str = "the thick lens: from principal plane to principal plane, without apertures; the point is where \
                     the ray leaves the vertex plane";
const THIN: &str = "as thick, with both principal planes where the film's side has its own (P')";

/// Every method; the first is the exact walk, to which all times are relative.
pub const METHODS: &[Method] = {
    use Algorithm::{
        Anywhere, Batch, One, Polynomial, PolynomialBatch, ThickLens, ThinLens, Three, Walk, Widest,
    };
    use Number::{DoubleDouble, F32, F64};
    use Refraction::{Fused, Heckbert, Other, Whitted};
    use Simd::{Avx2, Avx512, Portable};
    let new = Method::new;
    let offer = Method::offer;
    &[
        offer("walk f64", Walk(Fused), F64, "f64", "exact rays in double precision"),
        offer("walk f32", Walk(Fused), F32, "f32", "exact rays in single precision"),
        offer("batch f64", Widest, F64, "batch-f64", WIDEST),
        offer("batch f32", Widest, F32, "batch-f32", "the same in single precision"),
        offer("one f64", One, F64, "one-f64", ONE),
        offer("one f32", One, F32, "one-f32", "the same in single precision"),
        offer("heckbert", Walk(Heckbert), F64, "heckbert", "as f64, refracted by Heckbert's method"),
        offer("whitted", Walk(Whitted), F64, "whitted", "as f64, refracted by Whitted's method"),
        offer("other", Walk(Other), F64, "other", OTHER),
        offer("thick lens", ThickLens, F64, "thick", THICK),
        offer("thin lens", ThinLens, F64, "thin", THIN),
        new("reference", Walk(Fused), DoubleDouble),
        new("order 3", Polynomial(3), F64),
        new("order 5", Polynomial(5), F64),
        new("order 7", Polynomial(7), F64),
        new("order 9", Polynomial(9), F64),
        new("order 11", Polynomial(11), F64),
        new("order 3, f32", PolynomialBatch(3), F32),
        new("order 5, f32", PolynomialBatch(5), F32),
        new("order 7, f32", PolynomialBatch(7), F32),
        new("order 9, f32", PolynomialBatch(9), F32),
        new("order 11, f32", PolynomialBatch(11), F32),
        new("order 11, f64", PolynomialBatch(11), F64),
        new("three f32", Three, F32),
        new("three f64", Three, F64),
        new("f32 portable", Batch(Portable), F32),
        new("f64 portable", Batch(Portable), F64),
        new("f32x8", Batch(Avx2), F32),
        new("f64x4", Batch(Avx2), F64),
        new("f32x16", Batch(Avx512), F32),
        new("f64x8", Batch(Avx512), F64),
        new("f64 anywhere", Anywhere, F64),
        new("f32 anywhere", Anywhere, F32),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_method_lists_the_known_ones() {
        assert_eq!(Method::find("f32").map(|method| method.name), Ok("walk f32"));
        assert!(Method::find("f16").unwrap_err().contains("heckbert"));
    }

    #[test]
    fn every_name_stands_once() {
        for (number, method) in METHODS.iter().enumerate() {
            assert!(METHODS[..number].iter().all(|other| other.name != method.name), "{}", method.name);
        }
    }
}
