//! RayOptics (`.roa`), whose writer stores its Python objects: `optical_model`, and in it `seq_model` with the
//! interfaces (`ifcs`) and the gaps behind them, `profile_dict` with the figures, `optical_spec` and `system_spec`.
//! Every object has its class in `__instance_type__` and its values in `attributes`.
//!
//! Sizes are semi-diameters: `max_aperture` computed from rays, `clear_apertures` set by the user. The terms of a
//! polynomial are in the list `coefs` or, in older files beside an empty list, in `coef2`, `coef4`, … A
//! `RadialPolynomial` has `ec`, which is the conic constant plus 1. Tilts have the signs of Code V.

use super::{
    NamedGlasses, Part, by_name, by_numbers, check_image, fates::NoEffect, finished, object_own_image,
    profile_terms, refused, title,
};
use crate::prescription::{
    Aperture as Outline, CoordinateBreak, Fate, LensFileError, Outline as Figure,
    glass::{GlassLibrary, VALID_WAVELENGTHS},
    interfaces::{Asphere, LAST_POWER, Medium, NO_TERMS, Prescription},
    reader::{
        ledger::Ledger,
        sequential::{
            Aperture, Behind, Field, SequentialLens, SequentialSurface, SurfacePlaces, asphere,
            decentre_and_tilts, nanometres, set_term,
        },
        surface_rows::{General, MediumBehind, checked},
        text::Location,
    },
    unsymmetric::{Meridian, Toroid, Unsymmetric},
};
use realistic_base::message::{as_given, cut};

/// Keys without an effect on rays.
pub(super) const NO_EFFECT: NoEffect = &[
    ("the classes of the file's program", &["__instance_type__", "slots", "dtype", "shape"]),
    (
        "names, versions and settings of the file's program and of its displays",
        &[
            "ro_version",
            "radius_mode",
            "initials",
            "aperture_override",
            "label",
            "cur_surface",
            "z_type",
            "do_apertures",
            "edge_apertures",
            "render_colors",
            "coating_wvl",
            "_catalog_name",
            "max_nonzero_coef",
        ],
    ),
    (
        "derived by the file's program from the interfaces, the gaps and the figures",
        &[
            "specsheet",
            "parax_model",
            "ele_model",
            "part_tree",
            "parts_dict",
            "delta_n",
            "z_dir",
            "coefs",
            "bdhl_model",
            "medium.label",
            "wvls",
            "rndx",
            "od",
        ],
    ),
    (
        "fields, wavelengths and their weights, which the user chooses",
        &[
            "field_of_view",
            "spectral_region",
            "spectral_wts",
            "defocus",
            "pupil_rays",
            "ray_labels",
            "index_labels",
            "index_label_type",
            "is_wide_angle",
            "wide_angle",
            "vux",
            "vuy",
            "vlx",
            "vly",
            "wt",
            "aim_pt",
            "aim_info",
            "vcx",
            "vcy",
            "vdx",
            "vdy",
            "van",
            "type",
        ],
    ),
    (
        "describes the object or the image, which are the user's",
        &[
            "ifcs.attributes",
            "ifcs.interact_mode",
            "ifcs.max_aperture",
            "ifcs.clear_apertures",
            "ifcs.decenter",
            "ifcs.profile_id",
            "ifcs.phase_element",
        ],
    ),
    (
        "a term that the list of coefficients replaces",
        &[
            "coef1", "coef2", "coef3", "coef4", "coef5", "coef6", "coef7", "coef8", "coef9", "coef10",
            "coef12", "coef14", "coef16", "coef18", "coef20",
        ],
    ),
    (
        "the temperature and pressure of the file's program, which its indices do not follow",
        &["temperature", "pressure"],
    ),
];

/// Reads a lens.
///
/// # Errors
/// A value is missing or wrong, or the lens cannot be traced.
pub(super) fn read(
    root: Part<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let model = inner(root.need("optical_model", "the model")?);
    let sequence = inner(model.need("seq_model", "the sequence of surfaces")?);
    let list = sequence.list("ifcs")?;
    let gaps = sequence.list("gaps")?;
    let (object, own, image) = object_own_image(&list, sequence.need("ifcs", "a list of interfaces")?)?;
    if gaps.len() + 1 != list.len() {
        let message = format!("{} gaps between {} interfaces; expected one fewer", gaps.len(), list.len());
        return Err(sequence.need("gaps", "a list of gaps")?.error(message));
    }
    let gaps: Vec<Part<'_>> = gaps.into_iter().map(inner).collect();
    let stop = sequence.number("stop_surface")?;
    let mut glasses = NamedGlasses::new(library, Vec::new());
    let front = checked(medium(gaps[0], &mut glasses)?, |reason| {
        ledger.warn(Fate::Replaced, gaps[0].node.location, "medium", Some("0"), reason);
    });
    let mut surfaces: Vec<SequentialSurface> = Vec::with_capacity(own.len());
    let mut thicknesses = Vec::with_capacity(own.len());
    let mut places = Vec::with_capacity(own.len());
    for (number, (&part, &gap)) in (1..).zip(own.iter().zip(&gaps[1..])) {
        let name = format!("{number}");
        let is_stop = stop == Some(f64::from(number));
        let in_front = surfaces.last().map_or(front, |before| before.behind);
        let behind = if is_mirror(part)? { in_front } else { medium(gap, &mut glasses)? };
        surfaces.push(surface(part, &name, model, behind, is_stop)?);
        thicknesses.push(gap.number("thi")?.unwrap_or(0.0));
        let location = |part: Option<Part<'_>>| part.map(|part| part.node.location);
        places.push(SurfacePlaces {
            surface: part.node.location,
            size: location(inner(part).get("max_aperture")),
            thickness: location(gap.get("thi")),
            number: name,
        });
    }
    let profile_of_image = profile(inner(image), model)?;
    let image_curvature = profile_of_image.map_or(Ok(None), |profile| inner(profile).number("cv"))?;
    check_image(image_curvature.unwrap_or(0.0), image, "profile_id", ledger);
    let specification = inner(model.need("optical_spec", "apertures, fields and wavelengths")?);
    let in_air = surfaces.last().is_some_and(|last| last.behind.medium == Medium::Air);
    let object_distance = gaps[0].number_or_infinity("thi")?.unwrap_or(f64::INFINITY);
    let system = model.get("system_spec").map(inner);
    let lens = SequentialLens {
        object: front,
        object_place: object.node.location,
        object_distance,
        surfaces,
        thicknesses,
        image_break: decentre(inner(image), "of the image", false)?[0],
        places,
        aperture: aperture(specification, in_air, ledger)?,
        field: field(specification, ledger)?,
        wavelength: wavelength(specification)?,
        keys: ["ifcs", "max_aperture", "thi"],
        unit: unit(system)?,
    };
    let (lens, _) = lens.prescription(root.text, root.node.location, ledger)?;
    let name = system.map_or(Ok(None), |system| system.string("title"))?;
    Ok(finished(Prescription { title: title(name), ..lens }, glasses, root.text.file))
}

/// Returns the values of an object of the file's program.
fn inner(part: Part<'_>) -> Part<'_> {
    part.get("attributes").unwrap_or(part)
}

/// Returns the module and the class of an object of the file's program; empty if the file does not state them.
fn class<'j>(part: Part<'j>) -> [&'j str; 2] {
    let names = part.list("__instance_type__").unwrap_or_default();
    let name = |i: usize| names.get(i).and_then(|name| name.node.string()).unwrap_or("");
    [name(0), name(1)]
}

/// Returns the unit of the file's lengths, mm.
fn unit(system: Option<Part<'_>>) -> Result<f64, LensFileError> {
    let Some(system) = system else { return Ok(1.0) };
    let key = if system.node.has("_dimensions") { "_dimensions" } else { "dimensions" };
    match system.string(key)?.unwrap_or("mm").to_ascii_lowercase().as_str() {
        "mm" => Ok(1.0),
        "cm" => Ok(10.0),
        "m" => Ok(1000.0),
        "in" | "inch" | "inches" => Ok(25.4),
        other => {
            let part = system.need(key, "mm")?;
            Err(part.error(format!("\"{}\" is not a unit: mm, cm, m or in", cut(other))))
        }
    }
}

/// Returns the profile of an interface.
fn profile<'j>(part: Part<'j>, model: Part<'j>) -> Result<Option<Part<'j>>, LensFileError> {
    let Some(id) = part.string("profile_id")? else { return Ok(part.get("profile")) };
    let missing = || part.error(format!("no profile \"{}\" in \"profile_dict\"", cut(id)));
    let profiles = model.need("profile_dict", "the profiles of the surfaces")?;
    profiles.get(id).map(Some).ok_or_else(missing)
}

/// Reads one interface of the lens.
fn surface(
    part: Part<'_>,
    number: &str,
    model: Part<'_>,
    behind: MediumBehind,
    is_stop: bool,
) -> Result<SequentialSurface, LensFileError> {
    let [_, kind] = class(part);
    match kind {
        "Surface" | "" => {}
        "ThinLens" => {
            return Err(refused(part, number, "is an ideal thin lens (ThinLens), which has no glass"));
        }
        other => return Err(refused(part, number, format!("is a {}; read is Surface", cut(other)))),
    }
    let own = inner(part);
    match own.string("interact_mode")?.unwrap_or("transmit") {
        "transmit" | "dummy" | "reflect" => {}
        other => {
            let what =
                format!("has the interact_mode \"{}\"; read are transmit, reflect and dummy", cut(other));
            return Err(refused(part, number, what));
        }
    }
    let is_mirror = is_mirror(part)?;
    let [coordinate_break, break_behind] = decentre(own, number, is_mirror)?;
    if let Some(phase) = own.get("phase_element") {
        return Err(refused(phase, number, "is a grating or hologram (phase_element), which is not traced"));
    }
    let profile = profile(own, model)?;
    let unsymmetric = profile.map_or(Ok(None), |profile| toroid(profile, number))?;
    let (curvature, asphere) = match profile.filter(|_| unsymmetric.is_none()) {
        Some(profile) => figure(profile, number)?,
        None => (0.0, None),
    };
    let (clip, apertures) = apertures(own, number)?;
    let listed = own.number("max_aperture")?.map(f64::abs).filter(|size| *size > 0.0);
    Ok(SequentialSurface {
        curvature,
        asphere,
        behind,
        semi_diameter: clip.or(listed),
        listed,
        clip,
        is_fixed: clip.is_some() || !apertures.is_empty(),
        apertures,
        is_stop,
        general: General { unsymmetric, is_mirror, coordinate_break },
        break_behind,
    })
}

/// Returns the curvature and the figure of a profile.
fn figure(part: Part<'_>, number: &str) -> Result<(f64, Option<Asphere>), LensFileError> {
    let [_, kind] = class(part);
    let own = inner(part);
    let curvature = own.number("cv")?.unwrap_or(0.0);
    let (conic, step) = match kind {
        "Spherical" => return Ok((curvature, None)),
        "Conic" | "EvenPolynomial" => (own.number("cc")?.unwrap_or(0.0), 2),
        "RadialPolynomial" => {
            let by_ellipse = own.number("ec")?.map(|ec| ec - 1.0);
            (by_ellipse.or(own.number("cc")?).unwrap_or(0.0), 1)
        }
        other => {
            let what = format!(
                "has the profile {}; read are Spherical, Conic, EvenPolynomial, RadialPolynomial, XToroid and YToroid",
                cut(other)
            );
            return Err(refused(part, number, what));
        }
    };
    let mut terms = NO_TERMS;
    let list = array(own, "coefs")?;
    if kind != "Conic" {
        let by_list = (1..).zip(list.iter().copied()).map(|(i, value)| (step * i, value));
        let terms_of_list: Vec<(usize, f64)> = by_list.collect();
        let terms_by_name = (1..=LAST_POWER).filter(|power| power % step == 0);
        let all = match terms_of_list.is_empty() {
            false => terms_of_list,
            true => terms_by_name
                .map(|power| Ok((power, own.number(&format!("coef{power}"))?.unwrap_or(0.0))))
                .collect::<Result<_, LensFileError>>()?,
        };
        for (power, value) in all {
            set_term(&mut terms, power, value).map_err(|why| refused(part, number, why))?;
        }
    }
    Ok((curvature, asphere(conic, terms)))
}

/// Returns whether an interface reflects.
fn is_mirror(part: Part<'_>) -> Result<bool, LensFileError> {
    Ok(inner(part).string("interact_mode")? == Some("reflect"))
}

/// Returns the changes of frame in front of an interface and behind it.
fn decentre(
    own: Part<'_>,
    number: &str,
    is_mirror: bool,
) -> Result<[Option<CoordinateBreak>; 2], LensFileError> {
    let Some(part) = own.get("decenter") else { return Ok([None; 2]) };
    let values = inner(part);
    let vector = |key: &str| -> Result<[f64; 3], LensFileError> {
        let all = array(values, key)?;
        Ok(std::array::from_fn(|i| all.get(i).copied().unwrap_or(0.0)))
    };
    let (shift, tilts) = (vector("dec")?, vector("euler")?);
    if vector("rot_pt")? != [0.0; 3] {
        return Err(refused(
            part,
            number,
            "has an offset of the axis of its tilts (rot_pt), which is not read",
        ));
    }
    let key = if values.node.has("_dtype") { "_dtype" } else { "dtype" };
    let behind = match values.string(key)?.unwrap_or("") {
        "decenter" => Behind::Stay,
        "dec and return" => Behind::Return,
        "bend" => Behind::Bend,
        other => {
            let what = format!(
                "has a decenter of the type \"{}\", whose order is not known for certain",
                cut(other)
            );
            return Err(refused(part, number, what));
        }
    };
    decentre_and_tilts(shift, tilts, behind, is_mirror).map_err(|what| refused(part, number, what))
}

/// Returns the toroid of a profile; `None` for other profiles.
fn toroid(part: Part<'_>, number: &str) -> Result<Option<Unsymmetric>, LensFileError> {
    let [_, kind] = class(part);
    let meridian = match kind {
        "XToroid" => Meridian::X,
        "YToroid" => Meridian::Y,
        _ => return Ok(None),
    };
    let own = inner(part);
    let number_of = |key: &str| -> Result<f64, LensFileError> { Ok(own.number(key)?.unwrap_or(0.0)) };
    // 1/0 is infinite, as a plane's radius.
    let [radius, rotation_radius] =
        [number_of("cv")?, number_of("cR")?].map(|cv| cv.abs().recip().copysign(cv));
    let conic = own.number("ec")?.map_or_else(|| number_of("cc"), |ec| Ok(ec - 1.0))?;
    let terms = profile_terms(part, number, array(own, "coefs")?)?;
    Ok(Some(Unsymmetric::Toroid(Toroid { meridian, radius, conic, terms, rotation_radius })))
}

/// Returns the numbers of a list, or of an array of NumPy.
fn array(part: Part<'_>, key: &str) -> Result<Vec<f64>, LensFileError> {
    match part.get(key) {
        Some(own) if own.node.is_object() => own.numbers("__ndarray__"),
        _ => part.numbers(key),
    }
}

/// Returns the semi-diameter of the round aperture about the axis, and the other apertures.
fn apertures(part: Part<'_>, number: &str) -> Result<(Option<f64>, Vec<Outline>), LensFileError> {
    let mut clip: Option<f64> = None;
    let mut others = Vec::new();
    for aperture in part.list("clear_apertures")? {
        let [_, kind] = class(aperture);
        let own = inner(aperture);
        let value = |key: &str| -> Result<f64, LensFileError> { Ok(own.number(key)?.unwrap_or(0.0)) };
        let center = [value("x_offset")?, value("y_offset")?];
        let rotation = value("rotation")?;
        let is_obstruction = own.flag("is_obscuration")?;
        let positive = |key: &str| -> Result<f64, LensFileError> {
            let size = own.needed_number(key, "a size")?;
            if size > 0.0 {
                return Ok(size);
            }
            Err(own.error(format!("\"{key}\" is {}; expected a positive number", as_given(size))))
        };
        let outline = match kind {
            "Circular" => {
                let radius = positive("radius")?;
                if center == [0.0; 2] && !is_obstruction {
                    clip = Some(clip.map_or(radius, |clip| clip.min(radius)));
                    continue;
                }
                Figure::Ellipse([radius; 2])
            }
            "Rectangular" => Figure::Rectangle([positive("x_half_width")?, positive("y_half_width")?]),
            "Elliptical" => Figure::Ellipse([positive("x_half_width")?, positive("y_half_width")?]),
            other => {
                let what =
                    format!("has an aperture {}; read are Circular, Rectangular and Elliptical", cut(other));
                return Err(refused(aperture, number, what));
            }
        };
        others.push(Outline { outline, center, rotation, is_obstruction });
    }
    let reach = others.iter().filter(|own| !own.is_obstruction).map(Outline::reach).min_by(f64::total_cmp);
    Ok((clip.or(reach), others))
}

/// Returns the medium of a gap.
fn medium(gap: Part<'_>, glasses: &mut NamedGlasses<'_>) -> Result<MediumBehind, LensFileError> {
    let Some(part) = gap.get("medium") else { return Ok(Medium::Air.into()) };
    let [module, kind] = class(part);
    let own = inner(part);
    if matches!(kind, "Air" | "AirMedium") {
        return Ok(Medium::Air.into());
    }
    if matches!(kind, "ModelGlass" | "Glass" | "ConstantIndex" | "Medium") && own.node.has("n") {
        let n_d = own.needed_number("n", "an index")?;
        let abbe = own.number("v")?;
        let name = own.string("label")?.unwrap_or("");
        return by_numbers(name, n_d, abbe, glasses).map_err(|why| part.error(why));
    }
    let keys = ["gname", "label", "name", "_name"];
    let name = keys.iter().find_map(|key| own.string(key).ok().flatten().filter(|name| !name.is_empty()));
    let Some(name) = name else {
        let message = format!("a medium of class {} without a name; it is not read", cut(kind));
        return Err(part.error(message));
    };
    // The module is named after the maker: opticalglass.schott.
    let maker = module.rsplit('.').next().unwrap_or("");
    let of_maker = format!("{maker}:{name}");
    match glasses.by_name(&of_maker, None, None) {
        Ok(medium) => Ok(medium),
        Err(_) => by_name(part, name, glasses),
    }
}

/// Returns the last two words of a specification's key: the side of the lens and the quantity.
fn quantity<'j>(part: Part<'j>) -> [&'j str; 2] {
    let key = if part.node.has("_key") { "_key" } else { "key" };
    let words = part.list(key).unwrap_or_default();
    let word = |back: usize| {
        let word = words.len().checked_sub(back).and_then(|i| words.get(i));
        word.and_then(|word| word.node.string()).unwrap_or("")
    };
    [word(2), word(1)]
}

/// Returns the aperture that limits the beam.
fn aperture(
    specification: Part<'_>,
    in_air: bool,
    ledger: &mut Ledger<'_>,
) -> Result<Aperture, LensFileError> {
    let Some(pupil) = specification.get("pupil").map(inner) else { return Ok(Aperture::ByStop) };
    let value = pupil.number("value")?.unwrap_or(0.0).abs();
    Ok(match quantity(pupil) {
        _ if value == 0.0 => Aperture::ByStop,
        ["object", "epd"] => Aperture::EntrancePupil(value),
        ["object", "NA"] if value < 1.0 => Aperture::ObjectNa(value),
        ["object", "f/#"] => Aperture::ObjectCone((0.5 / value).atan().to_degrees()),
        ["image", "f/#"] => Aperture::WorkingFNumber(value),
        ["image", "NA"] if value < 1.0 && in_air => Aperture::image_na(value),
        [side, kind] => {
            let reason = format!(
                "an aperture of {} {}, which is not read; the stop's own size counts",
                cut(side),
                cut(kind)
            );
            let location = pupil.get("value").unwrap_or(pupil).node.location;
            ledger.warn(Fate::LeftOut, location, "pupil", None, reason);
            Aperture::ByStop
        }
    })
}

/// Returns the farthest field.
fn field(specification: Part<'_>, ledger: &mut Ledger<'_>) -> Result<Option<Field>, LensFileError> {
    let Some(view) = specification.get("field_of_view").map(inner) else { return Ok(None) };
    let mut farthest: f64 = 0.0;
    for field in view.list("fields")?.into_iter().map(inner) {
        let [x, y] = [field.number("x")?.unwrap_or(0.0), field.number("y")?.unwrap_or(0.0)];
        farthest = farthest.max(x.hypot(y));
    }
    let scale = if view.flag("is_relative")? { view.number("value")?.unwrap_or(0.0).abs() } else { 1.0 };
    let size = farthest * scale;
    Ok(match quantity(view) {
        ["object", "angle"] => Some(Field::Angle(size)),
        ["object", "height"] => Some(Field::ObjectHeight(size)),
        ["image", "height" | "real height"] => Some(Field::ImageHeight(size)),
        [side, kind] => {
            let reason = format!("fields of {} {}, which are not read", cut(side), cut(kind));
            ledger.warn(Fate::LeftOut, view.node.location, "field_of_view", None, reason);
            None
        }
    })
}

/// Returns the reference wavelength, nm, and its place.
fn wavelength(specification: Part<'_>) -> Result<Option<(f64, Location)>, LensFileError> {
    let Some(region) = specification.get("spectral_region").map(inner) else { return Ok(None) };
    let number = region.number("reference_wvl")?.unwrap_or(0.0);
    let all = array(region, "wavelengths")?;
    let place = region.get("wavelengths").unwrap_or(region);
    let Some(&wavelength) = all.get(number as usize).filter(|_| number >= 0.0) else { return Ok(None) };
    if VALID_WAVELENGTHS.contains(&wavelength) {
        return Ok(Some((wavelength, place.node.location)));
    }
    Err(place.error(nanometres(wavelength / 1e3).err().unwrap_or_default()))
}
