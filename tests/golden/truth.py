"""Exact sequential ray tracing in 70-digit arithmetic.

Writes truth_<lens>.csv (film to scene), truth_scene_<lens>.csv (scene to film) and the synthetic lenses' files.

Lens space: origin at the front vertex of the first interface, +z toward the scene, +x right, +y up, millimetres. The
lens data are the doubles nearest to the printed decimals, because a program that parses the file has these numbers;
from there on nothing is rounded.

A ray is evaluated at each interface in this order, and the first verdict stands:
  turned_back  its z-direction no longer leads onward
  missed       it does not meet the interface's sphere
  turned_back  the meeting point lies behind the ray's present point
  clipped      the meeting point is farther from the axis than half the clear diameter
  reflected    total internal reflection
Of the ray's two intersections with the sphere, the one that counts is that at which the ray crosses the sphere in the
direction in which it crosses the vertex plane. If that point lies on the hemisphere away from the vertex, there is no
agreed name for the outcome, and the ray is left out of the tables.
"""

import math
import random
from pathlib import Path
from typing import NamedTuple

from mpmath import mp, mpf, sqrt

from lenses import LENSES, SYNTHETIC, Lens, lens_file

mp.dps = 70

HERE = Path(__file__).parent
HALF_FILM_DIAGONAL = 17.5
SMALLEST_MARGIN = mpf(10) ** -9
# Maximum number of rays of each outcome, by direction of travel; for the lens that is made to turn rays back, a much
# smaller number suffices.
SHARES = {"film": {"ok": 280, "clipped": 96, "missed": 12, "reflected": 12, "turned_back": 12},
          "scene": {"ok": 105, "clipped": 45, "missed": 5, "reflected": 5, "turned_back": 5}}
SHARES_CROSSED = {"film": {"ok": 30, "clipped": 10, "missed": 3, "reflected": 3, "turned_back": 20},
                  "scene": {"ok": 30, "clipped": 10, "missed": 3, "reflected": 3, "turned_back": 20}}
MOST_RAYS = {"film": 400, "scene": 150}
FAR_SIDE = "far_side"  # never written
COLUMNS = "x,y,z,dx,dy,dz,ox,oy,oz,ux,uy,uz,status,margin"


class Interface(NamedTuple):
    vertex: mpf
    radius: mpf  # infinite for a plane
    scene_index: mpf
    film_index: mpf
    semi: mpf


class Trace(NamedTuple):
    status: str
    point: tuple | None
    direction: tuple | None
    margin: mpf  # the smallest relative distance to a decision that could have gone the other way
    heights: dict  # distance from the axis at each interface met, by interface number


def interfaces(lens: Lens) -> list[Interface]:
    found, vertex, index = [], mpf(0), mpf(1)
    for row in lens.rows:
        found.append(Interface(vertex, mpf(row.radius), index, mpf(row.index), mpf(row.diameter) / 2))
        vertex -= mpf(row.thickness)
        index = mpf(row.index)
    return found


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def trace(system: list[Interface], origin, direction, toward_scene: bool, clip: bool = True) -> Trace:
    p = tuple(mpf(v) for v in origin)
    d = tuple(mpf(v) for v in direction)
    length = sqrt(dot(d, d))
    d = tuple(v / length for v in d)
    travel_sign = 1 if toward_scene else -1
    margin, heights = mpf(1), {}

    def blocked(status):
        return Trace(status, None, None, margin, heights)

    order = range(len(system))
    for k in reversed(order) if toward_scene else order:
        vertex, radius, scene_index, film_index, semi = system[k]
        margin = min(margin, abs(d[2]))
        if travel_sign * d[2] <= 0:
            return blocked("turned_back")

        scale = abs(p[2] - vertex) + semi
        if mp.isinf(radius):
            t = (vertex - p[2]) / d[2]
            normal = (mpf(0), mpf(0), mpf(travel_sign))
            hit = (p[0] + t * d[0], p[1] + t * d[1], vertex)
        else:
            centre = vertex - radius
            q = (p[0], p[1], p[2] - centre)
            b = dot(q, d)
            # The squared distance of the ray's line from the centre is computed without cancellation, for the sake of
            # the margin.
            closest = tuple(q[i] - b * d[i] for i in range(3))
            disc = radius ** 2 - dot(closest, closest)
            margin = min(margin, abs(disc) / radius ** 2)
            if disc < 0:
                return blocked("missed")
            side = travel_sign if radius > 0 else -travel_sign
            t = side * sqrt(disc) - b
            h = tuple(q[i] + t * d[i] for i in range(3))
            hit = (h[0], h[1], h[2] + centre)
            normal = tuple(travel_sign * v / radius for v in h)  # along the ray

        margin = min(margin, abs(t) / scale)
        if t < 0:
            return blocked("turned_back")
        margin = min(margin, abs(normal[2]))
        if travel_sign * normal[2] <= 0:
            return blocked(FAR_SIDE)

        height = sqrt(hit[0] ** 2 + hit[1] ** 2)
        heights[k] = height
        if clip:
            margin = min(margin, abs(height / semi - 1))
            if height > semi:
                return blocked("clipped")

        before, after = (film_index, scene_index) if toward_scene else (scene_index, film_index)
        if before != after:
            ratio = before / after
            cosine = dot(normal, d)
            squared = 1 - ratio ** 2 * (1 - cosine ** 2)
            margin = min(margin, abs(squared))
            if squared < 0:
                return blocked("reflected")
            bend = sqrt(squared) - ratio * cosine
            d = tuple(ratio * d[i] + bend * normal[i] for i in range(3))
        p = hit
    return Trace("ok", p, d, margin, heights)


def back_focus(system: list[Interface]) -> mpf:
    """Returns the distance from the rear vertex to the paraxial rear focal point, positive toward the film."""
    y, reduced = mpf(1), mpf(0)  # height and n * slope
    for k, face in enumerate(system):
        if k:
            y += reduced / face.scene_index * (system[k - 1].vertex - face.vertex)
        if not mp.isinf(face.radius):
            reduced -= y * (face.film_index - face.scene_index) / face.radius
    return -y / reduced


class Table:
    """Collects rays, and refuses those too close to a decision and those beyond the share of their status."""

    def __init__(self, system, toward_scene, shares):
        self.system, self.toward_scene = system, toward_scene
        self.left, self.rows, self.seen = dict(shares), [], set()

    def try_ray(self, origin, direction) -> Trace:
        found = trace(self.system, origin, direction, self.toward_scene)
        key = (*origin, *direction)
        if (found.status != FAR_SIDE and found.margin > SMALLEST_MARGIN and self.left[found.status] > 0
                and key not in self.seen):
            self.left[found.status] -= 1
            self.seen.add(key)
            self.rows.append((origin, direction, found))
        return found

    def write(self, path: Path):
        lines = [COLUMNS]
        for origin, direction, found in self.rows:
            cells = [f"{v:.17g}" for v in (*origin, *direction)]
            if found.status == "ok":
                cells += [mp.nstr(v, 25, strip_zeros=False) for v in (*found.point, *found.direction)]
            else:
                cells += [""] * 6
            lines.append(",".join(cells + [found.status, f"{float(found.margin):.2e}"]))
        path.write_text("\n".join(lines) + "\n", newline="\n")


def shares(lens: Lens) -> dict:
    return SHARES_CROSSED if lens.name == "crossed" else SHARES


def polar(radius: float, angle: float) -> tuple[float, float]:
    return radius * math.cos(angle), radius * math.sin(angle)


def away(origin, target) -> tuple[float, float, float]:
    return tuple(b - a for a, b in zip(origin, target))


def last_inside(inside, low: float, high: float) -> float | None:
    """Returns the largest value up to which `inside` holds, by bisection; None if the ends do not bracket it."""
    if not inside(low) or inside(high):
        return None
    for _ in range(44):
        middle = (low + high) / 2
        if inside(middle):
            low = middle
        else:
            high = middle
    return low


def aim_at_edges(table: Table, stop: int, entry_z: float, semi: float, origin, heading: float, centre,
                 keep_hidden_stop: bool = False) -> bool:
    """Aims rays from a point at either side of the stop's rim, or else of the whole pupil's edge; returns whether it
    was the stop's rim."""

    def direction(s: float):
        x, y = polar(s, heading)
        return away(origin, (centre[0] + x, centre[1] + y, entry_z))

    def within_stop(s: float) -> bool:
        found = trace(table.system, origin, direction(s), table.toward_scene, clip=False)
        return stop in found.heights and found.heights[stop] <= table.system[stop].semi

    def passes(s: float) -> bool:
        return trace(table.system, origin, direction(s), table.toward_scene).status == "ok"

    rim = last_inside(within_stop, 0.0, 2.0 * semi)
    # If another rim limits the rays before the stop's rim does, rays near the stop's rim would add nothing new.
    if rim is not None and (passes(rim * (1 - 1e-6)) or keep_hidden_stop):
        for offset in (1e-2, 1e-3, 1e-6):
            table.try_ray(origin, direction(rim * (1 - offset)))
            table.try_ray(origin, direction(rim * (1 + offset)))
        return True
    edge = last_inside(passes, 0.0, 2.0 * semi)
    if edge is not None:
        table.try_ray(origin, direction(edge * (1 - 1e-4)))
        table.try_ray(origin, direction(edge * (1 + 1e-4)))
    return False


def film_table(lens: Lens) -> Table:
    system = interfaces(lens)
    rear = system[-1]
    rear_z, semi = float(rear.vertex), float(rear.semi)
    film_z = rear_z - float(back_focus(system))
    rng = random.Random(f"film {lens.name}")
    table = Table(system, True, shares(lens)["film"])

    def film_point(fraction: float, angle: float):
        return (*polar(fraction * HALF_FILM_DIAGONAL, angle), film_z)

    def passing_centre(origin):
        """Returns a middle of the rays that pass from here, as a starting point inside the pupil."""
        hits = []
        for _ in range(150):
            x, y = polar(semi * math.sqrt(rng.random()), math.tau * rng.random())
            if trace(system, origin, away(origin, (x, y, rear_z)), True).status == "ok":
                hits.append((x, y))
            if len(hits) == 12:
                break
        return tuple(sum(c) / len(hits) for c in zip(*hits)) if hits else None

    table.try_ray((0.0, 0.0, film_z), (0.0, 0.0, 1.0))
    table.try_ray((0.0, 0.0, film_z), (0.0, 0.0, 2.5))
    table.try_ray((0.0, 0.0, rear_z - 1e-3), (0.0, 0.0, 1.0))
    table.try_ray((0.0, 0.0, film_z - 1e4), (0.0, 0.0, 1.0))
    table.try_ray((0.25, 0.0, film_z), (0.0, 0.0, 1.0))
    table.try_ray((0.0, -0.25, film_z), (0.0, 0.0, 1.0))

    fractions = (0.0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.8, 0.9, 1.0)
    azimuths = (0.0, 0.61, math.pi / 2, 2.5, 4.0)

    for i, fraction in enumerate(fractions):
        origin = film_point(fraction, azimuths[i % len(azimuths)])
        centre = passing_centre(origin)
        if centre:
            at_stop = 0
            for turn in range(7):
                at_stop += aim_at_edges(table, lens.stop, rear_z, semi, origin, 0.2 + 0.9 * turn, centre,
                                        keep_hidden_stop=turn == 0 and i == 0)
                if at_stop == 3 or turn - at_stop >= 4:
                    break
        # The rim lies on the sphere, not in the vertex plane.
        drop = 0.0 if math.isinf(lens.rows[-1].radius) else (
            lens.rows[-1].radius - math.copysign(math.sqrt(lens.rows[-1].radius ** 2 - semi ** 2),
                                                 lens.rows[-1].radius))
        for scale in (1 - 1e-2, 1 - 1e-4, 1 + 1e-4):
            for heading in (rng.random() * math.tau, math.pi + math.atan2(origin[1], origin[0])):
                x, y = polar(semi * scale, heading)
                table.try_ray(origin, away(origin, (x, y, rear_z - drop)))

    # Search for the rarer outcomes before the ordinary rays use up the places.
    for _ in range(6000):
        if not any(table.left[s] for s in ("missed", "reflected", "turned_back")):
            break
        z = film_z if rng.random() < 0.3 else rear_z - (rear_z - film_z) * rng.random() ** 2 - 0.05
        origin = (*polar(1.6 * HALF_FILM_DIAGONAL * math.sqrt(rng.random()), math.tau * rng.random()), z)
        reach = semi * (1.0 if rng.random() < 0.7 else 4.0)
        x, y = polar(reach * math.sqrt(rng.random()), math.tau * rng.random())
        direction = away(origin, (x, y, rear_z))
        found = trace(system, origin, direction, True)
        if found.status in ("missed", "reflected", "turned_back"):
            table.try_ray(origin, direction)

    for attempt in range(30000):
        if len(table.rows) >= MOST_RAYS["film"] or not (table.left["ok"] or table.left["clipped"]):
            break
        fraction = fractions[attempt % len(fractions)]
        origin = film_point(fraction, rng.choice(azimuths))
        x, y = polar(semi * math.sqrt(rng.random()), math.tau * rng.random())
        if table.left["clipped"] < 20 and table.left["ok"] > 0:
            # Keep the last places of the blocked rays for the end.
            if trace(system, origin, away(origin, (x, y, rear_z)), True).status != "ok":
                continue
        table.try_ray(origin, away(origin, (x, y, rear_z)))
    return table


def scene_table(lens: Lens, film_side: Table) -> Table:
    system = interfaces(lens)
    front = float(system[0].semi)
    rng = random.Random(f"scene {lens.name}")
    table = Table(system, False, shares(lens)["scene"])

    table.try_ray((0.0, 0.0, 100.0), (0.0, 0.0, -1.0))
    table.try_ray((0.0, 0.0, 1e6), (0.0, 0.0, -3.0))
    table.try_ray((0.5, 0.0, 10.0), (0.0, 0.0, -1.0))
    table.try_ray((0.0, -0.5, 10.0), (0.0, 0.0, -1.0))
    for heading in (0.3, 1.9, 4.5):
        aim_at_edges(table, lens.stop, 0.0, front, (0.0, 0.0, 500.0), heading, (0.0, 0.0))
        aim_at_edges(table, lens.stop, 0.0, front, (2.0, 1.0, 50.0), heading, (0.0, 0.0))

    for _ in range(3000):
        if not any(table.left[s] for s in ("missed", "reflected", "turned_back")):
            break
        slope, azimuth = 2.5 * rng.random(), math.tau * rng.random()
        direction = (*polar(slope, azimuth), -1.0)
        x, y = polar(1.3 * front * math.sqrt(rng.random()), math.tau * rng.random())
        distance = 10.0 ** rng.uniform(1.0, 2.5)
        origin = (x - distance * direction[0], y - distance * direction[1], distance)
        if trace(system, origin, direction, False).status in ("missed", "reflected", "turned_back"):
            table.try_ray(origin, direction)

    # The rays that left the lens toward the scene, reversed and slightly shifted, enter where the lens can accept them.
    seeds = [found for _, _, found in film_side.rows if found.status == "ok" and found.direction[2] > 0.02]
    for _ in range(6000):
        if len(table.rows) >= MOST_RAYS["scene"] or not (table.left["ok"] or table.left["clipped"]):
            break
        # Once enough rays pass, shift the rays farther.
        shift = 1.0 if table.left["ok"] else 8.0
        seed = rng.choice(seeds)
        u = [float(v) + rng.gauss(0.0, 3e-3 * shift) for v in seed.direction]
        o = [float(v) + rng.gauss(0.0, 0.01 * shift * front) for v in seed.point[:2]] + [float(seed.point[2])]
        distance = 10.0 ** rng.uniform(0.5, 4.0)
        origin = tuple(o[i] + distance * u[i] for i in range(3))
        if origin[2] <= 0.0 or u[2] <= 0.0:
            continue
        table.try_ray(origin, tuple(-v * 2.0 ** rng.randint(-1, 1) for v in u) if rng.random() < 0.2
                      else tuple(-v for v in u))
    return table


def main():
    for name in SYNTHETIC:
        (HERE / f"{name}.dat").write_text(lens_file(name), newline="\n")
    for name, lens in LENSES.items():
        film_side = film_table(lens)
        film_side.write(HERE / f"truth_{name}.csv")
        scene_side = scene_table(lens, film_side)
        scene_side.write(HERE / f"truth_scene_{name}.csv")
        for label, table in (("film", film_side), ("scene", scene_side)):
            count = {}
            for _, _, found in table.rows:
                count[found.status] = count.get(found.status, 0) + 1
            smallest = min(float(found.margin) for _, _, found in table.rows)
            print(f"{name:16s} {label:5s} {len(table.rows):4d} rays, smallest margin {smallest:.1e}: {count}",
                  flush=True)


if __name__ == "__main__":
    main()
