"""The parameters of a camera, their types, and their members of the C options.

Made from the library's table by `REALISTIC_WRITE_HEADER=1 cargo test --test abi up_to_date`.
"""

from __future__ import annotations

from ctypes import c_char_p, c_double, c_int32
from typing import TYPE_CHECKING, Any, Literal, TypedDict

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable


class Parameters(TypedDict, total=False):
    """What a `Camera` takes besides its lens, its resolution and its pose. None: not given."""

    lens_text: str | bytes | None
    """The text of a lens file, read instead of `lens_file`; at most 1 MiB."""
    model: Literal["lens", "thick", "thin", "perspective", "orthographic", "environment"] | None
    """Kind of camera: "lens", "thick", "thin", "perspective", "orthographic" or "environment"; default "lens"."""
    glass_catalog: str | os.PathLike[str] | None
    """Glass catalogue (AGF) to search first for the glasses of a lens file, before the catalogues beside the file
    and the built-in glasses."""
    strict: bool | None
    """Whether to refuse a lens file of which a statement is replaced or left out that may change the picture;
    default false."""
    film_distance: float | None
    """Distance from the last vertex to the film: positive, in mm; default the lens file's, or focused at
    `focus_distance`."""
    focus_distance: float | None
    """Distance from the film plane to the plane in focus, or inf, instead of `film_distance`: positive, in units of
    camera space; default infinity."""
    focus_by: Literal["film", "group"] | None
    """Part that moves to focus, the film or groups of the lens; the groups leave the film where the lens file has
    it: "film" or "group"; default "film"."""
    zoom: float | str | None
    """Focal length of a zoom lens in mm, or the name of one of its positions; without it the lens file's first
    position."""
    aperture_diameter: float | None
    """Clear diameter of the stop: positive, in mm; default the file's."""
    fnumber: float | None
    """Focal length over the diameter of the axial beam, instead of `aperture_diameter`: positive."""
    blades: float | None
    """Number of blades of the stop, 3 or more; their corners lie on the circle of its clear diameter: 0 (a round
    stop) or more, up to 32; default the lens file's, or 0."""
    blade_rotation: float | None
    """Angle of the blades' first corner, from image right toward image up: a finite number, in degrees; default the
    lens file's, or 0."""
    blade_curvature: float | None
    """Curvature of the blades' edges relative to that of the circle: 0 is straight, 1 the circle: 0 or more, up to
    1; default the lens file's, or 0."""
    stop_picture: str | os.PathLike[str] | None
    """PNG or EXR picture of the stop's transmission, centred on the axis and as wide as the stop; 8-bit values are
    sRGB, all others linear."""
    stop_picture_gain: bool | None
    """Whether the picture's mean transmission over the stop is scaled to 1; default false."""
    film_diagonal: float | None
    """Diagonal of the film: positive, in mm; default 35."""
    film_shift_x: float | None
    """Shift of the film from the axis toward image right; the picture shows more of what lies on the left: from
    -1e15 to 1e15 mm; default 0."""
    film_shift_y: float | None
    """Shift of the film from the axis toward image up; the picture shows more of what lies below: from -1e15 to
    1e15 mm; default 0."""
    film_tilt_x: float | None
    """Tilt of the film about its own x axis, after the shift; turns the film's normal from the axis toward image
    down: from -80 to 80 degrees; default 0."""
    film_tilt_y: float | None
    """Tilt of the film about its own y axis, after that about x; turns the film's normal from the axis toward image
    right: from -80 to 80 degrees; default 0."""
    film_curvature_radius: float | None
    """Radius of a film that is curved like a sphere, positive with the centre behind the film; the raster is
    projected along the film's axis: a number, in mm; default flat."""
    hither: float | None
    """Distance along a ray at which it begins: 0 or more and finite, in units of camera space; default 1e-3."""
    yon: float | None
    """Distance along a ray at which it ends, beyond `hither`: 0 or more, in units of camera space; default 1e30."""
    shutter_open: float | None
    """Time at which the shutter opens: a finite number; default 0."""
    shutter_close: float | None
    """Time at which the shutter closes; before `shutter_open`, time runs backward, as in pbrt: a finite number;
    default 1."""
    weighting: Literal["radiometric", "assignment", "relative", "none"] | None
    """Definition of a ray's weight: "radiometric", "assignment", "relative" or "none"; default "radiometric"."""
    simple_weighting: bool | None
    """Pbrt-v3's name for `weighting`, true for "relative" and false for "radiometric"."""
    iso: float | None
    """Sensitivity of the film, a factor of iso/100 of radiometric weights: positive; default 100, if another of the
    exposure is given."""
    exposure_time: float | None
    """Time for which the film is exposed, a factor of radiometric weights; does not depend on the shutter's times:
    positive, in s; default 1, if another of the exposure is given."""
    exposure: float | None
    """Exposure compensation, a factor of 2 to this power of radiometric weights: from -100 to 100 stops; default 0,
    if another of the exposure is given."""
    responsivity: float | None
    """Response of the film to light, a factor of radiometric weights: positive; default 1, if another of the
    exposure is given."""
    transmission: Literal["none", "bare", "quarter-wave", "v-coat", "three-layer", "file"] | None
    """Transmission of the surfaces, as a factor of every weight: 1, or that of surfaces without a coating, with
    one, two or three layers for 550 nm between air and glass, or with the coatings that the lens file names:
    "none", "bare", "quarter-wave", "v-coat", "three-layer" or "file"; default "none"."""
    ghosts: float | None
    """Share of the lens samples for paths with two reflections, whose strength follows from `transmission`; 1 for
    the light of those paths alone: 0 or more, up to 1 of the samples; default 0."""
    pupil: Literal["warped", "rear", "disk"] | None
    """Region of the lens samples, the true pupil of each film point, the rear element's disk, or the thick-lens
    exit pupil: "warped", "rear" or "disk"; default "warped"."""
    disk: Literal["concentric", "polar", "rejection"] | None
    """Mapping of lens samples to the disk: "concentric", "polar" or "rejection"; default "concentric"."""
    refraction: Literal["fused", "heckbert", "whitted", "other"] | None
    """Method of refraction: "fused", "heckbert", "whitted" or "other"; default "fused"."""
    wavelength: float | None
    """Wavelength of the rays, for lenses with V-numbers or dispersion formulas; below 300 only with glasses whose
    data reach there: from 200 to 2000 nm; default the lens file's, or 587.56."""
    mm_per_unit: float | None
    """Length of a unit of camera space; world units have the same length unless the camera transform scales:
    positive, from 1e-15 to 1e30 mm; default 1."""
    precision: Literal["auto", "f64", "f32", "double", "single"] | None
    """Precision of the trace; "auto" is double, or what `tolerance` allows: "auto", "f64", "f32", "double" or
    "single"; default "auto"."""
    tolerance: float | None
    """Largest error of 99.9 % of the rays, which allows a faster model of the lens: 0 (exact) or more and finite,
    in pixels; default 0."""
    shutter: Literal["global", "leaf", "focal-plane"] | None
    """Type of shutter: "global", "leaf" or "focal-plane"; default "global"."""
    shutter_ramp: float | None
    """Share of the shutter's interval in which a leaf shutter opens, and in which it closes: more than 0 and at
    most 0.5 of the interval; default 0.25."""
    shutter_slit: float | None
    """Share of the shutter's interval for which a focal-plane shutter exposes each row: more than 0 and at most 1
    of the interval; default 0.25."""
    crop: Iterable[float] | None
    """Part of the picture that the host renders, which changes no ray: x from, y from, x to, y to in whole pixels,
    the last two one past the last pixel: 0 or more and finite, in pixels; default the whole picture."""
    fov: float | None
    """Angle across the shorter side of the image: from 0.0001 to less than 180 degrees; default 90."""
    screen_window: Iterable[float] | None
    """Part of the screen that becomes the image: x from, x to, y from, y to: from -1e15 to 1e15; default by the
    aspect ratio."""
    frame_aspect_ratio: float | None
    """Width over height of the screen window: positive, from 1e-15 to 1e15; default the image's."""
    lens_radius: float | None
    """Radius of the projection's thin lens: 0 (a pinhole) or more, up to 1e15 units of camera space; default 0."""
    focal_distance: float | None
    """Distance from the eye to the plane of focus, beyond `hither`, of a lens of `lens_radius`: a number, in units
    of camera space; default 1e30."""
    lens_plane: Literal["eye", "hither"] | None
    """Plane of the projection's thin lens, the eye's as in pbrt 1.05, or the near plane as in older versions and on
    the lecture's slide: "eye" or "hither"; default "eye"."""


MEMBERS: list[tuple[str, Any]] = [
    ("model", c_char_p),
    ("lens_file", c_char_p),
    ("glass_catalog", c_char_p),
    ("strict", c_int32),
    ("film_distance", c_double),
    ("focus_distance", c_double),
    ("focus_by", c_char_p),
    ("zoom", c_char_p),
    ("aperture_diameter", c_double),
    ("fnumber", c_double),
    ("blades", c_double),
    ("blade_rotation", c_double),
    ("blade_curvature", c_double),
    ("stop_picture", c_char_p),
    ("stop_picture_gain", c_int32),
    ("film_diagonal", c_double),
    ("film_shift_x", c_double),
    ("film_shift_y", c_double),
    ("film_tilt_x", c_double),
    ("film_tilt_y", c_double),
    ("film_curvature_radius", c_double),
    ("hither", c_double),
    ("yon", c_double),
    ("shutter_open", c_double),
    ("shutter_close", c_double),
    ("weighting", c_char_p),
    ("simple_weighting", c_int32),
    ("iso", c_double),
    ("exposure_time", c_double),
    ("exposure", c_double),
    ("responsivity", c_double),
    ("transmission", c_char_p),
    ("ghosts", c_double),
    ("pupil", c_char_p),
    ("disk", c_char_p),
    ("refraction", c_char_p),
    ("wavelength", c_double),
    ("mm_per_unit", c_double),
    ("precision", c_char_p),
    ("tolerance", c_double),
    ("shutter", c_char_p),
    ("shutter_ramp", c_double),
    ("shutter_slit", c_double),
    ("crop", c_double * 4),
    ("fov", c_double),
    ("screen_window", c_double * 4),
    ("frame_aspect_ratio", c_double),
    ("lens_radius", c_double),
    ("focal_distance", c_double),
    ("lens_plane", c_char_p),
]
"""Their members of `realistic_options`, which stand after the host's."""
