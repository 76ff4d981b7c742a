//! The library's results, against closed forms, invariants, golden tables of exact arithmetic, other programs and
//! brute force.

mod afocal;
mod apertures;
mod aspheres;
mod autofocus;
mod axial_beam;
mod batch;
mod blades;
mod camera_parameters;
mod catalogue;
mod flat_field;
mod glasses;
mod golden;
mod importance;
mod invariants;
mod kernel;
mod lens_format;
mod light;
mod media;
mod messages;
mod misprints;
mod models;
mod moving;
mod odd_samples;
mod plan;
mod planes;
mod posed_film;
mod pupil_everywhere;
mod pupil_fit;
mod refocus;
mod stock_cameras;
mod support;
mod tables;
mod warped_pupil;
mod wavelengths;
mod zemax;
