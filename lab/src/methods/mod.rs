//! Methods to trace rays through a lens, in one [`list`](METHODS). They are timed over blocks of rays from a film
//! ([`block`]), or applied to rays of any origin ([`any_ray`]), as in `trace` and the stability cases.

pub mod any_ray;
pub mod block;
mod list;

pub use list::{Algorithm, Family, METHODS, Method, Number};
