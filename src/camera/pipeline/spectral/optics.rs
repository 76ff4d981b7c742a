//! A lens at any wavelength: the media between its surfaces, and at which wavelengths they have indices.

use std::{ops::RangeInclusive, sync::Arc};

use crate::{
    lens::{Lens, refraction::Refraction},
    light::SpectralPaths,
    prescription::{
        Blades, Coating, Medium, SurfaceCoating,
        glass::{InternalTransmittance, refractive_index},
    },
    trace::{Direction, Path},
};

/// The wavelengths that may be asked for, nm.
pub(crate) const WAVELENGTHS: RangeInclusive<f32> = 380.0..=780.0;

/// A lens with the media between its surfaces, from which it is made at any wavelength.
#[derive(Clone, Debug)]
pub(crate) struct LensOfMedia {
    /// At the camera's own wavelength and stop.
    pub lens: Lens,
    /// The medium on the film's side of each surface.
    pub media: Vec<Medium>,
    /// What each of them absorbs, where that is known.
    pub transmittances: Vec<Option<Arc<InternalTransmittance>>>,
    /// Those in its stop, if it is not round.
    pub blades: Option<Blades>,
    /// Those of its surfaces, where what they leave of the light counts.
    pub coatings: Option<Vec<SurfaceCoating>>,
}

impl LensOfMedia {
    /// The lens at a wavelength, nm: the same surfaces and stop, and the indices there.
    pub fn at(&self, wavelength: f64) -> Lens {
        let mut lens = Lens { wavelength, ..self.lens.clone() };
        let mut n_scene = 1.0;
        for ((surface, medium), transmittance) in
            lens.surfaces.iter_mut().zip(&self.media).zip(&self.transmittances)
        {
            surface.n_scene = n_scene;
            n_scene = refractive_index(*medium, wavelength);
            surface.n_film = n_scene;
            surface.absorption = transmittance.as_ref().map_or(0.0, |own| own.coefficient(wavelength));
        }
        lens
    }

    /// Rays from the film through the lens at a wavelength, nm.
    pub fn path(&self, wavelength: f64) -> Path {
        let lens = self.at(wavelength);
        Path::new(&lens, Direction::FilmToScene, Refraction::Fused).with_blades(&lens, self.blades)
    }

    /// The lens for rays one at a time at wavelengths within a range, nm.
    pub fn paths(&self, range: &RangeInclusive<f32>) -> SpectralPaths {
        let mut largest = self.lens.clone();
        for nm in [range.start(), range.end()].map(|nm| f64::from(*nm)) {
            for (surface, other) in largest.surfaces.iter_mut().zip(self.at(nm).surfaces) {
                surface.n_scene = surface.n_scene.max(other.n_scene);
                surface.n_film = surface.n_film.max(other.n_film);
            }
        }
        let (media, transmittances) = (self.media.clone(), self.transmittances.clone());
        let medium = move |surface: usize, nm: f64| {
            let absorption = transmittances[surface].as_ref().map_or(0.0, |own| own.coefficient(nm));
            [refractive_index(media[surface], nm), absorption]
        };
        let bare = || vec![Coating::Bare.into(); largest.surfaces.len()];
        let coatings = self.coatings.clone().unwrap_or_else(bare);
        SpectralPaths::new(&largest, self.blades, &coatings, Arc::new(medium))
    }

    /// The wavelengths, nm, at which every medium has an index of 1 or more: the widest stretch of whole numbers. Most
    /// glasses have one everywhere; a formula that was fitted elsewhere may not.
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

/// The largest index that is believed.
const MOST_INDEX: f64 = 5.0;
