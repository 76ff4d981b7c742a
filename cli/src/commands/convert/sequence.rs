//! A lens as a sequence of surfaces between an object and an image, which is how designers' programs describe one. The
//! writers of their formats differ in the words alone: everything that a prescription leaves open, and such a program
//! demands, is decided here.

use super::glasses::Material;
use realistic_base::message::{counted, short};
use realistic_optics::imaging::axial_beam::AxialBeam;
use realistic_optics::imaging::moving::MovingGroups;
use realistic_optics::lens::{Lens, first_order::FirstOrder, pupil::EntrancePupil};
use realistic_optics::prescription::{
    Aperture, FIRST_POWER, Outline, Prescription, Shape, SurfaceCoating,
    glass::{C_LINE, F_LINE},
};

/// A surface of the lens, and what stands behind it.
#[derive(Clone, Debug)]
pub struct SequenceRow<'a> {
    /// The number of the surface, counted from 1.
    pub number: usize,
    /// Signed radius, mm; infinite for a plane.
    pub radius: f64,
    pub conic: f64,
    /// The powers of r, in ascending order, with the coefficients that are not 0, mm^(1 - power).
    pub terms: Vec<(usize, f64)>,
    /// Distance to the next surface, or to the image, mm.
    pub thickness: f64,
    /// The medium behind the surface.
    pub behind: Material,
    /// Semi-diameter of the circle that limits the rays, mm.
    pub semi_diameter: f64,
    pub is_stop: bool,
    /// Apertures and obstructions other than circles about the axis that rays must pass.
    pub shapes: Vec<&'a Aperture>,
    pub coating: Option<&'a SurfaceCoating>,
}

/// A setting of the groups that move.
#[derive(Clone, Debug)]
pub struct Configuration {
    /// Distance from the object to the first surface, mm; infinite for a distant object.
    pub object_distance: f64,
    /// The surfaces, counted from 1, with the thicknesses behind them, mm.
    pub gaps: Vec<(usize, f64)>,
    /// Semi-diameter of the stop, mm.
    pub stop: f64,
}

/// A lens with object, image, wavelengths and field. Its aperture is the size of the stop.
#[derive(Clone, Debug)]
pub struct Sequence<'a> {
    pub title: Option<&'a str>,
    /// The medium in front of the lens.
    pub object: Material,
    /// The rows; one is the stop.
    pub rows: Vec<SequenceRow<'a>>,
    /// Wavelengths, nm, in ascending order.
    pub wavelengths: Vec<f64>,
    /// The wavelength for which the lens is described, among these.
    pub primary: usize,
    /// Diameter of the entrance pupil, by first-order optics, mm.
    pub entrance_pupil: f64,
    /// Half of the field of view, degrees; 0 if the lens states none.
    pub half_field: f64,
    /// The settings of the lens, at least one. The rows are as the first of them says.
    pub configurations: Vec<Configuration>,
}

impl<'a> Sequence<'a> {
    /// Returns the sequence of a lens. `notes` receives what was added, and what no other program is told.
    pub fn of(lens: &'a Prescription, notes: &mut Vec<String>) -> Self {
        let primary = lens.own_wavelength();
        let traced = Lens::at_own_wavelength(lens);
        let stop = lens.stop_index().unwrap_or_else(|| {
            let limiting = AxialBeam::of(&traced).limiting;
            notes.push(format!(
                "the lens states no stop; surface {}, which limits the axial beam, is the stop",
                limiting + 1
            ));
            limiting
        });
        let film = lens.nominal_film_distance.unwrap_or_else(|| {
            let focus = FirstOrder::of(&traced).map_or(0.0, |optics| optics.back_focal_distance());
            let focus = Some(focus).filter(|focus| *focus > 0.0 && focus.is_finite());
            let place = if focus.is_some() { "its paraxial focus" } else { "the last surface" };
            notes.push(format!("the lens states no place of the film; the image is at {place}"));
            focus.unwrap_or(0.0)
        });
        let configurations = configurations(lens, lens.interfaces[stop].semi_diameter);
        let mut media = lens.media().map(|medium| Material::of(lens, medium));
        let object = media.next().unwrap_or(Material::Air);
        let mut rows: Vec<SequenceRow<'a>> = (1..)
            .zip(&lens.interfaces)
            .zip(media)
            .map(|((number, interface), behind)| {
                let (radius, conic, terms) = figure(&interface.shape);
                let is_stop = number == stop + 1;
                let mut row = SequenceRow {
                    number,
                    radius,
                    conic,
                    terms,
                    thickness: interface.thickness,
                    behind,
                    semi_diameter: if is_stop { configurations[0].stop } else { interface.semi_diameter },
                    is_stop,
                    shapes: Vec::new(),
                    coating: lens.coatings.as_ref().and_then(|coatings| coatings.get(number - 1)),
                };
                interface.apertures.iter().for_each(|aperture| row.limit(aperture, notes));
                row
            })
            .collect();
        if let Some(last) = rows.last_mut() {
            last.thickness = film;
        }
        // The stop of the traced lens has the size of the table's row.
        let opening = rows[stop].semi_diameter / lens.interfaces[stop].semi_diameter;
        for (number, gap) in &configurations[0].gaps {
            rows[number - 1].thickness = *gap;
        }
        note_facts(lens, notes);
        let has_colours = (F_LINE..C_LINE).contains(&primary) && primary > F_LINE && lens.is_dispersive();
        let wavelengths = if has_colours { vec![F_LINE, primary, C_LINE] } else { vec![primary] };
        Self {
            title: lens.title.as_deref(),
            object,
            rows,
            primary: usize::from(has_colours),
            wavelengths,
            entrance_pupil: opening * EntrancePupil::of_surface(&traced, stop).diameter(),
            half_field: lens.stated.fields.first().copied().flatten().unwrap_or(0.0) / 2.0,
            configurations,
        }
    }

    /// Returns the wavelength for which the lens is described, nm.
    pub fn primary_wavelength(&self) -> f64 {
        self.wavelengths[self.primary]
    }

    /// Returns the angles of the field, degrees: the axis, seven tenths of the field and its end.
    pub fn angles(&self) -> Vec<f64> {
        let end = self.half_field;
        if end > 0.0 { vec![0.0, 0.7 * end, end] } else { vec![0.0] }
    }

    /// Notes that the format has one configuration, if the lens has more.
    pub fn note_one_configuration(&self, notes: &mut Vec<String>) {
        if let more @ 2.. = self.configurations.len() {
            notes.push(format!("the lens has {more} positions, of which the first is written"));
        }
    }

    /// Notes that coatings are left out, if the lens has any.
    pub fn note_no_coatings(&self, notes: &mut Vec<String>) {
        let is_coated = |row: &&SequenceRow<'_>| row.coating.is_some_and(|coating| !coating.is_bare());
        let coated: Vec<usize> = self.rows.iter().filter(is_coated).map(|row| row.number).collect();
        if !coated.is_empty() {
            notes.push(format!("the coatings of {} are left out", counted("surface", "surfaces", &coated)));
        }
    }

    /// Returns the row of the stop.
    pub fn stop(&self) -> &SequenceRow<'a> {
        self.rows.iter().find(|row| row.is_stop).unwrap_or(&self.rows[0])
    }
}

impl<'a> SequenceRow<'a> {
    /// Adds an aperture of the surface.
    fn limit(&mut self, aperture: &'a Aperture, notes: &mut Vec<String>) {
        let is_centered = aperture.center == [0.0; 2];
        match &aperture.outline {
            Outline::Ellipse([x, y]) if x == y && is_centered && !aperture.is_obstruction => {
                self.semi_diameter = self.semi_diameter.min(*x);
            }
            Outline::Blades(_) => {
                notes.push(format!(
                    "the blades of the stop, surface {}, are left out: it is round",
                    self.number
                ));
            }
            Outline::Picture(_) => {
                notes.push(format!("the picture in the stop, surface {}, is left out", self.number));
            }
            _ => self.shapes.push(aperture),
        }
    }

    /// Returns what `state` makes of the first shape that it can state; `None` if the surface is limited by its circle
    /// alone. Other programs have one aperture a surface: the others, and a circle that the shape does not lie in, are
    /// noted.
    pub fn shape<T>(&self, state: impl Fn(&Aperture) -> Option<T>, notes: &mut Vec<String>) -> Option<T> {
        let mut stated: Option<T> = None;
        for shape in &self.shapes {
            let made = if stated.is_none() { state(shape) } else { None };
            if made.is_none() {
                notes.push(format!("{} of surface {} is left out", in_words(shape), self.number));
            } else if !shape.is_obstruction && shape.reach() > self.semi_diameter {
                notes.push(format!(
                    "the circle of radius {} mm around {} of surface {} is left out",
                    short(self.semi_diameter),
                    in_words(shape),
                    self.number
                ));
            }
            stated = stated.or(made);
        }
        stated
    }

    /// Returns the step between the powers of a series in r that has all terms, and the number of powers in it. The step
    /// is 2 if all powers are even.
    pub fn powers(&self) -> (usize, usize) {
        let step = if self.terms.iter().all(|(power, _)| power % 2 == 0) { 2 } else { 1 };
        (step, self.terms.last().map_or(0, |(power, _)| power / step))
    }
}

/// Returns the radius, the conic constant and the terms of a shape.
fn figure(shape: &Shape) -> (f64, f64, Vec<(usize, f64)>) {
    match shape {
        Shape::Plane => (f64::INFINITY, 0.0, Vec::new()),
        Shape::Sphere { radius } => (*radius, 0.0, Vec::new()),
        // `Format::write` refuses such lenses.
        Shape::Unsymmetric(figure) => (figure.radii()[1], 0.0, Vec::new()),
        Shape::Asphere(asphere) => {
            let terms = (FIRST_POWER..).zip(asphere.terms).filter(|(_, term)| *term != 0.0);
            (asphere.radius, asphere.conic, terms.collect())
        }
    }
}

/// Returns the settings of the groups that the lens lists; one for a lens without positions. `stop` is the stop's
/// semi-diameter without positions.
fn configurations(lens: &Prescription, stop: f64) -> Vec<Configuration> {
    let (Some(positions), Some(groups)) = (&lens.positions, MovingGroups::of(lens)) else {
        return vec![Configuration { object_distance: f64::INFINITY, gaps: Vec::new(), stop }];
    };
    let layout = positions.layout();
    let configuration = |(number, column): (usize, &realistic_optics::prescription::Position)| {
        // A position without a diameter has the one that its f-number or the table's row demands.
        let placed = groups.position(number % layout.zooms).at(column.vergence());
        let own = lens.stop_index().map(|row| placed.interfaces[row].semi_diameter);
        Configuration {
            object_distance: column.object_distance.unwrap_or(f64::INFINITY),
            gaps: positions.gaps.iter().map(|row| row + 1).zip(column.gaps.iter().copied()).collect(),
            stop: column.stop_diameter.map(|diameter| diameter / 2.0).or(own).unwrap_or(stop),
        }
    };
    positions.columns.iter().enumerate().map(configuration).collect()
}

/// Notes the facts of a lens for which other programs have no words.
fn note_facts(lens: &Prescription, notes: &mut Vec<String>) {
    let columns = lens.positions.as_ref().map_or(&[][..], |positions| &positions.columns);
    let facts = [
        ("the year", lens.stated.year.is_some()),
        ("the stated focal length", lens.stated_focal_length.is_some()),
        ("the stated f-number", lens.stated.fnumber.is_some()),
        ("the names of the positions", columns.iter().any(|column| column.name.is_some())),
        (
            "the focal lengths and f-numbers of the positions",
            columns.iter().any(|column| column.focal_length.or(column.fnumber).is_some()),
        ),
        ("the fields of the other positions", lens.stated.fields.len() > 1),
    ];
    let left_out: Vec<&str> = facts.iter().filter(|(_, is_there)| *is_there).map(|(fact, _)| *fact).collect();
    if !left_out.is_empty() {
        notes.push(format!("left out, without effect on rays: {}", left_out.join(", ")));
    }
    let absorbing = lens.glasses.iter().filter(|(_, glass)| glass.transmittance.is_some());
    let absorbing: Vec<&str> = absorbing.map(|(name, _)| name.as_str()).collect();
    if !absorbing.is_empty() {
        notes.push(format!("the absorption of {} is left out", absorbing.join(", ")));
    }
}

/// Returns a shape in words.
fn in_words(shape: &Aperture) -> String {
    let outline = match &shape.outline {
        Outline::Ellipse([x, y]) if x == y => "circular",
        Outline::Ellipse(_) => "elliptical",
        Outline::Rectangle(_) => "rectangular",
        Outline::Polygon(_) => "polygonal",
        Outline::Blades(_) | Outline::Picture(_) => "other",
    };
    format!("the {outline} {}", if shape.is_obstruction { "obstruction" } else { "aperture" })
}
