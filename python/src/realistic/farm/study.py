"""Studies: what many lenses do at many stops, distances, fields and wavelengths, as one table.

A job is one camera: a lens at a stop, a distance and a wavelength, over all fields.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import measure
from ..camera import Camera
from ..errors import FocusError, quietly
from .table import Table
from .workers import spread

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from ..parameters import Parameters

# Given by the study itself.
_ITS_OWN = {"specfile", "lensfile", "lens_text", "fnumber", "aperture_diameter", "aperturediameter", "wavelength"} | {
    "focusdistance",
    "filmdistance",
    "weighting",
    "simpleweighting",
}


def study(
    lenses: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    fnumbers: float | Iterable[float | None] | None = None,
    distances: float | Iterable[float] = np.inf,
    fields: float | Iterable[float] = (0.0, 0.5, 0.7, 0.95),
    wavelengths: float | Iterable[float] = 587.56,
    *,
    frequencies: float | Iterable[float] = (10.0, 30.0),
    resolution: tuple[int, int] = (1500, 1000),
    client: Any = None,
    processes: int | None = None,
    **parameters: Unpack[Parameters],
) -> Table:
    """Measures of lenses, at every combination of stop, distance, field and wavelength.

    Each argument is one value or several.

    Parameters
    ----------
    lenses : str or path-like
        Names of the catalogue, or lens files. Other machines must see a file under the same name.
    fnumbers : float, optional
        None: the lens's own stop.
    distances : float
        The plane that is in focus, and looked at: as `focusdistance`, world units from the film, or inf.
    fields : float
        Shares of half the film's diagonal, from 0 in the middle to 1 in the corner.
    wavelengths : float
        nm. The film stands where the lens is in focus at 587.56 nm.
    frequencies : float
        Of the MTF, line pairs per mm on the film.
    resolution : (int, int)
        In pixels; only its aspect ratio matters.
    client : dask.distributed.Client or concurrent.futures.Executor, optional
        Where to do the work; default processes of this machine.
    processes : int, optional
        How many of them; default one for each processor. With more than one, a script must keep its own work behind
        `if __name__ == "__main__":`, for each process reads it.
    **parameters
        Others of `realistic.Parameters` for all cameras: `filmdiag`, `mmperunit` and so on.

    Returns
    -------
    Table
        A row for each combination, the wavelength changing fastest, then the field. Columns: `lens`, `fnumber`,
        `distance`, `field`, `wavelength_nm`; `focal_length_mm`; `spot_rms_um` on the film; `mtf_tangential_F` and
        `mtf_sagittal_F` for each frequency F; `relative_illumination`, over that in the middle; `distortion`; `acceptance`,
        the share of camera rays that get through; and `note`. NaN where there is no light, and in all of a row where the lens
        cannot focus so near or the middle of the picture is dark: `note` says so.

    Raises
    ------
    realistic.Error
        For a lens or a parameter that no camera can be built from.
    TypeError
        For a parameter that is one of the study's own arguments.
    """
    if taken := _ITS_OWN & set(parameters):
        raise TypeError(
            f"{', '.join(sorted(taken))}: give a study's lenses, fnumbers, distances and wavelengths instead"
        )
    named = [lenses] if isinstance(lenses, (str, os.PathLike)) else list(lenses)
    stops = _several(fnumbers)
    far, shares, colours = (
        np.atleast_1d(np.asarray(each, float)) for each in map(_several, (distances, fields, wavelengths))
    )
    lines = [float(number) for number in _several(frequencies)]
    if not (np.isfinite(shares).all() and (shares >= 0).all() and (shares <= 1).all()):
        raise ValueError(f"fields are shares of half the diagonal, from 0 to 1, and not {shares.tolist()}")
    jobs = [
        _Job(os.fspath(lens), stop, distance, colour, shares.tolist(), lines, resolution, dict(parameters))
        for lens, stop, distance, colour in product(named, stops, far.tolist(), colours.tolist())
    ]
    found = spread(_measured, jobs, client, processes)
    # A job has a camera's fields; in the table the wavelength changes fastest.
    dtype = _dtype(named, lines, found)
    cells = np.array([[tuple(row) for row in rows] for rows in found], dtype)
    ordered = cells.reshape(-1, len(colours), len(shares)).swapaxes(1, 2) if cells.size else cells
    return Table(ordered.reshape(-1))


@dataclass(frozen=True)
class _Job:
    """One camera, and what to measure of it."""

    lens: str
    fnumber: float | None
    distance: float
    wavelength: float
    fields: Sequence[float]
    frequencies: Sequence[float]
    resolution: tuple[int, int]
    parameters: dict[str, Any]


def _several(given: Any) -> list[Any]:
    """One value or several, as a list."""
    if given is None or isinstance(given, (str, bytes)) or np.ndim(given) == 0 and not isinstance(given, Iterable):
        return [given]
    return list(given)


def _dtype(lenses: Sequence[Any], frequencies: Sequence[float], found: list[list[list[Any]]]) -> np.dtype[Any]:
    width = max((len(os.fspath(lens)) for lens in lenses), default=1)
    note = max((len(row[-1]) for rows in found for row in rows), default=0)
    names = ["fnumber", "distance", "field", "wavelength_nm", "focal_length_mm", "spot_rms_um"]
    names += [f"mtf_{way}_{frequency:g}" for frequency in frequencies for way in ("tangential", "sagittal")]
    names += ["relative_illumination", "distortion", "acceptance"]
    return np.dtype([("lens", f"U{width}"), *((name, "f8") for name in names), ("note", f"U{max(note, 1)}")])


def _measured(job: _Job) -> list[list[Any]]:
    """The rows of a camera, one for each field."""
    fields = np.array(job.fields)
    with quietly():
        nothing = np.full(4 + 2 * len(job.frequencies), np.nan)
        try:
            camera = _camera(job)
        except FocusError as error:
            return [_row(job, field, np.nan, nothing, str(error)) for field in fields]
        with camera:
            stop, length = camera.fnumber, camera.focal_length_mm
            try:
                illumination = measure.relative_illumination(camera, _points(camera, fields))
            except ValueError as error:
                return [_row(job, field, length, nothing, str(error), stop) for field in fields]
            numbers = _numbers(camera, job, fields, illumination)
    return [_row(job, field, length, row, "", stop) for field, row in zip(fields, numbers)]


def _row(
    job: _Job, field: float, length: float, numbers: NDArray[np.float64], note: str, stop: float = np.nan
) -> list[Any]:
    fnumber = stop if job.fnumber is None else job.fnumber
    return [job.lens, fnumber, job.distance, field, job.wavelength, length, *numbers.tolist(), note]


def _camera(job: _Job) -> Camera:
    """The camera at its wavelength, its film where the lens is in focus at 587.56 nm."""
    given = {**job.parameters, "specfile": job.lens, "fnumber": job.fnumber, "resolution": job.resolution}
    if given.get("model", "lens") == "lens" and given.get("focusby", "film") == "film":
        with Camera(focusdistance=job.distance, **given) as focused:
            return Camera(filmdistance=focused.film_distance_mm, wavelength=job.wavelength, **given)
    return Camera(focusdistance=job.distance, wavelength=job.wavelength, **given)


def _points(camera: Camera, fields: NDArray[np.float64]) -> NDArray[np.float64]:
    """Film points toward the upper right corner, pixels."""
    half = np.array(camera.resolution) / 2
    points: NDArray[np.float64] = half + fields[:, None] * half * [1.0, -1.0]
    return points


def _numbers(
    camera: Camera, job: _Job, fields: NDArray[np.float64], illumination: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Spot, MTF, illumination, distortion and acceptance, (fields, columns)."""
    half, points = np.array(camera.resolution) / 2, _points(camera, fields)
    micrometres = 1000 * camera.film_size_mm[0] / camera.resolution[0]
    spots = measure.spots(camera, points, distance=job.distance)
    mtf = measure.mtf(camera, points, job.frequencies, distance=job.distance)
    radii = fields * np.hypot(*half)
    # In the middle there is none by definition.
    distortion = np.where(radii > 0, measure.distortion(camera, np.maximum(radii, 1e-3), distance=job.distance), 0.0)
    return np.column_stack(
        [
            spots.rms * micrometres,
            mtf.transpose(0, 2, 1).reshape(len(fields), -1),
            illumination,
            distortion,
            (spots.weight > 0).mean(axis=1),
        ]
    )
