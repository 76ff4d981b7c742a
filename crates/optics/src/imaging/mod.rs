//! Properties of a lens that need tracing: its axial beam, focus, depth of field and film irradiance. Also opens a lens
//! at a wavelength, stop, zoom and focus, which needs these. Field of view and image scale take many rays: they are in
//! `crates/trace`.
//!
//! The inputs are a lens and the position of its film; the results are distances (mm), angles (radians) and scales. The
//! module knows nothing of rasters, samplers or cameras.
//!
//! | question | answer | in |
//! |---|---|---|
//! | how wide is the beam of a distant point, and what limits it | the outermost ray parallel to the axis that gets through | [`axial_beam::AxialBeam`] |
//! | where is the image of an axial point | the plane where its bundle of exact rays has the smallest RMS radius | [`focus::AxialImage`] |
//! | which film distance for an object at D | the root of D(u) = F + 1/u - z' + b(u), with the best image's distance b(u) | [`focus::Focus`] |
//! | which distances are sharp enough | those where the blur D \|s₁ - s\|/s₁ of a pupil D wide stays below the circle of confusion | [`focus::DepthOfField`] |
//! | which angle the film covers | 2 atan(d/2f); of the real lens, between chief rays, which cross the stop at its centre | `realistic_trace::field` |
//! | how long an angle in the scene is on film | dx/dθ of the chief ray, meridional and sagittal | `realistic_trace::image_scale` |
//! | how bright the film is for unit radiance | E = ∫ cos⁴θ' d(slope)² over the rays that get through | [`irradiance`] |

pub mod axial_beam;
pub mod focus;
pub mod irradiance;
pub mod moving;
pub mod open;
