//! The optics that a shader needs before it traces a lens: the position of the film for an object distance and a
//! stop, and the plane in which the shader samples the pupil.
//!
//! The input is a lens at its widest stop. The output is its first-order optics, and the film distance of sharpest
//! focus (as in `realistic_optics::imaging::focus`) as a polynomial in two variables.
//!
//! The focus f runs from 0 at infinity to 1 at the nearest object: f = u / `nearest`, with u = 1/(z - F), where z is
//! the object plane and F is the front focal point, or the front vertex if groups focus. The stop s runs from 0 to 1,
//! the widest.

use super::polynomial::{Polynomial, fit};
use super::stations::Station;
use realistic_optics::imaging::axial_beam::{AxialBeam, semi_diameter_for_beam};
use realistic_optics::imaging::focus::{AxialImage, Focus, FocusError};
use realistic_optics::lens::pupil::{EntrancePupil, ExitPupil};
use realistic_optics::lens::{Lens, first_order::FirstOrder};

/// Magnification at the nearest focus, unless the lens states a nearer one.
const NEAREST_MAGNIFICATION: f64 = 0.15;
/// Numbers of Chebyshev points of focus and stop at which the film distance is sampled for the fit.
const FOCUS_POINTS: usize = 9;
const STOP_POINTS: usize = 9;
/// Stops whose film distances bound the film distances of all stops.
const STOPS: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
/// Number of terms of the film distance, in the focus and in the square of the stop.
pub const FOCUS_TERMS: usize = 5;
pub const STOP_TERMS: usize = 5;
/// Number of terms of the ratio of stop to beam width, in the square of that width.
pub const WIDTH_TERMS: usize = 4;

/// A lens prepared for the generator.
#[derive(Debug)]
pub struct Optics {
    /// The lens at its widest stop.
    pub lens: Lens,
    /// The surface whose aperture the f-number sets, counted from the scene.
    pub stop: usize,
    pub focal_length: f64,
    /// z from which an object distance is measured for the focus, mm: the z of the scene-side focal point, or of the
    /// front vertex if groups focus.
    pub focus_point: f64,
    /// f-number of the axial beam at the widest stop; smaller requested f-numbers have no effect.
    pub widest: f64,
    /// The ratio s/x by powers of x², where s is the stop and x is the axial beam's diameter as a share of that at
    /// the widest stop.
    pub stop_per_width: Polynomial<WIDTH_TERMS>,
    /// z of the entrance pupil, mm; for a pupil at infinity, z of the front vertex.
    pub entrance: f64,
    /// u at the nearest focus, 1/mm.
    pub nearest: f64,
    /// Distance of the plane in which the pupil is sampled, mm in front of the last vertex.
    pub plane: f64,
    /// Film distance, mm behind the last vertex: each row is a power of s², each column a power of f.
    pub film: [Polynomial<FOCUS_TERMS>; STOP_TERMS],
    /// Motion of the groups that focus; `None` if the whole lens moves.
    pub motion: Option<Motion>,
}

/// The motion of the groups that focus, as functions of f: the gap behind each surface except the last, mm, and the
/// stop's clear semi-diameter.
#[derive(Clone, Debug)]
pub struct Motion {
    pub gaps: Vec<Polynomial<FOCUS_TERMS>>,
    pub stop_radius: Polynomial<FOCUS_TERMS>,
}

impl Optics {
    /// Computes the optics of a lens; `stated` is its nearest object distance, mm in front of the front vertex, if
    /// its file states one.
    ///
    /// # Errors
    /// The lens cannot focus.
    pub fn of(station: &Station, stated: Option<f64>) -> Result<Self, FocusError> {
        let lens = &station.lens;
        let first_order = FirstOrder::of(lens)?;
        let focus = Focus::new(lens)?;
        let focal_length = first_order.focal_length;
        let beam = AxialBeam::of(lens);
        let stop = lens.stop_index().unwrap_or(beam.limiting);
        let entrance = EntrancePupil::of_surface(lens, stop);
        // The object stays in front of the lens.
        let room = 0.25 * focal_length - first_order.front_focal_point;
        // Gaps are nearly linear in the vergence at the front vertex; the film distance is nearly linear in the
        // vergence at the focal point.
        let focus_point = if station.focuses_by_groups() { 0.0 } else { first_order.front_focal_point };
        let stated = stated.map(|object| object - focus_point).filter(|ahead| *ahead > 0.0);
        let nearest = match stated {
            // Groups do not focus nearer than stated.
            Some(ahead) if station.focuses_by_groups() => 1.0 / ahead,
            _ => (NEAREST_MAGNIFICATION / focal_length)
                .max(stated.map_or(0.0, |ahead| (1.0 / ahead).min(1.0 / focal_length)))
                .min(1.0 / room.max(1e-3 * focal_length)),
        };
        let back = focus.film_distance(f64::INFINITY)?;
        // Any plane works; in the plane of the pupil, the pupil's outline hardly changes with field and focus. A
        // distant plane replaces the plane of a pupil that is at infinity or behind the film, which is beyond
        // infinity.
        let vergence = ExitPupil::of_surface(lens, stop).vergence(lens.rear().vertex - back);
        let vergence = vergence.clamp(0.2 / back.max(focal_length), 1.5 / back);
        let mut optics = Self {
            lens: lens.clone(),
            stop,
            focal_length,
            focus_point,
            widest: beam.fnumber(focal_length),
            stop_per_width: stop_per_width(lens, stop, beam.diameter()),
            entrance: entrance.position().unwrap_or(0.0),
            nearest,
            plane: 1.0 / vergence - back,
            film: [Polynomial([0.0; FOCUS_TERMS]); STOP_TERMS],
            motion: None,
        };
        optics.motion = optics.motion(station);
        optics.film = optics.film_distances();
        Ok(optics)
    }

    /// Returns the focal length on the scene's side, mm.
    pub fn front_focal_length(&self) -> f64 {
        self.focal_length * self.lens.front().n_scene
    }

    /// Returns the focal length on the film's side, mm.
    pub fn rear_focal_length(&self) -> f64 {
        self.focal_length * self.lens.rear().n_film
    }

    /// Returns the squeeze ratio; 1 for a lens that is afocal in the meridian x.
    pub fn squeeze(&self) -> f64 {
        FirstOrder::squeeze(&self.lens).unwrap_or(1.0)
    }

    /// Returns the vergence at the front vertex, 1/mm, of the object for a focus.
    fn vergence(&self, f: f64) -> f64 {
        let u = f * self.nearest;
        u / (1.0 + u * self.focus_point)
    }

    fn motion(&self, station: &Station) -> Option<Motion> {
        let points = chebyshev(FOCUS_POINTS);
        let lenses: Option<Vec<Lens>> = points.iter().map(|&f| station.focused(self.vergence(f))).collect();
        let lenses = lenses?;
        let of = |value: &dyn Fn(&Lens) -> f64| {
            let values: Vec<f64> = lenses.iter().map(value).collect();
            if values.iter().all(|value| *value == values[0]) {
                let mut terms = [0.0; FOCUS_TERMS];
                terms[0] = values[0];
                Polynomial(terms)
            } else {
                fit(&points, &values)
            }
        };
        let gaps = (0..self.lens.surfaces.len() - 1)
            .map(|row| of(&|lens: &Lens| lens.surfaces[row].thickness))
            .collect();
        Some(Motion { gaps, stop_radius: of(&|lens: &Lens| lens.surfaces[self.stop].semi_diameter) })
    }

    /// Returns the lens at a focus, with its groups at the positions for that focus.
    pub fn focused(&self, f: f64) -> Lens {
        let mut lens = self.lens.clone();
        if let Some(motion) = &self.motion {
            lens.surfaces[self.stop].semi_diameter = motion.stop_radius.at(f);
            let mut vertex = 0.0;
            for (surface, gap) in lens.surfaces.iter_mut().zip(&motion.gaps) {
                surface.vertex = vertex;
                surface.thickness = gap.at(f);
                vertex -= surface.thickness;
            }
            if let Some(rear) = lens.surfaces.last_mut() {
                rear.vertex = vertex;
            }
        }
        lens
    }

    /// Returns the film distance of sharpest focus for each focus, from exact rays, mm.
    pub fn exact_film_distances(&self, s: f64, focus: &[f64]) -> Vec<f64> {
        let image = |f: f64| {
            let mut lens = self.focused(f);
            lens.surfaces[self.stop].semi_diameter *= s;
            AxialImage::of(&lens, AxialBeam::of(&lens).entrance)
        };
        let unmoved = self.motion.is_none().then(|| image(0.0));
        let distance = |&f: &f64| match &unmoved {
            Some(image) => image.best(self.vergence(f)).distance,
            None => image(f).best(self.vergence(f)).distance,
        };
        focus.iter().map(distance).collect()
    }

    fn film_distances(&self) -> [Polynomial<FOCUS_TERMS>; STOP_TERMS] {
        let (focus, squares) = (chebyshev(FOCUS_POINTS), chebyshev(STOP_POINTS));
        let columns: Vec<Polynomial<FOCUS_TERMS>> = squares
            .iter()
            .map(|square| fit(&focus, &self.exact_film_distances(square.sqrt(), &focus)))
            .collect();
        let mut rows = [Polynomial([0.0; FOCUS_TERMS]); STOP_TERMS];
        for power in 0..FOCUS_TERMS {
            let values: Vec<f64> = columns.iter().map(|column| column.0[power]).collect();
            let terms: Polynomial<STOP_TERMS> = fit(&squares, &values);
            for (row, term) in rows.iter_mut().zip(terms.0) {
                row.0[power] = term;
            }
        }
        rows
    }

    /// Returns the fitted film distance, mm.
    pub fn film_distance(&self, f: f64, s: f64) -> f64 {
        self.film.iter().rev().fold(0.0, |sum, row| sum * s * s + row.at(f))
    }

    /// Returns the shortest and the longest distance from the film to the sampling plane, mm, over all foci and stops.
    pub fn distances(&self) -> [f64; 2] {
        let all = || STOPS.iter().flat_map(|&s| [0.0, 1.0].map(|f| self.film_distance(f, s) + self.plane));
        [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
    }

    /// Returns the lens at a node of the table, or between two nodes, and the distance from the film to the sampling
    /// plane, mm. Nodes run from 0 for infinity to `last` for the nearest object. Nodes of a lens that moves as a
    /// whole are equally spaced in 1/distance.
    pub fn at_node(&self, focus: f64, last: f64) -> (Lens, f64) {
        let share = focus / last;
        if self.motion.is_some() {
            return (self.focused(share), self.film_distance(share, 1.0) + self.plane);
        }
        let [shortest, longest] = self.distances();
        (self.lens.clone(), ((1.0 - share) / shortest + share / longest).recip())
    }

    /// Returns the distance of the nearest object in focus from the front vertex, mm.
    pub fn nearest_object(&self) -> f64 {
        self.focus_point + 1.0 / self.nearest
    }
}

/// Fits the stop as a function of the axial beam's width, both as shares of their widest values. The stop is the
/// height of the beam's outermost ray in the plane of the stop.
fn stop_per_width(lens: &Lens, stop: usize, widest: f64) -> Polynomial<WIDTH_TERMS> {
    let squares = chebyshev(STOP_POINTS);
    let share = |square: &f64| {
        let width = square.sqrt();
        semi_diameter_for_beam(lens, stop, width * widest) / lens.surfaces[stop].semi_diameter / width
    };
    fit(&squares, &squares.iter().map(share).collect::<Vec<f64>>())
}

/// Returns the Chebyshev points of [0, 1].
fn chebyshev(count: usize) -> Vec<f64> {
    let angle = |i: usize| (i as f64 + 0.5) / count as f64 * std::f64::consts::PI;
    (0..count).map(|i| 0.5 - 0.5 * angle(i).cos()).collect()
}
