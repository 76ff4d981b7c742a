"""Plots a square grid seen through a lens and through its exported models, and the differences.

$ python export_grid.py fisheye.10mm grid.png
"""

import sys
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt

import realistic

Array = npt.NDArray[np.float64]

MODELS = {"opencv": "tab:orange", "opencv-rational": "tab:blue", "kannala-brandt": "tab:green"}
# Spacing of the grid's lines, and half the grid's width, as tangents of the angle from the axis.
SPACING, EXTENT = 0.5, 4.5
# Spacing of the arrows that show a difference, and length of the longest one, pixels.
STEP, LONGEST = 80, 110.0
# Length of a scale bar, pixels.
BAR = 200.0


def grid() -> Array:
    """Returns points (x, y) of the plane z = 1 on the lines of a grid, (lines, points, 2)."""
    levels = np.arange(-EXTENT, EXTENT + SPACING / 2, SPACING)
    across, along = np.meshgrid(levels, np.linspace(-EXTENT, EXTENT, 1001), indexing="ij")
    return np.concatenate([np.stack([across, along], axis=-1), np.stack([along, across], axis=-1)])


def seen(camera: realistic.Camera) -> Array:
    """Returns the points where the exact chief rays of pixels meet z = 1, (height, width, 2), +y down; NaN for dark
    pixels."""
    direction = camera.export("rays")["direction"].astype(np.float64)
    ahead = np.where(direction[..., 2] > 0, direction[..., 2], np.nan)
    return direction[..., :2] * [1, -1] / ahead[..., None]


def project(report: dict[str, Any], points: Array) -> Array:
    """Projects points of the plane z = 1 to pixels, (..., 2), by an exported model: the formulas of docs/export.md."""
    found = report["parameters"]
    k = found["distortion"]
    t = np.hypot(points[..., 0], points[..., 1])
    if report["as"] == "kannala-brandt":
        angle = np.arctan(t)
        radius = angle * (1 + sum(k[i] * angle ** (2 * i + 2) for i in range(4)))
        scale = radius / np.where(t == 0, 1.0, t)
    else:
        # k1, k2, p1, p2, k3 and, for the rational model, k4, k5, k6.
        below = k[5:] if len(k) > 5 else np.zeros(3)
        scale = _cubic(t * t, k[[0, 1, 4]]) / _cubic(t * t, below)
    focal_length = np.array([found["fx_px"], found["fy_px"]])
    return points * scale[..., None] * focal_length + [found["cx_px"], found["cy_px"]]


def _cubic(x: Array, k: Array) -> Array:
    return 1 + x * (k[0] + x * (k[1] + x * k[2]))


def magnification(worst: float) -> float:
    """Returns the largest of 1, 2, 5, 10, ... that magnifies a difference of `worst` pixels to at most LONGEST."""
    steps = [step * 10.0**power for power in range(7) for step in (1, 2, 5)]
    return max((step for step in steps if step * worst <= LONGEST), default=1.0)


def main(lens: str, out: str) -> None:
    # The grid is at infinity, and so is the focus. A nearer grid would add parallax, because the entrance pupil shifts
    # over the field.
    camera = realistic.Camera(lens, resolution=(1920, 1280), focus_distance=float("inf"))
    width, height = camera.resolution
    points = seen(camera)
    row, column = np.indices((height, width))
    pixels = np.stack([column, row], axis=-1)
    lattice = np.s_[height // 2 % STEP :: STEP, width // 2 % STEP :: STEP]

    figure = plt.figure(figsize=(12, 7.2), layout="constrained")
    panels: list[Any] = [["lens"] * 3 + ["models"] * 3, [model for model in MODELS for _ in range(2)]]
    axes = figure.subplot_mosaic(panels, height_ratios=[3, 2])
    for each in axes.values():
        each.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5), aspect="equal", xticks=[], yticks=[])

    axes["lens"].set_title(f"a square grid through {lens}: exact chief rays")
    for tangents in np.moveaxis(points, -1, 0):
        levels = np.arange(-EXTENT, EXTENT + SPACING / 2, SPACING)
        axes["lens"].contour(tangents, levels=levels, colors="black", linewidths=1.0, linestyles="solid")
    axes["models"].set_title("through its exported models, in the colours below")
    for number, (model, color) in enumerate(MODELS.items()):
        report = camera.export(model)
        lines = grid()
        lines[np.hypot(lines[..., 0], lines[..., 1]) > np.tan(np.radians(report["held_half_field_deg"]))] = np.nan
        lines = project(report, lines)
        # The dashes differ, so that a line on top of another one does not hide it.
        dashes: Any = "-" if number == 0 else (6.0 * number, (6.0, 6.0))
        axes["models"].plot(lines[..., 0].T, lines[..., 1].T, color=color, lw=1.2, ls=dashes)

        difference = project(report, points) - pixels
        worst = float(np.nanmax(np.hypot(difference[..., 0], difference[..., 1])))
        factor = magnification(worst)
        start, end = pixels[lattice], (pixels + factor * difference)[lattice]
        shown = axes[model]
        shown.plot(*np.stack([start, end]).reshape(2, -1, 2).transpose(2, 0, 1), color=color, lw=1.2)
        shown.plot(*start[np.isfinite(end).all(axis=-1)].T, ".", color="black", ms=2)
        shown.set_title(f"{model}: difference × {factor:,.0f}, worst {worst:.2g} px", color=color, fontsize=10)
        shown.plot([30, 30 + BAR], [height - 30] * 2, color="black", lw=3, solid_capstyle="butt")
        shown.text(30, height - 50, f"{BAR / factor:g} px", fontsize=9)
        print(f"{model}: at most {worst:.4f} pixels, {report['errors']['worst_px']:.4f} by its report")
    figure.savefig(out, dpi=100)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(
            "usage: python export_grid.py LENS PICTURE.png, as in: python export_grid.py fisheye.10mm grid.png",
            file=sys.stderr,
        )
        sys.exit(2)
    main(sys.argv[1], sys.argv[2])
