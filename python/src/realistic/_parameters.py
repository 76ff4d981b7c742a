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
    """The text of a lens file, read instead of `specfile`; at most 1 MiB."""
    model: Literal["lens", "thick", "thin", "perspective", "orthographic", "environment"] | None
    """What the camera is a model of: "lens", "thick", "thin", "perspective", "orthographic" or "environment";
    default "lens"."""
    lensfile: str | os.PathLike[str] | None
    """Another name of `specfile`."""
    glasscatalog: str | os.PathLike[str] | None
    """Glass catalogue (AGF) in which glasses that a lens file names are looked up first, before catalogues beside
    the file and the built-in glasses."""
    filmdistance: float | None
    """From the last vertex to the film: positive, in mm; default the lens file's, or focused at `focusdistance`."""
    focusdistance: float | None
    """From the film plane to the plane in focus, or inf, instead of `filmdistance`: positive, in units of camera
    space; default infinity."""
    focusby: Literal["film", "group"] | None
    """Whether the film moves to focus, or the lens's own groups with the film where the lens file has it: "film" or
    "group"; default "film"."""
    zoom: float | str | None
    """Focal length of a zoom lens, a number of mm, or the name of one of its positions; without it the lens file's
    first."""
    aperture_diameter: float | None
    """Clear diameter of the stop: positive, in mm; default the file's."""
    aperturediameter: float | None
    """Another name of `aperture_diameter`."""
    fnumber: float | None
    """Focal length over the axial beam's diameter, instead of `aperture_diameter`: positive."""
    blades: float | None
    """Number of blades of the stop, 3 or more; their corners lie on the circle of its clear diameter: 0 (a round
    stop) or more, up to 32; default the lens file's, or 0."""
    bladerotation: float | None
    """Angle of the blades' first corner, from image right toward image up: a finite number, in degrees; default the
    lens file's, or 0."""
    bladecurvature: float | None
    """Curvature of the blades' edges over that of the circle: 0 is straight, 1 the circle: 0 or more, up to 1;
    default the lens file's, or 0."""
    filmdiag: float | None
    """Diagonal of the film: positive, in mm; default 35."""
    hither: float | None
    """Where a ray begins, along it: 0 or more and finite, in units of camera space; default 1e-3."""
    yon: float | None
    """Where a ray ends, along it, from `hither` on: 0 or more, in units of camera space; default 1e30."""
    shutteropen: float | None
    """Time at which the shutter opens: a finite number; default 0."""
    shutterclose: float | None
    """Time at which the shutter closes; before `shutteropen`, time runs backward, as in pbrt: a finite number;
    default 1."""
    weighting: Literal["radiometric", "assignment", "relative", "none"] | None
    """Definition of a ray's weight: "radiometric", "assignment", "relative" or "none"; default "radiometric"."""
    simpleweighting: bool | None
    """Pbrt-v3's name for `weighting`, true for "relative" and false for "radiometric"."""
    transmission: Literal["none", "bare", "quarter-wave", "v-coat", "three-layer", "file"] | None
    """What of the light the surfaces of the lens leave, as a factor of every weight: all of it, or what surfaces
    without a coating, with one of one, two or three layers for 550 nm between air and glass, or with those that the
    lens file names, do not reflect: "none", "bare", "quarter-wave", "v-coat", "three-layer" or "file"; default
    "none"."""
    ghosts: float | None
    """Share of the lens samples that go along paths with two reflections, where `transmission` says what the
    surfaces reflect; 1 for the light of those paths alone: 0 or more, up to 1 of the samples; default 0."""
    pupil: Literal["warped", "rear", "disk"] | None
    """Where lens samples lie, in the true pupil of each film point, the rear element's disk, or the thick-lens exit
    pupil: "warped", "rear" or "disk"; default "warped"."""
    disk: Literal["concentric", "polar", "rejection"] | None
    """How lens samples map to the disk: "concentric", "polar" or "rejection"; default "concentric"."""
    refraction: Literal["fused", "heckbert", "whitted", "other"] | None
    """Method of refraction: "fused", "heckbert", "whitted" or "other"; default "fused"."""
    wavelength: float | None
    """Wavelength, for lenses with V-numbers or dispersion formulas, below 300 only with glasses whose data reach
    there: from 200 to 2000 nm; default the lens file's, or 587.56."""
    mmperunit: float | None
    """Length of a unit of camera space; a world unit is as long unless the camera transform scales: positive, from
    1e-15 to 1e30 mm; default 1."""
    precision: Literal["auto", "f64", "f32", "double", "single"] | None
    """Precision of the trace; "auto" is double, or what `tolerance` allows: "auto", "f64", "f32", "double" or
    "single"; default "auto"."""
    tolerance: float | None
    """Largest error of 99.9 % of the rays, for a faster model of the lens: 0 (exact) or more and finite, in pixels;
    default 0."""
    shutter: Literal["global", "leaf", "focal-plane"] | None
    """Type of shutter: "global", "leaf" or "focal-plane"; default "global"."""
    shutterramp: float | None
    """Share of the shutter's interval in which a leaf shutter opens, and closes: more than 0 and at most 0.5 of the
    interval; default 0.25."""
    shutterslit: float | None
    """Share of the shutter's interval for which a focal-plane shutter exposes each row: more than 0 and at most 1
    of the interval; default 0.25."""
    crop: Iterable[float] | None
    """X from, y from, x to, y to of the part of the picture that the host renders, which changes no ray: whole
    numbers, the last two one past the last pixel: 0 or more and finite, in pixels; default the whole picture."""
    fov: float | None
    """Angle across the shorter side of the image: from 0.0001 to less than 180 degrees; default 90."""
    screenwindow: Iterable[float] | None
    """X from, x to, y from, y to of the part of the screen that becomes the image: from -1e15 to 1e15; default by
    the aspect ratio."""
    frameaspectratio: float | None
    """Width over height of the screen window: positive, from 1e-15 to 1e15; default the image's."""
    lensradius: float | None
    """Radius of the projection's thin lens: 0 (a pinhole) or more, up to 1e15 units of camera space; default 0."""
    focaldistance: float | None
    """From the eye to the plane of focus of a lens of `lensradius`, more than `hither`: a number, in units of
    camera space; default 1e30."""
    lensplane: Literal["eye", "hither"] | None
    """Where that thin lens lies, as in pbrt 1.05, or as in older versions and on the lecture's slide: "eye" or
    "hither"; default "eye"."""


ALIASES = {
    "lensfile": "specfile",
    "aperturediameter": "aperture_diameter",
}
"""Other names of parameters."""

MEMBERS: list[tuple[str, Any]] = [
    ("model", c_char_p),
    ("specfile", c_char_p),
    ("glasscatalog", c_char_p),
    ("filmdistance", c_double),
    ("focusdistance", c_double),
    ("focusby", c_char_p),
    ("zoom", c_char_p),
    ("aperture_diameter", c_double),
    ("fnumber", c_double),
    ("blades", c_double),
    ("bladerotation", c_double),
    ("bladecurvature", c_double),
    ("filmdiag", c_double),
    ("hither", c_double),
    ("yon", c_double),
    ("shutteropen", c_double),
    ("shutterclose", c_double),
    ("weighting", c_char_p),
    ("simpleweighting", c_int32),
    ("transmission", c_char_p),
    ("ghosts", c_double),
    ("pupil", c_char_p),
    ("disk", c_char_p),
    ("refraction", c_char_p),
    ("wavelength", c_double),
    ("mmperunit", c_double),
    ("precision", c_char_p),
    ("tolerance", c_double),
    ("shutter", c_char_p),
    ("shutterramp", c_double),
    ("shutterslit", c_double),
    ("crop", c_double * 4),
    ("fov", c_double),
    ("screenwindow", c_double * 4),
    ("frameaspectratio", c_double),
    ("lensradius", c_double),
    ("focaldistance", c_double),
    ("lensplane", c_char_p),
]
"""Their members of `realistic_options`, which stand after the host's."""
