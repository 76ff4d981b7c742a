"""Compares the written tables with one another; fails if a difference is larger than the limits below.

1. rays_<program>.csv against an exact trace of the same rays.
2. truth_*.csv against both programs: scene rays as they are, film rays through the reversed lens. Blocked rays are
   compared with rayoptics' own verdicts (it has none for turned_back).
3. The exact tracer against itself: every passing film ray, sent back, must return along its line.
4. first_order.csv against y-nu paraxial tracing in 70 digits, and this tracing against exact rays very close to the
   axis.
"""

import csv
import math
from pathlib import Path

import numpy as np
from mpmath import mp, mpf, sqrt

from first_order import QUANTITIES
from lenses import LENSES, REAL_LENSES, Lens, Row, configurations
from programs import optiland_rays, rayoptics_rays
from truth import Interface, back_focus, dot, interfaces, trace

HERE = Path(__file__).parent
# Largest differences allowed: points in mm, directions in radians, first-order data relative to the focal length.
LIMIT_RAY, LIMIT_FIRST_ORDER, LIMIT_EXACT = 1e-10, 1e-12, 1e-45
# optiland solves for the sphere from the start of the ray, and its error grows with the square of that distance: 1e-10
# mm from 1e4 mm away. Moved near the lens, the same rays agree to 2e-14 mm.
FAR_START, LIMIT_FAR = 1e3, 1e-9

failures = []


def report(what: str, value, limit: float):
    value = float(value)
    verdict = "" if value <= limit else "  <-- TOO LARGE"
    print(f"{what:66s} {value:9.2e}{verdict}")
    if verdict:
        failures.append(what)


def read(name: str) -> list[dict]:
    with open(HERE / name, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def turned_round(lens: Lens) -> Lens:
    """Returns the lens seen from the film: z becomes (last vertex's z) - z."""
    rows = []
    for k in reversed(range(len(lens.rows))):
        row = lens.rows[k]
        before = lens.rows[k - 1].index if k else 1.0
        rows.append(Row(row.radius if math.isinf(row.radius) else -row.radius,
                        lens.rows[k - 1].thickness if k else 0.0, before, row.diameter))
    return Lens(lens.name, tuple(rows), lens.wavelength)


def difference(results: np.ndarray, expected: np.ndarray) -> tuple[float, float]:
    delta = np.abs(results - expected)
    return delta[:, :3].max(), delta[:, 3:].max()


def numbers(rows: list[dict], names: str) -> np.ndarray:
    return np.array([[float(row[n] or "nan") for n in names.split(",")] for row in rows])


def check_ray_tables():
    for program in ("optiland", "rayoptics"):
        rows = read(f"rays_{program}.csv")
        for lens in configurations():
            mine = [r for r in rows if r["lens"] == lens.name and float(r["wavelength_nm"]) == lens.wavelength]
            system = interfaces(lens)
            point = direction = mpf(0)
            for row in mine:
                exact = trace(system, [float(row[c]) for c in ("x", "y", "z")],
                              [float(row[c]) for c in ("dx", "dy", "dz")], toward_scene=False)
                assert exact.status == "ok", (lens.name, exact.status)
                point = max(point, *(abs(mpf(float(row[c])) - v) for c, v in zip(("ox", "oy", "oz"), exact.point)))
                direction = max(direction,
                                *(abs(mpf(float(row[c])) - v) for c, v in zip(("ux", "uy", "uz"), exact.direction)))
            label = f"rays_{program} {lens.name} {lens.wavelength} ({len(mine)} rays)"
            report(f"{label}: point, mm", point, LIMIT_RAY)
            report(f"{label}: direction", direction, LIMIT_RAY)


def check_truth_tables():
    for name, lens in LENSES.items():
        last_z = -sum(row.thickness for row in lens.rows[:-1])
        for table, toward_scene in ((f"truth_{name}", True), (f"truth_scene_{name}", False)):
            rows = read(f"{table}.csv")
            rays, expected = numbers(rows, "x,y,z,dx,dy,dz"), numbers(rows, "ox,oy,oz,ux,uy,uz")
            status = [row["status"] for row in rows]
            model = lens
            if toward_scene:
                model = turned_round(lens)
                for array in (rays, expected):
                    array[:, 2] = last_z - array[:, 2]
                    array[:, 5] *= -1.0
            rays[:, 3:] /= np.linalg.norm(rays[:, 3:], axis=1)[:, None]
            ok = np.array([s == "ok" for s in status])
            through, verdicts = rayoptics_rays(model, rays)
            for program, results in (("optiland", optiland_rays(model, rays[ok])), ("rayoptics", through[ok])):
                far = np.abs(rays[ok, 2]) > FAR_START
                point, direction = difference(results[~far], expected[ok][~far])
                report(f"{table} ({(~far).sum()} passing) by {program}: point, mm", point, LIMIT_RAY)
                report(f"{table} ({(~far).sum()} passing) by {program}: direction", direction, LIMIT_RAY)
                if far.any():
                    report(f"{table} ({far.sum()} from afar) by {program}", max(difference(
                        results[far], expected[ok][far])), LIMIT_FAR)
            evaluated = [k for k, s in enumerate(status) if s != "turned_back"]
            wrong = [(k, status[k], verdicts[k]) for k in evaluated if status[k] != verdicts[k]]
            report(f"{table}: other verdicts by rayoptics, of {len(evaluated)}", len(wrong), 0)
            for k, here, there in wrong:
                print(f"    row {k + 1}: {here}, rayoptics {there}")


def check_return():
    for name, lens in LENSES.items():
        system = interfaces(lens)
        worst = mpf(0)
        for row in read(f"truth_{name}.csv"):
            if row["status"] != "ok":
                continue
            origin = [mpf(float(row[c])) for c in ("x", "y", "z")]
            heading = [mpf(float(row[c])) for c in ("dx", "dy", "dz")]
            out = trace(system, origin, heading, toward_scene=True)
            for c, v in zip(("ox", "oy", "oz", "ux", "uy", "uz"), (*out.point, *out.direction)):
                assert abs(mpf(row[c]) - v) < mpf(10) ** -21, (name, row)
            start = [p + u for p, u in zip(out.point, out.direction)]
            back = trace(system, start, [-u for u in out.direction], toward_scene=False)
            assert back.status == "ok"
            away = [a - b for a, b in zip(origin, back.point)]
            length = sqrt(dot(away, away))
            worst = max(worst, *(abs(a / length - u) for a, u in zip(away, back.direction)))
        report(f"truth_{name}: exact trace and back, direction", worst, LIMIT_EXACT)


def transfer(system: list[Interface], y, slope, first: int, last: int):
    """Traces a paraxial ray that meets `first` with this height and slope; returns its height there and its slope
    behind `last`."""
    reduced = slope * system[first].scene_index
    for k in range(first, last + 1):
        if k > first:
            y += reduced / system[k].scene_index * (system[k - 1].vertex - system[k].vertex)
        if not mp.isinf(system[k].radius):
            reduced -= y * (system[k].film_index - system[k].scene_index) / system[k].radius
    return y, reduced / system[last].film_index


def exact_first_order(lens: Lens) -> dict:
    def half(system: list[Interface], stop: int):
        """Returns the focal length, the focal distance and the image of the stop, on the side toward which the light
        travels."""
        end = len(system) - 1
        y, slope = transfer(system, mpf(1), mpf(0), 0, end)
        centre, centre_slope = transfer(system, mpf(0), mpf(1), stop, end)
        rim, rim_slope = transfer(system, system[stop].semi, mpf(0), stop, end)
        pupil = -centre / centre_slope
        return -1 / slope, -y / slope, pupil, 2 * abs(rim + pupil * rim_slope)

    focal, back, exit_position, exit_diameter = half(interfaces(lens), lens.stop)
    _, front, entrance_position, entrance_diameter = half(interfaces(turned_round(lens)),
                                                          len(lens.rows) - 1 - lens.stop)
    values = (focal, back, -front, focal - front, back - focal, -entrance_position, entrance_diameter, exit_position,
              exit_diameter, focal / entrance_diameter)
    return dict(zip(QUANTITIES, values, strict=True))


def check_first_order():
    rows = read("first_order.csv")
    for lens in configurations():
        exact = exact_first_order(lens)
        near = trace(interfaces(lens), (mpf(10) ** -25, 0, 1), (0, 0, -1), toward_scene=False)
        slope = near.direction[0] / near.direction[2]
        crossing = near.point[2] - near.point[0] / slope
        last_z = interfaces(lens)[-1].vertex
        report(f"{lens.name} {lens.wavelength}: exact ray near the axis, back focus",
               abs(last_z - crossing - back_focus(interfaces(lens))) / exact["focal_length"], LIMIT_EXACT)
        report(f"{lens.name} {lens.wavelength}: exact ray near the axis, focal length",
               abs(mpf(10) ** -25 / slope / exact["focal_length"] - 1), LIMIT_EXACT)
        if lens.name not in REAL_LENSES:
            continue
        for program in ("optiland", "rayoptics"):
            mine = [r for r in rows if r["lens"] == lens.name and float(r["wavelength_nm"]) == lens.wavelength
                    and r["program"] == program]
            assert len(mine) == len(QUANTITIES)
            report(f"first_order {lens.name} {lens.wavelength} by {program}",
                   max(abs(mpf(float(r["value_mm"])) - exact[r["quantity"]]) for r in mine) / exact["focal_length"],
                   LIMIT_FIRST_ORDER)


def main():
    check_ray_tables()
    check_truth_tables()
    check_return()
    check_first_order()
    if failures:
        raise SystemExit(f"{len(failures)} differences too large")
    print("all within limits")


if __name__ == "__main__":
    main()
