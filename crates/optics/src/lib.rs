//! Lenses: what they are, and all that can be said of them without many rays at once.
//!
//! A lens file becomes a [`Prescription`](prescription::Prescription), at a wavelength a [`Lens`](lens::Lens), and for a
//! direction of travel a [`Path`](trace::Path), which single rays walk.
//!
//! | module | contents |
//! |---|---|
//! | [`prescription`] | the table of a lens, the readers of its files, glasses, names of coatings, the catalogue (its files: `lenses`) |
//! | [`lens`] | surfaces with indices, figures with proven bounds, Snell's law, first-order optics, pupils |
//! | [`trace`] | exact single rays, with the reason where one is blocked: the reference for every faster way |
//! | [`imaging`] | opening a lens by name; the axial beam, focus, depth of field, moving groups, irradiance |

#![forbid(unsafe_code)]

pub mod imaging;
pub mod lens;
pub mod prescription;
pub mod trace;
