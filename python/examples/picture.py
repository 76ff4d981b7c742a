"""A small renderer in NumPy: balls on a chequered floor, through a real lens.

$ python picture.py dgauss.50mm picture.png
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import realistic

Array = NDArray[np.float32]

# Millimetres, camera space: x right, y up, z away from the camera, which is 150 above the floor.
FLOOR = -150.0
BALLS = [
    # centre, radius, colour
    ((-190.0, -70.0, 750.0), 80.0, (0.75, 0.16, 0.12)),
    ((0.0, -70.0, 1150.0), 80.0, (0.95, 0.75, 0.25)),
    ((330.0, -70.0, 2000.0), 80.0, (0.15, 0.35, 0.75)),
    ((-700.0, 50.0, 3600.0), 200.0, (0.2, 0.6, 0.3)),
]
LIGHT = np.array([-0.45, 0.8, -0.4], np.float32)


def meet_ball(origin: Array, direction: Array, centre: Array, radius: float) -> Array:
    """Returns the distance along rays (n, 3) to a ball; inf for a miss."""
    away = origin - centre
    half = (away * direction).sum(axis=1)
    square = half * half - (away * away).sum(axis=1) + radius * radius
    far = -half - np.sqrt(np.maximum(square, 0))
    return np.where((square > 0) & (far > 1e-2), far, np.inf).astype(np.float32)


def nearest(origin: Array, direction: Array) -> tuple[Array, NDArray[np.int_]]:
    """Returns the distance to the nearest object, and its number: a ball's index, -1 for the floor, -2 for the sky."""
    with np.errstate(divide="ignore"):
        floor = (FLOOR - origin[:, 1]) / direction[:, 1]
    far = np.where((floor > 1e-2) & (floor < 2e4), floor, np.inf).astype(np.float32)
    which = np.where(np.isfinite(far), -1, -2)
    for i, (centre, radius, _) in enumerate(BALLS):
        to_ball = meet_ball(origin, direction, np.array(centre, np.float32), radius)
        which = np.where(to_ball < far, i, which)
        far = np.minimum(far, to_ball)
    return far, which


def shade(origin: Array, direction: Array) -> Array:
    """Returns the colours that rays (n, 3) see, (n, 3)."""
    light = LIGHT / np.linalg.norm(LIGHT)
    far, which = nearest(origin, direction)
    up = np.clip(direction[:, 1:2] * 2 + 0.3, 0, 1)
    colour = (1 - up) * np.array([0.95, 0.9, 0.85], np.float32) + up * np.array([0.35, 0.55, 0.9], np.float32)
    hit = which > -2
    points = origin[hit] + direction[hit] * far[hit, None]
    surface = which[hit]
    normal = np.tile(np.array([0, 1, 0], np.float32), (len(points), 1))
    squares = (np.floor(points[:, 0] / 100) + np.floor(points[:, 2] / 100)) % 2
    albedo = np.where(squares[:, None] > 0, np.float32(0.8), np.float32(0.25)) * np.ones((1, 3), np.float32)
    for i, (centre, radius, tint) in enumerate(BALLS):
        own = surface == i
        normal[own] = (points[own] - np.array(centre, np.float32)) / radius
        albedo[own] = tint
    shadow = nearest(points + normal, np.tile(light, (len(points), 1)).astype(np.float32))[1] >= 0
    lit = np.clip(normal @ light, 0, 1) * ~shadow
    colour[hit] = albedo * (0.25 + 0.85 * lit[:, None])
    return colour.astype(np.float32)


def main(lens: str, out: str, width: int = 450, height: int = 300, side: int = 8) -> None:
    camera = realistic.Camera(lens, resolution=(width, height), focus_distance=1220.0, weighting="relative")
    random = np.random.default_rng(1)
    y, x = np.mgrid[0:height, 0:width].astype(np.float32)
    corner = np.stack([x.ravel(), y.ravel()]).T
    picture = np.zeros((width * height, 3), np.float32)
    rays = realistic.Rays.empty(width * height)
    for cell in np.ndindex(side, side):
        # One jittered sample in each cell of the lens square, at a random point of the pixel.
        lens_uv = (np.array(cell, np.float32) + random.random((width * height, 2), np.float32)) / np.float32(side)
        camera.rays(corner + random.random(corner.shape, np.float32), lens_uv, out=rays)
        passed = rays.weight > 0
        seen = rays[passed]
        picture[passed] += seen.weight[:, None] * shade(seen.origin, seen.direction)
    shown = np.clip(picture / side**2, 0, 1) ** (1 / 2.2)
    plt.imsave(out, shown.reshape(height, width, 3))
    print(f"{out}: {camera}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(
            "usage: python picture.py LENS PICTURE.png, as in: python picture.py dgauss.50mm picture.png",
            file=sys.stderr,
        )
        sys.exit(2)
    main(sys.argv[1], sys.argv[2])
