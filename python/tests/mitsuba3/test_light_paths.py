"""Directions from the scene toward the lens, and pictures whose paths begin at the lamps."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

WHOLE = {"width": 36, "height": 24}
CROP = {"crop_width": 16, "crop_height": 12, "crop_offset_x": 15, "crop_offset_y": 6}


def sensor_of(mi, film=WHOLE, **properties):
    pose = mi.ScalarTransform4f().look_at(origin=[30, 20, 5], target=[40, -40, 900], up=[0, 1, 0])
    shown = {"type": "hdrfilm", "rfilter": {"type": "box"}, **film}
    kind = {"type": "realistic", "lens_file": "wide.22mm", "focus_distance": 1000.0, "fnumber": 4, "to_world": pose}
    return {**kind, "film": shown, **properties}


def scene_of(mi, sensor, integrator):
    """Loads a scene with a ball on a floor, a lamp in the picture, and a larger lamp above."""
    T = mi.ScalarTransform4f
    white = {"type": "diffuse", "reflectance": 0.6}
    lamp = {"type": "area", "radiance": 3.0}
    down = {"type": "rectangle", "to_world": T().translate([0, 600, 800]).rotate([1, 0, 0], 90).scale(300)}
    up = {"type": "rectangle", "to_world": T().translate([0, -200, 1000]).rotate([1, 0, 0], -90).scale(1500)}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": integrator, "max_depth": 3},
            "sensor": sensor,
            "floor": {**up, "bsdf": white},
            "ball": {"type": "sphere", "center": [60, -20, 900], "radius": 100, "bsdf": white},
            "lamp": {"type": "sphere", "center": [-150, 150, 1300], "radius": 60, "light": lamp},
            "above": {**down, "light": lamp},
        }
    )


@pytest.mark.parametrize("film", [WHOLE, {**WHOLE, **CROP}])
@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "llvm_ad_spectral"])
def test_ptracer_renders_what_path_renders(fast, film, variant):
    import drjit as dr

    mi = fast
    mi.set_variant(variant)
    pictures = {}
    for integrator, spp in (("path", 256), ("ptracer", 64)):
        scene = scene_of(mi, sensor_of(mi, film), integrator)
        with dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, False):
            each = [np.array(mi.render(scene, spp=spp, seed=seed), np.float64).sum(axis=2) for seed in range(16)]
        pictures[integrator] = np.mean(each, axis=0), np.std(each, axis=0, ddof=1) / 4
    (path, spread), (light, other) = pictures["path"], pictures["ptracer"]
    assert abs(light.mean() / path.mean() - 1) < 0.01
    # Pixels at the edge of the lamps get too few paths for a standard error.
    enough = (spread < 0.1 * path) & (other < 0.1 * path)
    assert enough.sum() > 80
    off = (light - path)[enough] / np.hypot(spread, other)[enough]
    assert abs(off.mean()) < 0.25 and off.std() < 1.3 and np.abs(off).max() < 6


def test_directions_reach_the_film_point_that_sends_them(mi):
    """A camera ray, sampled from its far end, returns to its film point in the crop window."""
    film = {"width": 360, "height": 240, **{name: 10 * value for name, value in CROP.items()}}
    sensor = mi.load_dict(sensor_of(mi, film, mm_per_unit=10.0, focus_distance=100.0, shutter_close=2.0, fnumber=22))
    scalar = mi.variant().startswith("scalar")
    numbers = np.random.default_rng(3).random((60, 4))
    # The points avoid the very edge of the window, because beyond it the importance is 0.
    for x, y, u, v in (0.03 + 0.94 * numbers).tolist():
        # With a small stop, rays from the point in focus meet nearly the same film point through all points of the
        # pupil.
        ray, weight = sensor.sample_ray(1.0, 0.5, mi.Point2f(x, y), mi.Point2f(0.5, 0.5))
        far = mi.SurfaceInteraction3f() if scalar else mi.Interaction3f()
        far.p, far.time = ray(100.0), 1.0
        found, importance = sensor.sample_direction(far, mi.Point2f(u, v))
        assert np.ravel(weight)[0] > 0 and np.ravel(found.pdf)[0] > 0 and np.ravel(importance)[0] > 0
        np.testing.assert_allclose(np.ravel(found.uv), [160 * x, 120 * y], atol=1.0)
        toward = np.ravel(found.p) - np.ravel(far.p)
        np.testing.assert_allclose(np.linalg.norm(toward), np.ravel(found.dist)[0], rtol=1e-5)
        np.testing.assert_allclose(toward / np.linalg.norm(toward), np.ravel(found.d), atol=1e-5)
    # The camera sees nothing behind the lens.
    far.p = [30, 20, -50]
    found, importance = sensor.sample_direction(far, mi.Point2f(0.5, 0.5))
    assert np.ravel(found.pdf)[0] == 0 and not np.array(importance).any()


RECORDED = """
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
import realistic.mitsuba
from test_light_paths import scene_of, sensor_of
mi.render(scene_of(mi, sensor_of(mi), "ptracer"), spp=1)
"""


def test_a_recorded_loop_is_refused_with_the_flag_that_helps(fast):
    """Runs in a process of its own: Dr.Jit does not always survive an aborted recording."""
    path = f"{Path(__file__).parent}:{os.environ.get('PYTHONPATH', '')}"
    done = subprocess.run(
        [sys.executable, "-c", RECORDED], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path}
    )
    assert done.returncode != 0
    assert "dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, False)" in done.stderr
