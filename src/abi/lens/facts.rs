//! Properties of a lens: its first-order optics, pupils and surfaces, and its focus by exact rays.

use std::ffi::c_char;

use super::{
    super::{
        boundary::{self, Failure, realistic_status},
        exchange::{give, give_text},
    },
    handle::{OpenedLens, opened, realistic_lens},
};
use ::realistic_camera::CameraError;
use realistic_light::{Surfaces, TStop};
use realistic_optics::{
    imaging::{axial_beam::AxialBeam, focus::Focus, plane_of_focus::FocusedFilm},
    lens::first_order::FirstOrder,
    prescription::{Asphere, Coating, NO_TERMS},
};

/// First-order data of a lens (M. Born and E. Wolf, *Principles of Optics*, chapter 4). z is a coordinate in
/// lens space, mm; it is infinite for a point at infinity. `realistic_lens_get_info` fills this structure.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_lens_info {
    /// `sizeof(realistic_lens_info)`.
    pub struct_size: u32,
    /// Number of surfaces, including the stop.
    pub surfaces: u32,
    /// Number of the stop among the surfaces, counted from 0 at the scene side; -1 for a lens without a stop.
    pub stop: i32,
    /// Number of the surface that limits the beam from a distant point on the axis: the surface that blocks
    /// the first exact ray outside the beam.
    pub limiting: i32,
    /// Wavelength, nm.
    pub wavelength: f64,
    /// Effective focal length 1/φ, mm; negative for a diverging lens, infinite for an afocal one. The focal
    /// lengths n/φ and n'/φ on both sides are this times `index_scene` and `index_film`.
    pub focal_length_mm: f64,
    /// Absolute focal length divided by the diameter of the beam of exact rays from a distant point on the
    /// axis; infinite for an afocal lens, or if no ray parallel to the axis passes.
    pub fnumber: f64,
    /// Distance from the last vertex to the film-side focal point, mm. This and the next four members are NaN
    /// for an afocal lens.
    pub back_focal_distance_mm: f64,
    /// z of the scene-side focal point.
    pub front_focal_point_mm: f64,
    /// z of the film-side focal point.
    pub rear_focal_point_mm: f64,
    /// z of the scene-side principal plane.
    pub front_principal_plane_mm: f64,
    /// z of the film-side principal plane.
    pub rear_principal_plane_mm: f64,
    /// z of the last vertex; 0 or less.
    pub rear_vertex_mm: f64,
    /// z of the entrance pupil, the first-order image of the limiting surface's aperture.
    pub entrance_pupil_mm: f64,
    /// Diameter of the entrance pupil, mm, which is the diameter of the beam.
    pub entrance_pupil_diameter_mm: f64,
    /// z of the exit pupil, the first-order image of the limiting surface's aperture.
    pub exit_pupil_mm: f64,
    /// Diameter of the exit pupil, mm; infinite for a pupil at infinity.
    pub exit_pupil_diameter_mm: f64,
    /// Focal length that the lens's description states, mm; NaN if it states none.
    pub stated_focal_length_mm: f64,
    /// Film distance that the lens's description proposes, from the last vertex, mm; NaN if it proposes none.
    pub nominal_film_distance_mm: f64,
    /// T-number with uncoated surfaces: the f-number divided by the square root of the transmission on the
    /// axis, at the lens's wavelength; NaN if no light passes.
    pub tnumber_bare: f64,
    /// T-number with a quarter-wave coating of MgF2 for 550 nm on all surfaces between air and glass.
    pub tnumber_quarter_wave: f64,
    /// f-number by first-order optics alone: the absolute focal length divided by the diameter of the
    /// smallest image of any aperture, formed by the surfaces in front of that aperture.
    pub fnumber_paraxial: f64,
    /// Refractive index in front of the lens; 1 in air.
    pub index_scene: f64,
    /// Refractive index behind the lens, where the film is; 1 in air.
    pub index_film: f64,
    /// z of the scene-side nodal point: a ray toward it leaves the lens from the other one in the same
    /// direction. Nodal points are the principal points if both indices are equal, and NaN for an afocal lens.
    pub front_nodal_point_mm: f64,
    /// z of the film-side nodal point.
    pub rear_nodal_point_mm: f64,
    /// Effective focal length in the meridian x, mm; the lengths above are those in the meridian y. The two differ for
    /// lenses with cylinders, toroids, biconics or tilted surfaces.
    pub focal_length_x_mm: f64,
    /// Distance from the last vertex to the film-side focal point in the meridian x, mm; NaN for an afocal lens.
    pub back_focal_distance_x_mm: f64,
    /// 1 if all surfaces are symmetric about one axis, otherwise 0.
    pub is_centred: u32,
    /// Number of mirrors among the surfaces.
    pub mirrors: u32,
    /// The f-number in the meridian x.
    pub fnumber_x: f64,
    /// z of the entrance pupil in the meridian x, mm.
    pub entrance_pupil_x_mm: f64,
    /// Diameter of the entrance pupil in the meridian x, mm.
    pub entrance_pupil_diameter_x_mm: f64,
    /// z of the exit pupil in the meridian x, mm.
    pub exit_pupil_x_mm: f64,
    /// Diameter of the exit pupil in the meridian x, mm.
    pub exit_pupil_diameter_x_mm: f64,
}

/// One surface of a lens. `realistic_lens_get_surface` fills this structure.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_lens_surface {
    /// `sizeof(realistic_lens_surface)`.
    pub struct_size: u32,
    /// 1 for the aperture stop, otherwise 0.
    pub is_stop: u32,
    /// z of the surface's vertex, mm; 0 for the first surface.
    pub vertex_mm: f64,
    /// Radius of curvature, mm: positive if the centre of curvature lies on the film's side, infinite for a
    /// plane.
    pub radius_mm: f64,
    /// Distance to the next vertex, mm; 0 for the last surface.
    pub thickness_mm: f64,
    /// Refractive index on the scene's side.
    pub index_scene: f64,
    /// Refractive index on the film's side.
    pub index_film: f64,
    /// Clear semi-diameter, mm.
    pub semi_diameter_mm: f64,
    /// Vertex radius of the conic part of the surface, mm. It differs from `radius_mm` only if A2 adds to the
    /// curvature.
    pub conic_radius_mm: f64,
    /// Conic constant k: 0 for a sphere or a plane, -1 for a paraboloid, less for a hyperboloid. With c =
    /// 1/`conic_radius_mm` and r the distance from the axis, the surface lies c r²/(1 + √(1 - (1 + k) c² r²)) + A1 r +
    /// A2 r² + … + A30 r^30 behind its vertex plane, toward the film (W. J. Smith, *Modern Optical Engineering*, on
    /// aspheric surfaces).
    pub conic: f64,
    /// Coefficients A1, A2, … A30 of the asphere; Ai is in mm^(1 - i).
    pub aspheric: [f64; 30],
    /// Vertex radius in the meridian x, mm. It differs from `radius_mm`, which is that in y, for a cylinder, a toroid or a
    /// biconic; their other numbers are not given.
    pub radius_x_mm: f64,
    /// 1 if the surface reflects, otherwise 0.
    pub is_mirror: u32,
    /// 1 if the surface does not share the axis of the surface before it, or for the first that of the camera,
    /// otherwise 0. `vertex_mm` then counts thicknesses alone.
    pub is_turned: u32,
}

/// Describes a lens.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_get_info(
    lens: *const realistic_lens,
    info: *mut realistic_lens_info,
) -> realistic_status {
    // SAFETY: the caller's promise.
    boundary::status(|| unsafe {
        let filled = info_of(opened(lens)?);
        give("realistic_lens_info", filled, "info", info)
    })
}

fn info_of(opened: &OpenedLens) -> realistic_lens_info {
    let OpenedLens { lens, first_order, beam, .. } = opened;
    let AxialBeam { entrance, exit, .. } = beam;
    let [index_scene, index_film] = lens.outer_indices();
    let optics = first_order.as_ref().ok();
    // The section of the turned lens in y is that of the lens in x.
    let turned = (!lens.is_centred()).then(|| lens.turned());
    let in_x = turned.as_ref().map_or(optics.copied(), |lens| FirstOrder::of(lens).ok());
    let beam_in_x = turned.as_ref().map_or(*beam, AxialBeam::of);
    let focal_length_x = in_x.map_or(f64::INFINITY, |optics| optics.focal_length);
    let of = |position: fn(&FirstOrder) -> f64| optics.map_or(f64::NAN, position);
    let focal_length = optics.map_or(f64::INFINITY, |optics| optics.focal_length);
    let tnumber = |coating: Coating| {
        TStop::of(lens, &Surfaces::new(lens, coating), beam, focal_length)
            .map_or(f64::NAN, |stop| stop.number)
    };
    realistic_lens_info {
        struct_size: size_of::<realistic_lens_info>() as u32,
        surfaces: lens.surfaces.len() as u32,
        stop: lens.stop_index().map_or(-1, |stop| stop as i32),
        limiting: beam.limiting as i32,
        wavelength: lens.wavelength,
        focal_length_mm: focal_length,
        fnumber: beam.fnumber(focal_length),
        back_focal_distance_mm: of(|optics| optics.back_focal_distance()),
        front_focal_point_mm: of(|optics| optics.front_focal_point),
        rear_focal_point_mm: of(|optics| optics.rear_focal_point),
        front_principal_plane_mm: of(|optics| optics.front_principal_plane),
        rear_principal_plane_mm: of(|optics| optics.rear_principal_plane),
        rear_vertex_mm: lens.rear().vertex,
        entrance_pupil_mm: entrance.position().unwrap_or(f64::INFINITY),
        entrance_pupil_diameter_mm: entrance.diameter(),
        exit_pupil_mm: exit.position().unwrap_or(f64::INFINITY),
        exit_pupil_diameter_mm: exit.diameter(),
        stated_focal_length_mm: opened.stated_focal_length.unwrap_or(f64::NAN),
        nominal_film_distance_mm: lens.nominal_film_distance.unwrap_or(f64::NAN),
        tnumber_bare: tnumber(Coating::Bare),
        tnumber_quarter_wave: tnumber(Coating::QuarterWave),
        fnumber_paraxial: beam.paraxial_fnumber(focal_length),
        index_scene,
        index_film,
        front_nodal_point_mm: of(|optics| optics.nodal_points()[0]),
        rear_nodal_point_mm: of(|optics| optics.nodal_points()[1]),
        focal_length_x_mm: focal_length_x,
        back_focal_distance_x_mm: in_x.map_or(f64::NAN, |optics| optics.back_focal_distance()),
        is_centred: lens.is_centred().into(),
        mirrors: lens.surfaces.iter().filter(|surface| surface.is_mirror).count() as u32,
        fnumber_x: beam_in_x.fnumber(focal_length_x),
        entrance_pupil_x_mm: beam_in_x.entrance.position().unwrap_or(f64::INFINITY),
        entrance_pupil_diameter_x_mm: beam_in_x.entrance.diameter(),
        exit_pupil_x_mm: beam_in_x.exit.position().unwrap_or(f64::INFINITY),
        exit_pupil_diameter_x_mm: beam_in_x.exit.diameter(),
    }
}

/// Describes surface `number`, counted from 0 at the scene side.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_get_surface(
    lens: *const realistic_lens,
    number: u32,
    surface: *mut realistic_lens_surface,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let surfaces = unsafe { opened(lens) }?.lens.surfaces.as_slice();
        let Some(found) = surfaces.get(number as usize) else {
            return Err(Failure::invalid(format!(
                "surface {number}: the lens has {}, counted from 0 at the scene side",
                surfaces.len()
            )));
        };
        let plain = Asphere { radius: found.radius, conic: 0.0, terms: NO_TERMS };
        let figure = found.figure.map_or(plain, |figure| figure.asphere);
        let filled = realistic_lens_surface {
            struct_size: size_of::<realistic_lens_surface>() as u32,
            is_stop: found.is_stop.into(),
            vertex_mm: found.vertex,
            radius_mm: found.radius,
            thickness_mm: found.thickness,
            index_scene: found.n_scene,
            index_film: found.n_film,
            semi_diameter_mm: found.semi_diameter,
            conic_radius_mm: figure.radius,
            conic: figure.conic,
            aspheric: figure.terms,
            radius_x_mm: found.unsymmetric.as_ref().map_or(found.radius, |figure| figure.surface.radii()[0]),
            is_mirror: found.is_mirror.into(),
            is_turned: found.coordinate_break.is_some().into(),
        };
        // SAFETY: the caller's promise.
        unsafe { give("realistic_lens_surface", filled, "surface", surface) }
    })
}

/// Copies the name of a lens.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_get_name(
    lens: *const realistic_lens,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> realistic_status {
    // SAFETY: the caller's promise.
    boundary::status(|| unsafe { give_text(&opened(lens)?.lens.name, buffer, capacity, length) })
}

/// Finds the film distance, mm from the last vertex, at which a point on the axis `focus_distance_mm` in
/// front of the **film** is sharpest: there the point's bundle of exact rays, at the lens's stop and
/// wavelength, has the smallest RMS spot. The object distance may be infinite. Returns
/// `REALISTIC_STATUS_UNREACHABLE_FOCUS` if the lens cannot focus at that distance; the message then states
/// the nearest possible distance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_focus(
    lens: *const realistic_lens,
    focus_distance_mm: f64,
    film_distance: *mut f64,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let focus = focus_of(unsafe { opened(lens) }?)?;
        positive("focus_distance_mm", focus_distance_mm)?;
        let found = focus.film_distance(focus_distance_mm).map_err(CameraError::from)?;
        // SAFETY: the caller's promise.
        unsafe { give_distance(film_distance, "film_distance", found) }
    })
}

/// Finds the distance in focus, mm from the film along the axis, for a film at `film_distance` behind the
/// last vertex: infinity if the lens is focused at infinity, NaN if nothing in front of the lens is in focus.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_focused_on(
    lens: *const realistic_lens,
    film_distance: f64,
    focus_distance_mm: *mut f64,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let focus = focus_of(unsafe { opened(lens) }?)?;
        positive("film_distance", film_distance)?;
        let found = focus.object_distance(film_distance).unwrap_or(f64::NAN);
        // SAFETY: the caller's promise.
        unsafe { give_distance(focus_distance_mm, "focus_distance_mm", found) }
    })
}

/// The film that has a given plane in focus. `realistic_lens_plane_of_focus` fills this structure.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_focused_film {
    /// `sizeof(realistic_focused_film)`.
    pub struct_size: u32,
    /// Distance from the last vertex to the film's centre, mm; the value for the parameter of this name.
    pub film_distance: f64,
    /// Tilt about x, degrees; the value for the parameter of this name.
    pub film_tilt_x: f64,
    /// Tilt about y, degrees; the value for the parameter of this name.
    pub film_tilt_y: f64,
}

/// Finds the distance and the tilt of the film that brings the plane through three points of lens space into
/// focus (Scheimpflug's rule). `points` are nine numbers in mm, x, y and z of each point, with z toward the
/// scene. The tilt follows from first-order optics, the distance on the axis from exact rays. Returns
/// `REALISTIC_STATUS_UNREACHABLE_FOCUS`, with the reason, if a point has no real image, the points do not
/// define a plane, or the film would intersect the lens.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_plane_of_focus(
    lens: *const realistic_lens,
    points: *const f64,
    film: *mut realistic_focused_film,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let opened = unsafe { opened(lens) }?;
        if points.is_null() {
            return Err(boundary::null("points"));
        }
        // SAFETY: the caller's promise.
        let points: [[f64; 3]; 3] = unsafe { points.cast::<[[f64; 3]; 3]>().read_unaligned() };
        let focus = focus_of(opened)?;
        let FocusedFilm { film_distance, tilt: [film_tilt_x, film_tilt_y] } = FocusedFilm::on(focus, points)
            .map_err(|error| Failure::new(realistic_status::UnreachableFocus, error.to_string()))?;
        let struct_size = size_of::<realistic_focused_film>() as u32;
        let found = realistic_focused_film { struct_size, film_distance, film_tilt_x, film_tilt_y };
        // SAFETY: the caller's promise.
        unsafe { give("realistic_focused_film", found, "film", film) }
    })
}

fn focus_of(opened: &OpenedLens) -> Result<&Focus, Failure> {
    opened.focus.as_ref().map_err(|error| CameraError::from(error.clone()).into())
}

fn positive(name: &str, distance: f64) -> Result<(), Failure> {
    if distance > 0.0 {
        return Ok(());
    }
    Err(Failure::invalid(format!("{name} is {distance}; it must be positive")))
}

/// # Safety
/// `out` is NULL or writable.
unsafe fn give_distance(out: *mut f64, name: &str, found: f64) -> Result<(), Failure> {
    if out.is_null() {
        return Err(boundary::null(name));
    }
    // SAFETY: not NULL, and the caller's promise.
    unsafe { out.write_unaligned(found) };
    Ok(())
}
