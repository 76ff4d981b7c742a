//! Error against run time: rays by every method, polynomials and pupils by the size of their tables, film irradiance by
//! every sampler, pictures by every source of rays, refraction by every formula, and the savings of plans; and a whole
//! report in one run ([`suite`]).

pub mod cameras;
pub mod curve;
pub mod irradiance;
pub mod leaving_out;
pub mod pictures;
pub mod pupils;
pub mod ray_map;
pub mod ray_sources;
pub mod refractions;
pub mod set_up;
pub mod suite;
pub mod vignetting;
