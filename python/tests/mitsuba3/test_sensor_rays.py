"""The sensor's rays are those of the camera."""

import numpy as np
import pytest

import realistic

# Mitsuba has +x to the left.
MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])
SIZE = (384, 256)


def film(**more):
    return {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], **more}


def rays_of(mi, sensor, time, picture, lens):
    """Traces samples (n,), (2, n), (2, n); returns o, d, o_x, d_x, o_y, d_y (n, 3); maxt, time, weight (n,)."""
    names = ("o", "d", "o_x", "d_x", "o_y", "d_y", "maxt", "time")
    if mi.variant().startswith("scalar"):
        found = [
            sensor.sample_ray_differential(
                float(t), 0.5, mi.Point2f(float(x), float(y)), mi.Point2f(float(u), float(v))
            )
            for t, x, y, u, v in zip(time, *picture, *lens)
        ]
        arrays = [np.array([getattr(ray, name) for ray, _ in found]) for name in names]
        return (*arrays, np.array([np.array(weight)[0] for _, weight in found]))
    ray, weight = sensor.sample_ray_differential(mi.Float(time), mi.Float(0.5), mi.Point2f(picture), mi.Point2f(lens))
    assert ray.has_differentials
    arrays = [np.broadcast_to(np.array(getattr(ray, name)).T, (len(time), 3)) for name in names[:6]]
    arrays += [np.broadcast_to(np.array(getattr(ray, name)), len(time)) for name in names[6:]]
    response = sensor.sample_wavelengths(mi.SurfaceInteraction3f(), mi.Float(0.5))[1] if mi.is_spectral else [1.0]
    return (*arrays, np.array(weight)[0] / np.array(response)[0])


def samples(n=400, seed=1):
    numbers = np.random.default_rng(seed).random((5, n), np.float32)
    return numbers[0], numbers[1:3], numbers[3:5]


@pytest.mark.parametrize(
    "properties",
    [
        {"lens_file": "dgauss.50mm", "focus_distance": 1000.0},
        # Some film points of this camera get no light.
        {"lens_file": "fisheye.10mm", "film_diagonal": 40.0, "pupil": "rear", "mm_per_unit": 1000.0},
        {
            "lens_file": "wide.22mm",
            "focus_distance": 700.0,
            "fnumber": 8,
            "weighting": "radiometric",
            "far_clip": 5000.0,
        },
    ],
)
def test_rays_are_those_of_the_camera_in_the_crop_window(mi, properties):
    pose = mi.ScalarTransform4f().look_at(origin=[1, 2, 3], target=[5, 3, 9], up=[0, 1, 0.2])
    crop = {"crop_width": 100, "crop_height": 80, "crop_offset_x": 270, "crop_offset_y": 40}
    sensor = mi.load_dict({"type": "realistic", "to_world": pose, "film": film(**crop), **properties})
    time, picture, lens = samples()
    o, d, o_x, d_x, o_y, d_y, maxt, _, weight = rays_of(mi, sensor, 0 * time, picture, lens)
    parameters = {{"far_clip": "yon"}.get(name, name): value for name, value in properties.items()}
    camera = realistic.Camera(
        resolution=SIZE, camera_to_world=np.array(pose.matrix) @ MIRROR, **{"weighting": "relative", **parameters}
    )
    rays = camera.rays(picture.T * [100, 80] + [270, 40], lens.T, differentials=True)
    passed = rays.weight > 0
    assert 20 < passed.sum()
    np.testing.assert_allclose(weight, rays.weight, rtol=2e-5)
    np.testing.assert_allclose(maxt, camera.parameters.get("yon", 1e30), rtol=1e-4)
    for origin, direction, expected in ((o, d, rays), (o_x, d_x, rays.rx), (o_y, d_y, rays.ry)):
        start = expected.origin + 1e-3 * expected.direction
        np.testing.assert_allclose(origin[passed], start[passed], atol=3e-5)
        np.testing.assert_allclose(direction[passed], expected.direction[passed], atol=1e-6)
    # A blocked ray and its neighbours have directions that fit the film point.
    for origin, direction in ((o, d), (o_x, d_x), (o_y, d_y)):
        assert np.isfinite(origin).all()
        np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1, rtol=1e-5)


def angles(a, b):
    """Returns the angles between unit vectors, radians."""
    return 2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=1) / 2, 0, 1))


@pytest.mark.parametrize(
    "properties",
    [
        {"lens_file": "wide.22mm", "pupil": "rear"},
        {"lens_file": "dgauss.50mm", "shutter": "focal-plane", "shutter_slit": 0.1, "shutter_close": 1.0},
        # Film points beyond 13.4 mm from the axis get no light.
        {"lens_file": "fisheye.10mm", "film_diagonal": 32.0},
        {"model": "thin"},
    ],
)
def test_a_blocked_ray_has_the_direction_of_its_film_point(mi, properties):
    sensor = mi.load_dict({"type": "realistic", "focus_distance": 1000.0, "film": film(), **properties})
    time, picture, lens = samples(n=100)
    o, d, _, d_x, _, d_y, _, _, weight = rays_of(mi, sensor, time, picture, lens)
    camera = realistic.Camera(
        properties.get("lens_file"),
        model=properties.get("model"),
        film_diagonal=properties.get("film_diagonal"),
        focus_distance=1000.0,
        resolution=SIZE,
        camera_to_world=MIRROR,
    )
    chief = camera.rays(picture.T * SIZE, [0.5, 0.5], differentials=True)
    lit = chief.weight > 0
    blocked = (weight == 0) & lit
    if "thin" in properties.values():
        assert not blocked.any()
    elif "film_diagonal" not in properties:
        assert blocked.sum() > 20
    same = 1e-5 if not mi.is_spectral else 2e-3
    assert angles(d[blocked], chief.direction[blocked]).max(initial=0) < same
    dark = ~lit
    assert dark.any() == ("film_diagonal" in properties)
    # The expected rays are those of a pinhole with the lens's focal length, computed here; Mitsuba's +x is to the left.
    per_pixel = camera.film_diagonal / np.hypot(*SIZE) / camera.focal_length_mm
    for found, step in ((d, (0, 0)), (d_x, (1, 0)), (d_y, (0, 1))):
        x, y = (picture.T[dark] * SIZE + step - np.array(SIZE) / 2).T * per_pixel
        pinhole = np.stack([-x, -y, np.ones(len(x))], axis=1)
        pinhole /= np.linalg.norm(pinhole, axis=1, keepdims=True)
        assert angles(found[dark], pinhole).max(initial=0) < 1e-5
    assert np.abs(o[dark] - 1e-3 * d[dark]).max(initial=0) < 1e-6


def test_a_shutter_and_a_camera_that_moves(mi):
    T = mi.ScalarTransform4f
    begin = T().look_at(origin=[1, 2, 3], target=[5, 3, 9], up=[0, 1, 0])
    end = T().look_at(origin=[3, 2, 3], target=[5, 3, 9], up=[0, 1, 0.5])
    shutter = {"shutter_open": 2.0, "shutter_close": 5.0, "shutter": "focal-plane", "shutter_slit": 0.5}
    sensor = mi.load_dict({"type": "realistic", "to_world": begin, "to_world_end": end, "film": film(), **shutter})
    fraction, picture, lens = samples()
    o, d, *_, time, weight = rays_of(mi, sensor, 2 + 3 * fraction, picture, lens)
    camera = realistic.Camera(
        resolution=SIZE,
        weighting="relative",
        camera_to_world=np.array(begin.matrix) @ MIRROR,
        camera_to_world_end=np.array(end.matrix) @ MIRROR,
        shutter_open=2.0,
        shutter_close=5.0,
        shutter="focal-plane",
        shutter_slit=0.5,
    )
    rays = camera.rays(picture.T * SIZE, lens.T, fraction)
    passed = rays.weight > 0
    assert 0.2 < passed.mean() < 0.8
    # At an edge of the shutter, rounding of the time may decide.
    same = passed == (weight > 0)
    assert same.mean() > 0.98
    passed &= same
    np.testing.assert_allclose(time, 2 + 3 * fraction, rtol=1e-6)
    np.testing.assert_allclose(o[passed], (rays.origin + 1e-3 * rays.direction)[passed], atol=1e-5)
    np.testing.assert_allclose(d[passed], rays.direction[passed], atol=2e-6)


def test_thick_is_the_thick_lens(mi):
    time, picture, lens = samples()
    thick, named, real = (
        rays_of(mi, mi.load_dict({"film": film(), **kind}), 0 * time, picture, lens)
        for kind in ({"type": "thick"}, {"type": "realistic", "model": "thick"}, {"type": "realistic"})
    )
    for a, b in zip(thick, named):
        np.testing.assert_array_equal(a, b)
    assert np.abs(thick[1] - real[1]).max() > 1e-3


def test_any_number_of_threads_gives_the_same_rays(llvm):
    pytest.importorskip("mitsuba", reason="Mitsuba is not installed (pip install mitsuba)")
    from realistic.mitsuba.tracing import Tracer

    camera = realistic.Camera("dgauss.50mm", resolution=SIZE, pupil="rear")
    numbers = np.random.default_rng(3).random((5, 70_001), np.float32)
    numbers[:2] *= np.float32(SIZE)[:, None]

    def rays(threads, columns=21):
        found = np.zeros((columns, numbers.shape[1]), np.float32)
        tracer.trace(numbers, found, threads)
        return found

    tracer = Tracer(camera)
    one = rays(1)
    blocked = one[6] == 0
    assert 0 < blocked.sum() < len(blocked) and not one[6::7, blocked].any()
    for threads in (2, 3, 64):
        np.testing.assert_array_equal(rays(threads), one)
    np.testing.assert_array_equal(rays(3, columns=7), one[:7])
    for k in (0, 1, 70_000, *np.flatnonzero(blocked)[:3]):
        assert tracer.trace_one(numbers[:, k].tolist(), True) == one[:, k].tolist()


def test_without_differentials_there_are_none(fast):
    mi = fast
    sensor = mi.load_dict({"type": "realistic", "differentials": False})
    ray, _ = sensor.sample_ray_differential(0.0, 0.5, mi.Point2f(0.5), mi.Point2f(0.5))
    assert not ray.has_differentials


def test_gradients_pass_to_the_pose_and_not_through_the_lens(fast):
    import drjit as dr

    mi = fast
    shade = np.linspace(0, 1, 64 * 64 * 3, dtype=np.float32).reshape(64, 64, 3)
    light = {"type": "area", "radiance": {"type": "bitmap", "bitmap": mi.Bitmap(shade), "raw": True}}
    to_world = mi.ScalarTransform4f().translate([0, 0, 4]).rotate([0, 1, 0], 180).scale(3)
    sensor = {
        "type": "realistic",
        "lens_file": "wide.22mm",
        "mm_per_unit": 1000.0,
        "film": {"type": "hdrfilm", "width": 30, "height": 20},
    }
    wall = {"type": "rectangle", "to_world": to_world, "light": light}
    scene = mi.load_dict({"type": "scene", "integrator": {"type": "direct"}, "wall": wall, "camera": sensor})
    parameters = mi.traverse(scene)

    def mean(up):
        parameters["camera.to_world"] = mi.Transform4f().translate(mi.Vector3f(0, up, 0))
        parameters.update()
        return dr.mean(mi.render(scene, parameters, spp=16, seed=1), axis=None)

    step = mi.Float(0.0)
    dr.enable_grad(step)
    dr.backward(mean(step))
    difference = (np.array(mean(mi.Float(0.01))) - np.array(mean(mi.Float(-0.01)))) / 0.02
    np.testing.assert_allclose(np.array(dr.grad(step)), difference.ravel(), rtol=0.02)

    picture = mi.Point2f(dr.linspace(mi.Float, 0.3, 0.7, 8), 0.5)
    dr.enable_grad(picture)
    ray, _ = scene.sensors()[0].sample_ray(0.0, 0.5, picture, mi.Point2f(0.5))
    assert not dr.grad_enabled(ray.d)


def test_recorded_kernels_are_refused(fast):
    """dr.freeze would replay its kernels with the memory of the last call."""
    import drjit as dr

    mi = fast
    film = {"type": "hdrfilm", "width": 6, "height": 4}
    sensor = {"type": "realistic", "film": film}
    one = mi.load_dict(
        {"type": "scene", "integrator": {"type": "path"}, "light": {"type": "constant"}, "sensor": sensor}
    )
    picture = np.array(mi.render(one, spp=1))
    with pytest.raises(RuntimeError, match="frozen function") as caught:
        dr.freeze(lambda: mi.render(one, spp=1))()
    assert "it cannot be asked for rays within dr.freeze" in causes(caught.value)
    np.testing.assert_array_equal(np.array(mi.render(one, spp=1)), picture)


def causes(error):
    """Returns the messages of an exception and of its causes."""
    return "" if error is None else f"{error}\n{causes(error.__cause__ or error.__context__)}"


def test_a_spectral_ray_has_its_own_wavelength(spectral):
    """Tests wavelengths that go alone; test_dispersion.py tests wavelengths that go together."""
    mi = spectral
    kind = {"type": "realistic", "lens_file": "tessar.50mm", "focus_distance": 1000.0, "film": film()}
    sensor = mi.load_dict({**kind, "dispersion_tolerance": 0})
    _time, picture, lens = samples(50)
    colour = np.random.default_rng(4).random(50, np.float32)
    ray, weight = sensor.sample_ray_differential(0.0, mi.Float(colour), mi.Point2f(picture), mi.Point2f(lens))
    wavelengths, _response = sensor.sample_wavelengths(mi.SurfaceInteraction3f(), mi.Float(colour))
    np.testing.assert_array_equal(np.array(ray.wavelengths), np.array(wavelengths))
    weight = np.array(weight)
    assert ((weight > 0).sum(axis=0) == 1).all()
    own = weight.argmax(axis=0)
    hero = np.clip(np.array(wavelengths)[own, np.arange(50)], 380, 780)
    assert np.ptp(hero) > 100
    camera = realistic.Camera(
        "tessar.50mm", focus_distance=1000.0, resolution=SIZE, weighting="relative", camera_to_world=MIRROR
    )
    image_xy = picture.T * SIZE
    rays = camera.rays(image_xy, lens.T, wavelengths=hero)
    np.testing.assert_allclose(np.array(ray.d).T, rays.direction, atol=1e-6)
    for found, step in (((ray.o_x, ray.d_x), [1, 0]), ((ray.o_y, ray.d_y), [0, 1])):
        beside = camera.rays(image_xy + step, lens.T, wavelengths=hero)
        there = np.array(found[1]).T - rays.direction
        expected = beside.direction - rays.direction
        both = (beside.weight > 0) & (np.abs(there).max(axis=1) > 0)
        assert both.mean() > 0.9
        # The step to the neighbours is that at the first wavelength.
        scale = np.linalg.norm(expected[both], axis=1, keepdims=True)
        assert np.abs((there - expected)[both] / scale).max() < 0.01
    # At one wavelength, and without dispersion, a ray carries all four.
    for own in ({**kind, "wavelength": 550.0}, {**kind, "model": "thick"}, {**kind, "lens_file": "dgauss.50mm"}):
        _, weight = mi.load_dict(own).sample_ray(0.0, mi.Float(colour), mi.Point2f(picture), mi.Point2f(lens))
        assert (np.array(weight) > 0).all()
