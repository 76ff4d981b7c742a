//! Traces of many rays through a lens at once: by the fast kernel, and by polynomials fitted to rays.
//!
//! The kernel traces exactly and gives the same bits for one ray and for a million, with every instruction set. Fields
//! of view and the scale of the image, which require many rays, are measured with the kernel.
//!
//! | type | is |
//! |---|---|
//! | [`Kernel`](kernel::Kernel) | a lens compiled for one direction and one precision |
//! | [`PlaneRays`](kernel::PlaneRays) | a caller's rays from a plane: points and slopes |
//! | [`Optics`](kernel::Optics) | anything that rays in lanes go through, such as [`LensSteps`](kernel::LensSteps) |
//! | [`Traced`](kernel::Traced), [`LensRays`](kernel::LensRays) | a ray behind the lens; many such rays, as columns |
//! | [`Field`](field::Field) | the beam and the chief ray of a film point, and the field of view |
//! | [`ImageScale`](image_scale::ImageScale) | millimetres on the film per radian in the scene |
//! | [`Polynomial`](polynomial::Polynomial) | a lens fitted by polynomials |
//! | [`PolynomialLens`](polynomial::PolynomialLens) | such polynomials, which trace rays as a kernel does |
//!
//! This crate depends on `base`, `simd` and `optics`; `light` and `camera` depend on this crate.
//!
//! ```
//! use realistic_optics::{lens::Lens, prescription::catalogue, trace::Direction};
//! use realistic_trace::kernel::Kernel;
//!
//! let lens = Lens::at_own_wavelength(&catalogue::find("tessar.50mm").expect("in the catalogue"));
//! let kernel = Kernel::<f64>::new(&lens, Direction::FilmToScene);
//! let film = lens.rear().vertex - 46.0;
//! let ray = kernel.trace_one(film, [0.0, 0.0], [0.05, 0.0]).expect("it passes the lens");
//! assert!(ray.direction[2] > 0.99);
//! assert!(kernel.trace_one(film, [0.0, 0.0], [2.0, 0.0]).is_none());
//! ```
//!
//! Points are in lens space, millimetres; slopes are dx/dz and dy/dz.
//!
//! Only the public interface of the crate `realistic` is stable; the interface of this crate may change in any version.

#![deny(unsafe_code)]

pub mod field;
pub mod image_scale;
pub mod kernel;
pub mod polynomial;
