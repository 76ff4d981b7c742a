//! Light at surfaces: transmission by Fresnel's equations and thin films, and ghosts.
//!
//! [`split`] is the physics: it takes a stack of films and an angle and returns R and T. [`Surfaces`] tabulates it for
//! each distinct surface of a lens; [`LitPath`] carries light with its polarisation along a traced ray
//! ([`Path`](realistic_optics::trace::Path)), and [`Transmission`] along rays in lanes. [`Ghosts`] is
//! the light of a lamp that two surfaces reflect, and [`FilmGhosts`] samples the same paths from the film. `docs/light.md`
//! documents this crate.

#![forbid(unsafe_code)]

mod absorption;
mod beam;
mod boundary;
mod coated;
mod film_ghosts;
mod ghosts;
mod lamp;
mod lane_light;
mod lane_surface;
mod pairs;
mod polarization;
mod shares;
mod spray;
mod stack;
mod sums;
mod t_stop;
mod transmission;
mod work;

pub use absorption::Absorbers;
pub use boundary::Boundary;
pub use coated::{LitPath, MediumAt, Pair, SpectralPaths, Surfaces};
pub use film_ghosts::{FilmGhosts, PairChoice, SlopeChoice};
pub use ghosts::{GhostSpectrum, Ghosts, LeftOut, beyond_pairs, paraxial_focus};
pub use lamp::{Lamp, LampError};
pub use polarization::Light;
pub use spray::{Landing, Spray};
pub use stack::{Share, Split, split};
pub use t_stop::TStop;
pub use transmission::Transmission;
#[doc(hidden)]
pub use work::work_spent;
