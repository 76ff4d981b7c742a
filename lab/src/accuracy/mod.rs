//! Error against run time, for rays traced by every method, polynomials and pupils with tables of several sizes, film
//! irradiance estimated by every sampler, pictures rendered with every source of rays, and refraction by every formula;
//! also the savings of plans, and a whole report in one run ([`suite`]).

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
