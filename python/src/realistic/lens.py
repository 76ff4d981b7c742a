"""A lens without a film: first-order data, surfaces, focus, and exact rays in both directions."""

from __future__ import annotations

import ctypes
import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._abi import FocusedFilm, LensInfo, LensPointsView, LensRaysView, LensSurface, Vectors, library, text_of
from ._ghosts import Ghost, ghosts
from ._handle import Handle, build
from ._waves import Psf, Wavefront, WaveMtf, mtf, psf
from .errors import check, warn
from .notebook import drawing
from .parameters import checked, options_of
from .rays import view
from .surfaces import Surface

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

SIDES = ("film", "scene")
"""Names of the values of `realistic_side`, indexed by value."""


def _number(name: str, value: float) -> ctypes.c_double:
    """Converts a number for the library."""
    try:
        return ctypes.c_double(value)
    except TypeError:
        raise TypeError(f"{name} must be a number, not {type(value).__name__}") from None


def catalogue() -> tuple[str, ...]:
    """Returns the names of the built-in lenses, for `lens_file`; the first is the default.

    >>> catalogue()[0]
    'dgauss.50mm'
    """
    status, text = text_of(library.realistic_catalogue)
    check(status)
    return tuple(text.split("\n"))


class Pupils(NamedTuple):
    """First-order images of the aperture that limits the axial beam: z in lens space, and the beam's diameter there,
    mm."""

    entrance_mm: float
    entrance_diameter_mm: float
    exit_mm: float
    exit_diameter_mm: float


@dataclass(eq=False, repr=False)
class LensRays:
    """Rays traced through a lens.

    Attributes
    ----------
    origin : ndarray (n, 3) of float64
        Point where each ray leaves the last surface, mm in lens space; for a blocked ray, its point on the last surface
        that it met.
    direction : ndarray (n, 3) of float64
        Unit vectors.
    reason : ndarray (n,) of int32
        `Reason` of each ray; 0 for a ray that passes the lens.
    points : ndarray (n, surfaces, 3) of float64, or None
        Point where each ray meets each surface, mm, with the surfaces in order from the scene's side; NaN where a ray
        does not reach a surface. None unless requested.
    optical_path : ndarray (n,) of float64, or None
        Optical path of each ray, mm: lengths times refractive indices, from the given point of the ray to `origin`. None
        unless requested.
    """

    origin: NDArray[np.float64]
    direction: NDArray[np.float64]
    reason: NDArray[np.int32]
    points: NDArray[np.float64] | None = None
    optical_path: NDArray[np.float64] | None = None

    @property
    def passed(self) -> NDArray[np.bool_]:
        """Mask of the rays that pass the lens, (n,)."""
        return self.reason == 0

    def __len__(self) -> int:
        return len(self.reason)

    def __repr__(self) -> str:
        return f"<LensRays {self.reason.shape}, {np.count_nonzero(self.passed)} of {self.reason.size} get through>"


class Lens:
    """A lens at one wavelength and one setting of the stop.

    Lens space has its origin at the front vertex, +z toward the scene, +x right and +y up; its unit is the millimetre.

    Parameters
    ----------
    lens_file : str or path-like, optional
        A lens file or a name of the catalogue, as for `Camera`; default "dgauss.50mm".
    lens_text : str or bytes, optional
        The text of a lens file, instead of `lens_file`.
    glass_catalog : str or path-like, optional
        A glass catalogue (AGF) to search first for the glasses of a lens file.
    strict : bool, optional
        Refuse a lens file of which a statement is replaced or left out that may change the picture.
    zoom : float or str, optional
        Focal length of a zoom lens in mm, or name of a zoom position; default the first position in the lens file.
    wavelength : float, optional
        Wavelength, nm, from 200 to 2000; default that of the lens file, else 587.56.
    aperture_diameter, fnumber : float, optional
        Clear diameter of the stop in mm, or f-number (focal length divided by the axial beam's diameter); default the
        stop of the lens file.

    Raises
    ------
    realistic.Error
        With the library's message, as for `Camera`.

    Examples
    --------
    >>> import realistic
    >>> lens = realistic.Lens("wide.22mm@22mm", fnumber=8)
    >>> round(lens.focal_length_mm, 9), round(lens.fnumber, 9)
    (22.0, 8.0)
    """

    def __init__(
        self,
        lens_file: str | os.PathLike[str] | None = None,
        *,
        lens_text: str | bytes | None = None,
        glass_catalog: str | os.PathLike[str] | None = None,
        strict: bool | None = None,
        zoom: float | str | None = None,
        wavelength: float | None = None,
        aperture_diameter: float | None = None,
        fnumber: float | None = None,
    ) -> None:
        self._parameters = checked(
            {
                "lens_file": lens_file,
                "lens_text": lens_text,
                "glass_catalog": glass_catalog,
                "strict": strict,
                "zoom": zoom,
                "wavelength": wavelength,
                "aperture_diameter": aperture_diameter,
                "fnumber": fnumber,
            }
        )
        # The library ignores the resolution.
        options = options_of(self._parameters, (1, 1), {})
        self._handle: Handle
        self._handle, messages = build(options, library.realistic_lens_new, library.realistic_lens_free)
        for message in messages:
            warn(message)
        self._info = LensInfo(struct_size=ctypes.sizeof(LensInfo))
        check(library.realistic_lens_get_info(self._handle.pointer, ctypes.byref(self._info)))

    @property
    def name(self) -> str:
        """Name of the lens, from the catalogue or the file."""
        status, text = text_of(library.realistic_lens_get_name, self._handle.pointer)
        check(status)
        return text

    @property
    def wavelength(self) -> float:
        """Wavelength of the lens."""
        return float(self._info.wavelength)

    @property
    def focal_length_mm(self) -> float:
        """Effective focal length 1/φ; negative for a diverging lens, infinite for an afocal one.

        The focal lengths on both sides are this times the `outer_indices`.
        """
        return float(self._info.focal_length_mm)

    @property
    def focal_length_x_mm(self) -> float:
        """Effective focal length in the meridian x; figures without `x` in their names are those in y.

        The two differ for lenses with cylinders, toroids, biconics or tilted surfaces.
        """
        return float(self._info.focal_length_x_mm)

    @property
    def back_focal_distance_x_mm(self) -> float:
        """Distance from the last vertex to the film-side focal point in the meridian x; NaN for an afocal lens."""
        return float(self._info.back_focal_distance_x_mm)

    @property
    def is_round(self) -> bool:
        """Whether all surfaces are symmetric about one axis and refract."""
        return bool(self._info.is_centred) and not self._info.mirrors

    @property
    def fnumber(self) -> float:
        """Absolute focal length divided by the diameter of the axial beam, from exact rays.

        Infinite for an afocal lens, and if no ray parallel to the axis passes the lens.
        """
        return float(self._info.fnumber)

    @property
    def fnumber_paraxial(self) -> float:
        """Paraxial f-number: focal length divided by the diameter of the smallest first-order image of any aperture.

        It differs from `fnumber` in a fast lens, whose outer rays are not paraxial.
        """
        return float(self._info.fnumber_paraxial)

    @property
    def tnumber_bare(self) -> float:
        """T-number with uncoated surfaces: f-number divided by the square root of the transmission on the axis."""
        return float(self._info.tnumber_bare)

    @property
    def tnumber_quarter_wave(self) -> float:
        """T-number with a quarter-wave layer of MgF2 for 550 nm on the surfaces between air and glass."""
        return float(self._info.tnumber_quarter_wave)

    @property
    def back_focal_distance_mm(self) -> float:
        """Distance from the last vertex to the film-side focal point; NaN for an afocal lens."""
        return float(self._info.back_focal_distance_mm)

    @property
    def focal_points_mm(self) -> tuple[float, float]:
        """z of the scene-side and film-side focal points; NaN for an afocal lens."""
        return float(self._info.front_focal_point_mm), float(self._info.rear_focal_point_mm)

    @property
    def principal_planes_mm(self) -> tuple[float, float]:
        """z of the scene-side and film-side principal planes; NaN for an afocal lens."""
        return float(self._info.front_principal_plane_mm), float(self._info.rear_principal_plane_mm)

    @property
    def nodal_points_mm(self) -> tuple[float, float]:
        """z of the scene-side and film-side nodal points; NaN for an afocal lens.

        A ray toward the first leaves the lens from the second in the same direction. In one medium they are the
        principal points.
        """
        return float(self._info.front_nodal_point_mm), float(self._info.rear_nodal_point_mm)

    @property
    def outer_indices(self) -> tuple[float, float]:
        """Refractive indices in front of the lens and behind it, at the lens's wavelength; 1 in air."""
        return float(self._info.index_scene), float(self._info.index_film)

    @property
    def rear_vertex_mm(self) -> float:
        """z of the last vertex; 0 or less."""
        return float(self._info.rear_vertex_mm)

    @property
    def pupils(self) -> Pupils:
        """Entrance and exit pupil."""
        info = self._info
        return Pupils(
            info.entrance_pupil_mm, info.entrance_pupil_diameter_mm, info.exit_pupil_mm, info.exit_pupil_diameter_mm
        )

    @property
    def pupils_x(self) -> Pupils:
        """Entrance and exit pupil in the meridian x."""
        info = self._info
        return Pupils(
            info.entrance_pupil_x_mm,
            info.entrance_pupil_diameter_x_mm,
            info.exit_pupil_x_mm,
            info.exit_pupil_diameter_x_mm,
        )

    @property
    def fnumber_x(self) -> float:
        """Absolute focal length in the meridian x divided by the width of the axial beam there."""
        return float(self._info.fnumber_x)

    @property
    def nominal_film_distance_mm(self) -> float:
        """Film distance that the lens file states, from the last vertex; NaN if it states none."""
        return float(self._info.nominal_film_distance_mm)

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """The surfaces from the scene's side, including the stop."""
        found = []
        for number in range(self._info.surfaces):
            surface = LensSurface(struct_size=ctypes.sizeof(LensSurface))
            check(library.realistic_lens_get_surface(self._handle.pointer, number, ctypes.byref(surface)))
            found.append(
                Surface(
                    vertex_mm=surface.vertex_mm,
                    radius_mm=surface.radius_mm,
                    thickness_mm=surface.thickness_mm,
                    index_scene=surface.index_scene,
                    index_film=surface.index_film,
                    semi_diameter_mm=surface.semi_diameter_mm,
                    is_stop=bool(surface.is_stop),
                    conic_radius_mm=surface.conic_radius_mm,
                    conic=surface.conic,
                    aspheric=tuple(surface.aspheric),
                    radius_x_mm=surface.radius_x_mm,
                    is_mirror=bool(surface.is_mirror),
                    is_turned=bool(surface.is_turned),
                )
            )
        return tuple(found)

    def focus(self, focus_distance_mm: float) -> float:
        """Returns the film distance, mm from the last vertex, at which an object `focus_distance_mm` in front of the
        film is sharp.

        Exact rays determine it: there the RMS spot of the axial object point is smallest. `focus_distance_mm` may be
        infinite.

        Raises
        ------
        realistic.FocusError
            If the lens cannot focus at this distance; the message states the nearest distance at which it can.
        """
        found = ctypes.c_double()
        check(
            library.realistic_lens_focus(
                self._handle.pointer, _number("focus_distance_mm", focus_distance_mm), ctypes.byref(found)
            )
        )
        return found.value

    def focused_on(self, film_distance: float) -> float:
        """Returns the distance from the film to an object in focus, mm, as the inverse of `focus`; NaN if nothing is in
        focus."""
        found = ctypes.c_double()
        check(
            library.realistic_lens_focused_on(
                self._handle.pointer, _number("film_distance", film_distance), ctypes.byref(found)
            )
        )
        return found.value

    def plane_of_focus(self, points: ArrayLike) -> dict[str, float]:
        """Returns the film distance and tilt that focus the lens on a plane, by the Scheimpflug principle: the
        parameters `film_distance`, `film_tilt_x` and `film_tilt_y` of a `Camera`.

        The tilt follows from first-order optics, and the distance on the axis from exact rays.

        Parameters
        ----------
        points : array_like (3, 3)
            Three points of the plane in lens space, mm.

        Raises
        ------
        realistic.FocusError
            If a point has no real image, the points define no plane, or the film would lie inside the lens.

        Examples
        --------
        >>> import realistic
        >>> lens = realistic.Lens("dgauss.50mm")
        >>> film = lens.plane_of_focus([[0, -100, 800], [0, 100, 1200], [100, 0, 1000]])
        >>> round(film["film_tilt_x"], 2)
        -5.91
        """
        given = np.asarray(points)
        if given.shape != (3, 3) or not np.can_cast(given.dtype, np.float64, "same_kind"):
            raise ValueError(f"points must be three points (x, y, z), and has shape {given.shape}, dtype {given.dtype}")
        numbers = (ctypes.c_double * 9)(*given.astype(np.float64).ravel())
        film = FocusedFilm(struct_size=ctypes.sizeof(FocusedFilm))
        check(library.realistic_lens_plane_of_focus(self._handle.pointer, numbers, ctypes.byref(film)))
        return {name: float(getattr(film, name)) for name in ("film_distance", "film_tilt_x", "film_tilt_y")}

    def ghosts(self, light: Sequence[float] = (0.0, 0.0), *, coating: str = "quarter-wave") -> tuple[Ghost, ...]:
        """Returns the ghosts of a lamp (light that two surfaces reflect) on film focused at infinity, the brightest
        first.

        Parameters
        ----------
        light : sequence of float
            For a lamp at infinity, two angles in degrees: to the right in the image (-180 to 180; both ends are
            straight behind) and up (-90 to 90). For a nearer lamp, a point in mm from the front vertex: right, up and
            toward the scene.
        coating : str
            Coating of the surfaces between air and glass: "bare", "quarter-wave" (MgF2 for 550 nm), "v-coat",
            "three-layer", or "file" for the coatings that the lens file names.

        Raises
        ------
        realistic.Error
            If the program fails, with its message; also if no part of the front surface faces the lamp.
        FileNotFoundError
            If the program is not installed.
        """
        return ghosts(self._parameters, light, coating)

    def psf(
        self,
        at: Sequence[float] = (0.0, 0.0),
        *,
        object_distance: float | None = None,
        spectrum: Mapping[float, float] | None = None,
        rays: int = 256,
        pixels: int = 128,
        pitch_um: float | None = None,
        transmission: str | None = None,
    ) -> Psf:
        """Returns the picture of a point, with diffraction, and its wavefront.

        Parameters
        ----------
        at : sequence of float
            Image point: x and y on the film in lens space, mm. The picture is upside down there.
        object_distance : float, optional
            Distance of the object from the film, mm, or infinity; that of the plane in focus by default.
        spectrum : mapping, optional
            Weights by wavelengths in nm; the lens's own wavelength by default. Powers of wavelengths are added.
        rays : int
            Number of rows of rays, and of rays in each row, 16 to 2048.
        pixels : int
            Number of pixels along a side, 8 to 1024.
        pitch_um : float, optional
            Side of a pixel, micrometres; a quarter of the wavelength times the f-number by default.
        transmission : str, optional
            Coatings by which surfaces transmit light, as for a camera: "bare", "quarter-wave", "v-coat", "three-layer" or
            "file"; glasses then absorb, too. None of this counts by default.

        Raises
        ------
        realistic.Error
            If the program fails, with its message; also if no light reaches the point.
        FileNotFoundError
            If the program is not installed.
        """
        return psf(self._lit(transmission), at, object_distance, spectrum, rays, pixels, pitch_um)

    def _lit(self, transmission: str | None) -> dict[str, Any]:
        """Returns the lens's parameters with those of its transmission."""
        return {**self._parameters, "transmission": transmission}

    def wavefront(
        self,
        at: Sequence[float] = (0.0, 0.0),
        *,
        object_distance: float | None = None,
        rays: int = 128,
        transmission: str | None = None,
    ) -> Wavefront:
        """Returns the wavefront at an image point: RMS, Strehl ratio, Zernike coefficients. The parameters, and the
        errors raised, are those of `Lens.psf`."""
        return psf(self._lit(transmission), at, object_distance, None, rays, 8, None).wavefront

    def mtf(
        self,
        frequencies: Sequence[float],
        at: Sequence[float] = (0.0, 0.0),
        *,
        object_distance: float | None = None,
        spectrum: Mapping[float, float] | None = None,
        rays: int = 256,
        transmission: str | None = None,
    ) -> WaveMtf:
        """Returns the contrast of fine detail at an image point, with diffraction, by rays alone, and of a perfect lens.
        `measure.mtf` of a camera is geometric, and in pixels of its picture.

        Parameters
        ----------
        frequencies : sequence of float
            Cycles per mm, positive.
        at, object_distance, spectrum, rays, transmission
            As for `Lens.psf`, which also has the errors raised.
        """
        return mtf(self._lit(transmission), frequencies, at, object_distance, spectrum, rays, (0.0,))[0]

    def mtf_through_focus(
        self,
        frequencies: Sequence[float],
        defocus_mm: Sequence[float],
        at: Sequence[float] = (0.0, 0.0),
        *,
        object_distance: float | None = None,
        spectrum: Mapping[float, float] | None = None,
        rays: int = 256,
        transmission: str | None = None,
    ) -> tuple[WaveMtf, ...]:
        """Returns `Lens.mtf` for film moved away from the lens by each of several distances, mm, at most 101."""
        return mtf(self._lit(transmission), frequencies, at, object_distance, spectrum, rays, defocus_mm)

    def trace(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        side: str = "scene",
        points: bool = False,
        optical_path: bool = False,
    ) -> LensRays:
        """Traces rays through the lens.

        Parameters
        ----------
        origins : array_like (n, 3)
            A point on each ray, mm in lens space, anywhere before the lens.
        directions : array_like (n, 3)
            Directions of any nonzero length: toward -z from the scene's side, toward +z from the film's side. They are
            broadcast together with `origins`.
        side : str
            Side from which rays come, "scene" or "film".
        points : bool
            Whether to also return the points where each ray meets each surface, which takes longer.
        optical_path : bool
            Whether to also return the optical path of each ray.

        Returns
        -------
        LensRays
            New arrays. A ray that contains NaN or infinity gets the reason `MISSED`.
        """
        if side not in SIDES:
            raise ValueError(f'side is {side!r}; give "scene" or "film"')
        given = []
        for name, array in (("origins", np.asarray(origins)), ("directions", np.asarray(directions))):
            if not np.can_cast(array.dtype, np.float64, "same_kind"):
                raise TypeError(f"{name} must hold real numbers, and has dtype {array.dtype}")
            if array.ndim == 0 or array.shape[-1] != 3:
                raise ValueError(f"{name} must have shape (n, 3), and has {array.shape}")
            given.append(array)
        try:
            shape = np.broadcast_shapes(*(array.shape[:-1] for array in given))
        except ValueError:
            raise ValueError(
                f"the rays are not equally many: origins {given[0].shape}, directions {given[1].shape}"
            ) from None
        n = math.prod(shape)
        # The library overwrites its input.
        origin, direction = (np.array(np.broadcast_to(array, (*shape, 3)), np.float64, order="C") for array in given)
        reason = np.zeros(shape, np.int32)
        rays = LensRaysView(
            ctypes.sizeof(LensRaysView),
            view(Vectors, origin.reshape(n, 3)),
            view(Vectors, direction.reshape(n, 3)),
            reason.ctypes.data,
            reason.itemsize,
        )
        paths = np.zeros(shape) if optical_path else None
        if paths is not None:
            rays.optical_path, rays.optical_path_stride = paths.ctypes.data, paths.itemsize
        arguments = (self._handle.pointer, SIDES.index(side), n, ctypes.byref(rays))
        met = None
        if points:
            met = np.empty((*shape, self._info.surfaces, 3))
            points_view = LensPointsView(ctypes.sizeof(LensPointsView), view(Vectors, met.reshape(-1, 3)), None, 0)
            check(library.realistic_lens_trace(*arguments, ctypes.byref(points_view)))
        else:
            check(library.realistic_lens_trace(*arguments, None))
        return LensRays(origin, direction, reason, met, paths)

    def __repr__(self) -> str:
        given = dict(self._parameters)
        words = [repr(given.pop("lens_file"))] if "lens_file" in given else []
        words += [f"{name}={value if name != 'lens_text' else '...'!r}" for name, value in given.items()]
        return f"Lens({', '.join(words)})"

    def _repr_html_(self) -> str:
        """Returns the cross-section as HTML, for notebooks."""
        caption = f"{self.name}: {self.focal_length_mm:.4g} mm, f/{self.fnumber:.3g}, {self.wavelength:g} nm"
        return drawing(self.surfaces if self.is_round else (), caption)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self._parameters,)


def _again(parameters: dict[str, Any]) -> Lens:
    """Rebuilds a pickled lens."""
    return Lens(**parameters)
