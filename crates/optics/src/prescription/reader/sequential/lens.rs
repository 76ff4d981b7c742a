//! Builds the prescription of a sequential file with one configuration, whatever its format.

use super::{
    Aperture, Effective, FAR, Field, Frames, Paraxial, ROUNDING, SequentialSurface, derive_missing,
    has_range, let_through, light_sign, positions, surface_row,
};
use crate::prescription::{
    CoordinateBreak, Fate, LensFileError, MAX_INTERFACES,
    glass::D_LINE,
    interfaces::{Medium, Prescription, Stated},
    reader::{
        ledger::Ledger,
        surface_rows::{self, MediumBehind},
        text::{Location, Text},
    },
    unsymmetric::Meridian,
};
use realistic_base::message::cut;

/// The places in the file at which a surface is described.
#[derive(Clone, Debug)]
pub(in super::super) struct SurfacePlaces {
    /// The surface as a whole.
    pub surface: Location,
    /// The statement of its semi-diameter, if it has one.
    pub size: Option<Location>,
    /// The statement of the thickness behind it, if it has one.
    pub thickness: Option<Location>,
    /// The name or number of the surface in messages.
    pub number: String,
}

/// A lens in sequence, between the object and the image.
#[derive(Debug)]
pub(in super::super) struct SequentialLens {
    pub object: MediumBehind,
    /// The place of the object's description.
    pub object_place: Location,
    /// The distance from the object to the first surface; infinite for a distant object.
    pub object_distance: f64,
    pub surfaces: Vec<SequentialSurface>,
    /// The thicknesses behind the surfaces; the last one reaches to the image.
    pub thicknesses: Vec<f64>,
    /// The change of frame in front of the image.
    pub image_break: Option<CoordinateBreak>,
    pub places: Vec<SurfacePlaces>,
    pub aperture: Aperture,
    pub field: Option<Field>,
    /// The wavelength for which the file describes the lens, nm, and its place.
    pub wavelength: Option<(f64, Location)>,
    /// The keys of the file for a surface, its semi-diameter and the thickness behind it, for messages.
    pub keys: [&'static str; 3],
    /// The unit of the lengths, mm.
    pub unit: f64,
}

impl SequentialLens {
    /// Returns a lens in air whose sizes the file states, of a format without object, image and wavelengths. `location`
    /// is the place of the lens.
    pub(in super::super) fn in_air(
        location: Location,
        surfaces: Vec<SequentialSurface>,
        thicknesses: Vec<f64>,
        places: Vec<SurfacePlaces>,
        keys: [&'static str; 3],
    ) -> Self {
        Self {
            object: Medium::Air.into(),
            object_place: location,
            object_distance: f64::INFINITY,
            surfaces,
            thicknesses,
            image_break: None,
            places,
            aperture: Aperture::ByStop,
            field: None,
            wavelength: None,
            keys,
            unit: 1.0,
        }
    }

    /// Builds the prescription, and the surfaces that became its interfaces. The place of the lens is `location`.
    ///
    /// # Errors
    /// The lens cannot be traced; the error gives the place of the fault.
    pub(in super::super) fn prescription(
        mut self,
        text: &Text<'_>,
        location: Location,
        ledger: &mut Ledger<'_>,
    ) -> Result<(Prescription, Vec<usize>), LensFileError> {
        if self.surfaces.len() > MAX_INTERFACES {
            let message =
                format!("{} surfaces; a lens has at most {MAX_INTERFACES} interfaces", self.surfaces.len());
            return Err(text.error(self.places[MAX_INTERFACES].surface, message));
        }
        self.check_stops(text)?;
        if self.object_distance.abs() >= FAR {
            self.object_distance = f64::INFINITY;
        }
        self.round_thicknesses(ledger);
        let wavelength = self.wavelength.map_or(D_LINE, |(wavelength, _)| wavelength);
        let stop_size = self.size_stop(wavelength, location, ledger);
        let thicknesses: Vec<f64> =
            std::iter::once(self.object_distance).chain(self.thicknesses.iter().copied()).collect();
        let field = self.field.unwrap_or(Field::Angle(0.0));
        for i in derive_missing(self.object, &mut self.surfaces, &thicknesses, field, wavelength) {
            let reason = "no semi-diameter is stated; 1.1 times that of paraxial rays of the file's aperture and field is used";
            self.warn(i, Fate::Replaced, 1, reason, ledger);
        }
        let Effective { kept, left_out } = Effective::of(self.object, &self.surfaces, &self.thicknesses);
        for (i, reason) in left_out {
            let SurfacePlaces { surface, number, .. } = &self.places[i];
            ledger.note(Fate::LeftOut, *surface, self.keys[0], Some(number), reason);
        }
        let frames = Frames::of(&self.surfaces, &kept, &self.thicknesses, self.image_break);
        let Frames { front, gaps, breaks, film_break } = frames;
        let mut rows = Vec::with_capacity(kept.len());
        for ((&i, &gap), &change) in kept.iter().zip(&gaps).zip(&breaks) {
            rows.push(surface_row(self.object, &self.surfaces, i, (gap, change)).ok_or_else(|| {
                let message = format!(
                    "surface {} has no semi-diameter, and the file does not state an aperture, a field and a stop to \
                     derive it from",
                    cut(&self.places[i].number)
                );
                text.error(self.places[i].surface, message)
            })?);
        }
        let Some(last) = rows.len().checked_sub(1) else {
            return Err(text.error(location, "no surface does anything; expected a lens"));
        };
        // The distance to the film is along the light.
        let back = light_sign(&self.surfaces) * gaps[last];
        if back < 0.0 {
            let reason = "the image lies in front of the last surface, where no film can be; the film's place is left open";
            self.warn(kept[last], Fate::LeftOut, 2, reason, ledger);
            rows[last].thickness = 0.0;
        }
        let at = |row: usize, message: &str| {
            let SurfacePlaces { surface, number, .. } = &self.places[kept[row]];
            text.error(*surface, format!("surface {}: {message}", cut(number)))
        };
        let mut interfaces = surface_rows::interfaces(&rows, self.object.medium, &at, ledger)?;
        interfaces[last].thickness = 0.0;
        let lens = Prescription {
            object_medium: self.object.medium,
            object_glass: self.object.glass,
            nominal_film_distance: (back > 0.0).then_some(back),
            film_break,
            stated: self.stated(),
            wavelength: self.wavelength.map(|(wavelength, _)| wavelength),
            positions: positions(
                text,
                &[self.object_distance + front],
                &[gaps],
                &[stop_size],
                self.object_place,
            )?,
            ..Prescription::new(interfaces)
        };
        if let Some((wavelength, location)) = self.wavelength {
            lens.check_wavelength(wavelength).map_err(|why| text.error(location, why))?;
        }
        let lens = if self.unit == 1.0 { lens } else { lens.scaled(self.unit) };
        if !has_range(&lens) {
            return Err(text.error(location, "a length of this lens, in mm, is beyond the range of numbers"));
        }
        Ok((lens, kept))
    }

    /// Makes the first surface the stop if none is stated, as the programs do that number it so. `key` is the statement
    /// of a stop.
    pub(in super::super) fn take_first_for_stop(&mut self, key: &str, ledger: &mut Ledger<'_>) {
        if self.surfaces.iter().any(|surface| surface.is_stop) {
            return;
        }
        if let (Some(first), Some(place)) = (self.surfaces.first_mut(), self.places.first()) {
            first.is_stop = true;
            let reason =
                format!("no stop ({key}) is stated; the first surface is the stop, as in the file's program");
            ledger.warn(Fate::Replaced, place.surface, key, Some(&place.number), reason);
        }
    }

    /// Returns the paraxial rays in the meridian y, to which the files' apertures and fields refer.
    pub(in super::super) fn paraxial(&self, wavelength: f64) -> Paraxial {
        Paraxial::of(self.object.medium, &self.surfaces, &self.thicknesses, Meridian::Y, wavelength)
    }

    /// Checks that at most one surface is the stop.
    fn check_stops(&self, text: &Text<'_>) -> Result<(), LensFileError> {
        let mut stops = (0..self.surfaces.len()).filter(|&i| self.surfaces[i].is_stop);
        match (stops.next(), stops.next()) {
            (Some(first), Some(second)) => {
                let [first, number] = [first, second].map(|i| cut(&self.places[i].number));
                let message = format!(
                    "surface {number} is a second stop (the first is surface {first}); a lens has one"
                );
                Err(text.error(self.places[second].surface, message))
            }
            _ => Ok(()),
        }
    }

    /// Sets negative thicknesses that are rounding errors to 0.
    fn round_thicknesses(&mut self, ledger: &mut Ledger<'_>) {
        for i in 0..self.thicknesses.len() {
            if self.thicknesses[i] < 0.0 && self.thicknesses[i] * self.unit > -ROUNDING {
                self.thicknesses[i] = 0.0;
                let reason = "a thickness of less than 100 nm below 0, as rounding leaves; 0 is used";
                self.warn(i, Fate::Replaced, 2, reason, ledger);
            }
        }
    }

    /// Sets the semi-diameter of the stop from the aperture, from its own size, or from the beam that the other
    /// surfaces pass.
    fn size_stop(&mut self, wavelength: f64, location: Location, ledger: &mut Ledger<'_>) -> Option<f64> {
        let Some(stop) = self.surfaces.iter().position(|surface| surface.is_stop) else {
            if self.aperture != Aperture::ByStop {
                let reason = "the file states an aperture but no stop; the surface that limits the axial beam is the stop";
                ledger.warn(Fate::LeftOut, location, "aperture", None, reason);
            }
            return None;
        };
        let paraxial = self.paraxial(wavelength);
        let by_aperture = paraxial.stop(self.aperture, stop, self.object_distance);
        let SequentialSurface { listed, clip, .. } = self.surfaces[stop];
        let stated = by_aperture.or(listed).into_iter().chain(clip).min_by(f64::total_cmp);
        let size = stated.or_else(|| let_through(self.object, &self.surfaces, stop, &paraxial));
        let has_size = listed.or(clip).is_some();
        if self.aperture != Aperture::ByStop && by_aperture.is_none() {
            let reason = "the file's aperture leaves the size of the stop open, and is not used";
            ledger.warn(Fate::LeftOut, location, "aperture", None, reason);
        } else if has_size && by_aperture.is_some() {
            let reason = match clip == size && clip < by_aperture {
                true => "the stop's own aperture, which is the narrower one, limits the beam",
                false => "the stop is as large as the file's aperture says",
            };
            let SurfacePlaces { surface, size, number, .. } = &self.places[stop];
            ledger.note(Fate::Replaced, size.unwrap_or(*surface), self.keys[1], Some(number), reason);
        }
        if stated.is_none() && size.is_some() {
            let reason = "the stop has no size, and the file states no aperture; it is as large as the axial beam that the \
                          other surfaces let through";
            self.warn(stop, Fate::Replaced, 1, reason, ledger);
        }
        self.surfaces[stop].semi_diameter = size.or(self.surfaces[stop].semi_diameter);
        size
    }

    /// Warns about a surface. `key` selects the surface as a whole, its size or the thickness behind it.
    fn warn(&self, surface: usize, fate: Fate, key: usize, reason: &str, ledger: &mut Ledger<'_>) {
        let place = &self.places[surface];
        let location = [None, place.size, place.thickness][key].unwrap_or(place.surface);
        ledger.warn(fate, location, self.keys[key], Some(&place.number), reason);
    }

    /// Returns the f-number and the full field of view, if the file states them as such.
    fn stated(&self) -> Stated {
        let fnumber = match self.aperture {
            Aperture::FNumber(number) => Some(number),
            _ => None,
        };
        let field = match self.field {
            Some(Field::Angle(degrees)) if degrees > 0.0 && degrees <= 180.0 => Some(2.0 * degrees),
            _ => None,
        };
        Stated { year: None, fnumber, fields: field.map(Some).into_iter().collect() }
    }
}
