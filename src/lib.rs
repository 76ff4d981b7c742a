//! A real camera for renderers: rays traced from the film through every interface of a real lens
//! prescription (C. Kolb, D. Mitchell and P. Hanrahan, "A Realistic Camera Model for Computer
//! Graphics", SIGGRAPH 1995).
//!
//! The modules stand in the order in which data flows:
//!
//! | module | what it does |
//! |---|---|
//! | [`prescription`] | lens files to tables of interfaces and glasses; the built-in catalogue |
//! | [`optics`] | a lens at one wavelength and stop; thick lens, pupils, focus, depth of field |
//! | [`trace`] | exact rays through the lens, with the reason where one stops |
//! | [`plan`] | what a camera needs of all that, proven or measured; models within a tolerance |
//! | [`camera`] | film, lens samples, weights, transforms: a sample in, a ray out |
//! | `report` | errors against run time and stability (feature `report`) |
//! | [`abi`] | the C ABI and the entry of a pbrt-v1 host: the only exports, the only raw pointers |
//!
//! Lens space is camera space: origin at the vertex of the first interface, +z toward the scene, +x image
//! right, +y image up, millimetres.
#![deny(missing_docs)]

pub mod abi;
pub mod camera;
mod message;
mod numeric;
pub mod optics;
pub mod plan;
pub mod prescription;
#[cfg(feature = "report")]
pub mod report;
pub mod trace;
