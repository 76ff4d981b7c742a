"""A sheet of plots for a lens: illumination, spots, MTF, distortion.

$ python lens_sheet.py dgauss.50mm sheet.png
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import realistic
from realistic import plot


def main(lens: str, out: str) -> None:
    camera = realistic.Camera(lens, resolution=(1500, 1000), focus_distance=2000.0)
    figure, axes = plt.subplots(2, 2, figsize=(11, 7.5), layout="constrained")
    plot.illumination(camera, axes[0, 0])
    plot.spots(camera, axes[0, 1])
    plot.mtf(camera, axes[1, 0])
    plot.distortion(camera, axes[1, 1])
    figure.savefig(out, dpi=100)
    print(f"{out}: {camera}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(
            "usage: python lens_sheet.py LENS PICTURE.png, as in: python lens_sheet.py dgauss.50mm sheet.png",
            file=sys.stderr,
        )
        sys.exit(2)
    main(sys.argv[1], sys.argv[2])
