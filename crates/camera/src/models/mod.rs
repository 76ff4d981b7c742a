//! The camera models: the real lens, the thick lens, the thin lens, and cameras like pbrt's stock cameras.
//!
//! | model | ray | weight | in |
//! |---|---|---|---|
//! | `lens` | through every surface of the lens | A cos⁴θ'/Z² | `lens`, its parts in `lens_parts` |
//! | `thick`, `thin` | to the exit pupil, then by first-order optics | A cos⁴θ'/Z² | `ideal` |
//! | `perspective`, `orthographic` | as in pbrt, by transforms between spaces | 1 | `projective`, `spaces` |
//! | `environment` | every direction, by spherical coordinates | 1 | `environment` |
//!
//! A cos⁴θ'/Z² is the integrand of the film's irradiance E(x') = 1/Z² ∫ L cos⁴θ' dA'' times the area A that a lens
//! sample represents (Kolb, Mitchell and Hanrahan 1995, eq. 2); `weighting` scales it. `stock_cameras` builds the
//! models without a prescription.
//!
//! To add a model, add its file here; its variant and name in `camera/model.rs`; its parameters in
//! `camera/parameters/table.rs`, where every row lists the models that use the parameter; and its camera in
//! `camera/any_camera.rs`, where the compiler reports the matches on the model that must be extended. Every
//! model provides one `pipeline::ray_maker::RayMaker`, which makes one ray, four or many.

pub(crate) mod environment;
pub(crate) mod ideal;
pub(crate) mod lens;
mod lens_parts;
pub(crate) mod projective;
pub(crate) mod spaces;
pub(crate) mod stock_cameras;
