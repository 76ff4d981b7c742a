//! ghostlight (`.lens`): `optical_system` is a list of elements, each with N surfaces, N - 1 materials between them,
//! and the place of its first vertex on the axis. The sensor is the end of the chain: where the last surface's
//! thickness leads or, without one, at z = 0. `glass_catalogue` holds the glasses. Lengths are in mm, sizes are
//! semi-diameters, and the terms of an asphere begin with r^4.

use super::{
    NamedGlasses, Part, REVOLUTION, by_numbers, check_count, curvature, fates::NoEffect, finished, place,
    refused, title,
};
use crate::prescription::{
    Aperture as Outline, Coating, Fate, LensFileError, MAX_VERTICES, Outline as Figure, SurfaceCoating,
    glass::{D_LINE, GlassLibrary, refractive_index},
    interfaces::{Asphere, Medium, NO_TERMS, Prescription, has_coating},
    reader::{
        ledger::Ledger,
        sequential::{SequentialLens, SequentialSurface, SurfacePlaces, asphere, set_term},
        surface_rows::{General, MediumBehind},
    },
    unsymmetric::{Meridian, Toroid, Unsymmetric},
};
use realistic_base::message::{as_given, cut};
use std::collections::HashMap;

/// Keys without an effect on rays.
pub(super) const NO_EFFECT: NoEffect = &[
    (
        "names, notes and versions",
        &[
            "id",
            "metadata",
            "version",
            "minor",
            "version.minor",
            "elements",
            "pivot_point",
            "catalogue_ref",
            "description",
            "author",
            "source",
            "optical_system.name",
            "optical_system.type",
            "exposed",
        ],
    ),
    ("a glass that no element uses", &["glass_catalogue"]),
    ("offsets of 0, which move no element", &["pivots"]),
    ("without an effect where nothing is rotated", &["transform.pivot"]),
];

/// Reads a lens.
///
/// # Errors
/// A value is missing or wrong, or the lens cannot be traced.
pub(super) fn read(root: Part<'_>, ledger: &mut Ledger<'_>) -> Result<Prescription, LensFileError> {
    let version = root.get("version").map_or(Ok(None), |version| version.number("major"))?;
    if version.is_some_and(|major| major != 1.0) {
        return Err(root
            .need("version", "1")?
            .error("another version of ghostlight's format; read is major 1"));
    }
    check_pivots(root)?;
    let library = GlassLibrary::default();
    let mut glasses = NamedGlasses::new(&library, Vec::new());
    let catalogue: HashMap<&str, Part<'_>> =
        root.get("glass_catalogue").map(|all| all.members().collect()).unwrap_or_default();
    let mut chain = Chain::default();
    for (number, element) in (1..).zip(root.list("optical_system")?) {
        chain.add(element, &format!("{number}"), &catalogue, &mut glasses, ledger)?;
    }
    if chain.surfaces.is_empty() {
        return Err(root.error("no surface in \"optical_system\"; expected at least one"));
    }
    check_count(&chain.parts)?;
    chain.end();
    let Chain { surfaces, thicknesses, places, layers, .. } = chain;
    let location = root.node.location;
    let keys = ["surfaces", "semi_aperture", "thickness"];
    let lens = SequentialLens::in_air(location, surfaces, thicknesses, places, keys);
    let (lens, kept) = lens.prescription(root.text, location, ledger)?;
    let coatings = coatings(&lens, kept.iter().map(|&i| layers[i]));
    let metadata = root.get("metadata");
    let name = metadata.map_or(Ok(None), |own| own.string("name"))?;
    let focal_length = metadata.map_or(Ok(None), |own| own.number("focal_length_mm"))?;
    let lens = Prescription {
        title: title(name),
        stated_focal_length: focal_length.filter(|length| *length > 0.0),
        coatings,
        ..lens
    };
    Ok(finished(lens, glasses, root.text.file))
}

/// Checks that no pivot moves or rotates an element.
fn check_pivots(root: Part<'_>) -> Result<(), LensFileError> {
    for pivot in root.list("pivots")? {
        let Some(offset) = pivot.get("offset") else { continue };
        for group in ["position", "rotation"] {
            let Some(own) = offset.get(group) else { continue };
            for (key, value) in own.members() {
                if value.node.number() != Some(0.0) {
                    let message = format!(
                        "a pivot that moves or rotates elements (offset.{group}.{}), which is not read; write 0",
                        cut(key)
                    );
                    return Err(value.error(message));
                }
            }
        }
    }
    Ok(())
}

/// The surfaces of the elements so far.
#[derive(Default)]
struct Chain<'j> {
    surfaces: Vec<SequentialSurface>,
    thicknesses: Vec<f64>,
    places: Vec<SurfacePlaces>,
    parts: Vec<Part<'j>>,
    /// The number of layers of each surface's coating.
    layers: Vec<f64>,
    /// The places on the axis of the first vertex of the last element, and of the last surface's.
    start: f64,
    end: f64,
}

impl<'j> Chain<'j> {
    /// Adds the surfaces of an element.
    fn add(
        &mut self,
        element: Part<'j>,
        number: &str,
        catalogue: &HashMap<&str, Part<'j>>,
        glasses: &mut NamedGlasses<'_>,
        ledger: &mut Ledger<'_>,
    ) -> Result<(), LensFileError> {
        let start = self.start(element, number)?;
        let surfaces = element.list("surfaces")?;
        let materials = element.list("materials")?;
        if surfaces.is_empty() || surfaces.len() != materials.len() + 1 {
            let message = format!(
                "element {number} has {} surfaces and {} materials; expected one material fewer than surfaces",
                surfaces.len(),
                materials.len()
            );
            return Err(element.error(message));
        }
        if let Some(last) = self.thicknesses.last_mut() {
            *last = start - self.end;
        }
        let mut vertex = start;
        for (i, &part) in surfaces.iter().enumerate() {
            let name = format!("{number}.{}", i + 1);
            let behind = match materials.get(i) {
                Some(material) => medium(*material, catalogue, glasses)?,
                None => Medium::Air.into(),
            };
            let thickness = part.number("thickness")?.unwrap_or(0.0);
            let (surface, layers) = surface(part, &name, behind, ledger)?;
            self.end = vertex;
            vertex += thickness;
            self.surfaces.push(surface);
            self.layers.push(layers);
            self.thicknesses.push(thickness);
            self.places.push(place(part, name, Some("semi_aperture"), Some("thickness")));
            self.parts.push(part);
            self.check_active(part)?;
        }
        self.start = start;
        Ok(())
    }

    /// Returns the place of an element's first vertex.
    fn start(&self, element: Part<'_>, number: &str) -> Result<f64, LensFileError> {
        let Some(transform) = element.get("transform") else { return Ok(0.0) };
        if let Some(rotation) = transform.get("rotation") {
            for key in ["tilt_x", "tilt_y", "roll"] {
                if rotation.number(key)?.is_some_and(|angle| angle != 0.0) {
                    let place = rotation.need(key, "0")?;
                    let message = format!("element {number} has a tilt or roll ({key}); {REVOLUTION}");
                    return Err(place.error(message));
                }
            }
        }
        let Some(position) = transform.get("position") else { return Ok(0.0) };
        for key in ["x", "y"] {
            if position.number(key)?.is_some_and(|shift| shift != 0.0) {
                let place = position.need(key, "0")?;
                return Err(place.error(format!("element {number} is off the axis ({key}); {REVOLUTION}")));
            }
        }
        let height = position.number("z")?.unwrap_or(0.0);
        match position.string("mode")?.unwrap_or("absolute") {
            "relative_to_preceding" if !self.surfaces.is_empty() => Ok(self.start + height),
            "absolute" | "relative_to_preceding" => Ok(height),
            other => Err(position.error(format!("the mode \"{}\" of a position is not read", cut(other)))),
        }
    }

    /// Takes the last surface away if it is muted.
    ///
    /// # Errors
    /// The media on its sides differ, so that it is unsure what is left.
    fn check_active(&mut self, part: Part<'_>) -> Result<(), LensFileError> {
        if !part.node.has("is_active") || part.flag("is_active")? {
            return Ok(());
        }
        let last = self.surfaces.len() - 1;
        let before = last.checked_sub(1).map_or(Medium::Air, |i| self.surfaces[i].behind.medium);
        let surface = &mut self.surfaces[last];
        if before != surface.behind.medium {
            let place = part.need("is_active", "true")?;
            let what = "is muted (is_active) between two media, of which the file does not say which remains";
            return Err(refused(place, &self.places[last].number, what));
        }
        // A surface without effect: it bends no ray, limits none, and is left out.
        surface.is_fixed = false;
        surface.is_stop = false;
        surface.apertures.clear();
        Ok(())
    }

    /// Sets the distance to the sensor of a chain whose last surface states none.
    fn end(&mut self) {
        if let Some(last) = self.thicknesses.last_mut().filter(|last| **last == 0.0) {
            *last = (-self.end).max(0.0);
        }
    }
}

/// Reads one surface. Returns it with the number of layers of its coating.
fn surface(
    part: Part<'_>,
    number: &str,
    behind: MediumBehind,
    ledger: &mut Ledger<'_>,
) -> Result<(SequentialSurface, f64), LensFileError> {
    let form = part.need("form", "the form of the surface")?;
    let radius = form.number("radius")?.unwrap_or(0.0);
    let unsymmetric = cylinder(form, number, radius)?;
    let curvature = if unsymmetric.is_some() { 0.0 } else { curvature(radius) };
    let asphere = match form.string("type")?.unwrap_or("") {
        "sphere" => None,
        "asphere" => figure(form, number)?,
        "cylindrical" => None,
        other => {
            let what = format!("has the form {}; read are sphere, asphere and cylindrical", cut(other));
            return Err(refused(form, number, what));
        }
    };
    let size = part.needed_number("semi_aperture", "a semi-diameter")?;
    if size <= 0.0 {
        let place = part.need("semi_aperture", "a semi-diameter")?;
        let message = format!("\"semi_aperture\" is {}; expected a positive number", as_given(size));
        return Err(place.error(message));
    }
    let (mut layers, mut apertures) = (0.0, Vec::new());
    for modifier in part.list("modifiers")? {
        match modifier.string("type")?.unwrap_or("") {
            "coating" => layers = coating(modifier, number, ledger)?,
            "aperture" => apertures = aperture(modifier, number, size)?,
            other => {
                let what = format!("has a modifier {}, which is not read", cut(other));
                return Err(refused(modifier, number, what));
            }
        }
    }
    let reach = apertures.iter().map(Outline::reach).fold(size, f64::max);
    let surface = SequentialSurface {
        curvature,
        asphere,
        behind,
        semi_diameter: Some(reach),
        listed: Some(reach),
        clip: None,
        apertures,
        is_fixed: true,
        is_stop: part.flag("is_stop")?,
        general: General { unsymmetric, ..General::default() },
        break_behind: None,
    };
    Ok((surface, layers))
}

/// Returns the cylinder of a form; `None` for other forms. The axis of the cylinder is straight: along y it bends light
/// in x.
fn cylinder(form: Part<'_>, number: &str, radius: f64) -> Result<Option<Unsymmetric>, LensFileError> {
    if form.string("type")? != Some("cylindrical") {
        return Ok(None);
    }
    let meridian = match form.string("axis")?.unwrap_or("") {
        "y" => Meridian::X,
        "x" => Meridian::Y,
        other => {
            let what = format!("is a cylinder along \"{}\"; expected the axis \"x\" or \"y\"", cut(other));
            return Err(refused(form, number, what));
        }
    };
    let radius = if radius == 0.0 { f64::INFINITY } else { radius };
    Ok(Some(Unsymmetric::Toroid(Toroid::cylinder(meridian, radius))))
}

/// Returns the figure of an asphere.
fn figure(form: Part<'_>, number: &str) -> Result<Option<Asphere>, LensFileError> {
    let conic = form.number("conic_constant")?.unwrap_or(0.0);
    let mut terms = NO_TERMS;
    for (power, &value) in (4..).step_by(2).zip(&form.numbers("terms")?) {
        set_term(&mut terms, power, value).map_err(|why| refused(form, number, why))?;
    }
    Ok(asphere(conic, terms))
}

/// Returns the number of layers of a coating. Coatings that only the file's program knows are left out.
fn coating(modifier: Part<'_>, number: &str, ledger: &mut Ledger<'_>) -> Result<f64, LensFileError> {
    match modifier.string("model")?.unwrap_or("layers") {
        "simple" => {
            let layers = modifier.number("ar_layers")?.unwrap_or(0.0);
            if layers > 0.0 {
                let location = modifier.need("ar_layers", "a number")?.node.location;
                let reason = "the number of a coating's layers is taken for a coating that has as many";
                ledger.note(Fate::Replaced, location, "ar_layers", Some(number), reason);
            }
            Ok(layers)
        }
        "attenuator_gaussian" => {
            let what = "is an apodiser (attenuator_gaussian), which is not traced; delete the modifier";
            Err(refused(modifier, number, what))
        }
        other => {
            let reason =
                format!("a coating of the model {}, which is not read; the surface is bare", cut(other));
            let location = modifier.get("model").unwrap_or(modifier).node.location;
            ledger.warn(Fate::LeftOut, location, "coating", Some(number), reason);
            Ok(0.0)
        }
    }
}

/// Returns the aperture of a surface that is not round. The first vertex of a polygon lies at +x.
fn aperture(modifier: Part<'_>, number: &str, size: f64) -> Result<Vec<Outline>, LensFileError> {
    let aspect = modifier.number("aperture_aspect")?.unwrap_or(1.0);
    if !(aspect > 0.0 && (aspect * size).is_finite()) {
        return Err(modifier.error(format!("an aspect of {}; expected a positive number", as_given(aspect))));
    }
    match modifier.string("shape")?.unwrap_or("") {
        "circular" if aspect == 1.0 => Ok(Vec::new()),
        "circular" => Ok(vec![Outline::centered(Figure::Ellipse([size * aspect, size]))]),
        "polygon" => {
            for key in ["curvature", "twist", "notch_deg"] {
                if modifier.number(key)?.is_some_and(|value| value != 0.0) {
                    let what =
                        format!("has blades that are not straight ({key}), which are not read; write 0");
                    return Err(refused(modifier.need(key, "0")?, number, what));
                }
            }
            modifier.number("notch_angle_deg")?;
            let blades = modifier.needed_number("blades", "a number of blades")?;
            let count = blades as usize;
            if blades.fract() != 0.0 || !(3..=MAX_VERTICES).contains(&count) {
                let message = format!("{} blades; expected 3 to {MAX_VERTICES}", as_given(blades));
                return Err(modifier.error(message));
            }
            let rotation = modifier.number("rotation_deg")?.unwrap_or(0.0);
            let vertex = |i: usize| {
                let angle = (rotation + 360.0 * i as f64 / count as f64).to_radians();
                [size * aspect * angle.cos(), size * angle.sin()]
            };
            Ok(vec![Outline::centered(Figure::Polygon((0..count).map(vertex).collect()))])
        }
        other => {
            let what = format!("has an aperture of shape {}; read are circular and polygon", cut(other));
            Err(refused(modifier, number, what))
        }
    }
}

/// Returns the medium of a material.
fn medium(
    material: Part<'_>,
    catalogue: &HashMap<&str, Part<'_>>,
    glasses: &mut NamedGlasses<'_>,
) -> Result<MediumBehind, LensFileError> {
    let key = material.string("glass")?.unwrap_or("");
    if key.eq_ignore_ascii_case("air") {
        return Ok(Medium::Air.into());
    }
    let Some(glass) = catalogue.get(key) else {
        return Err(material.error(format!("glass \"{}\" is not in \"glass_catalogue\"", cut(key))));
    };
    glass.get("name");
    let dispersion = glass.need("dispersion", "the dispersion of the glass")?;
    match dispersion.string("model")?.unwrap_or("") {
        "abbe" => {
            let n_d = dispersion.needed_number("nd", "an index")?;
            let abbe = dispersion.needed_number("Vd", "a V-number")?;
            by_numbers(key, n_d, Some(abbe), glasses).map_err(|why| dispersion.error(why))
        }
        "sellmeier" => {
            let [b, c] = ["B", "C"].map(|key| dispersion.numbers(key));
            let (Ok(b), Ok(c)) = (<[f64; 3]>::try_from(b?), <[f64; 3]>::try_from(c?)) else {
                return Err(dispersion.error("expected three constants B and three constants C"));
            };
            let medium = Medium::Sellmeier { b, c };
            let n_d = refractive_index(medium, D_LINE);
            if !(1.0..=5.0).contains(&n_d) {
                return Err(dispersion.error("constants that give no index between 1 and 5 at 587.56 nm"));
            }
            Ok(glasses.by_medium(key, medium))
        }
        other => {
            let message = format!("a dispersion of the model {}; read are abbe and sellmeier", cut(other));
            Err(dispersion.error(message))
        }
    }
}

/// Returns the coatings with these numbers of layers; `None` if no surface has one.
fn coatings(lens: &Prescription, layers: impl Iterator<Item = f64>) -> Option<Vec<SurfaceCoating>> {
    let coatings: Vec<Coating> = has_coating(lens.object_medium, &lens.interfaces)
        .zip(layers)
        .map(|(is_in_air, layers)| match layers {
            _ if !is_in_air || layers < 1.0 => Coating::Bare,
            1.0 => Coating::QuarterWave,
            2.0 => Coating::VCoat,
            _ => Coating::ThreeLayer,
        })
        .collect();
    let is_coated = coatings.iter().any(|coating| *coating != Coating::Bare);
    is_coated.then(|| coatings.into_iter().map(SurfaceCoating::from).collect())
}
