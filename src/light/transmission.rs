//! Transmission of rays from the film, a factor of a camera's weights. Takes a lens with its coatings; returns shares
//! of power, in lanes of either precision.
//!
//! Nearly every lens of the catalogue, and half of random ones, have a polynomial within 1e-4, relative, of the exact
//! product of their surfaces ([`TransmissionFit`]), which costs a small part of a ray. If there is none, as for the
//! gull-wing aspheres of telephones, each ray's light is traced from surface to surface ([`LitPath::trace_exactly`]):
//! the exact product, one ray at a time. The same holds for a lens that exceeds the work of a fit: many surfaces,
//! aspheres or layers.

use std::{fmt, sync::Arc};

use super::{
    absorption::Absorbers,
    coated::{LitPath, SpectralPaths, Surfaces},
    transmission_fit::{LaneFit, TransmissionFit},
};
use crate::{
    lens::{Lens, Ray, film_ray, pupil::SlopeDisk, refraction::Refraction},
    prescription::SurfaceCoating,
    trace::{
        Direction, Path, Real,
        kernel::{Cpu, Lanes, Scalar},
    },
};

/// A lens's transmission for rays from the film, at one wavelength or over a range of them.
#[derive(Clone, Debug)]
pub enum FilmTransmission {
    /// A polynomial.
    Fitted(TransmissionFit),
    /// The exact product, traced for each ray.
    Carried(CarriedLight),
}

impl FilmTransmission {
    /// Builds the transmission of a lens with these coatings, from the scene on, at its wavelength, for film at z =
    /// `film` out to `reach`, mm; `cover` returns the slopes of all rays that get through from a film point.
    pub fn new(
        lens: &Lens,
        coatings: &[SurfaceCoating],
        film: f64,
        reach: f64,
        cover: impl Fn([f64; 2]) -> SlopeDisk,
    ) -> Self {
        let lit = LitPath::new(path(lens), &Surfaces::of_each(lens, coatings));
        match TransmissionFit::new(&lit, film, reach, cover) {
            Some(fit) => Self::Fitted(fit),
            None => Self::Carried(CarriedLight { film, paths: Paths::One(lit.into()) }),
        }
    }

    /// Builds the transmission with a wavelength per ray, in nm within `range`. At a wavelength `lens` builds the lens,
    /// `paths` trace light, and `cover` returns the slopes of the lens's rays, if known. `absorbers` are its glasses.
    /// No polynomial is tried if one wavelength alone already has none.
    pub fn spectral<C: Fn([f64; 2]) -> SlopeDisk>(
        &self,
        range: [f64; 2],
        [film, reach]: [f64; 2],
        absorbers: &Absorbers,
        paths: &Arc<SpectralPaths>,
        lens: impl Fn(f64) -> Lens,
        cover: impl Fn(&Lens) -> Option<C>,
    ) -> Self {
        let at = |wavelength| {
            let lens = lens(wavelength);
            let surfaces = paths.surfaces(&lens).without_absorption();
            Some((LitPath::new(path(&lens), &surfaces), cover(&lens)?))
        };
        if let Self::Fitted(_) = self
            && let Some(fit) = TransmissionFit::spectral(range, film, reach, absorbers, at)
        {
            return Self::Fitted(fit);
        }
        Self::Carried(CarriedLight { film, paths: Paths::AtEach { range, paths: paths.clone() } })
    }

    /// Returns the transmission for rays in lanes of a precision.
    pub fn lane_transmission<S: Scalar>(&self) -> LaneTransmission<S> {
        match self {
            Self::Fitted(fit) => LaneTransmission::Fitted(fit.lane_fit()),
            Self::Carried(carried) => LaneTransmission::Carried(carried.clone()),
        }
    }
}

/// Returns the path of rays from the film. Blades in the stop do not change the transmission of a ray that passes it.
fn path(lens: &Lens) -> Path {
    Path::new(lens, Direction::FilmToScene, Refraction::Fused)
}

/// [`FilmTransmission`], for lanes of a precision.
#[derive(Clone, Debug)]
pub enum LaneTransmission<S> {
    /// A polynomial.
    Fitted(LaneFit<S>),
    /// The exact product, traced for each ray.
    Carried(CarriedLight),
}

impl<S: Scalar> LaneTransmission<S> {
    /// Returns the transmission of `U` vectors of rays from these film points, mm, with these slopes; 0 for a blocked
    /// ray. The wavelengths, nm, are used only if it depends on them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        points: &[[L; 2]; U],
        slopes: &[[L; 2]; U],
        wavelengths: &[L; U],
    ) -> [L; U] {
        match self {
            Self::Fitted(fit) => fit.lanes(cpu, points, slopes, wavelengths),
            Self::Carried(carried) => {
                let mut left = *wavelengths;
                for u in 0..U {
                    left[u] = carried.lanes(cpu, points[u], slopes[u], wavelengths[u]);
                }
                left
            }
        }
    }
}

/// Paths along which the light of each ray from the film is traced.
#[derive(Clone)]
pub struct CarriedLight {
    /// z of the film, mm.
    film: f64,
    paths: Paths,
}

#[derive(Clone)]
enum Paths {
    /// Path at the lens's wavelength.
    One(Arc<LitPath>),
    /// Paths at each wavelength, nm, within a range.
    AtEach { range: [f64; 2], paths: Arc<SpectralPaths> },
}

/// Maximum number of lanes of a vector.
const MOST_LANES: usize = 16;

impl CarriedLight {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes>(&self, cpu: Cpu<L>, [x, y]: [L; 2], [dx, dy]: [L; 2], wavelengths: L) -> L {
        let mut rays = [[L::Scalar::ZERO; MOST_LANES]; 5];
        for (numbers, lanes) in rays.iter_mut().zip([x, y, dx, dy, wavelengths]) {
            lanes.store(numbers);
        }
        L::load(cpu, &self.shares(&rays, L::WIDTH))
    }

    /// Returns the shares of `count` rays, given as film points, slopes and wavelengths.
    #[cold]
    #[inline(never)]
    fn shares<S: Scalar>(&self, rays: &[[S; MOST_LANES]; 5], count: usize) -> [S; MOST_LANES] {
        let mut shares = [S::ZERO; MOST_LANES];
        for (i, share) in shares.iter_mut().enumerate().take(count) {
            let [x, y, dx, dy, wavelength] = rays.each_ref().map(|numbers| numbers[i].to_f64());
            *share = S::from_f64(self.share(film_ray([x, y], self.film, [dx, dy]), wavelength));
        }
        shares
    }

    fn share(&self, ray: Ray, wavelength: f64) -> f64 {
        let carried = match &self.paths {
            Paths::One(lit) => lit.trace_exactly(ray),
            Paths::AtEach { range: [from, to], paths } if (*from..=*to).contains(&wavelength) => {
                paths.trace(None, wavelength, ray)
            }
            Paths::AtEach { .. } => return 0.0,
        };
        carried.map_or(0.0, |(_, left)| left)
    }
}

impl fmt::Debug for CarriedLight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CarriedLight").field("film", &self.film).finish_non_exhaustive()
    }
}
