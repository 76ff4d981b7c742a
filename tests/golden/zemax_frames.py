"""Frames of surfaces as OpticStudio reports them; writes zemax_frames.csv.

The arguments are prescription reports of OpticStudio: docs/examples/Zemax_txts/hdllr_c1.txt and hdllr_c4.txt of
https://github.com/ataras2/zemax_to_cad (44 coordinate breaks in both orders, 5 tilted surfaces).  A row is a surface:
the thickness behind the surface before it, the change of frame behind that surface and the one in front of its own
(decentre x and y, mm, tilts about x, y and z, degrees, 1 for the tilts first), and its frame: the rotation by rows, and
the origin, mm.
"""

import csv
import re
import sys
from pathlib import Path

NONE = ["0"] * 6
BREAK = ["Decenter X", "Decenter Y", "Tilt About X", "Tilt About Y", "Tilt About Z"]


def section(lines, title, end):
    start = next(i for i, line in enumerate(lines) if line.startswith(title))
    return lines[start + 1 : next(i for i in range(start, len(lines)) if lines[i].startswith(end))]


def name(surface):
    return "4" if surface == "STO" else surface


def report(path):
    lines = Path(path).read_text(encoding="utf-8").splitlines()
    cells = [line.split("\t") for line in section(lines, "SURFACE DATA SUMMARY", "SURFACE DATA DETAIL")]
    thicknesses = {name(row[0].strip()): row[3].strip() for row in cells if len(row) > 4}
    details, own = {}, None
    for line in section(lines, "SURFACE DATA DETAIL", "GLOBAL VERTEX"):
        begins = re.match(r"Surface\s+(\w+)\s", line)
        if begins:
            own = details.setdefault(name(begins.group(1)), {})
        elif own is not None and ":" in line:
            key, value = line.split(":", 1)
            own.setdefault(key.strip(), value.strip())

    def change(surface, key):
        own = details.get(surface, {})
        if key in own:
            values = own[key].split(None, 5)
        elif key == "Before surface" and "Order" in own and BREAK[0] in own:
            values = [own[name] for name in BREAK] + [own["Order"]]
        else:
            return NONE
        return values[:5] + ["0" if values[5].startswith("Dec") else "1"]

    rows, before = [], None
    table = section(lines, "GLOBAL VERTEX", "GLOBAL SURFACE CENTER")
    for i, line in enumerate(table):
        begins = re.match(r"\s*(\d+|STO)\s*\t\s*-?\d", line)
        if begins:
            surface = name(begins.group(1))
            matrix = [[cell.strip() for cell in row.split("\t")[1:5]] for row in table[i : i + 3]]
            behind = [thicknesses[before], *change(before, "After surface")] if before else ["0", *NONE]
            frame = [cell for row in matrix for cell in row[:3]] + [row[3] for row in matrix]
            rows.append([Path(path).stem, surface, *behind, *change(surface, "Before surface"), *frame])
            before = surface
    return rows


header = ["report", "surface", "gap"]
header += [f"{side}_{part}" for side in ("behind", "front") for part in ("x", "y", "a", "b", "c", "tilts_first")]
header += [f"r{i}{j}" for i in "123" for j in "123"] + ["x", "y", "z"]
with open(Path(__file__).with_name("zemax_frames.csv"), "w", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(header)
    for path in sys.argv[1:]:
        writer.writerows(report(path))
