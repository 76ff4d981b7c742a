"""The sensor: one class per variant of Mitsuba, because the variants' types differ."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import drjit as dr
import mitsuba as mi
import numpy as np

from ..camera import Camera
from ..errors import ParameterError, quietly
from ..lens import Lens
from ..parameters import INSTEAD_OF
from .dispersion import WAVELENGTHS, amounts, carried, landing
from .properties import parameters_of
from .tracing import AIM, COLUMNS, DOWN, RAY, RIGHT, Tracer, aim, aim_one

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Mitsuba's cameras have +x to the left of the picture.
_MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])


def sensor_class(model: str | None) -> type:
    """Returns the class of the sensors of Mitsuba's current variant; `model` as in `parameters_of`."""
    scalar = mi.variant().startswith("scalar")
    # This type accepts mi.Float and the numbers of Python and NumPy, and keeps double precision.
    number = dr.scalar.ArrayXf64 if scalar else mi.Float64

    class RealisticSensor(mi.Sensor):  # type: ignore[misc]
        """A camera with a real lens. Traces rays in the sensor's own space; Mitsuba transforms them to the scene."""

        def __init__(self, props: Any) -> None:
            super().__init__(props)
            self.m_needs_sample_2 = self.m_needs_sample_3 = True
            self.to_world: Any = mi.Transform4f(self.m_to_world)
            poses = {name: props[name] for name in ("to_world", "to_world_end") if name in props}
            parameters, own = parameters_of(props, model)
            parameters.setdefault("weighting", "relative")
            self.parameters = parameters
            self.differentials = own.get("differentials", True)
            self.tolerance = own.get("dispersion_tolerance", 1.0)
            self.near, self.far = parameters.get("hither", 1e-3), parameters.get("yon", 1e30)
            self.end = _end(poses)
            self._take(self._built(parameters))
            self.zooms = _zooms(self.camera)
            self.shown = {name: number([value]) for name, value in self._values().items()}

        def _built(self, parameters: dict[str, Any]) -> Camera:
            width, height = self.film().size()
            end = None if self.end is None else self.end @ _MIRROR
            return Camera(
                resolution=(int(width), int(height)),
                camera_to_world=_MIRROR,
                camera_to_world_end=end,
                **parameters,
            )

        def _take(self, camera: Camera) -> None:
            """Sets the sensor's camera."""
            self.camera, self.tracer = camera, Tracer(camera)
            # A camera with a given wavelength treats all light as light of that wavelength.
            self.disperses = mi.is_spectral and "wavelength" not in camera.parameters and disperses(camera)
            if self.disperses:
                self.nearness = _nearness(camera)

        def _values(self) -> dict[str, float]:
            """Returns the parameters of this camera that `mi.traverse` shows, with their values."""
            camera, given = self.camera, self.camera.parameters
            found = {
                "focus_distance": camera.focus_distance_mm / given.get("mm_per_unit", 1.0),
                "film_distance": camera.film_distance,
                "fnumber": camera.fnumber,
                "film_diagonal": camera.film_diagonal,
            }
            if self.zooms:
                found["zoom"] = _lens_of(camera).focal_length_mm
            if given.get("shutter") == "leaf":
                found["shutter_ramp"] = given.get("shutter_ramp", 0.25)
            if given.get("shutter") == "focal-plane":
                found["shutter_slit"] = given.get("shutter_slit", 0.25)
            return found

        def sample_ray(self, time: Any, sample1: Any, sample2: Any, sample3: Any, active: Any = True) -> Any:
            """Returns a ray and its weight."""
            ray, weight, _, _ = self._rays(time, sample1, sample2, sample3, False)
            return ray, weight

        def sample_ray_differential(
            self, time: Any, sample1: Any, sample2: Any, sample3: Any, active: Any = True
        ) -> Any:
            """Returns a ray with its neighbours one pixel to the right and one pixel down, and its weight."""
            ray, weight, right, down = self._rays(time, sample1, sample2, sample3, self.differentials)
            found = mi.RayDifferential3f(ray)
            if self.differentials:
                found.o_x, found.d_x = right
                found.o_y, found.d_y = down
                found.has_differentials = True
            return found, weight

        def _rays(self, time: Any, sample1: Any, sample2: Any, sample3: Any, differentials: bool) -> Any:
            film = self.film()
            size, offset = film.crop_size(), film.crop_offset()
            samples = [
                sample2.x * float(size.x) + float(offset.x),
                sample2.y * float(size.y) + float(offset.y),
                sample3.x,
                sample3.y,
                self._fraction(time),
            ]
            wavelengths, response = self.sample_wavelengths(dr.zeros(mi.SurfaceInteraction3f), sample1)
            if self.disperses:
                columns, weight = self._dispersed(samples, sample1, wavelengths, response)
            else:
                columns = self._traced(samples, differentials)
                weight = response * columns[RAY][6]
            found = mi.Ray3f(*self._in_scene(columns[RAY]), time, wavelengths)
            found.maxt = mi.Float(self.far - self.near)
            neighbours = [self._in_scene(columns[at]) if differentials else None for at in (RIGHT, DOWN)]
            return found, weight, *neighbours

        def _dispersed(self, samples: list[Any], number: Any, wavelengths: Any, response: Any) -> tuple[list[Any], Any]:
            """Returns the columns of the hero's ray with its neighbours, and the weight of each wavelength."""
            traced = [
                self._traced([*samples, dr.clip(wavelength, *WAVELENGTHS)], k == 0)
                for k, wavelength in enumerate(wavelengths)
            ]
            rays = [columns[RAY] for columns in traced]
            neighbours = [traced[0][at] for at in (RIGHT, DOWN)]
            weights = [ray[6] for ray in rays]
            plain = mi.unpolarized_spectrum(response)
            spectral = mi.has_flag(self.film().flags(), mi.FilmFlags.Spectral)
            positions, known = landing(self._point_in_focus, rays, *neighbours)
            each = amounts(spectral, wavelengths, plain)
            heroes, factors = carried(weights, positions, known, each, number, self.tolerance)

            # If all four are blocked, the first represents them.
            hero = list(rays[0][:7])
            for chosen, ray in zip(heroes[1:], rays[1:]):
                hero = [dr.select(chosen, other, own) for other, own in zip(ray, hero)]
            for neighbour in neighbours:
                # The step to a neighbour is that at the first wavelength. At the other wavelengths it differs by the
                # lens's lateral colour, about a thousandth.
                hero += [here + (b - a) for here, a, b in zip(hero[:6], rays[0][:6], neighbour[:6])] + [neighbour[6]]
            weight = mi.UnpolarizedSpectrum(0.0)
            for k, factor in enumerate(factors):
                weight[k] = weights[k] * factor
            return hero, response * weight

        def _point_in_focus(self, ray: Any) -> Any:
            """Returns the point that represents a ray: its point on the plane in focus, divided by the plane's distance
            from the front vertex; for a plane at infinity, the ray's direction, scaled to z = 1."""
            origin, direction = mi.Vector3f(*ray[:3]), mi.Vector3f(*ray[3:6])
            forward = dr.maximum(direction.z, 0.1)
            return self.nearness * origin + direction * ((1 - self.nearness * origin.z) / forward)

        def _traced(self, samples: list[Any], differentials: bool) -> list[Any]:
            """Returns the columns of rays, as many as `COLUMNS` states."""
            if scalar:
                return self.tracer.trace_one(samples, differentials)
            return self._columns(self.tracer.trace, samples, COLUMNS[differentials])

        def _columns(self, call: Any, samples: list[Any], count: int) -> list[Any]:
            """Returns the columns that a call writes through NumPy into memory that Dr.Jit owns and reuses."""
            if dr.flag(dr.JitFlag.FreezingScope) or dr.flag(dr.JitFlag.SymbolicScope):
                raise RuntimeError(
                    "the sensor realistic traces its rays outside of Dr.Jit's kernels: it cannot be asked for rays within "
                    'dr.freeze, in a recorded loop or by the sensor "batch"; for "ptracer", whose loop is recorded otherwise, '
                    "render with dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, False)"
                )
            samples = [dr.detach(mi.Float(column)) for column in samples]
            dr.eval(samples)
            n = max(dr.width(column) for column in samples)
            given = [column.numpy() if len(column) == n else np.full(n, column[0], np.float32) for column in samples]
            columns = [dr.empty(mi.Float, n) for _ in range(count)]
            call(given, [column.numpy() for column in columns], dr.thread_count())
            return columns

        def sample_direction(self, it: Any, sample: Any, active: Any = True) -> Any:
            """Samples a direction from a scene point toward the lens; returns the direction, and the importance divided
            by the density."""
            inside = self.to_world.inverse() @ mi.Point3f(it.p)
            given = [inside.x, inside.y, inside.z, sample.x, sample.y, self._fraction(it.time)]
            columns: Any = (
                aim_one(self.camera, given) if scalar else self._columns(partial(aim, self.camera), given, AIM)
            )
            *front, density, x, y, importance = columns
            film = self.film()
            whole, size, offset = film.size(), film.crop_size(), film.crop_offset()
            u, v = x - float(offset.x), y - float(offset.y)
            seen = (density > 0) & (importance > 0) & (u >= 0) & (v >= 0) & (u < float(size.x)) & (v < float(size.y))
            seen &= active
            found = mi.DirectionSample3f()
            found.delta = False
            forward = mi.Vector3f(0, 0, 1)
            front = [dr.select(seen, column, 0.0) for column in front]
            toward = dr.select(seen, mi.Vector3f(*front[3:]), -forward)
            # Objects between the lens and the points where rays start do not occlude.
            found.p = self.to_world @ mi.Point3f(mi.Vector3f(*front[:3]) - self.near * toward)
            found.n = mi.Normal3f(self.to_world @ forward)
            found.d = self.to_world @ toward
            found.dist = dr.norm(found.p - it.p)
            found.uv = mi.Point2f(dr.select(seen, u, 0.0), dr.select(seen, v, 0.0))
            found.time = it.time
            found.pdf = dr.select(seen, density, 0.0)
            # Mitsuba divides by the number of pixels of the crop window; the camera's importance is per pixel of the
            # whole picture.
            pixels = float(whole.x) * float(whole.y) / (float(size.x) * float(size.y))
            return found, mi.Spectrum(dr.select(seen, pixels * importance / dr.select(seen, density, 1.0), 0.0))

        def _fraction(self, time: Any) -> Any:
            """Returns the time as a fraction of the shutter's interval."""
            interval = self.shutter_open_time()
            return (time - self.shutter_open()) / interval if interval > 0 else 0.0

        def _in_scene(self, columns: Any) -> tuple[Any, Any]:
            """Returns the point where a ray begins in the scene, and its direction."""
            forward = mi.Vector3f(*columns[3:6])
            return self.to_world @ mi.Point3f(mi.Vector3f(*columns[:3]) + self.near * forward), self.to_world @ forward

        def traverse(self, callback: Any) -> None:
            """Lists the parameters that Mitsuba may change."""
            super().traverse(callback)
            callback.put("to_world", self.to_world, mi.ParamFlags.Differentiable)
            for name, value in self.shown.items():
                callback.put(name, value, mi.ParamFlags.NonDifferentiable)

        def parameters_changed(self, keys: list[str]) -> None:
            """Applies assigned parameters: builds another camera if the film or the lens changed.

            Raises
            ------
            realistic.Error
                With the library's message, if there is no such camera; the sensor and its values then stay unchanged.
            """
            super().parameters_changed(keys)
            self.m_to_world = self.to_world
            before = self._values()
            try:
                shown = {name: _single(name, value) for name, value in self.shown.items()}
                changed = {
                    name: value for name, value in shown.items() if value != before[name] and not math.isnan(value)
                }
                if not changed and tuple(self.film().size()) == self.camera.resolution:
                    return
                parameters = dict(self.parameters)
                for name in changed:
                    for displaced in INSTEAD_OF.get(name, ()):
                        parameters.pop(displaced, None)
                parameters |= {name: repr(value) if name == "zoom" else value for name, value in changed.items()}
                self._take(self._built(parameters))
                self.parameters = parameters
            finally:
                for name, value in self._values().items():
                    mi.set_property(self.shown[name], number([value]))

        def bbox(self) -> Any:
            """Returns a box around the front vertex alone."""
            box = mi.BoundingBox3f if scalar else mi.ScalarBoundingBox3f
            return box(mi.ScalarPoint3f(*np.ravel(self.to_world.translation()).tolist()))

        def to_string(self) -> str:
            return f"RealisticSensor[\n  camera = {self.camera},\n  to_world = {self.to_world}\n]"

    return RealisticSensor


def _single(name: str, value: Any) -> float:
    """Returns the number assigned to a parameter.

    Raises
    ------
    ValueError
        For anything but one number.
    """
    numbers = np.ravel(value)
    if len(numbers) != 1:
        raise ValueError(f'"{name}" takes one number, such as 8.0 or mi.Float(8.0), not {len(numbers)}')
    return float(numbers[0])


def _lens_of(camera: Camera, **changes: Any) -> Lens:
    """Returns a camera's lens with some parameters changed; if it focuses by moving groups, as focused at infinity."""
    given = {**camera.parameters, **changes}
    names = ("lens_file", "lens_text", "glass_catalog", "zoom", "wavelength", "aperture_diameter", "fnumber")
    # The camera has given these warnings already.
    with quietly():
        return Lens(**{name: given[name] for name in names if name in given})


def _zooms(camera: Camera) -> bool:
    """Whether a camera's lens has more than one focal length."""
    try:
        _lens_of(camera, zoom=repr(_lens_of(camera).focal_length_mm))
    except ParameterError:
        return False
    return True


def _nearness(camera: Camera) -> float:
    """Returns the inverse of the distance from the front vertex to the plane in focus, per world unit; 0 if nothing is
    in focus."""
    distance = camera.focus_distance_mm - camera.film_distance + _lens_of(camera).rear_vertex_mm
    return camera.parameters.get("mm_per_unit", 1.0) / distance if distance > 0 else 0.0


def disperses(camera: Camera) -> bool:
    """Whether rays of different wavelengths take different paths."""
    width, height = camera.resolution
    film = np.array([[0.5, 0.5], [0.7, 0.6], [0.9, 0.9]]) * [width, height]
    lens = [[0.5, 0.5], [0.2, 0.4], [0.6, 0.9]]
    low, high = (camera.rays(film[:, None], lens, wavelengths=wavelength) for wavelength in WAVELENGTHS)
    return not np.array_equal(low.direction, high.direction)


def _end(poses: dict[str, Any]) -> NDArray[np.float64] | None:
    """Returns a moving camera's pose at shutter close, in the sensor's space at shutter open; None for a still one."""
    matrices = {}
    for name, pose in poses.items():
        if not hasattr(pose, "has_scale") or np.shape(pose.matrix) != (4, 4):
            raise ValueError(f'property "{name}" must be a transform, not {pose!r}')
        if pose.has_scale():
            raise ValueError(f'property "{name}" must not scale; the length of a unit is "mm_per_unit"')
        matrices[name] = np.array(pose.matrix, np.float64)
    if "to_world_end" not in matrices:
        return None
    begin = matrices.get("to_world", np.eye(4))
    return np.asarray(np.linalg.solve(begin, matrices["to_world_end"]), np.float64)
