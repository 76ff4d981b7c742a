"""Compares rays with independent results: pbrt's own cameras, closed forms, brute force."""

import numpy as np
import pytest

from realistic import Camera, Parameters


def stock_cameras(checkout):
    """Reads the cameras of tests/golden/stock_cameras.txt: model, resolution, parameters, camera to world, rays."""
    # The file has pbrt's names, without underscores.
    names = {name.replace("_", ""): name for name in Parameters.__annotations__}
    for line in (checkout / "tests/golden/stock_cameras.txt").read_text().splitlines():
        word, *rest = line.split()
        if word == "camera":
            model, width, height, *settings = rest
            parameters = dict(setting.split("=") for setting in settings)
            parameters = {
                names[name]: [float(n) for n in value.split(",")]
                if "," in value
                else value
                if name == "lensplane"
                else float(value)
                for name, value in parameters.items()
            }
            rows = []
        elif word == "matrix":
            matrix = np.array(rest, float).reshape(4, 4)
        elif word == "ray":
            rows.append([float(number) for number in rest if number != "|"])
            if len(rows) == 5:
                yield model, (int(width), int(height)), parameters, matrix, np.array(rows)


def test_the_stock_models_have_the_rays_of_pbrts_own(checkout):
    cameras = list(stock_cameras(checkout))
    assert len(cameras) == 77
    for model, resolution, parameters, matrix, rows in cameras:
        rows = rows.astype(np.float32)
        camera = Camera(model=model, resolution=resolution, camera_to_world=matrix, **parameters)
        rays = camera.rays(rows[:, 0:2], rows[:, 2:4], rows[:, 4])
        # These cameras use sines and cosines, which differ between C libraries; rays of the others are bit-identical.
        tolerance = 4e-7 if model == "environment" or "lens_radius" in parameters else 0.0
        found = np.column_stack([rays.origin, rays.direction, rays.mint, rays.maxt, rays.time])
        np.testing.assert_allclose(found, rows[:, 5:14], tolerance, tolerance, err_msg=f"{model} {parameters}")
        assert (rays.weight == 1).all()


def lens_grid(side):
    middles = (np.arange(side) + 0.5) / side
    return np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)


def test_a_pinholes_rays_all_weigh_one(samples):
    camera = Camera(model="perspective", resolution=(300, 200))
    assert (camera.rays(*samples(camera, 1000)).weight == 1).all()


@pytest.mark.parametrize("fnumber", [2.5, 4, 11])
def test_the_thin_lens_lights_its_film_by_the_closed_form(fnumber):
    """A corrected lens has, for unit radiance, the axial irradiance π sin² U'; by Abbe's condition sin U' = 1/(2N)."""
    camera = Camera("dgauss.50mm", model="thin", resolution=(301, 201), fnumber=fnumber)
    weight = camera.rays([150.5, 100.5], lens_grid(64)).weight.astype(float)
    assert weight.mean() == pytest.approx(np.pi / (2 * fnumber) ** 2, rel=5e-3)


def test_the_true_pupil_and_the_rear_disk_agree_on_the_light():
    """Compares two ways to integrate over the pupil: all samples pass, or four of five are blocked."""
    camera = Camera("dgauss.50mm", resolution=(300, 200))
    for x in (150.0, 40.0, 2.0):
        means = [
            np.mean(camera.replace(pupil=pupil).rays([x, 30.0], lens_grid(400)).weight, dtype=float)
            for pupil in ("warped", "rear")
        ]
        assert means[0] == pytest.approx(means[1], rel=2e-3)


def test_relative_weights_have_mean_one_on_the_axis():
    camera = Camera("wide.22mm", resolution=(300, 200), weighting="relative")
    # The samples are jittered, because the whole last ring of a uniform grid may fall into the map's narrow blocked
    # margin.
    side = 300
    samples = lens_grid(side) + (np.random.default_rng(1).random((side * side, 2)) - 0.5) / side
    assert camera.rays([150.0, 100.0], samples).weight.mean(dtype=float) == pytest.approx(1, rel=1e-3)


def test_rays_are_unit_vectors_that_meet_in_the_plane_in_focus():
    """dgauss.50mm at f/8: the rays of one film point meet at one object point, 1 m from the film."""
    camera = Camera("dgauss.50mm", resolution=(300, 200), focus_distance=1000.0, fnumber=8)
    rays = camera.rays([150.0, 100.0], lens_grid(20))
    rays = rays[rays.weight > 0]
    np.testing.assert_allclose(np.linalg.norm(rays.direction, axis=1), 1, atol=2e-7)
    # The last vertex lies 32.04 mm behind the first: tests/golden, truth_scene_dgauss.50mm.csv.
    plane = 1000 - camera.film_distance - 32.04
    points = rays.origin + rays.direction * ((plane - rays.origin[:, 2:]) / rays.direction[:, 2:])
    spot = np.sqrt((points[:, :2] ** 2).sum(axis=1).mean())
    at_front = np.sqrt((rays.origin[:, :2] ** 2).sum(axis=1).mean())
    assert spot < 0.02 * at_front


def test_film_and_scene_are_on_opposite_sides():
    """The image's left edge is on the right of a real lens's film, and sees objects on the left."""
    for model in ("lens", "thick", "thin", "perspective"):
        camera = Camera(model=model, resolution=(300, 200))
        right = camera.rays([290.0, 100.0], [0.5, 0.5]).direction
        below = camera.rays([150.0, 190.0], [0.5, 0.5]).direction
        assert right[0] > 0 and below[1] < 0, model
