"""Maps of points, Strehl ratio and contrast over the picture of a lens, with diffraction.

$ python field_maps.py planar.50mm maps.png
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import realistic
from realistic import farm, plot

GRID = (7, 5)
FNUMBER = 4.0


def main(lens: str, out: str) -> None:
    camera = realistic.Camera(lens, resolution=(1500, 1000), fnumber=FNUMBER, focus_distance=float("inf"))
    points = farm.psf_map(camera, GRID)
    fields = realistic.Field.grid(*GRID)
    table = realistic.study(lens, FNUMBER, fields=fields, frequencies=40, diffraction=True)

    figure = plt.figure(figsize=(11, 10.5), layout="constrained")
    panels = figure.subplot_mosaic([["points"] * 2, ["strehl", "contrast"]], height_ratios=[2, 1])
    plot.psf_map(points, panels["points"])
    plot.field_map(table, "strehl", panels["strehl"])
    plot.field_map(table, "wave_mtf_tangential_40", panels["contrast"])
    figure.savefig(out, dpi=90)
    print(f"{out}: {camera}, error at most {points.error.max():.1e}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(
            "usage: python field_maps.py LENS PICTURE.png, as in: python field_maps.py planar.50mm maps.png",
            file=sys.stderr,
        )
        sys.exit(2)
    main(sys.argv[1], sys.argv[2])
