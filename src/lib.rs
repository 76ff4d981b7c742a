//! A real camera for renderers: rays traced from the film through every interface of a real lens
//! prescription (C. Kolb, D. Mitchell and P. Hanrahan, "A Realistic Camera Model for Computer
//! Graphics", SIGGRAPH 1995).
//!
//! The modules stand in the order in which data flows:
//!
//! | module | what it does |
//! |---|---|
//! | [`message`] | warnings and errors for people: levels, and names and numbers in them |
//! | [`numeric`] | vectors, roots and quadrature that several rooms need |
//! | [`prescription`] | lens files to tables of interfaces and glasses; the built-in catalogue |
//! | [`lens`] | a lens at one wavelength and stop: surfaces, refraction, thick lens and pupils |
//! | [`trace`] | exact rays through the lens, with the reason where one stops |
//! | [`imaging`] | what tracing tells about a lens: focus, depth of field, field, image scale |
//! | [`sampling`] | where rays start: disk mappings, the pupil disk, the warped pupil |
//! | [`plan`] | what a camera needs of all that, proven or measured; models within a tolerance |
//! | [`camera`] | film, weights, transforms: a sample in, a ray out |
//! | [`abi`] | the C ABI and the entry of a pbrt-v1 host: the only exports, the only raw pointers |
//!
//! Lens space is camera space: origin at the vertex of the first interface, +z toward the scene, +x image
//! right, +y image up, millimetres.

pub mod abi;
pub mod camera;
pub mod imaging;
pub mod lens;
pub mod message;
pub mod numeric;
pub mod plan;
pub mod prescription;
pub mod sampling;
pub mod trace;
