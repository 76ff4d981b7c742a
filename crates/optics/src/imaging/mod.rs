//! Properties of a lens that need tracing: its axial beam, focus, depth of field and film irradiance. This module also
//! opens a lens at a wavelength, stop, zoom and focus, because opening needs these properties. Field of view and image
//! scale need many rays and are therefore in `crates/trace`.
//!
//! The inputs are a lens and the position of its film; the results are distances (mm), angles (radians) and scales. The
//! module is independent of rasters, samplers and cameras.
//!
//! | property | definition | item |
//! |---|---|---|
//! | width of the beam of a distant point, and the surface that limits it | the outermost ray parallel to the axis that gets through | [`axial_beam::AxialBeam`] |
//! | image of an axial point | the plane where the bundle of exact rays from that point has the smallest RMS radius | [`focus::AxialImage`] |
//! | film distance for an object at D | b(u), the distance of the best image, at the root u of F + 1/u - z' + b(u) = D | [`focus::Focus`] |
//! | depth of field | the object distances s₁ at which the blur D \|s₁ - s\|/s₁, with a pupil D wide, stays below the circle of confusion | [`focus::DepthOfField`] |
//! | field of view | 2 atan(d/2f) for a thin lens; for the real lens, the angle between the chief rays, which pass the centre of the stop | `realistic_trace::field` |
//! | chief ray of a point of the film or the scene | the ray through the centre of the stop, whatever apertures do to it | [`chief`] |
//! | image scale: length on the film for an angle in the scene | dx/dθ of the chief ray, meridional and sagittal | `realistic_trace::image_scale` |
//! | film irradiance for unit radiance | E = ∫ cos⁴θ' d(slope)² over the rays that get through | [`irradiance`] |

pub mod axial_beam;
pub mod chief;
pub mod focus;
pub mod irradiance;
pub mod moving;
pub mod open;
pub mod plane_of_focus;
