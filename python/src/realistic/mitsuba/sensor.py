"""The sensor: a class made for each of Mitsuba's variants, whose types differ."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import drjit as dr
import mitsuba as mi
import numpy as np

from ..camera import Camera
from .properties import parameters_of
from .tracing import COLUMNS, DOWN, RAY, RIGHT, trace, trace_one

if TYPE_CHECKING:
    from numpy.typing import NDArray

WAVELENGTHS = (380.0, 780.0)
"""Wavelengths, nm, at which rays can be asked for; Mitsuba's reach a little further, where eyes see nothing."""

# Mitsuba's cameras have +x to the left of the picture.
_MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])


def sensor_class(model: str | None) -> type:
    """The class of the sensors of Mitsuba's current variant; `model` as in `parameters_of`."""
    scalar = mi.variant().startswith("scalar")

    class RealisticSensor(mi.Sensor):  # type: ignore[misc]
        """A camera with a real lens. Its rays are traced in the sensor's own space; Mitsuba's transform does the rest."""

        def __init__(self, props: Any) -> None:
            super().__init__(props)
            self.m_needs_sample_2 = self.m_needs_sample_3 = True
            self.to_world: Any = mi.Transform4f(self.m_to_world)
            poses = {name: props[name] for name in ("to_world", "to_world_end") if name in props}
            parameters, own = parameters_of(props, model)
            parameters.setdefault("weighting", "relative")
            self.parameters = parameters
            self.differentials = own.get("differentials", True)
            self.near, self.far = parameters.get("hither", 1e-3), parameters.get("yon", 1e30)
            self.end = _end(poses)
            self.camera = self._built()
            # With a wavelength of its own the camera takes all light to be of that one.
            self.disperses = mi.is_spectral and "wavelength" not in parameters and disperses(self.camera)

        def _built(self) -> Camera:
            width, height = self.film().size()
            end = None if self.end is None else self.end @ _MIRROR
            return Camera(
                resolution=(int(width), int(height)),
                camera_to_world=_MIRROR,
                camera_to_world_end=end,
                **self.parameters,
            )

        def sample_ray(self, time: Any, sample1: Any, sample2: Any, sample3: Any, active: Any = True) -> Any:
            """A ray and its weight."""
            ray, weight, _, _ = self._rays(time, sample1, sample2, sample3, False)
            return ray, weight

        def sample_ray_differential(
            self, time: Any, sample1: Any, sample2: Any, sample3: Any, active: Any = True
        ) -> Any:
            """A ray with those one pixel to the right and one pixel down, and its weight."""
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
                # All the light of a ray is that of its first wavelength: the others would go another way.
                samples.append(dr.clip(wavelengths[0], *WAVELENGTHS))
                hero = mi.UnpolarizedSpectrum(0.0)
                hero[0] = len(wavelengths)
                response = response * hero
            if scalar:
                columns: Any = trace_one(self.camera, samples, differentials)
            else:
                columns = self._columns(samples, differentials)
            weight = columns[RAY][6]
            lit = weight > 0
            found = mi.Ray3f(*self._in_scene(columns[RAY], lit), time, wavelengths)
            # A blocked ray ends where it begins and meets nothing.
            found.maxt = dr.select(lit, mi.Float(self.far - self.near), 0.0)
            neighbours = [self._neighbour(columns, at, lit) if differentials else None for at in (RIGHT, DOWN)]
            return found, response * weight, *neighbours

        def _columns(self, samples: list[Any], differentials: bool) -> list[Any]:
            """The columns of rays: memory of Dr.Jit's, which it uses again, as NumPy sees it."""
            if dr.flag(dr.JitFlag.FreezingScope) or dr.flag(dr.JitFlag.SymbolicScope):
                raise RuntimeError(
                    "the sensor realistic traces its rays outside of Dr.Jit's kernels: it cannot be asked for rays within "
                    'dr.freeze, in a recorded loop or by the sensor "batch"'
                )
            samples = [dr.detach(mi.Float(column)) for column in samples]
            dr.eval(samples)
            n = max(dr.width(column) for column in samples)
            given = [column.numpy() if len(column) == n else np.full(n, column[0], np.float32) for column in samples]
            columns = [dr.empty(mi.Float, n) for _ in range(COLUMNS[differentials])]
            trace(self.camera, given, [column.numpy() for column in columns], dr.thread_count())
            return columns

        def _fraction(self, time: Any) -> Any:
            """The time as a fraction of the shutter's interval."""
            interval = self.shutter_open_time()
            return (time - self.shutter_open()) / interval if interval > 0 else 0.0

        def _in_scene(self, columns: Any, lit: Any) -> tuple[Any, Any]:
            """Where a ray begins in the scene and its direction; something harmless where it is blocked."""
            x, y, z, *direction = (dr.select(lit, column, mi.Float(0.0)) for column in columns[:5])
            forward = mi.Vector3f(*direction, dr.select(lit, columns[5], mi.Float(1.0)))
            return self.to_world @ mi.Point3f(mi.Vector3f(x, y, z) + self.near * forward), self.to_world @ forward

        def _neighbour(self, columns: Any, at: slice, lit: Any) -> tuple[Any, Any]:
            """The same for a neighbour; the ray itself where that is blocked."""
            here, there = columns[RAY], columns[at]
            passes = there[6] > 0
            return self._in_scene([dr.select(passes, b, a) for a, b in zip(here[:6], there)], lit)

        def traverse(self, callback: Any) -> None:
            """Tells Mitsuba what can be changed."""
            super().traverse(callback)
            callback.put("to_world", self.to_world, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys: list[str]) -> None:
            """Follows the film, whose size may have changed."""
            super().parameters_changed(keys)
            self.m_to_world = self.to_world
            if tuple(self.film().size()) != self.camera.resolution:
                self.camera = self._built()

        def bbox(self) -> Any:
            """Where the front vertex is."""
            box = mi.BoundingBox3f if scalar else mi.ScalarBoundingBox3f
            return box(mi.ScalarPoint3f(*np.ravel(self.to_world.translation()).tolist()))

        def to_string(self) -> str:
            return f"RealisticSensor[\n  camera = {self.camera},\n  to_world = {self.to_world}\n]"

    return RealisticSensor


def disperses(camera: Camera) -> bool:
    """Whether rays of different wavelengths go different ways."""
    width, height = camera.resolution
    film = np.array([[0.5, 0.5], [0.7, 0.6], [0.9, 0.9]]) * [width, height]
    lens = [[0.5, 0.5], [0.2, 0.4], [0.6, 0.9]]
    low, high = (camera.rays(film[:, None], lens, wavelengths=wavelength) for wavelength in WAVELENGTHS)
    return not np.array_equal(low.direction, high.direction)


def _end(poses: dict[str, Any]) -> NDArray[np.float64] | None:
    """Where a camera that moves is when the shutter closes, in the space of the sensor when it opens; None if it stands."""
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
