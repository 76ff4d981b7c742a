//! Optiland. Its writer stores its Python objects: `surface_group` with the surfaces, the object first and the image
//! last, `aperture`, `fields` and `wavelengths`. Every surface has its place (`cs`, with rotations in radians about x,
//! then y, then z, of fixed axes) and the material behind it. Sizes are stated for surfaces with an `aperture` alone; the others follow from aperture and field.
//!
//! A material names a glass and perhaps its catalogue (`catalog` or `reference`). Its `filename` is a path on the computer of the
//! writer, and is never opened.

use super::{
    NamedGlasses, Part, by_name, by_numbers, check_image, curvature, fates::NoEffect, finished,
    object_own_image, place, profile_terms, refused, title,
};
use crate::prescription::{
    Aperture as Outline, CoordinateBreak, Fate, LensFileError, Outline as Figure,
    glass::GlassLibrary,
    interfaces::{Asphere, Medium, NO_TERMS, Prescription},
    reader::{
        ledger::Ledger,
        sequential::{Aperture, Field, SequentialLens, SequentialSurface, asphere, nanometres, set_term},
        surface_rows::{General, MediumBehind, checked},
        text::Location,
    },
    unsymmetric::{Meridian, Toroid, Unsymmetric},
};
use realistic_base::message::{as_given, cut};

/// Keys without an effect on rays.
pub(super) const NO_EFFECT: NoEffect = &[
    ("names, versions and notes", &["version", "comment", "name", "surfaces.type", "obj_space_telecentric"]),
    (
        "settings of the file's program",
        &[
            "ray_tracer",
            "apodization",
            "polarization",
            "robust_search",
            "tol",
            "max_iter",
            "use_standard_coords",
            "propagation_model",
            "model",
            "symmetry",
        ],
    ),
    ("a path on the computer that wrote the file; it is not opened", &["filename"]),
    ("the range of the glass's data", &["min_wavelength", "max_wavelength"]),
    ("solves and pickups, whose values the file holds", &["pickups", "solves"]),
    (
        "fields, wavelengths and their weights, which the user chooses",
        &[
            "fields",
            "wavelengths",
            "wavelengths.value",
            "wavelengths.unit",
            "wavelengths.is_primary",
            "vx",
            "vy",
            "weight",
            "fields.field_type",
            "telecentric",
            "object_space_telecentric",
        ],
    ),
    ("the medium in front of a surface is that behind the surface before", &["material_pre"]),
    ("follows from the places of the surfaces", &["surfaces.thickness"]),
    (
        "describes the object or the image, which are the user's",
        &[
            "surfaces.aperture",
            "surfaces.coating",
            "surfaces.bsdf",
            "surfaces.is_reflective",
            "surfaces.is_stop",
            "surfaces.interaction_model",
            "geometry.type",
            "geometry.conic",
            "geometry.radius",
            "geometry.coefficients",
            "surfaces.material_post",
            "cs.x",
            "cs.y",
            "cs.rx",
            "cs.ry",
            "cs.rz",
            "cs.reference_cs",
        ],
    ),
];

/// Relative difference between a thickness and the distance of two places up to which the thickness is used.
const ROUNDED: f64 = 1e-12;

/// Reads a lens.
///
/// # Errors
/// A value is missing or wrong, or the lens cannot be traced.
pub(super) fn read(
    root: Part<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let group = root.need("surface_group", "the surfaces")?;
    let list = group.list("surfaces")?;
    let (object, own, image) = object_own_image(&list, group.need("surfaces", "a list of surfaces")?)?;
    let mut glasses = NamedGlasses::new(library, Vec::new());
    let front = checked(medium(object, "0", &mut glasses)?, |reason| {
        ledger.warn(Fate::Replaced, object.node.location, "material_post", Some("0"), reason);
    });
    let mut surfaces: Vec<SequentialSurface> = Vec::with_capacity(own.len());
    let mut places = Vec::with_capacity(own.len());
    let mut frames = Vec::with_capacity(own.len() + 1);
    for (number, &part) in (1..).zip(own) {
        let number: String = format!("{number}");
        let in_front = surfaces.last().map_or(front, |before| before.behind);
        surfaces.push(surface(part, &number, in_front, &mut glasses)?);
        frames.push(frame(part, &number)?);
        places.push(place(part, number, Some("aperture"), Some("thickness")));
    }
    let flat = image.need("geometry", "a geometry")?;
    check_image(curvature(flat.number_or_infinity("radius")?.unwrap_or(0.0)), flat, "radius", ledger);
    frames.push(frame(image, "of the image")?);
    let heights: Vec<f64> = frames.iter().map(|frame| frame.shift[2]).collect();
    let object_height = object
        .get("geometry")
        .and_then(|geometry| geometry.get("cs"))
        .map_or(Ok(None), |cs| cs.number_or_infinity("z"))?
        .unwrap_or(f64::NEG_INFINITY);
    let mut thicknesses: Vec<f64> = heights.windows(2).map(|pair| pair[1] - pair[0]).collect();
    for ((part, thickness), height) in own.iter().zip(&mut thicknesses).zip(&heights) {
        // Places are sums, which are rounded.
        let stated = part.get("thickness").and_then(|own| own.node.number());
        let rounding = ROUNDED * (height.abs() + thickness.abs());
        *thickness = stated.filter(|stated| (stated - *thickness).abs() <= rounding).unwrap_or(*thickness);
    }
    let image_break = set_breaks(&frames, &mut surfaces, &mut thicknesses, own, image)?;
    let lens = SequentialLens {
        object: front,
        object_place: object.node.location,
        object_distance: heights[0] - object_height,
        surfaces,
        thicknesses,
        image_break,
        places,
        aperture: aperture(root)?,
        field: field(root, ledger)?,
        wavelength: wavelength(root)?,
        keys: ["surfaces", "aperture", "thickness"],
        unit: 1.0,
    };
    let lens = with_stop_diameter(lens, root)?;
    let (lens, _) = lens.prescription(root.text, root.node.location, ledger)?;
    let title = title(root.string("name").unwrap_or_default());
    Ok(finished(Prescription { title, ..lens }, glasses, root.text.file))
}

/// Returns the frame of a surface in the frame of the file.
fn frame(part: Part<'_>, number: &str) -> Result<CoordinateBreak, LensFileError> {
    let system = part.need("geometry", "a geometry")?.need("cs", "a coordinate system")?;
    if let Some(other) = system.get("reference_cs") {
        return Err(refused(
            other,
            number,
            "stands in another coordinate system (reference_cs), which is not read",
        ));
    }
    let z = system.needed_number("z", "the place on the axis")?;
    let value = |key: &str| -> Result<f64, LensFileError> { Ok(system.number(key)?.unwrap_or(0.0)) };
    let [x, y] = [value("x")?, value("y")?];
    let [a, b, c] = [value("rx")?, value("ry")?, value("rz")?].map(f64::to_degrees);
    // About fixed axes: the rotation about z is the outermost one.
    let tilts = [[0.0, 0.0, c], [0.0, b, 0.0], [a, 0.0, 0.0]].map(CoordinateBreak::tilted);
    Ok(tilts.iter().fold(CoordinateBreak::shifted([x, y, z]), |frame, tilt| frame.then(tilt)))
}

/// Gives the surfaces of a lens that does not stand along one axis the changes of frame from each to the next, and the
/// distances along z. Returns the change in front of the image.
///
/// # Errors
/// The frame of a surface is turned so that light meets it from the other side than after as many mirrors elsewhere.
fn set_breaks(
    frames: &[CoordinateBreak],
    surfaces: &mut [SequentialSurface],
    thicknesses: &mut [f64],
    own: &[Part<'_>],
    image: Part<'_>,
) -> Result<Option<CoordinateBreak>, LensFileError> {
    if frames.iter().all(|frame| frame.along_axis().is_some()) {
        return Ok(None);
    }
    let [first, ..] = frames else { return Ok(None) };
    let at_first = CoordinateBreak::shifted([0.0, 0.0, -first.shift[2]]);
    surfaces[0].general.coordinate_break = Some(at_first.then(first));
    let mut sign = 1.0;
    let mut image_break = None;
    for (i, pair) in frames.windows(2).enumerate() {
        sign = if surfaces[i].general.is_mirror { -sign } else { sign };
        let step = pair[0].inverse().then(&pair[1]);
        let arrival = step.inverse().turned(step.shift)[2];
        if sign * arrival < -ROUNDED * step.shift.iter().fold(0.0, |sum: f64, part| sum.max(part.abs())) {
            let part = own.get(i + 1).copied().unwrap_or(image);
            let what = "has its z axis the wrong way for light that comes from the surface before it: z turns round at no mirror, \
                        and behind an odd number of them light goes against it";
            return Err(refused(part, &format!("{}", i + 2), what));
        }
        let along = step.shift[2];
        thicknesses[i] = along;
        let change = Some(CoordinateBreak::shifted([0.0, 0.0, -along]).then(&step));
        match surfaces.get_mut(i + 1) {
            Some(next) => next.general.coordinate_break = change,
            None => image_break = change,
        }
    }
    Ok(image_break)
}

/// Reads one surface of the lens.
fn surface(
    part: Part<'_>,
    number: &str,
    in_front: MediumBehind,
    glasses: &mut NamedGlasses<'_>,
) -> Result<SequentialSurface, LensFileError> {
    if let Some(kind) = part.string("type")?.filter(|kind| kind.contains("Paraxial")) {
        return Err(refused(part, number, format!("is an ideal lens ({}), which has no glass", cut(kind))));
    }
    let is_mirror = is_mirror(part, number)?;
    let geometry = part.need("geometry", "a geometry")?;
    let unsymmetric = toroid(geometry, number)?;
    let (curvature, asphere) = if unsymmetric.is_some() { (0.0, None) } else { figure(geometry, number)? };
    let (clip, apertures) = match part.get("aperture") {
        Some(aperture) => outline(aperture, number)?,
        None => (None, Vec::new()),
    };
    Ok(SequentialSurface {
        curvature,
        asphere,
        behind: if is_mirror { in_front } else { medium(part, number, glasses)? },
        semi_diameter: clip,
        listed: None,
        clip,
        is_fixed: clip.is_some() || !apertures.is_empty(),
        apertures,
        is_stop: part.flag("is_stop")?,
        general: General { unsymmetric, is_mirror, coordinate_break: None },
        break_behind: None,
    })
}

/// Returns whether a surface reflects, and checks that it does not scatter. Older files state this beside the geometry, newer
/// ones in `interaction_model`.
fn is_mirror(part: Part<'_>, number: &str) -> Result<bool, LensFileError> {
    let mut is_mirror = match part.get("material_post") {
        Some(material) => material.string("type")? == Some("Mirror"),
        None => false,
    };
    let model = part.get("interaction_model");
    if let Some(kind) = model.map_or(Ok(None), |model| model.string("type"))? {
        let plain = kind.replace('_', "").to_ascii_lowercase();
        if !matches!(plain.as_str(), "refractivereflectivemodel" | "refractivereflective") {
            let what =
                if plain.contains("thinlens") { "an ideal thin lens" } else { "no refracting surface" };
            let what = format!("is {what} ({}), which is not traced", cut(kind));
            return Err(refused(model.unwrap_or(part), number, what));
        }
    }
    for own in [Some(part), model].into_iter().flatten() {
        is_mirror |= own.flag("is_reflective")?;
        if let Some(scatter) = own.get("bsdf") {
            return Err(refused(scatter, number, "scatters light (bsdf), which is not traced; write null"));
        }
        if let Some(coating) = own.get("coating") {
            return Err(refused(coating, number, "has a coating, whose values are not read; write null"));
        }
    }
    Ok(is_mirror)
}

/// Returns the curvature and the figure of a surface.
fn figure(part: Part<'_>, number: &str) -> Result<(f64, Option<Asphere>), LensFileError> {
    let curvature = curvature(part.number_or_infinity("radius")?.unwrap_or(0.0));
    let step = match part.string("type")?.unwrap_or("") {
        "Plane" => return Ok((0.0, None)),
        "StandardGeometry" => 0,
        "EvenAsphere" => 2,
        "OddAsphere" => 1,
        "BiconicGeometry" => {
            let what = "is a biconic as the sum of two profiles (BiconicGeometry), which is not that of other programs and not \
                        traced; fit it by a toroid";
            return Err(refused(part, number, what));
        }
        other => {
            let what = format!(
                "has the geometry {}; read are Plane, StandardGeometry, EvenAsphere, OddAsphere and ToroidalGeometry",
                cut(other)
            );
            return Err(refused(part, number, what));
        }
    };
    let conic = part.number("conic")?.unwrap_or(0.0);
    let mut terms = NO_TERMS;
    if step > 0 {
        for (i, &value) in (1..).zip(&part.numbers("coefficients")?) {
            set_term(&mut terms, step * i, value).map_err(|why| refused(part, number, why))?;
        }
    }
    Ok((curvature, asphere(conic, terms)))
}

/// Returns the toroid of a geometry; `None` for other geometries.
fn toroid(part: Part<'_>, number: &str) -> Result<Option<Unsymmetric>, LensFileError> {
    if part.string("type")? != Some("ToroidalGeometry") {
        return Ok(None);
    }
    let radius = |key: &str| -> Result<f64, LensFileError> {
        let radius = part.number_or_infinity(key)?.unwrap_or(f64::INFINITY);
        Ok(if radius == 0.0 { f64::INFINITY } else { radius })
    };
    let terms = profile_terms(part, number, part.numbers("coeffs_poly_y")?)?;
    Ok(Some(Unsymmetric::Toroid(Toroid {
        meridian: Meridian::Y,
        radius: radius("radius_y")?,
        conic: part.number("conic_yz")?.unwrap_or(0.0),
        terms,
        rotation_radius: radius("radius_x")?,
    })))
}

/// Returns the semi-diameter of the circle around an aperture, and the aperture if it is not round.
fn outline(part: Part<'_>, number: &str) -> Result<(Option<f64>, Vec<Outline>), LensFileError> {
    let value = |key: &str| -> Result<f64, LensFileError> { Ok(part.number(key)?.unwrap_or(0.0)) };
    let positive = |size: f64, key: &str| match size > 0.0 {
        true => Ok(size),
        false => Err(part.error(format!("\"{key}\" is {}; expected a positive number", as_given(size)))),
    };
    let centered =
        |outline, center, is_obstruction| Outline { outline, center, rotation: 0.0, is_obstruction };
    let center = [value("offset_x")?, value("offset_y")?];
    let mut apertures = Vec::new();
    let mut clip = None;
    match part.string("type")?.unwrap_or("") {
        "RadialAperture" | "OffsetRadialAperture" => {
            let outer = part.number_or_infinity("r_max")?.unwrap_or(f64::INFINITY);
            let inner = value("r_min")?;
            if inner > 0.0 {
                apertures.push(centered(Figure::Ellipse([inner; 2]), center, true));
            }
            if center == [0.0; 2] {
                clip = Some(outer).filter(|outer| outer.is_finite());
            } else {
                apertures.push(centered(Figure::Ellipse([positive(outer, "r_max")?; 2]), center, false));
            }
            clip.map_or(Ok(0.0), |clip| positive(clip, "r_max"))?;
        }
        "RectangularAperture" => {
            let [x, y] = [["x_min", "x_max"], ["y_min", "y_max"]].map(|keys| keys.map(value));
            let ([left, right], [low, high]) = (x, y);
            let (left, right, low, high) = (left?, right?, low?, high?);
            let half = [positive((right - left) / 2.0, "x_max")?, positive((high - low) / 2.0, "y_max")?];
            let center = [f64::midpoint(left, right), f64::midpoint(low, high)];
            apertures.push(centered(Figure::Rectangle(half), center, false));
        }
        "EllipticalAperture" => {
            let half = [positive(value("a")?, "a")?, positive(value("b")?, "b")?];
            apertures.push(centered(Figure::Ellipse(half), center, false));
        }
        other => {
            let what = format!(
                "has an aperture {}; read are RadialAperture, OffsetRadialAperture, RectangularAperture and \
                 EllipticalAperture",
                cut(other)
            );
            return Err(refused(part, number, what));
        }
    }
    if apertures.iter().any(|own| !own.reach().is_finite()) {
        return Err(part.error("an aperture without end; write null for none"));
    }
    let reach = apertures.iter().filter(|own| !own.is_obstruction).map(Outline::reach).max_by(f64::total_cmp);
    Ok((clip.or(reach), apertures))
}

/// Returns the medium behind a surface.
fn medium(
    part: Part<'_>,
    number: &str,
    glasses: &mut NamedGlasses<'_>,
) -> Result<MediumBehind, LensFileError> {
    let Some(material) = part.get("material_post") else { return Ok(Medium::Air.into()) };
    match material.string("type")?.unwrap_or("") {
        "IdealMaterial" => {
            if material.number("absorp")?.is_some_and(|absorption| absorption != 0.0) {
                let place = material.need("absorp", "0")?;
                return Err(refused(
                    place,
                    number,
                    "has an absorbing medium (absorp), which is not read; write 0",
                ));
            }
            let n_d = number_or_only(material, "index")?;
            by_numbers("", n_d, None, glasses).map_err(|why| material.error(why))
        }
        "AbbeMaterial" => {
            let [n_d, abbe] = [number_or_only(material, "index")?, number_or_only(material, "abbe")?];
            by_numbers("", n_d, Some(abbe), glasses).map_err(|why| material.error(why))
        }
        "Material" => {
            let name = material.string("name")?.unwrap_or("");
            let [catalogue, reference] = [material.string("catalog")?, material.string("reference")?];
            let reference = catalogue.or(reference).filter(|reference| !reference.is_empty());
            let of_maker = reference.map(|reference| format!("{reference}:{name}"));
            match of_maker.map(|own| glasses.by_name(&own, None, None)) {
                Some(Ok(medium)) => Ok(medium),
                _ => by_name(material, name, glasses),
            }
        }
        other => {
            let what =
                format!("has a material {}; read are IdealMaterial, AbbeMaterial and Material", cut(other));
            Err(refused(material, number, what))
        }
    }
}

/// Returns the number of that name, which may be the only element of a list.
fn number_or_only(part: Part<'_>, key: &str) -> Result<f64, LensFileError> {
    let own = part.need(key, "a number")?;
    match own.node.is_list() {
        true => match part.list(key)?.as_slice() {
            [only] => only.finite(key),
            _ => Err(own.error(format!("\"{key}\" is a list; expected one number"))),
        },
        false => own.finite(key),
    }
}

/// Returns the aperture that limits the beam.
fn aperture(root: Part<'_>) -> Result<Aperture, LensFileError> {
    let Some(aperture) = root.get("aperture") else { return Ok(Aperture::ByStop) };
    let value = aperture.number("value")?.unwrap_or(0.0);
    if value <= 0.0 {
        return Err(aperture.error(format!("an aperture of {}; expected a positive number", as_given(value))));
    }
    match aperture.string("type")?.unwrap_or("") {
        "EPD" => Ok(Aperture::EntrancePupil(value)),
        "imageFNO" => Ok(Aperture::FNumber(value)),
        "objectNA" if value < 1.0 => Ok(Aperture::ObjectNa(value)),
        "float_by_stop_size" => Ok(Aperture::ByStop),
        other => {
            let message = format!(
                "an aperture of type {}; read are EPD, imageFNO, objectNA below 1 and float_by_stop_size",
                cut(other)
            );
            Err(aperture.error(message))
        }
    }
}

/// Gives the stop the diameter that `float_by_stop_size` states.
fn with_stop_diameter(mut lens: SequentialLens, root: Part<'_>) -> Result<SequentialLens, LensFileError> {
    let Some(aperture) = root.get("aperture") else { return Ok(lens) };
    if aperture.string("type")? == Some("float_by_stop_size") {
        let size = aperture.number("value")?.map(|diameter| diameter / 2.0);
        for stop in lens.surfaces.iter_mut().filter(|surface| surface.is_stop) {
            stop.listed = size;
            stop.semi_diameter = stop.clip.or(size);
        }
    }
    Ok(lens)
}

/// Returns the farthest field.
fn field(root: Part<'_>, ledger: &mut Ledger<'_>) -> Result<Option<Field>, LensFileError> {
    let Some(fields) = root.get("fields") else { return Ok(None) };
    let mut farthest: f64 = 0.0;
    for field in fields.list("fields")? {
        let [x, y] = [field.number("x")?.unwrap_or(0.0), field.number("y")?.unwrap_or(0.0)];
        farthest = farthest.max(x.hypot(y));
    }
    let newer = fields.get("field_definition").map_or(Ok(None), |own| own.string("field_type"))?;
    match newer.or(fields.string("field_type")?).unwrap_or("angle") {
        "angle" | "AngleField" => Ok(Some(Field::Angle(farthest))),
        "object_height" | "ObjectHeightField" => Ok(Some(Field::ObjectHeight(farthest))),
        "paraxial_image_height"
        | "ParaxialImageHeightField"
        | "real_image_height"
        | "RealImageHeightField" => Ok(Some(Field::ImageHeight(farthest))),
        other => {
            let reason = format!("fields of type {}, which is not read", cut(other));
            ledger.warn(Fate::LeftOut, fields.node.location, "fields", None, reason);
            Ok(None)
        }
    }
}

/// Returns the primary wavelength, nm, and its place.
fn wavelength(root: Part<'_>) -> Result<Option<(f64, Location)>, LensFileError> {
    let Some(group) = root.get("wavelengths") else { return Ok(None) };
    for wavelength in group.list("wavelengths")? {
        if wavelength.flag("is_primary")? {
            let own = wavelength.need("value", "a wavelength")?;
            let unit = match wavelength.string("unit")?.unwrap_or("um") {
                "um" => 1.0,
                "nm" => 1e-3,
                "mm" => 1e3,
                other => {
                    let message = format!("\"{}\" is not a unit of wavelengths: um, nm or mm", cut(other));
                    return Err(wavelength.error(message));
                }
            };
            let value = nanometres(own.finite("value")? * unit).map_err(|why| own.error(why))?;
            return Ok(Some((value, own.node.location)));
        }
    }
    Ok(None)
}
