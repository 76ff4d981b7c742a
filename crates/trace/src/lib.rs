//! Many rays through a lens at once.
//!
//! A [`Path`](realistic_optics::trace::Path) becomes a table of steps, and a vector of rays takes each step together.
//!
//! | module | contents |
//! |---|---|
//! | [`kernel`] | the exact trace in every precision, vector width and instruction set; the data that rays carry; searches of edges |
//! | [`polynomial`] | polynomials fitted to exact rays, which take the place of the surfaces within a tolerance |
//! | [`field`] | chief rays, the field of view, the lit radius of the film |
//! | [`image_scale`] | the length on film of an angle in the scene |

pub mod field;
pub mod image_scale;
pub mod kernel;
pub mod polynomial;
