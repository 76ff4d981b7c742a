"""The sensor's share of a path-traced picture in Mitsuba 3, 384 x 256 pixels, 16 samples per pixel.

$ python benches/mitsuba_share.py

One thread, process CPU time, after one picture that compiles the kernels; interleaved with the same picture by Mitsuba's own
thin lens. The share is the time inside `sample_ray_differential`, with the evaluation of Mitsuba's random numbers that it
waits for.
"""

import statistics
import time
from typing import Any

import drjit as dr
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")

import realistic.mitsuba  # noqa: F401

ROUNDS = 9


def scene(sensor: dict[str, Any]) -> Any:
    """Mitsuba's Cornell box, two units wide, seen through a sensor."""
    box = mi.cornell_box()
    film = {"type": "hdrfilm", "width": 384, "height": 256}
    box["sensor"] = {
        "to_world": mi.ScalarTransform4f().look_at(origin=[0, 0, 3.9], target=[0, 0, 0], up=[0, 1, 0]),
        "film": film,
        "sampler": {"type": "independent", "sample_count": 16},
        **sensor,
    }
    return mi.load_dict(box)


def main() -> None:
    dr.set_thread_count(1)
    lens = {"lensfile": "dgauss.50mm", "mm_per_unit": 1000.0, "focus_distance": 3.9}
    scenes = {
        "realistic": scene({"type": "realistic", **lens}),
        "realistic, no differentials": scene({"type": "realistic", "differentials": False, **lens}),
        "thinlens": scene({"type": "thinlens", "fov": 35, "aperture_radius": 0.0125, "focus_distance": 3.9}),
    }
    inside: list[float] = []

    def timed(rays: Any) -> Any:
        def measured(*given: Any, **named: Any) -> Any:
            begin = time.process_time()
            found = rays(*given, **named)
            inside.append(time.process_time() - begin)
            return found

        return measured

    for name in list(scenes)[:2]:
        sensor = scenes[name].sensors()[0]
        sensor.sample_ray_differential = timed(sensor.sample_ray_differential)
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in scenes}
    for seed in range(ROUNDS + 1):
        for name, shown in scenes.items():
            inside.clear()
            begin = time.process_time()
            dr.eval(mi.render(shown, seed=seed))
            dr.sync_thread()
            taken[name].append((time.process_time() - begin, sum(inside)))
    print("| sensor | s per picture | s inside the sensor | share |\n|---|---|---|---|")
    for name, times in taken.items():
        whole, part = (statistics.median(column) for column in zip(*times[1:]))
        share = statistics.median(b / a for a, b in times[1:])
        print(f"| `{name}` | {whole:.3f} | {part:.3f} | {100 * share:.1f} % |")


if __name__ == "__main__":
    main()
