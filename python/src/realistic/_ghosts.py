"""The ghosts of a lens: what the program's `flare` reports, as objects."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ._export import _text
from ._program import program
from .errors import Error


@dataclass(frozen=True)
class Ghost:
    """Light of a lamp that two surfaces reflect on its way to the film."""

    surfaces: tuple[int, int]
    """The two surfaces, counted from 0 at the scene side: the one that reflects second, and the one that reflects first."""
    watts: float
    """What reaches the plane of the film, W, where the lamp makes 1 W/m² at the lens, across its light."""
    middle_mm: tuple[float, float]
    """The middle of it there, x and y."""
    rms_radius_mm: float
    """The root of the mean squared distance from the middle."""
    focus_before_film_mm: float | None
    """Where it is in focus for a lamp infinitely far away on the axis, toward the scene; None for nowhere."""


def ghosts(parameters: Mapping[str, Any], light: Sequence[float], coating: str) -> tuple[Ghost, ...]:
    """What `realistic flare --json` reports of a lens, the brightest ghost first."""
    given = {"specfile": "dgauss.50mm", **parameters}
    lens_text = given.pop("lens_text", None)
    if lens_text is not None:
        given["specfile"] = "-"
    words = [f"--param={name}={_text(value)}" for name, value in given.items() if value is not None]
    at = ",".join(repr(float(number)) for number in light)
    command = [str(program()), "flare", "--json", "--quiet", f"--light={at}", f"--coating={coating}"]
    text = lens_text.encode() if isinstance(lens_text, str) else lens_text
    told = subprocess.run([*command, *words], input=text or b"", capture_output=True, check=False)
    if told.returncode != 0:
        said = told.stderr.decode(errors="replace").strip()
        raise Error(said.removeprefix("realistic: error: ") or f"{command[0]} failed")
    return tuple(_ghost(pair) for pair in json.loads(told.stdout)["pairs"])


def _ghost(pair: Mapping[str, Any]) -> Ghost:
    first, second = pair["surfaces"]
    x, y = pair["middle_mm"]
    return Ghost(
        surfaces=(first - 1, second - 1),
        watts=pair["watts"],
        middle_mm=(x, y),
        rms_radius_mm=pair["rms_radius_mm"],
        focus_before_film_mm=pair["focus_before_film_mm"],
    )
