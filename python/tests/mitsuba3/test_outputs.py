"""Outputs of integrators other than light: tests which of them a ray's weight multiplies, and their values for blocked
rays."""

import numpy as np
import pytest

import realistic

MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])
SIZE = (24, 16)
FAR = 900.0
SCALE = 4000.0
SAMPLES = 4096
# This camera blocks most rays, and some film points get no light.
LENS = {"lens_file": "dgauss.50mm", "film_diagonal": 65.0, "pupil": "rear", "focus_distance": 1000.0}


def scene_of(mi, integrator, sensor):
    """Makes a wall across the whole view; its texture coordinates go from 0 to 1 over twice `SCALE`."""
    shown = {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    to_world = mi.ScalarTransform4f().translate([0, 0, FAR]).rotate([0, 1, 0], 180).scale(SCALE)
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": integrator,
            "light": {"type": "constant"},
            "wall": {"type": "rectangle", "to_world": to_world},
            "sensor": {"type": "realistic", "film": shown, **sensor},
        }
    )


def rays_to_the_wall(samples=4000):
    """Returns per pixel (height, width) the mean weight, the share of rays that pass, and their mean wall point."""
    camera = realistic.Camera(
        LENS["lens_file"],
        film_diagonal=LENS["film_diagonal"],
        pupil="rear",
        focus_distance=LENS["focus_distance"],
        weighting="relative",
        resolution=SIZE,
        camera_to_world=MIRROR,
    )
    random = np.random.default_rng(5)
    corner = np.stack(np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1])), axis=-1)[:, :, None]
    rays = camera.rays(corner + random.random((SIZE[1], SIZE[0], samples, 2)), random.random((1, 1, samples, 2)))
    passes = rays.weight > 0
    along = (FAR - rays.origin[..., 2]) / np.where(passes, rays.direction[..., 2], 1)
    points = rays.origin + along[..., None] * rays.direction
    share = passes.mean(axis=2)
    with np.errstate(invalid="ignore"):
        mean = np.where(passes[..., None], points, 0).sum(axis=2) / passes.sum(axis=2)[..., None]
    return rays.weight.mean(axis=2), share, mean


def test_texture_derivatives_are_right_where_rays_are_blocked(fast):
    aovs = {"type": "aov", "aovs": "p:position,x:duv_dx,y:duv_dy"}
    picture = np.array(fast.render(scene_of(fast, aovs, LENS), spp=SAMPLES), np.float64)
    assert picture.shape == (*SIZE[::-1], 7) and np.isfinite(picture).all()
    _, share, points = rays_to_the_wall()
    assert (share == 0).sum() >= 4 and ((share > 0) & (share < 0.5)).sum() > 50
    lit = share > 0.1
    # Mitsuba scales differentials to the distance between samples.
    position, dx, dy = picture[..., :3], SAMPLES**0.5 * picture[..., 3:5], SAMPLES**0.5 * picture[..., 5:7]
    pixel = LENS["film_diagonal"] / np.hypot(*SIZE) / 50.4 * FAR
    assert np.abs(position - points)[lit, :2].max() < 0.25 * pixel
    # Steps to the next pixel's point on the wall, in texture coordinates; u increases toward the world's left.
    steps = (
        np.diff(points, axis=1)[..., :2] / (2 * SCALE) * [-1, 1],
        np.diff(points, axis=0)[..., :2] / (2 * SCALE) * [-1, 1],
    )
    inner = share > 0.3
    for found, step, both in (
        (dx[:, :-1], steps[0], inner[:, :-1] & inner[:, 1:]),
        (dy[:-1], steps[1], inner[:-1] & inner[1:]),
    ):
        size = np.linalg.norm(step[both], axis=1)
        assert (np.linalg.norm(np.abs(found[both]) - np.abs(step[both]), axis=1) < 0.2 * size).all()


@pytest.mark.parametrize("weighting", ["relative", "none"])
def test_the_weight_multiplies_an_integrators_radiance_alone(fast, weighting):
    """Checks the table in docs/mitsuba.md: `depth` returns the distance as radiance."""
    light, depth = (
        np.array(fast.render(scene_of(fast, kind, {**LENS, "weighting": weighting}), spp=SAMPLES), np.float64)[..., 0]
        for kind in ({"type": "path", "max_depth": 1}, {"type": "depth"})
    )
    aovs = {"type": "aov", "aovs": "d:depth,p:position"}
    plain = np.array(fast.render(scene_of(fast, aovs, {**LENS, "weighting": weighting}), spp=SAMPLES), np.float64)
    mean, share, points = rays_to_the_wall()
    lit = share > 0.1
    np.testing.assert_allclose(plain[lit, 0], np.linalg.norm(points, axis=2)[lit], rtol=0.05)
    np.testing.assert_allclose(plain[..., 3], FAR, rtol=1e-5)
    expected = mean if weighting == "relative" else share
    np.testing.assert_allclose((depth / plain[..., 0])[lit], expected[lit], rtol=0.01, atol=0.05)
    assert not light[lit].any()
