"""HTML for notebooks, without matplotlib: a lens's cross-section as a drawing, and a table."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

from .surfaces import glasses, outlines, stop_blades

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .surfaces import Line, Surface


_POINTS = 33
"""Number of points of a surface's line: enough at the size of a notebook's figure."""

_ROWS = 60
"""Largest number of rows of a table that notebooks show."""


def drawing(surfaces: Sequence[Surface], caption: str) -> str:
    """Draws the cross-section as SVG, the scene on the left, with a caption below; lines have the page's colour."""
    lines = [line for surface, line in zip(surfaces, outlines(surfaces, _POINTS)) if not surface.is_stop]
    blades = stop_blades(surfaces)
    every = [*lines, *blades]
    if not every:
        return f"<p>{html.escape(caption)}</p>"
    left, right = (bound(float(bound(x)) for x, _ in every) for bound in (min, max))
    top = max(float(abs(y).max()) for _, y in every)
    margin = 0.05 * max(right - left, 2 * top)
    width, height = right - left + 2 * margin, 2 * (top + margin)
    box = f"{left - margin:.4g} {-top - margin:.4g} {width:.4g} {height:.4g}"
    parts = [
        f'<path d="{_path(line)}Z" fill="steelblue" fill-opacity="0.35" stroke="none"/>'
        for line in glasses(surfaces, _POINTS)
    ]
    axis = f"M{left - margin:.4g} 0H{right + margin:.4g}"
    thin = max(width, height) / 800
    for paths, stroke in (([axis], thin), (map(_path, lines), 2 * thin), (map(_path, blades), 6 * thin)):
        parts += [f'<path d="{path}" stroke-width="{stroke:.3g}"/>' for path in paths]
    return (
        f'<figure><svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" style="width:100%;max-width:30em;max-height:20em" '
        f'fill="none" stroke="currentColor">{"".join(parts)}</svg>'
        f"<figcaption>{html.escape(caption)}</figcaption></figure>"
    )


def table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """Formats a table with a header row. Of a long table, shows the first and the last rows, and the number of the
    others."""
    shown = [*rows] if len(rows) <= _ROWS else [*rows[: _ROWS // 2], *rows[-_ROWS // 2 :]]
    head = "".join(f"<th>{html.escape(name)}</th>" for name in columns)
    body = ["<tr>" + "".join(f"<td>{_cell(cell)}</td>" for cell in row) + "</tr>" for row in shown]
    if len(shown) < len(rows):
        body.insert(_ROWS // 2, f'<tr><td colspan="{len(columns)}">… {len(rows) - len(shown)} rows …</td></tr>')
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table>"


def _path(line: Line) -> str:
    return "M" + "L".join(f"{x:.5g} {-y:.5g}" for x, y in zip(*line))


def _cell(cell: Any) -> str:
    return html.escape(f"{cell:.6g}" if isinstance(cell, float) else str(cell))
