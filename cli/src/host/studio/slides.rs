//! The lecture's slides: for each effect, a small scene that is rendered without the effect, with few samples, and
//! with many (after R. L. Cook, T. Porter and L. Carpenter, "Distributed Ray Tracing", 1984).

use super::session::{ShotOptions, Studio, stopped_down, whole_only};
use crate::failure::Failure;
use crate::host::render::Integrator;
use crate::host::scene::effects::Effect::{self, Dof, Gloss, Motion, SoftShadow, Translucency};
use crate::host::scene::effects::Effects;
use crate::host::scene::slides::{colour, gloss, motion, soft_shadow, translucency};
use crate::host::scene::{Scene, night, props};
use crate::image::{Picture, Sheet};
use std::fmt::Write as _;

/// A slide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Slide {
    /// Blurred reflections
    Gloss,
    /// Objects seen through frosted glass
    Translucency,
    /// Penumbras
    SoftShadow,
    /// Depth of field of a lens stopped down and wide open
    Dof,
    /// Balls that move while the shutter is open
    Motion,
    /// The four lenses of Kolb's figure from one position
    Lenses,
    /// Colour errors of a lens, by one, few and many wavelengths
    Colour,
    /// Small lamps out of focus, by paths from the camera and, in about the same time, by paths from the lamps
    Lamps,
}

/// Number of samples per pixel that leaves visible noise.
const FEW: u32 = 4;
/// Number of samples per pixel that leaves no visible noise.
const MANY: u32 = 64;

/// One picture of a slide.
struct SlidePanel {
    label: String,
    effects: Effects,
    options: ShotOptions,
    /// Camera parameters of this picture; the user may not give the same parameters.
    parameters: Vec<(&'static str, String)>,
    /// Factor that multiplies the default exposure.
    exposure: f32,
}

impl SlidePanel {
    fn new(label: impl Into<String>, effects: &[Effect], spp: u32) -> Self {
        let options = ShotOptions::plain(spp);
        let effects = Effects::only(effects);
        Self { label: label.into(), effects, options, parameters: Vec::new(), exposure: 1.0 }
    }

    fn set(mut self, name: &'static str, value: impl ToString) -> Self {
        self.parameters.push((name, value.to_string()));
        self
    }
}

impl Slide {
    /// Takes the slide's pictures and puts them on one sheet, in values for the screen, each with a line of text.
    ///
    /// # Errors
    /// The user gives a parameter that the slide sets, or the camera reports an error.
    pub fn take(
        self,
        studio: &Studio,
        has_lens: bool,
        spp: Option<u32>,
    ) -> Result<(Picture, String), Failure> {
        whole_only(&studio.parameters)?;
        let many = spp.unwrap_or(MANY);
        let (scene, panels) = self.panels(many, studio.size);
        let columns = if self == Self::Lenses { 2 } else { panels.len() as u32 };
        let mut sheet = Sheet::new(studio.size, panels.len() as u32, columns);
        let mut text = String::new();
        for panel in &panels {
            let mut parameters = studio.parameters.clone();
            for (name, value) in &panel.parameters {
                if *name == "lens_file" {
                    if has_lens {
                        return Err(Failure::Usage(
                            "this slide has its own lenses; leave out the lens".to_owned(),
                        ));
                    }
                    parameters.lens_file = None;
                }
                parameters.set_from_text(name, value)?;
            }
            let parameters = stopped_down(&parameters, &panel.effects)?;
            let scene = scene.clone().with(&panel.effects);
            let shot = studio.take(&parameters, &scene, &panel.options)?;
            sheet.add(&panel.label, &shot.picture, shot.tone.scale * panel.exposure);
            let info = shot.camera.info()?;
            let _ = writeln!(
                text,
                "{:<24} {}: {:.1} mm, f/{:.2}, {} samples per pixel in {:.2} s",
                panel.label,
                shot.camera.lens_name()?,
                info.focal_length_mm,
                info.fnumber,
                panel.options.spp,
                shot.took.as_secs_f64()
            );
        }
        Ok((sheet.into_picture(), text))
    }

    /// Returns the scene and its panels, with up to `many` samples per pixel.
    fn panels(self, many: u32, size: [u32; 2]) -> (Scene, Vec<SlidePanel>) {
        match self {
            // The image of a large lamp in rough metal has less noise than the image of a point.
            Self::Gloss => (gloss::scene(), three(&[SoftShadow], &[Gloss, SoftShadow], many)),
            Self::Translucency => (translucency::scene(), three(&[], &[Translucency], many)),
            Self::SoftShadow => (soft_shadow::scene(), three(&[], &[SoftShadow], many)),
            Self::Dof => (props::scene(), three(&[], &[Dof], many)),
            Self::Motion => (motion::scene(), three(&[], &[Motion], many)),
            Self::Lenses => (props::scene(), lenses(many)),
            Self::Colour => (colour::scene(), colours(many, size)),
            Self::Lamps => (night::scene(), lamps(many)),
        }
    }
}

/// Returns one panel without the effect, and two panels with it, one with few and one with many samples.
fn three(off: &[Effect], shown: &[Effect], many: u32) -> Vec<SlidePanel> {
    let on = |spp: u32| SlidePanel::new(format!("{spp} samples"), shown, spp);
    vec![SlidePanel::new("off", off, many), on(FEW.min(many)), on(many)]
}

/// Returns panels for the four lenses of Kolb's figure 6, from one position: a telephoto lens, a wide-angle lens, a
/// double Gauss and a fisheye, scaled to the focal lengths in that figure.
fn lenses(spp: u32) -> Vec<SlidePanel> {
    let lens = |label: &str, name: &str, diagonal: f64| {
        SlidePanel::new(label, &[SoftShadow, Dof], spp).set("lens_file", name).set("film_diagonal", diagonal)
    };
    vec![
        lens("200 mm telephoto", "telephoto.250mm@200mm", 43.3),
        lens("35 mm wide-angle", "wide.22mm@35mm", 43.3),
        lens("50 mm double Gauss", "dgauss.50mm", 43.3),
        lens("16 mm fisheye", "fisheye.10mm@16mm", 48.0),
    ]
}

/// Returns panels of the night scene, by paths from the camera and by paths from the lamps. A path from a lamp is
/// connected to the camera up to three times, and takes about as long as `AS_LONG` paths from the camera.
fn lamps(many: u32) -> Vec<SlidePanel> {
    const AS_LONG: u32 = 2;
    let panel = |integrator: Integrator, name: &str, spp: u32| {
        let mut panel = SlidePanel::new(format!("{spp} {name}"), &[SoftShadow, Dof], spp).set("fnumber", 2.0);
        panel.options.integrator = integrator;
        panel
    };
    vec![
        panel(Integrator::Path, "paths from the camera", many),
        panel(Integrator::Light, "from the lamps", (many / AS_LONG).max(1)),
    ]
}

/// Returns panels of the corner of a large picture, rendered with one wavelength and with several.
fn colours(many: u32, size: [u32; 2]) -> Vec<SlidePanel> {
    /// Ratio of the size of the whole picture to that of the panel.
    const ZOOM: u32 = 16;
    let panel = |label: &str, wavelengths: Option<u32>| {
        let spp = (2 * many / wavelengths.unwrap_or(1)).clamp(1, many);
        let mut panel = SlidePanel::new(label, &[Dof], spp)
            .set("lens_file", "dgauss.100mm")
            .set("film_diagonal", 43.3)
            .set("fnumber", 5.6);
        let [width, height] = size;
        panel.options.wavelengths = wavelengths;
        panel.options.whole = Some([ZOOM * width, ZOOM * height]);
        let [left, top] = [width * (ZOOM - 1) - width / 4, height / 4];
        let mut panel = panel.set("crop", format!("{left},{top},{},{}", left + width, top + height));
        panel.exposure = 2.0;
        panel
    };
    vec![panel("587.6 nm", None), panel("3 wavelengths", Some(3)), panel("12 wavelengths", Some(12))]
}
