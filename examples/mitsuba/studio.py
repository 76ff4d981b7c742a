"""The program's test scene in Mitsuba 3: a card in focus, balls in front of and behind it, and lamps far behind.

$ python studio.py dgauss.50mm studio.png

The picture has the framing and the blur of
`realistic render --scene day --lens dgauss.50mm --param focus_distance=1071 --out program.png`; materials and sky are
Mitsuba's own and look a little different. Lengths are in millimetres; x is negated, because Mitsuba's cameras have +x
to the left.
"""

from __future__ import annotations

import sys
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import realistic.mitsuba  # noqa: F401

FLOOR = -155.0
CORAL, TEAL, AMBER = [0.66, 0.11, 0.07], [0.02, 0.33, 0.35], [0.76, 0.39, 0.05]
PLUM, CREAM, LEAF = [0.30, 0.08, 0.34], [0.76, 0.70, 0.60], [0.15, 0.36, 0.08]
GOLD, CHROME = [0.95, 0.68, 0.28], [0.86, 0.87, 0.90]
BALLS: list[tuple[float, float, float, Any, str]] = [
    # x, z, radius, colour, material
    (50, 990, 46, None, "glass"),
    (190, 1015, 64, CHROME, "metal"),
    (136, 490, 45, CORAL, "coated"),
    (-320, 620, 70, AMBER, "coated"),
    (430, 690, 92, TEAL, "coated"),
    (-170, 1800, 74, GOLD, "metal"),
    (390, 1640, 100, TEAL, "coated"),
    (-820, 1600, 190, CORAL, "coated"),
    (500, 3000, 150, AMBER, "coated"),
    (1300, 2100, 260, CREAM, "coated"),
    (-800, 4200, 240, PLUM, "coated"),
    (1500, 5600, 330, CORAL, "coated"),
    (-2300, 9500, 520, TEAL, "coated"),
    (950, 10000, 280, CREAM, "coated"),
    (-2600, 3000, 480, LEAF, "coated"),
]


def at(x: float, y: float, z: float) -> list[float]:
    return [-x, y, z]


def material(kind: str, colour: Any) -> dict[str, Any]:
    if kind == "glass":
        return {"type": "dielectric", "int_ior": 1.5}
    if kind == "metal":
        return {"type": "roughconductor", "alpha": 0.06, "specular_reflectance": {"type": "rgb", "value": colour}}
    return {"type": "plastic", "diffuse_reflectance": {"type": "rgb", "value": colour}}


def upright(corner: tuple[float, float, float], width: float, height: float) -> Any:
    """Maps Mitsuba's rectangle to an upright board that faces the camera, with the given top left corner."""
    x, y, z = corner
    middle = at(x + width / 2, y - height / 2, z)
    return mi.ScalarTransform4f().translate(middle).rotate([0, 1, 0], 180).scale([width / 2, height / 2, 1])


def card() -> mi.Bitmap:
    """Draws the print on the card, 80 by 66 units."""
    figure = plt.figure(figsize=(8, 6.6), dpi=160, facecolor="#f1ede5")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, 80), ylim=(66, 0))
    axes.axis("off")
    ink, red, green = "#262f55", "#ce3026", "#198b69"
    axes.plot([2.5, 77.5, 77.5, 2.5, 2.5], [2.5, 2.5, 63.5, 63.5, 2.5], color=ink, linewidth=6)
    axes.plot([6, 74], [17, 17], color=ink, linewidth=6)
    axes.text(40, 14, "realistic", size=78, color=ink, ha="center")
    arrow = np.array([[0, 0], [7.2, 9], [2.5, 9], [2.5, 30], [-2.5, 30], [-2.5, 9], [-7.2, 9]])
    axes.fill(*(arrow + [14, 21]).T, color=red, linewidth=0)
    axes.fill(53 - arrow[:, 1], 37 + arrow[:, 0], color=green, linewidth=0)
    axes.text(14, 62, "UP", size=58, color=red, ha="center")
    axes.text(53, 62, "RIGHT", size=58, color=green, ha="center")
    for ray in range(16):
        turn = 2 * np.pi * (ray + np.array([0, 0.5])) / 16
        axes.fill([66, *(66 + 10 * np.cos(turn))], [37, *(37 + 10 * np.sin(turn))], color=ink, linewidth=0)
    figure.canvas.draw()
    drawn = np.asarray(figure.canvas.buffer_rgba())[..., :3]
    plt.close(figure)
    # Row 0 is at the top of a bitmap; v is 0 at the lower edge of a rectangle.
    return mi.Bitmap(drawn[::-1].copy())


def lamps() -> dict[str, Any]:
    """Makes two strings of lamps that hang in spans."""
    warm = [[13.0, 7.4, 2.6], [13.0, 4.2, 1.5], [11.0, 8.8, 5.0]]
    span = 5200.0
    found = {}
    for z, radius, pitch, low, high in ((7000.0, 23.0, 410.0, 570.0, 1820.0), (12000.0, 38.0, 640.0, 620.0, 1500.0)):
        half = int(3 * span / pitch) // 2
        for index in range(-half, half + 1):
            x = (index + 0.25) * pitch
            across = ((x / span + 0.5) % 1.0) * 2 - 1
            # The lamps are visible, but too weak to be worth light sampling.
            light = {"type": "area", "radiance": {"type": "rgb", "value": warm[index % 3]}, "sampling_weight": 0.0}
            centre = at(x, low + (high - low) * across * across, z)
            found[f"lamp_{z:.0f}_{index + half}"] = {
                "type": "sphere",
                "center": centre,
                "radius": radius,
                "light": light,
            }
    return found


def sky() -> mi.Bitmap:
    """Draws a dusk sky as an environment map: a gradient above the horizon, dark below."""
    height = np.sin(np.pi * (0.5 - (np.arange(256) + 0.5) / 256))[:, None]
    horizon, middle, zenith = np.array([[0.93, 0.42, 0.23], [0.09, 0.14, 0.38], [0.06, 0.10, 0.26]])
    low = horizon + (middle - horizon) * (1 - np.exp(-6.5 * np.maximum(height, 0)))
    colour = low + (zenith - low) * np.clip(1.6 * height, 0, 1)
    colour = np.where(height > 0, colour, np.array([0.15, 0.12, 0.16]))
    return mi.Bitmap(np.repeat(colour[:, None, :], 512, axis=1).astype(np.float32))


def scene(sensor: dict[str, Any]) -> dict[str, Any]:
    """Makes the scene with a sensor at the origin that looks along +z."""
    tiles = {
        "type": "checkerboard",
        "color0": {"type": "rgb", "value": [0.08, 0.13, 0.18]},
        "color1": {"type": "rgb", "value": [0.60, 0.55, 0.46]},
        # A square of the checkerboard is half a unit of its texture wide.
        "to_uv": mi.ScalarTransform3f().scale([80000 / 310, 80000 / 310]),
    }
    flat = mi.ScalarTransform4f().translate([0, FLOOR, 0]).rotate([1, 0, 0], -90).scale([40000, 40000, 1])
    found: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 8},
        "sensor": sensor,
        "sky": {"type": "envmap", "bitmap": sky()},
        "sun": {
            "type": "directional",
            "direction": at(0.55, -0.52, 0.75),
            "irradiance": {"type": "rgb", "value": [3.3, 2.6, 1.9]},
        },
        "floor": {
            "type": "rectangle",
            "to_world": flat,
            "bsdf": {"type": "roughplastic", "alpha": 0.05, "diffuse_reflectance": tiles},
        },
        "card": {
            "type": "rectangle",
            "to_world": upright((-270, 10, 1000), 196, 196 * 66 / 80),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "bitmap", "bitmap": card()}},
        },
        **lamps(),
    }
    # Legs of the card, and poles for the lamps.
    legs = [(-270 + part * 196, 1001, 164, 196 / 30) for part in (0.15, 0.85)]
    legs += [(k * 2600.0, 7010, 1980, 34) for k in (-3, -1, 1, 3)]
    wood = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.11, 0.09, 0.08]}}
    for number, (x, z, height, width) in enumerate(legs):
        place = upright((x - width / 2, FLOOR + height, z), width, height)
        found[f"leg_{number}"] = {"type": "rectangle", "to_world": place, "bsdf": wood}
    for number, (x, z, radius, colour, kind) in enumerate(BALLS):
        ball = {"type": "sphere", "center": at(x, FLOOR + radius, z), "radius": radius, "bsdf": material(kind, colour)}
        found[f"ball_{number}"] = ball
    return found


def main(lens: str, out: str, width: int = 480, height: int = 320, samples: int = 64, passes: int = 8) -> None:
    sensor = {
        "type": "realistic",
        "lens_file": lens,
        # The distance of the card is measured from the film.
        "focus_distance": 1071.0,
        "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}},
        "sampler": {"type": "multijitter", "sample_count": samples},
    }
    shown = mi.load_dict(scene(sensor))
    # All rays of a pass are in memory at once, 84 bytes each.
    picture = sum(mi.render(shown, seed=number) for number in range(passes)) / passes
    mi.util.write_bitmap(out, picture, write_async=False)
    print(f"{out}: {shown.sensors()[0].camera}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(
            "usage: python studio.py LENS PICTURE.png, as in: python studio.py dgauss.50mm studio.png", file=sys.stderr
        )
        sys.exit(2)
    main(sys.argv[1], sys.argv[2])
