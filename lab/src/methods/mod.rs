//! The ways to take rays through a lens, in one [`list`](METHODS): timed over blocks of rays from a film ([`block`]),
//! or given rays from anywhere ([`any_ray`]), as `trace` and the stability cases do.

pub mod any_ray;
pub mod block;
mod list;

pub use list::{Family, METHODS, Method, Number, Way};
