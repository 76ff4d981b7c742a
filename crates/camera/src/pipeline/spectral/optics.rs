//! A lens at any wavelength: the media between its surfaces, and the wavelengths at which these media have
//! refractive indices.

use std::{ops::RangeInclusive, sync::Arc};

use realistic_light::SpectralPaths;
use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    prescription::{
        Coating, Medium, SurfaceCoating,
        glass::{InternalTransmittance, refractive_index},
    },
    trace::{Direction, Path},
};

/// Wavelengths that may be requested, nm.
pub const WAVELENGTHS: RangeInclusive<f32> = 380.0..=780.0;

/// A lens with the media between its surfaces, from which the lens at any wavelength follows.
#[derive(Clone, Debug)]
pub struct LensOfMedia {
    /// The lens at the camera's own wavelength and stop.
    pub lens: Lens,
    /// The media from the scene's to the film's, one more than surfaces.
    pub media: Vec<Medium>,
    /// Absorption of the medium behind each surface; `None` if it is not known.
    pub transmittances: Vec<Option<Arc<InternalTransmittance>>>,
}

impl LensOfMedia {
    /// Returns the lens at a wavelength, nm, with the same surfaces and stop and the refractive indices at
    /// that wavelength.
    pub fn at(&self, wavelength: f64) -> Lens {
        let mut lens = Lens { wavelength, ..self.lens.clone() };
        let beside = self.media.windows(2);
        for ((surface, media), transmittance) in
            lens.surfaces.iter_mut().zip(beside).zip(&self.transmittances)
        {
            surface.n_scene = refractive_index(media[0], wavelength);
            surface.n_film = refractive_index(media[1], wavelength);
            surface.absorption = transmittance.as_ref().map_or(0.0, |own| own.coefficient(wavelength));
        }
        lens
    }

    /// Returns the path of rays from the film through the lens at a wavelength, nm.
    pub fn path(&self, wavelength: f64) -> Path {
        let lens = self.at(wavelength);
        Path::new(&lens, Direction::FilmToScene, Refraction::Fused).with_apertures(&lens)
    }

    /// Returns the lens for rays traced one at a time, at wavelengths in a range, nm; without coatings the
    /// surfaces are bare.
    pub fn paths(&self, range: &RangeInclusive<f32>, coatings: Option<&[SurfaceCoating]>) -> SpectralPaths {
        let mut largest = self.lens.clone();
        for nm in [range.start(), range.end()].map(|nm| f64::from(*nm)) {
            for (surface, other) in largest.surfaces.iter_mut().zip(self.at(nm).surfaces) {
                surface.n_scene = surface.n_scene.max(other.n_scene);
                surface.n_film = surface.n_film.max(other.n_film);
            }
        }
        let (media, transmittances) = (self.media.clone(), self.transmittances.clone());
        let medium = move |number: usize, nm: f64| {
            let behind = number.checked_sub(1).and_then(|surface| transmittances[surface].as_ref());
            let absorption = behind.map_or(0.0, |own| own.coefficient(nm));
            [refractive_index(media[number], nm), absorption]
        };
        let bare = || vec![Coating::Bare.into(); largest.surfaces.len()];
        let coatings = coatings.map_or_else(bare, <[SurfaceCoating]>::to_vec);
        SpectralPaths::new(&largest, &coatings, Arc::new(medium))
    }

    /// Returns the longest run of whole-number wavelengths, nm, at which every medium has a refractive index
    /// from 1 to 5. Most glasses have such an index at every wavelength; a formula that was fitted to other
    /// wavelengths may not.
    pub fn range(&self) -> RangeInclusive<f32> {
        let has_index = |medium: &Medium, nm: f32| {
            let index = refractive_index(*medium, nm.into());
            (1.0..=MOST_INDEX).contains(&index)
        };
        let (first, last) = (*WAVELENGTHS.start() as u16, *WAVELENGTHS.end() as u16);
        let mut widest = 1.0..=0.0;
        let mut start = None;
        for nm in (first..=last).map(f32::from) {
            if !self.media.iter().all(|medium| has_index(medium, nm)) {
                start = None;
                continue;
            }
            let from = *start.get_or_insert(nm);
            if nm - from > widest.end() - widest.start() {
                widest = from..=nm;
            }
        }
        widest
    }
}

/// Largest plausible refractive index.
const MOST_INDEX: f64 = 5.0;
