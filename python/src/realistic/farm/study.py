"""Studies: measures of many lenses at many stops, distances, film positions, fields and wavelengths, as one table.

A job measures one camera, that is, one lens at one stop, focus distance, film position and wavelength, at all field
points.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _waves, measure
from ..camera import Camera
from ..errors import Error, FocusError, LensFileError, ParameterError, warnings_to
from ..measure import Field, diffraction_mtf
from ..measure.bundles import lens_grid
from ..measure.spots import transfer_of
from ..parameters import checked, focuses_by_film, mm_per_unit_of, resolution_of
from .table import Table
from .workers import Progress, Workers

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from typing_extensions import Unpack

    from .._parameters import Parameters

# Parameters that the study itself sets.
_ITS_OWN = {"lens_file", "lens_text", "fnumber", "aperture_diameter", "wavelength"} | {
    "focus_distance",
    "film_distance",
    "weighting",
    "simple_weighting",
}


def study(
    lenses: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    fnumbers: float | Iterable[float | None] | None = None,
    focus_distances: float | Iterable[float] = np.inf,
    fields: float | Iterable[float] | Field = (0.0, 0.5, 0.7, 0.95),
    wavelengths: float | Iterable[float] = 587.56,
    *,
    defocus_mm: float | Iterable[float] = 0.0,
    frequencies: float | Iterable[float] = (10.0, 30.0),
    resolution: tuple[int, int] = (1500, 1000),
    diffraction: bool = False,
    client: Any = None,
    processes: int | None = None,
    retries: int = 2,
    keep: str | os.PathLike[str] | None = None,
    progress: bool | Progress = True,
    **parameters: Unpack[Parameters],
) -> Table:
    """Measures lenses at every combination of stop, focus, field and wavelength.

    Each argument from `lenses` to `frequencies` is one value or several.

    Parameters
    ----------
    lenses : str or path-like
        Names of the catalogue, or lens files. Other machines must see a file under the same name.
    fnumbers : float, optional
        F-numbers; None means the lens's own stop.
    focus_distances : float
        Distances of the plane that is in focus and measured, given like the parameter `focus_distance`: world units
        from the film, or inf.
    fields : float or Field
        Fractions of half the film's diagonal, from 0 in the middle to 1 in the corner; or other field points.
    wavelengths : float
        Wavelengths, nm. The film is always placed where the lens is in focus at 587.56 nm.
    defocus_mm : float
        Distances by which the film is moved from there, mm, away from the lens: several show the lens through focus.
        The measured plane of the scene stays where it is.
    frequencies : float
        Frequencies of the MTF, line pairs per mm on the film.
    resolution : (int, int)
        Width and height of the picture, pixels; only the aspect ratio matters.
    diffraction : bool
        Whether to add the wavefront and the MTF with diffraction (`Lens.mtf`), which takes some tenths of a second per
        row and needs the program `realistic`.
    client : dask.distributed.Client or concurrent.futures.Executor, optional
        Workers for the jobs; default processes of this machine.
    processes : int, optional
        Number of processes of this machine; default one per processor. With more than one, a script must keep its own
        work behind `if __name__ == "__main__":`, because each process imports the script.
    retries : int
        Number of further attempts for a camera whose measurement failed or whose process died. After the last one, the
        camera's rows are marked as failed.
    keep : str or path-like, optional
        A folder that keeps each camera's result when it arrives, keyed by everything that determines the result,
        including the content of lens files (needs diskcache: `pip install "./python[farm]"`). An interrupted study
        continues where it stopped, and a finished one returns at once. Failures that a dead process or a missing file
        causes are not kept.
    progress : bool or callable
        True shows a bar if tqdm is installed and the output is a terminal or a notebook. A callable gets the number of
        finished cameras and the number of all cameras.
    **parameters
        Other parameters of `realistic.Parameters` for all cameras: `film_diagonal`, `mm_per_unit` and so on.

    Returns
    -------
    Table
        A row for each combination, the wavelength changing fastest, then the field, then the film's position. Columns:

        - `lens`, `focus_distance`, `defocus_mm`, `wavelength`, as requested;
        - `fnumber`, as requested, NaN for the lens's own stop; `fnumber_used`, which differs if the lens cannot open so
          far;
        - `field`, the distance from the middle divided by half the diagonal; `field_angle_deg`, the field angle; `x_mm`
          and `y_mm`, the place on the film as in the upright picture, to the right and up from the middle;
        - `focal_length_mm`;
        - `spot_rms_um`, on the film, and its diffraction limit, `airy_radius_um` (`measure.airy_radius`);
        - for each frequency F, the geometric `mtf_tangential_F` and `mtf_sagittal_F`, and their diffraction limit,
          `mtf_diffraction_F`;
        - with `diffraction`, `wavefront_rms` (waves), `strehl`, and for each frequency F `wave_mtf_tangential_F` and
          `wave_mtf_sagittal_F`;
        - `relative_illumination`, relative to the middle; `distortion`; `acceptance`, the share of camera rays that
          pass the lens; NaN where there is no light;
        - `failed`, whether the row has no measures because the lens cannot be read or cannot focus so near, the middle
          of the picture is dark, the field angle lies outside the picture, or no process could do the job;
        - `note`: the library's warnings, for example that the stop is wider than the lens, and why a row failed.

    Raises
    ------
    TypeError, ValueError
        For an argument that is invalid for every camera, or a `defocus_mm` for cameras whose film has no place of its own:
        textbook models and lenses that focus by their groups. Errors of one lens or one stop are in the rows' notes.
    """
    if taken := _ITS_OWN & set(parameters):
        raise TypeError(
            f"{', '.join(sorted(taken))}: give a study's lenses, fnumbers, focus_distances and wavelengths instead"
        )
    workers = Workers(client, processes, retries, keep, progress)
    given = checked(dict(parameters))
    named = [lenses] if isinstance(lenses, (str, os.PathLike)) else list(lenses)
    stops = [None if stop is None else float(stop) for stop in _several(fnumbers)]
    several = (focus_distances, defocus_mm, wavelengths, frequencies)
    far, moved, colours, lines = ([float(each) for each in _several(numbers)] for numbers in several)
    if not np.isfinite(moved).all():
        raise ValueError(f"defocus_mm is {defocus_mm!r}; give finite distances in mm")
    if any(moved) and not focuses_by_film(given):
        raise ValueError("defocus_mm moves the film of a lens that focuses by its film: leave out model and focus_by")
    points = fields if isinstance(fields, Field) else Field.fractions(np.asarray(_several(fields), float))
    jobs = [
        _Job(
            os.fspath(lens),
            stop,
            distance,
            away,
            colour,
            points,
            lines,
            resolution_of(resolution),
            given,
            diffraction,
        )
        for lens, stop, distance, away, colour in product(named, stops, far, moved, colours)
    ]
    found = [json.loads(result) for result in workers.do(_measured, jobs, _failed, "camera")]
    cells = np.full((len(jobs), points.x.size), np.nan, _dtype(lines, found, diffraction))
    for row, columns in zip(cells, found):
        for name, values in columns.items():
            row[name] = values
    # A job has all field points of one wavelength; in the table, the wavelength changes fastest.
    return Table(cells.reshape(-1, len(colours), points.x.size).swapaxes(1, 2).ravel() if cells.size else cells.ravel())


_CURVES = ("tangential", "sagittal")


@dataclass(frozen=True)
class _Job:
    """One camera, and what to measure of it."""

    lens: str
    fnumber: float | None
    focus_distance: float
    defocus_mm: float
    wavelength: float
    field: Field
    frequencies: Sequence[float]
    resolution: tuple[int, int]
    parameters: dict[str, Any]
    diffraction: bool = False

    @property
    def distance(self) -> float:
        """Distance of the measured plane from the film, world units: the film may be moved, but not the plane."""
        return self.focus_distance + self.defocus_mm / mm_per_unit_of(self.parameters)

    def result(self, found: dict[str, Any], notes: Sequence[str], failed: ArrayLike) -> bytes:
        """Returns the rows as JSON: a camera's columns by name, each with one value per field point."""
        requested: dict[str, Any] = {"fnumber": np.nan if self.fnumber is None else self.fnumber}
        requested |= {name: getattr(self, name) for name in ("focus_distance", "defocus_mm", "wavelength")}
        requested["field"] = self.field.share(self.resolution).ravel()
        requested["field_angle_deg"] = self.field.angle().ravel()
        points = self.field.x.size
        columns = {
            name: np.broadcast_to(numbers, points).tolist()
            for name, numbers in ({**requested, **found, "failed": failed, "lens": self.lens}).items()
        }
        return json.dumps({**columns, "note": list(notes)}).encode()


def _several(given: Any) -> list[Any]:
    """Returns one value or several as a list."""
    if given is None or isinstance(given, (str, bytes)) or np.ndim(given) == 0 and not isinstance(given, Iterable):
        return [given]
    return list(given)


def _dtype(frequencies: Sequence[float], found: Sequence[dict[str, list[Any]]], diffraction: bool) -> np.dtype[Any]:
    """Returns the dtype of the table, with its columns in order."""

    def text(name: str) -> tuple[str, str]:
        return name, f"U{max((len(each) for columns in found for each in columns[name]), default=1) or 1}"

    names = ["fnumber", "fnumber_used", "focus_distance", "defocus_mm", "field", "field_angle_deg", "x_mm", "y_mm"]
    names += ["wavelength", "focal_length_mm", "spot_rms_um", "airy_radius_um"]
    names += [
        f"mtf_{curve}_{frequency:g}" for frequency in frequencies for curve in ("tangential", "sagittal", "diffraction")
    ]
    if diffraction:
        names += ["wavefront_rms", "strehl"]
        names += [f"wave_mtf_{curve}_{frequency:g}" for frequency in frequencies for curve in _CURVES]
    names += ["relative_illumination", "distortion", "acceptance"]
    return np.dtype([text("lens"), *((name, "f8") for name in names), ("failed", "?"), text("note")])


def _measured(job: _Job) -> bytes:
    """Returns a camera's rows, in which errors of the camera itself are notes; raises errors that another attempt may
    avoid."""
    found: dict[str, Any] = {}
    warned: list[str] = []
    reached, failure = np.ones(job.field.x.size, bool), ""
    with warnings_to(warned.append):
        try:
            reached = _measure(job, found)
        except LensFileError:
            raise
        except (FocusError, ParameterError, ValueError) as error:
            failure = str(error)
    lit = np.asarray(found.get("acceptance", np.nan)) != 0
    notes = []
    for label, is_reached, is_lit in zip(job.field.labels, *np.broadcast_arrays(reached, lit)):
        own = "" if is_reached else f"the picture does not reach to {label}"
        dark = "" if is_lit else "no light gets to this point of the picture"
        # The camera is built twice, so it gives each warning twice.
        notes.append("; ".join(filter(None, [*dict.fromkeys(warned), failure, own, dark])))
    return job.result(found, notes, True if failure else ~reached)


def _failed(job: _Job, error: Exception) -> bytes:
    """Returns the rows of a camera that could not be measured."""
    note = str(error) if isinstance(error, Error) else f"{type(error).__name__}: {error}"
    if isinstance(error, BrokenExecutor):
        note = "the process that measured this camera died each time"
    return job.result({}, [note] * job.field.x.size, True)


def _camera(job: _Job) -> Camera:
    """Builds the camera at its wavelength, with its film where the lens is in focus at 587.56 nm, or moved from there."""
    given = {**job.parameters, "lens_file": job.lens, "fnumber": job.fnumber, "resolution": job.resolution}
    if focuses_by_film(given):
        with Camera(focus_distance=job.focus_distance, **given) as focused:
            return focused.replace(film_distance=focused.film_distance + job.defocus_mm, wavelength=job.wavelength)
    return Camera(focus_distance=job.focus_distance, wavelength=job.wavelength, **given)


def _measure(job: _Job, found: dict[str, Any]) -> NDArray[np.bool_]:
    """Fills in the columns one by one; returns a mask of the field points inside the picture. The others get NaN."""
    with _camera(job) as camera:
        found["fnumber_used"], found["focal_length_mm"] = camera.fnumber, camera.focal_length_mm
        image_xy = job.field.image_xy(camera, job.distance).reshape(-1, 2)
        reached = ~np.isnan(image_xy[:, 0])
        points = Field.pixels(image_xy[reached])

        def fill(name: str, numbers: NDArray[np.float64]) -> None:
            found[name] = np.full(len(reached), np.nan)
            found[name][reached] = numbers

        if job.field.unit == "angles":
            fill("field", points.share(camera.resolution))
        else:
            fill("field_angle_deg", measure.field_angle(camera, points, distance=job.distance))
        for name, numbers in zip(("x_mm", "y_mm"), _waves.from_the_middle(camera, image_xy[reached]).T):
            fill(name, numbers)
        fill("relative_illumination", measure.relative_illumination(camera, points))
        spots = measure.spots(camera, points, distance=job.distance)
        micrometres = 1000 * camera.film_size_mm[0] / camera.resolution[0]
        fill("spot_rms_um", spots.rms * micrometres)
        fill("airy_radius_um", measure.airy_radius(camera, points) * micrometres)
        fill("acceptance", (camera.rays(image_xy[reached][:, None], lens_grid(32)).weight > 0).mean(axis=-1))
        frequencies = np.asarray(job.frequencies, np.float64)
        mtf, limit = transfer_of(camera, image_xy[reached], spots, frequencies), diffraction_mtf(camera, frequencies)
        for k, frequency in enumerate(job.frequencies):
            fill(f"mtf_diffraction_{frequency:g}", np.broadcast_to(limit[k], len(mtf)))
            fill(f"mtf_tangential_{frequency:g}", mtf[:, 0, k])
            fill(f"mtf_sagittal_{frequency:g}", mtf[:, 1, k])
        fill("distortion", measure.distortion(camera, points, distance=job.distance))
        if job.diffraction:
            for name, numbers in _diffracted(job, camera, image_xy[reached]).items():
                fill(name, numbers)
    return reached


def _diffracted(job: _Job, camera: Camera, image_xy: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Returns the columns with diffraction, at points of the picture in pixels."""
    names = ["wavefront_rms", "strehl"]
    names += [f"wave_mtf_{curve}_{frequency:g}" for frequency in job.frequencies for curve in _CURVES]
    if camera.parameters.get("model", "lens") != "lens":
        return {name: np.full(len(image_xy), np.nan) for name in names}
    lens = _waves.parameters_of(camera)
    distance = job.distance * mm_per_unit_of(job.parameters)
    rows = []
    for point in -_waves.from_the_middle(camera, image_xy):
        try:
            tables = _waves.mtf(lens, job.frequencies, point, distance, None, 192, (0.0,))
        except Error as error:
            if not _waves.is_dark(error):
                raise ValueError(str(error)) from None
            rows.append([np.nan] * len(names))
            continue
        curves = np.stack([tables[0].tangential, tables[0].sagittal], axis=1)
        rows.append([tables[0].wavefront.rms, tables[0].wavefront.strehl, *curves.ravel()])
    return dict(zip(names, np.asarray(rows, np.float64).reshape(-1, len(names)).T))
