"""The prescriptions as transcriptions, so that nothing outside this folder is needed.

A row is (radius, thickness to the next vertex, index behind the interface, clear diameter), front (scene)
first.  A positive radius has its centre on the film's side; radius 0 or inf is a plane; index 0 or 1 is air.
The stop is the plane with air on both sides.  Lengths in millimetres.
"""

from dataclasses import dataclass
from math import inf, isinf

D_LINE, F_LINE, C_LINE = 587.56, 486.13, 656.27

_DGAUSS_50 = """
29.475   3.76   1.67   25.2
84.83    0.12   1      25.2
19.275   4.025  1.67   23
40.77    3.275  1.699  23
12.75    5.705  1      18
0        4.5    0      17.1
-14.495  1.18   1.603  17
40.77    6.065  1.658  20
-20.385  0.19   1      20
437.065  3.22   1.717  20
-39.73   0      1      20
"""

_WIDE_22 = """
35.98738  1.21638 1.54   23.716
11.69718  9.9957  1      17.996
13.08714  5.12622 1.772  12.364
-22.63294 1.76924 1.617  9.812
71.05802  0.8184  1      9.152
0         2.27766 0      8.756
-9.58584  2.43254 1.617  8.184
-11.28864 0.11506 1      9.152
-166.7765 3.09606 1.713  10.648
-7.5911   1.32682 1.805  11.44
-16.7662  3.98068 1      12.276
-7.70286  1.21638 1.617  13.42
-11.97328 0       1      17.996
"""

_TELEPHOTO_250 = """
54.6275  12.52   1.529 47.5
-86.365  3.755   1.599 44.5
271.7625 2.8175  1     41.5
0        67.4125 0     40.5
-32.13   3.755   1.613 31.5
49.5325  12.52   1.603 33.5
-50.945  0       1     37
"""

_FISHEYE_10 = """
30.2249  0.8335  1.62  30.34
11.3931  7.4136  1     20.68
75.2019  1.0654  1.639 17.8
8.3349   11.1549 1     13.42
9.5882   2.0054  1.654 9.02
43.8677  5.3895  1     8.14
0        1.4163  0     6.08
29.4541  2.1934  1.517 5.96
-5.2265  0.9714  1.805 5.84
-14.2884 0.0627  1     5.96
-22.3726 0.94    1.673 5.96
-15.0404 0       1     6.52
"""

# Smith, Modern Lens Design, p. 312; the fifth column is the V-number ("-" for air).
_DGAUSS_100 = """
58.950  7.520  1.670 50.4 47.1
169.660 0.240  1     50.4 -
38.550  8.050  1.670 46.0 47.1
81.540  6.550  1.699 46.0 30.1
25.500  11.410 1     36.0 -
0       9.000  0     34.2 -
-28.990 2.360  1.603 34.0 38.0
81.540  12.130 1.658 40.0 57.3
-40.770 0.380  1     40.0 -
874.130 6.440  1.717 40.0 48.0
-79.460 72.228 1     40.0 -
"""

# An invented lens: it has both spellings of a plane, a radius of 0 that is glass and not the stop, and a singlet strong
# enough for total reflection and misses.
_PLANAR = """
inf 3   1.5168 36
0   1.5 1      36
16  7   1.805  22
-40 2.5 1      20
0   4   0      12
inf 2.5 1.62   18
-30 0   1      18
"""

# An invented and poor lens: its glass has a negative thickness more than 6.2 mm from the axis, within the clear
# diameter, so that rays there meet the next interface behind themselves.
_CROSSED = """
20  2 1.6 24
-20 3 1   24
0   3 0   18
"""


@dataclass(frozen=True)
class Row:
    radius: float  # inf for a plane
    thickness: float
    index: float  # behind the interface, 1 for air
    diameter: float
    abbe: float | None = None


@dataclass(frozen=True)
class Lens:
    name: str
    rows: tuple[Row, ...]
    wavelength: float = D_LINE

    @property
    def stop(self) -> int:
        for k, row in enumerate(self.rows):
            before = self.rows[k - 1].index if k else 1.0
            if isinf(row.radius) and before == 1.0 and row.index == 1.0:
                return k
        raise ValueError(f"{self.name} has no stop")

    def at(self, wavelength: float) -> "Lens":
        """Returns the lens with its indices at another wavelength (nm)."""
        rows = tuple(
            row if row.abbe is None else Row(row.radius, row.thickness, two_numbers(row.index, row.abbe, wavelength),
                                            row.diameter, row.abbe)
            for row in self.rows)
        return Lens(self.name, rows, wavelength)


# The partial dispersions of glasses by their Abbe numbers, as in crates/optics/src/prescription/glass/two_numbers.rs.
_FITTED = (-0.2555, 1.583, -0.2678, 25.43)


def two_numbers(n_d: float, abbe: float, wavelength: float) -> float:
    """Returns the index by n_d and V: n_F - n_C = (n_d - 1) / V, with the partial dispersions of glasses with that
    V."""
    if wavelength == D_LINE:
        return n_d  # not to lose the last bit of the catalogue value

    def basis(nanometres: float) -> tuple[float, float, float]:
        square = (nanometres * 1e-3) ** 2
        return 1.0 / square, square, 1.0 / (square - 0.028)

    inverse = 1.0 / min(max(abbe, 17.0), 96.0)
    here, d, f, c = (basis(line) for line in (wavelength, D_LINE, F_LINE, C_LINE))
    cauchy = (here[0] - d[0]) / (f[0] - c[0])
    line, pole = (here[i] - d[i] - (f[i] - c[i]) * cauchy for i in (1, 2))
    p0, p1, q0, q1 = _FITTED
    return n_d + (n_d - 1.0) / abbe * (cauchy + (p0 + p1 * inverse) * line + (q0 + q1 * inverse) * pole)


def _parse(name: str, text: str) -> Lens:
    rows = []
    for line in text.split("\n"):
        field = line.split()
        if not field:
            continue
        radius, thickness, index, diameter = map(float, field[:4])
        abbe = float(field[4]) if len(field) > 4 and field[4] != "-" else None
        rows.append(Row(radius if radius != 0.0 else inf, thickness, index if index != 0.0 else 1.0, diameter, abbe))
    return Lens(name, tuple(rows))


LENSES = {
    name: _parse(name, text)
    for name, text in {
        "dgauss.50mm": _DGAUSS_50,
        "wide.22mm": _WIDE_22,
        "telephoto.250mm": _TELEPHOTO_250,
        "fisheye.10mm": _FISHEYE_10,
        "dgauss.100mm": _DGAUSS_100,
        "planar": _PLANAR,
        "crossed": _CROSSED,
    }.items()
}

SYNTHETIC = {"planar": ("Synthetic: planar glass (inf and 0), a strong singlet, a stop", _PLANAR),
             "crossed": ("Synthetic: a singlet whose surfaces cross within the clear diameter", _CROSSED)}
REAL_LENSES = [name for name in LENSES if name not in SYNTHETIC]


def lens_file(name: str) -> str:
    """Returns a synthetic lens as a four-column file."""
    remark, text = SYNTHETIC[name]
    rows = ["\t".join(line.split()) for line in text.strip().split("\n")]
    return "\n".join([f"# {remark}", "# radius\tsep\tn\taperture", *rows]) + "\n"


def configurations() -> list[Lens]:
    """Returns every lens at n_d, and the lens with V-numbers also at the F and C lines."""
    found = list(LENSES.values())
    return found + [LENSES["dgauss.100mm"].at(w) for w in (F_LINE, C_LINE)]
