"""The sensor's share of path-traced pictures in Mitsuba 3, 384 x 256 pixels, 16 samples per pixel.

$ python benches/mitsuba_share.py

Measures process CPU time on one thread, after one picture that compiles the kernels. Pictures alternate with the same
picture through Mitsuba's own thin lens. The share is the time inside `sample_ray_differential`, including the
evaluation of Mitsuba's random numbers, for which it waits. The two scenes are Mitsuba's Cornell box, which is very
cheap to render, and the scene of examples/mitsuba/studio.py.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import drjit as dr
import mitsuba as mi

sys.path.insert(0, str(Path(__file__).parents[2] / "examples/mitsuba"))

import studio  # sets the variant, and registers the sensors

if TYPE_CHECKING:
    from collections.abc import Callable

ROUNDS = 7
COMMON = {
    "film": {"type": "hdrfilm", "width": 384, "height": 256},
    "sampler": {"type": "independent", "sample_count": 16},
}


def box(sensor: dict[str, Any]) -> Any:
    """Loads Mitsuba's Cornell box, two units wide, seen through a sensor."""
    pose = mi.ScalarTransform4f().look_at(origin=[0, 0, 3.9], target=[0, 0, 0], up=[0, 1, 0])
    lens = {"mm_per_unit": 1000.0, "focus_distance": 3.9} if sensor["type"] == "realistic" else {"focus_distance": 3.9}
    return mi.load_dict({**mi.cornell_box(), "sensor": {"to_world": pose, **COMMON, **lens, **sensor}})


def table(sensor: dict[str, Any]) -> Any:
    """Loads the test scene: card, balls, lamps."""
    # 50 mm f/2; the thin lens's radius is in scene units.
    near = (
        {"focus_distance": 1071.0, "aperture_radius": 12.1}
        if sensor["type"] == "thinlens"
        else {"focus_distance": 1071.0}
    )
    return mi.load_dict(studio.scene({**COMMON, **sensor, **near}))


SENSORS: dict[str, dict[str, Any]] = {
    "realistic": {"type": "realistic", "lens_file": "dgauss.50mm"},
    "realistic, single precision": {"type": "realistic", "lens_file": "dgauss.50mm", "precision": "single"},
    "realistic, no differentials": {"type": "realistic", "lens_file": "dgauss.50mm", "differentials": False},
    "thinlens": {"type": "thinlens", "fov": 35, "aperture_radius": 0.0125},
}


def measure(title: str, made: Callable[[dict[str, Any]], Any]) -> None:
    """Prints the table of a scene."""
    scenes = {name: made(sensor) for name, sensor in SENSORS.items()}
    inside: list[float] = []

    def timed(rays: Any) -> Any:
        def measured(*given: Any, **named: Any) -> Any:
            begin = time.process_time()
            found = rays(*given, **named)
            inside.append(time.process_time() - begin)
            return found

        return measured

    for name, shown in scenes.items():
        if name != "thinlens":
            sensor = shown.sensors()[0]
            sensor.sample_ray_differential = timed(sensor.sample_ray_differential)
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in scenes}
    for seed in range(ROUNDS + 1):
        for name, shown in scenes.items():
            inside.clear()
            begin = time.process_time()
            dr.eval(mi.render(shown, seed=seed))
            dr.sync_thread()
            taken[name].append((time.process_time() - begin, sum(inside)))
    print(f"\n| {title} | s per picture | s inside the sensor | share |\n|---|---|---|---|")
    for name, times in taken.items():
        whole, part = (statistics.median(column) for column in zip(*times[1:]))
        share = statistics.median(b / a for a, b in times[1:])
        print(f"| `{name}` | {whole:.3f} | {part:.3f} | {100 * share:.1f} % |", flush=True)


def main() -> None:
    dr.set_thread_count(1)
    measure("Cornell box", box)
    measure("test scene", table)


if __name__ == "__main__":
    main()
