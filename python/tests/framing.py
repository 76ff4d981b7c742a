"""Measures framing and blur in pictures of the program's test scene, 480 by 320 pixels, as arrays (320, 480) or (320,
480, 3). Also measures the difference of any two pictures, which may differ in noise and size.
"""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np

SIZE = (480, 320)
# Positions of lamps of the nearer string in pictures by dgauss.50mm, focused on the card; other objects do not overlap
# them.
LAMPS = [(101, 60), (151, 78), (202, 87), (252, 89), (303, 83), (354, 70), (404, 49)]


def program(checkout):
    """Returns the command-line program, if it has been built."""
    named = os.environ.get("REALISTIC_PROGRAM")
    built = [checkout / f"target/{kind}/realistic" for kind in ("release", "debug")]
    found = [Path(named)] if named else [file for file in built if file.is_file()]
    return found[0] if found else shutil.which("realistic")


def by_program(command, out, spp, parameters):
    """Renders the picture through dgauss.50mm with the program."""
    given = [f"--param={name}={value}" for name, value in parameters.items()]
    size = f"--size={SIZE[0]}x{SIZE[1]}"
    done = subprocess.run(
        [str(command), "render", "--scene=day", "--lens=dgauss.50mm", size, f"--spp={spp}", *given, f"--out={out}"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def edge(profile, outside, inside):
    """Returns the position of an edge between two slices of a profile: `outside`, which is dark, and `inside`, which is
    light."""
    dark, light = profile[outside].mean(), profile[inside].mean()
    return outside.stop + ((light - profile[outside.stop : inside.start]) / (light - dark)).sum()


def edges(picture):
    """Returns the card's left, right and top edge, pixels from the left and from the top."""
    rows, columns = slice(190, 245), slice(30, 160)
    across = picture[rows].mean(axis=0)
    down = picture[:, columns].mean(axis=1)
    width = len(across)
    return np.array(
        [
            edge(across, slice(9, 11), slice(12, 14)),
            width - edge(across[::-1], slice(width - 179, width - 177), slice(width - 176, width - 174)),
            edge(down, slice(149, 151), slice(152, 154)),
        ]
    )


def bokeh(picture):
    """Returns centre (x, y) and radius of each lamp's disk in pixels, (lamps, 3).

    The radius is that of a uniformly bright disk with the same second moment.
    """
    rows, columns = np.indices(picture.shape)
    found = []
    for x, y in LAMPS:
        distance = np.hypot(columns + 0.5 - x, rows + 0.5 - y)
        # The background has a gradient, so a plane is fitted to the pixels around the disk.
        plane = np.stack([np.ones_like(distance), columns - x, rows - y], axis=-1)
        around = (distance > 12.5) & (distance < 16)
        behind = plane @ np.linalg.lstsq(plane[around], picture[around], rcond=None)[0]
        light = np.where(distance < 12.5, picture - behind, 0.0)
        total = light.sum()
        centre = [((at + 0.5) * light).sum() / total for at in (columns, rows)]
        moment = (((columns + 0.5 - centre[0]) ** 2 + (rows + 0.5 - centre[1]) ** 2) * light).sum() / total
        found.append([*centre, np.sqrt(2 * moment)])
    return np.array(found)


def difference(one, other, blur=7):
    """Returns the largest difference of two pictures (height, width, 3), in display values from 0 to 1, after both are
    shrunk to the smaller size and averaged over `blur` by `blur` pixels.
    """
    height, width = min(one.shape[:2], other.shape[:2])
    blurred = []
    for picture in (one, other):
        for size in (height, width):
            # The mean over a part of a line is the difference of the line's integral at the two ends, divided by the
            # part's length.
            ends = np.concatenate([[0.0 * picture[0]], np.cumsum(picture, axis=0)])
            at = np.linspace(0, len(picture), size + 1)
            whole = np.minimum(at.astype(int), len(picture) - 1)
            share = (at - whole)[:, None, None]
            means = np.diff(ends[whole] + share * (ends[whole + 1] - ends[whole]), axis=0) * size / len(picture)
            windows = np.lib.stride_tricks.sliding_window_view(means, blur, axis=0).mean(axis=-1)
            # The swap makes the next pass work on columns; the second swap restores the rows.
            picture = windows.swapaxes(0, 1)
        blurred.append(picture)
    return np.abs(blurred[0] - blurred[1]).max()
