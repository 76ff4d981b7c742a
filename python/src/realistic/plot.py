"""Plots of a lens with matplotlib: `pip install "./python[plot]"`.

Each function takes a camera or a lens and, optionally, the axes to draw into, and returns the axes; maps with diffraction
take what `realistic.study` and `farm.psf_map` return. `fields` are fractions of half the diagonal, or a `Field`.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import TYPE_CHECKING

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Circle

from . import measure
from .errors import quietly
from .measure import Field
from .measure.bundles import film_grid
from .surfaces import glasses, outlines, stop_blades

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .camera import Camera
    from .farm import PsfMap, Table
    from .lens import Lens

FIELDS = (0.0, 0.5, 0.7, 0.95)
"""Default field points, as fractions of half the diagonal."""


def illumination(camera: Camera, ax: Axes | None = None) -> Axes:
    """Plots the relative illumination over the picture, as a map with contour lines."""
    ax = ax or plt.subplots()[1]
    width, height = camera.resolution
    points = film_grid(camera.resolution, 49)
    rows = len(np.unique(points[:, 1]))
    values = measure.relative_illumination(camera, points, side=16).reshape(rows, -1)
    shown = ax.imshow(values, cmap="gray", vmin=0, vmax=max(1.0, float(values.max())), extent=(0, width, height, 0))
    x, y = (points[:, k].reshape(rows, -1) for k in range(2))
    lines = ax.contour(x, y, values, levels=np.arange(0.1, 1.0, 0.1), colors="tab:orange", linewidths=0.8)
    ax.clabel(lines, fmt="%.1f", fontsize=7)
    ax.figure.colorbar(shown, ax=ax, label="relative illumination", shrink=0.7)
    ax.set(title=f"{_name(camera)}: illumination", xlabel="pixels", ylabel="pixels")
    return ax


def spots(camera: Camera, ax: Axes | None = None, *, fields: Sequence[float] | Field = FIELDS) -> Axes:
    """Plots spot diagrams of points in the plane in focus side by side, from the middle to the corner.

    The dotted circles are Airy disks (`measure.airy_radius`), the spots of a perfect lens: smaller spots are not real.
    """
    ax = ax or plt.subplots()[1]
    points = _field(fields)
    found = measure.spots(camera, points)
    micrometres = 1000 * camera.film_size_mm[0] / camera.resolution[0]
    airy = np.full(len(found.rms), np.nan)
    if camera.interfaces > 0:
        airy = measure.airy_radius(camera, points) * micrometres
    lit = found.weight > 0
    reach = max((float(np.abs(found.offset[lit]).max()) * micrometres) if lit.any() else 0.0, 1e-3)
    reach = max(reach, float(np.nanmax(airy, initial=0.0)))
    for i, (field, rms) in enumerate(zip(points.labels, found.rms)):
        offset = found.offset[i][lit[i]] * micrometres
        # A dot's area is proportional to its ray's light.
        light = found.weight[i][lit[i]]
        size = 3.0 * light / max(float(light.mean()), 1e-300) if light.size else light
        ax.scatter(offset[:, 0] + 2.4 * reach * i, -offset[:, 1], s=size, linewidths=0, color="tab:blue")
        label = f"field {field}\nRMS {rms * micrometres:.1f} µm"
        if np.isfinite(airy[i]):
            ax.add_patch(Circle((2.4 * reach * i, 0.0), airy[i], fill=False, linestyle=":", edgecolor="0.3", zorder=3))
            label += f"\nAiry {airy[i]:.1f} µm"
        ax.annotate(label, (2.4 * reach * i, -1.1 * reach), ha="center", va="top", fontsize=8)
    ax.set_xlim(-1.3 * reach, 2.4 * reach * (len(found.rms) - 1) + 1.3 * reach)
    ax.set_ylim(-2.2 * reach, 1.2 * reach)
    ax.set_aspect("equal")
    ax.set(title=f"{_name(camera)}: spots", ylabel="µm on the film", xticks=[])
    return ax


def mtf(
    camera: Camera, ax: Axes | None = None, *, fields: Sequence[float] | Field = FIELDS, highest: float = 60.0
) -> Axes:
    """Plots the geometric MTF up to `highest` line pairs per mm, tangential (solid) and sagittal (dashed).

    The dotted line is the diffraction limit at the camera's f-number, which no real lens exceeds.
    """
    ax = ax or plt.subplots()[1]
    frequencies = np.linspace(0, highest, 121)
    points = _field(fields)
    with quietly():
        values = measure.mtf(camera, points, frequencies)
    for i, field in enumerate(points.labels):
        ax.plot(frequencies, values[i, 0], color=f"C{i}", label=f"field {field}")
        ax.plot(frequencies, values[i, 1], color=f"C{i}", linestyle="--")
    _directions(ax)
    if camera.interfaces > 0:
        limit = measure.diffraction_mtf(camera, frequencies)
        ax.plot(frequencies, limit, color="0.3", linestyle=":", label="limit of diffraction")
    return _contrasts(ax, f"{_name(camera)}: geometric MTF", "line pairs per mm on the film", highest)


def _directions(ax: Axes) -> None:
    """Adds the styles of tangential and sagittal lines to the legend."""
    ax.plot([], [], color="0.3", label="tangential")
    ax.plot([], [], color="0.3", linestyle="--", label="sagittal")


def _contrasts(ax: Axes, title: str, xlabel: str, highest: float) -> Axes:
    """Labels the axes of contrasts up to a frequency and returns them."""
    ax.set(title=title, xlabel=xlabel, xlim=(0, highest), ylim=(0, 1))
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3)
    return ax


def wave_mtf(
    lens: Lens,
    ax: Axes | None = None,
    *,
    points: Sequence[tuple[float, float]] = ((0.0, 0.0),),
    highest: float = 200.0,
    object_distance: float | None = None,
) -> Axes:
    """Plots the MTF with diffraction at points of the film, x and y in mm, up to `highest` cycles per mm: tangential
    (solid) and sagittal (dashed), and that of a perfect lens (dotted)."""
    ax = ax or plt.subplots()[1]
    frequencies = np.linspace(0.0, highest, 41)[1:]
    for i, (x, y) in enumerate(points):
        found = lens.mtf(frequencies.tolist(), (x, y), object_distance=object_distance)
        ax.plot(frequencies, found.tangential, color=f"C{i}", label=f"{x:g}, {y:g} mm")
        ax.plot(frequencies, found.sagittal, color=f"C{i}", linestyle="--")
        ax.plot(frequencies, found.perfect[0], color=f"C{i}", linestyle=":")
    _directions(ax)
    ax.plot([], [], color="0.3", linestyle=":", label="perfect lens")
    return _contrasts(ax, f"{lens.name}: MTF with diffraction", "cycles per mm", highest)


def psf(
    lens: Lens,
    ax: Axes | None = None,
    *,
    at: tuple[float, float] = (0.0, 0.0),
    pixels: int = 128,
    pitch_um: float | None = None,
    object_distance: float | None = None,
) -> Axes:
    """Shows the picture of a point with diffraction, as the logarithm of its energy down to a millionth of the peak.

    Axes are x and y on the film in lens space, micrometres from the image point.
    """
    ax = ax or plt.subplots()[1]
    found = lens.psf(at, pixels=pixels, pitch_um=pitch_um, object_distance=object_distance)
    half = 0.5 * pixels * found.pitch_mm * 1000
    level = np.log10(np.maximum(found.energy / found.energy.max(), 1e-6))
    image = ax.imshow(level, extent=(-half, half, -half, half), origin="lower", cmap="magma")
    ax.figure.colorbar(image, ax=ax, label="log10 of the energy, of the peak")
    strehl = found.wavefront.strehl
    ax.set(title=f"{lens.name}: Strehl ratio {strehl:.3f}", xlabel="µm", ylabel="µm")
    return ax


def psf_map(found: PsfMap, ax: Axes | None = None) -> Axes:
    """Shows the pictures of points at a grid over the picture, of `farm.psf_map`, each magnified, at its place.

    The picture is upright. Each shows the square root of the energy, relative to its own peak.
    """
    ax = ax or plt.subplots(layout="constrained")[1]
    rows, columns, pixels, _ = found.energy.shape
    # A line of NaN separates the pictures.
    tiles = np.full((rows, columns, pixels + 1, pixels + 1), np.nan)
    peak = found.energy.max(axis=(2, 3), keepdims=True)
    tiles[..., :-1, :-1] = np.sqrt(found.energy / np.where(peak > 0, peak, np.nan))
    whole = tiles.transpose(0, 2, 1, 3).reshape(rows * (pixels + 1), columns * (pixels + 1))
    ax.imshow(whole, cmap="inferno", vmin=0.0, vmax=1.0, extent=_extent(found.x_mm, found.y_mm), aspect="auto")
    ax.set_box_aspect(rows / columns)
    ax.set_xticks(found.x_mm, [f"{x:.3g}" for x in found.x_mm])
    ax.set_yticks(found.y_mm, [f"{y:.3g}" for y in found.y_mm])
    side = 1000 * pixels * found.pitch_mm
    ax.set(title=f"{found.lens_name}: points, {side:.3g} µm wide", xlabel="mm on the film", ylabel="mm on the film")
    return ax


def field_map(table: Table, column: str, ax: Axes | None = None) -> Axes:
    """Shows a column of a study over the picture, such as "strehl", "wavefront_rms" or "wave_mtf_tangential_30".

    The table has the rows of one camera at all points of a `Field.grid`.

    Raises
    ------
    ValueError
        For a table of several cameras, or of other points.
    """
    ax = ax or plt.subplots(layout="constrained")[1]
    x, y = (np.unique(np.round(table[name], 6)) for name in ("x_mm", "y_mm"))
    _of_one_camera(table, ("lens", "fnumber", "focus_distance", "defocus_mm", "wavelength"))
    values = np.full((len(y), len(x)), np.nan)
    at = np.searchsorted(y, np.round(table["y_mm"], 6)), np.searchsorted(x, np.round(table["x_mm"], 6))
    if len(table) != values.size or len({*zip(*(part.tolist() for part in at))}) != values.size:
        raise ValueError("a map shows the points of a grid: give the study fields=Field.grid(columns, rows)")
    values[at] = table[column]
    shown = ax.imshow(values, cmap="viridis", origin="lower", extent=_extent(x, y))
    ax.figure.colorbar(shown, ax=ax, label=column, shrink=0.7)
    number = float(table["fnumber_used"][0])
    ax.set(title=f"{table['lens'][0]}, f/{number:.3g}: {column}", xlabel="mm on the film", ylabel="mm on the film")
    return ax


def _of_one_camera(table: Table, columns: Sequence[str]) -> None:
    """Raises an error unless there are rows that all agree in columns."""
    if not len(table):
        raise ValueError("the table has no rows")
    if several := [name for name in columns if len(np.unique(table[name])) > 1]:
        raise ValueError(
            f"the figure is of one camera, and these rows differ in {', '.join(several)}: select some of them"
        )


def through_focus(table: Table, columns: str | Sequence[str], ax: Axes | None = None) -> Axes:
    """Plots columns of a study over the film's position: a colour for each field point, a dash for each column.

    The table has the rows of one camera at several `defocus_mm`.

    Raises
    ------
    ValueError
        For a table of several cameras, or of different field points at different positions of the film.
    """
    ax = ax or plt.subplots(layout="constrained")[1]
    _of_one_camera(table, ("lens", "fnumber", "focus_distance", "wavelength"))
    names = [columns] if isinstance(columns, str) else list(columns)
    moved, counts = np.unique(table["defocus_mm"], return_counts=True)
    if (counts != counts[0]).any():
        raise ValueError("the rows have different field points at different positions of the film: select whole fields")
    # In a study's order, all field points of one position follow one another.
    rows = table[np.argsort(table["defocus_mm"], kind="stable")].reshape(len(moved), -1)
    for point, field in enumerate(rows["field"][0]):
        for name, dash in zip(names, cycle(("-", "--", ":", "-."))):
            label = f"field {field:.2g}, {name}" if len(names) > 1 else f"field {field:.2g}"
            ax.plot(moved, rows[name][:, point], dash, color=f"C{point}", label=label)
    number = float(table["fnumber_used"][0])
    ax.set(title=f"{table['lens'][0]}, f/{number:.3g}: through focus", xlabel="film moved away from the lens, mm")
    ax.set_ylabel(names[0] if len(names) == 1 else "")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    return ax


def _extent(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Returns left, right, bottom and top of a map whose parts have their middles at x and y, which are evenly
    spaced."""
    sides = []
    for middles in (x, y):
        low, high = float(middles.min()), float(middles.max())
        half = 0.5 * (high - low) / (len(middles) - 1) if len(middles) > 1 else 0.5
        sides += [low - half, high + half]
    left, right, bottom, top = sides
    return left, right, bottom, top


def distortion(camera: Camera, ax: Axes | None = None) -> Axes:
    """Plots the distortion over the field, in percent."""
    ax = ax or plt.subplots()[1]
    fields = np.linspace(0.02, 1.0, 50)
    ax.plot(100 * measure.distortion(camera, Field.fractions(fields)), fields)
    ax.axvline(0, color="0.7", linewidth=0.8)
    ax.set(title=f"{_name(camera)}: distortion", xlabel="percent", ylabel="field, of the half diagonal", ylim=(0, 1))
    ax.grid(alpha=0.3)
    return ax


def fans(camera: Camera, *, fields: Sequence[float] | Field = FIELDS) -> Figure:
    """Plots ray fans of points in the plane in focus, one row per point: tangential left, sagittal right."""
    points = _field(fields)
    found = measure.fans(camera, points)
    values = 1000 * np.stack([found.tangential, found.sagittal], axis=1)
    reach = max(float(np.nanmax(np.abs(values), initial=0.0)), 1e-3)
    figure, axes = plt.subplots(
        len(values), 2, sharex=True, sharey=True, squeeze=False, figsize=(7, 1.2 + 1.3 * len(values))
    )
    for row, field, fan in zip(axes, points.labels, values):
        for ax, line, direction in zip(row, fan, ("tangential", "sagittal")):
            ax.axhline(0, color="0.7", linewidth=0.8)
            ax.axvline(0, color="0.7", linewidth=0.8)
            ax.plot(found.pupil, line)
            ax.set(xlim=(-1, 1), ylim=(-1.1 * reach, 1.1 * reach))
            ax.set_title(f"field {field}, {direction}", fontsize=8)
        row[0].set_ylabel("µm")
    for ax in axes[-1]:
        ax.set_xlabel("pupil")
    figure.suptitle(f"{_name(camera)}: ray fans")
    return figure


def field_curvature(camera: Camera, ax: Axes | None = None) -> Axes:
    """Plots the tangential (solid) and sagittal (dashed) focus over the field, mm behind the film."""
    ax = ax or plt.subplots()[1]
    share = np.linspace(0.0, 1.0, 51)
    found = measure.field_curvature(camera, Field.fractions(share))
    for column, style, label in zip(found.T, ("-", "--"), ("tangential", "sagittal")):
        ax.plot(column, share, style, color="tab:blue", label=label)
    ax.axvline(0, color="0.7", linewidth=0.8)
    ax.set(
        title=f"{_name(camera)}: field curvature",
        xlabel="mm behind the film",
        ylabel="field, of the half diagonal",
        ylim=(0, 1),
    )
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3)
    return ax


def section(
    lens: Lens,
    ax: Axes | None = None,
    *,
    angles: Sequence[float] = (),
    rays: int = 7,
    film_distance: float | None = None,
) -> Axes:
    """Draws a lens's cross-section: glass, stop, pupils, principal planes and focal points; the scene is on the left.

    `angles`, degrees from the axis, add bundles of `rays` rays from infinity at each angle. Only rays that pass the
    lens are drawn; they end on the film at `film_distance` behind the last vertex (default: focused at infinity).
    """
    ax = ax or plt.subplots(figsize=(8, 4))[1]
    surfaces = lens.surfaces
    for x, y in glasses(surfaces):
        ax.fill(x, y, facecolor="lightsteelblue", edgecolor="none", alpha=0.7)
    for surface, (x, y) in zip(surfaces, outlines(surfaces)):
        if not surface.is_stop:
            ax.plot(x, y, color="black", linewidth=0.9)
    for x, y in stop_blades(surfaces):
        ax.plot(x, y, color="black", linewidth=2.5)
    if angles:
        film = lens.focus(np.inf) if film_distance is None else film_distance
        for number, angle in enumerate(angles):
            for path in _paths(lens, angle, rays, film):
                ax.plot(-path[:, 2], path[:, 1], color=f"C{number}", linewidth=0.7)
    pupils = lens.pupils
    for at, diameter, label, colour in (
        (pupils.entrance_mm, pupils.entrance_diameter_mm, "entrance pupil", "tab:green"),
        (pupils.exit_mm, pupils.exit_diameter_mm, "exit pupil", "tab:red"),
    ):
        if np.isfinite([at, diameter]).all():
            ax.plot([-at] * 2, [-diameter / 2, diameter / 2], "--", color=colour, linewidth=1, label=label)
    for at, side, line in zip(lens.principal_planes_mm, ("front", "rear"), (":", "-.")):
        if np.isfinite(at):
            ax.axvline(-at, color="tab:purple", linewidth=0.7, linestyle=line, label=f"{side} principal plane")
    points = [-at for at in lens.focal_points_mm if np.isfinite(at)]
    ax.plot(points, [0.0] * len(points), "o", color="tab:orange", markersize=4, label="focal points")
    ax.axhline(0, color="0.6", linewidth=0.6)
    ax.set_aspect("equal")
    ax.set(
        title=f"{lens.name}: f = {lens.focal_length_mm:.4g} mm, f/{lens.fnumber:.3g}", xlabel="mm from the front vertex"
    )
    ax.legend(fontsize=7, loc="upper right")
    return ax


def _paths(lens: Lens, angle: float, rays: int, film_distance: float) -> list[NDArray[np.float64]]:
    """Returns paths of rays from infinity to the film, (points, 3) each, evenly spaced over the unvignetted meridional
    fan."""
    surfaces = lens.surfaces
    outer = max(surface.semi_diameter_mm for surface in surfaces)
    # Rays begin in front of the lens and aim at points in the plane of the paraxial entrance pupil, also far outside
    # the pupil.
    pupil = lens.pupils.entrance_mm if np.isfinite(lens.pupils.entrance_mm) else 0.0
    start = 1.2 * outer
    toward = np.array([0.0, np.sin(np.radians(angle)), -np.cos(np.radians(angle))])
    height = np.linspace(-2 * outer, 2 * outer, 4001)
    origin = np.stack([0 * height, height + (start - pupil) * toward[1] / toward[2], 0 * height + start], axis=-1)
    passed = np.flatnonzero(lens.trace(origin, toward).passed)
    if len(passed) == 0:
        return []
    chosen = passed[np.linspace(0, len(passed) - 1, rays).round().astype(int)]
    traced = lens.trace(origin[chosen], toward, points=True)
    assert traced.points is not None
    last = traced.origin + traced.direction * (
        (lens.rear_vertex_mm - film_distance - traced.origin[:, 2:]) / traced.direction[:, 2:]
    )
    return [np.concatenate([a[None], b, c[None]]) for a, b, c in zip(origin[chosen], traced.points, last)]


def _field(fields: Sequence[float] | Field) -> Field:
    """Returns field points in one row; numbers are fractions of half the diagonal."""
    points = fields if isinstance(fields, Field) else Field.fractions(fields)
    return Field(points.unit, points.x.ravel(), None if points.y is None else points.y.ravel())


def _name(camera: Camera) -> str:
    return f"{camera.lens_name}, f/{camera.fnumber:.3g}"
