"""The colour noise of a lens with dispersion in Mitsuba's spectral variant, and the CPU time.

$ python benches/mitsuba_colour.py [LENS]

Renders uniform light through the whole lens with 16 samples per pixel and a box filter. Prints the standard deviation
of a pixel divided by its mean in R, G and B, for several values of `dispersion_tolerance`. For comparison, it also does
so for the same lens at one wavelength, where all wavelengths take the same path. The lens's illumination falloff is
divided out. The last column is CPU seconds per picture on one thread, the median of five.
"""

from __future__ import annotations

import statistics
import sys
import time
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_spectral")

import realistic.mitsuba  # noqa: F401

SPP = 16
KINDS: dict[str, dict[str, Any]] = {
    "one wavelength": {"wavelength": 550.0},
    **{f"tolerance {tolerance:g}": {"dispersion_tolerance": tolerance} for tolerance in (0.0, 0.5, 1.0, 2.0)},
}


def measure(lens: str, width: int, height: int) -> None:
    """Prints the table of a lens for a size of picture."""
    print(f"\n| `{lens}`, {width} x {height} | R | G | B | s per picture |\n|---|---|---|---|---|")
    for name, properties in KINDS.items():
        # A part of the film between its middle and its corner represents the film at every size.
        crop = {"crop_offset_x": width // 2, "crop_offset_y": height // 2, "crop_width": 192, "crop_height": 128}
        film = {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, **crop}
        sensor = {
            "type": "realistic",
            "lens_file": lens,
            "film": film,
            "sampler": {"type": "independent"},
            **properties,
        }
        scene = mi.load_dict(
            {"type": "scene", "integrator": {"type": "path"}, "light": {"type": "constant"}, "s": sensor}
        )
        taken, pictures = [], []
        for seed in range(6):
            begin = time.process_time()
            picture = mi.render(scene, seed=seed, spp=SPP)
            dr.eval(picture)
            dr.sync_thread()
            taken.append(time.process_time() - begin)
            pictures.append(np.array(picture, np.float64))
        each = np.array(pictures)
        noise = np.sqrt(each.var(axis=0, ddof=1).mean(axis=(0, 1))) / each.mean(axis=(0, 1, 2))
        r, g, b = noise
        print(f"| {name} | {r:.3f} | {g:.3f} | {b:.3f} | {statistics.median(taken[1:]):.3f} |", flush=True)


def main() -> None:
    dr.set_thread_count(1)
    for lens in sys.argv[1:] or ("dgauss.100mm", "tessar.50mm"):
        for width, height in ((384, 256), (1920, 1280)):
            measure(lens, width, height)


if __name__ == "__main__":
    main()
