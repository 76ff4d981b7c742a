"""Maps of point spread functions over the picture, computed by many processes at once."""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from .. import _waves
from ..errors import Error
from ..measure import Field, working_fnumber
from ..measure.diffraction import wavelength_of
from ..parameters import mm_per_unit_of
from .workers import Progress, Workers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from ..camera import Camera


@dataclass(frozen=True, eq=False)
class PsfMap:
    """Pictures of points at a grid over the picture, as the upright picture shows them, with diffraction.

    Attributes
    ----------
    lens_name : str
        The lens.
    x_mm : ndarray (columns,)
        Places on the film as in the upright picture: to the right from its middle, mm.
    y_mm : ndarray (rows,)
        The same, up; from the top.
    energy : ndarray (rows, columns, pixels, pixels)
        Share of the energy on each pixel around each place, rows from the top; NaN where there is no light.
    pitch_mm : float
        Side of a pixel of `energy`, mm.
    strehl, rms, error : ndarray (rows, columns)
        `Wavefront.strehl`, `Wavefront.rms` (waves) and `Psf.error` of each point.
    """

    lens_name: str
    x_mm: NDArray[np.float64]
    y_mm: NDArray[np.float64]
    energy: NDArray[np.float64]
    pitch_mm: float
    strehl: NDArray[np.float64]
    rms: NDArray[np.float64]
    error: NDArray[np.float64]


def psf_map(
    camera: Camera,
    grid: tuple[int, int] = (7, 5),
    *,
    pixels: int = 64,
    pitch_um: float | None = None,
    distance: float | None = None,
    spectrum: Mapping[float, float] | None = None,
    rays: int = 128,
    client: Any = None,
    processes: int | None = None,
    retries: int = 2,
    keep: str | os.PathLike[str] | None = None,
    progress: bool | Progress = True,
) -> PsfMap:
    """Returns the point spread functions at a grid over a camera's picture, for `plot.psf_map`.

    Parameters
    ----------
    camera : Camera
        A camera with a lens. Film may be shifted, tilted or curved.
    grid : (int, int)
        Numbers of columns and rows of points, as for `Field.grid`.
    pixels : int
        Number of pixels along a side of each function, 8 to 1024.
    pitch_um : float, optional
        Side of a pixel, micrometres; a quarter of the wavelength times the working f-number by default.
    distance : float, optional
        Distance of the objects from the film, in world units; default the plane in focus.
    spectrum : mapping, optional
        Weights by wavelengths in nm, as for `Lens.psf`; default the camera's wavelength.
    rays : int
        Number of rows of rays, and of rays in each row, 16 to 2048.
    client, processes, retries, keep, progress
        As in `study`. A job is one point.

    Raises
    ------
    realistic.Error
        If the program fails for a point, with its message.
    ValueError
        For a camera without a lens.
    FileNotFoundError
        If the program is not installed.
    """
    columns, rows = grid
    if pitch_um is None:
        pitch_um = 0.25e-3 * wavelength_of(camera) * working_fnumber(camera)
    places = _waves.from_the_middle(camera, Field.grid(columns, rows).image_xy(camera).reshape(-1, 2))
    parameters = _waves.parameters_of(camera)
    far = None if distance is None else distance * mm_per_unit_of(camera.parameters)
    colours = None if spectrum is None else dict(spectrum)
    # In lens space the image is upside down.
    jobs = [_Point(parameters, (-x, -y), far, colours, rays, pixels, pitch_um) for x, y in places.tolist()]
    workers = Workers(client, processes, retries, keep, progress)
    found = [np.load(io.BytesIO(result)) for result in workers.do(_computed, jobs, _failed, "point")]
    shape = (rows, columns)
    strehl, rms, error = np.array([each["numbers"] for each in found]).T.reshape(3, *shape)
    # Rows of a function grow with y of lens space, which points down in the picture.
    energy = np.array([each["energy"][:, ::-1] for each in found]).reshape(*shape, pixels, pixels)
    x_mm, y_mm = places.reshape(*shape, 2)[0, :, 0], places.reshape(*shape, 2)[:, 0, 1]
    return PsfMap(camera.lens_name, x_mm, y_mm, energy, 1e-3 * pitch_um, strehl, rms, error)


@dataclass(frozen=True)
class _Point:
    """An image point, x and y in lens space, mm, and what to compute there; the arguments of `_waves.psf`."""

    parameters: dict[str, Any]
    at: tuple[float, float]
    object_distance: float | None
    spectrum: dict[float, float] | None
    rays: int
    pixels: int
    pitch_um: float


def _computed(point: _Point) -> bytes:
    """Returns a point's function, and its Strehl ratio, RMS and error, as a file of NumPy."""
    try:
        found = _waves.psf(
            point.parameters,
            point.at,
            point.object_distance,
            point.spectrum,
            point.rays,
            point.pixels,
            point.pitch_um,
        )
    except Error as error:
        if not _waves.is_dark(error):
            raise
        energy, numbers = np.full((point.pixels, point.pixels), np.nan), [np.nan] * 3
    else:
        energy, numbers = found.energy, [found.wavefront.strehl, found.wavefront.rms, found.error]
    out = io.BytesIO()
    np.savez(out, energy=energy, numbers=numbers)
    return out.getvalue()


def _failed(_point: _Point, error: Exception) -> NoReturn:
    """Raises the error of a failed point, because the map needs every point."""
    raise error
