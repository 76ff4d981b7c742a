"""Compares the best-fit pinhole with known cases and with OpenCV."""

import numpy as np
import pytest

from realistic import Camera
from realistic.measure import intrinsics
from realistic.measure.bundles import film_plane, in_camera_space


@pytest.mark.parametrize(
    ("parameters", "fx", "fy", "cx", "cy"),
    [
        # The shorter side, 480 pixels, spans fov: f = 240 / tan(fov / 2).
        ({"fov": 60.0}, 240 / np.tan(np.pi / 6), 240 / np.tan(np.pi / 6), 319.5, 239.5),
        ({"fov": 20.0}, 240 / np.tan(np.pi / 18), 240 / np.tan(np.pi / 18), 319.5, 239.5),
        # The picture's aspect ratio is 4/3, but the frame's is 2, so the picture is stretched.
        ({"fov": 60.0, "frame_aspect_ratio": 2.0}, 160 / np.tan(np.pi / 6), 240 / np.tan(np.pi / 6), 319.5, 239.5),
        # With x from -1 to 2, the axis is at a third of the width.
        ({"fov": 90.0, "screen_window": (-1, 2, -1, 1)}, 640 / 3, 240, 640 / 3 - 0.5, 239.5),
        (
            {"fov": 60.0, "lens_radius": 0.2, "focal_distance": 5.0},
            240 / np.tan(np.pi / 6),
            240 / np.tan(np.pi / 6),
            319.5,
            239.5,
        ),
    ],
)
def test_a_perspective_is_its_own_pinhole(parameters, fx, fy, cx, cy):
    found = intrinsics(Camera(model="perspective", resolution=(640, 480), **parameters))
    np.testing.assert_allclose(found.matrix, [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], rtol=1e-6, atol=1e-4)
    # Shift of the corner by each coefficient, relative to its distance from the middle.
    r = max(np.hypot(320 / fx, 240 / fy), 1e-9)
    np.testing.assert_allclose(found.distortion * r ** np.array([2, 4, 1, 1, 6]), 0, atol=1e-5)
    np.testing.assert_allclose(found.position, 0, atol=1e-6)
    assert found.residual_rms <= found.residual_max < 2e-4
    assert found.coverage == 1
    assert found.distance == pytest.approx(parameters.get("focal_distance", np.inf))


@pytest.mark.parametrize("unit", [1.0, 1000.0])
def test_the_thin_lens_has_its_focal_length_at_infinity(unit):
    camera = Camera("dgauss.50mm", model="thin", resolution=(1920, 1280), mm_per_unit=unit)
    pixel = camera.film_size_mm[0] / 1920
    found = intrinsics(camera)
    assert found.matrix[0, 0] == pytest.approx(camera.focal_length_mm / pixel, rel=1e-6)
    assert found.residual_max < 1e-3
    np.testing.assert_allclose(found.distortion[:2] * [0.1, 0.01], 0, atol=1e-6)


@pytest.mark.parametrize("model", ["lens", "thick", "thin"])
@pytest.mark.parametrize(
    ("lens", "length"), [("dgauss.50mm", 32.04), ("telephoto.250mm", 102.78), ("wide.22mm", 33.37114)]
)
def test_the_film_plane_is_found(model, lens, length):
    """The lenses' lengths, to the last vertex, are those of tests/golden (truth_scene_*.csv)."""
    camera = Camera(lens, model=model, resolution=(300, 200), mm_per_unit=10.0)
    with in_camera_space(camera) as plain:
        found = film_plane(plain)
    assert -found * 10 == pytest.approx(length + camera.film_distance, abs=2e-3)


@pytest.mark.parametrize("lens", ["dgauss.50mm", "wide.22mm", "telephoto.250mm"])
def test_a_real_lens_is_fitted_to_a_fortieth_of_a_pixel(lens):
    camera = Camera(lens, resolution=(1920, 1280))
    found = intrinsics(camera)
    assert found.residual_max < 0.025
    # The lens is rotationally symmetric: no skew of any kind, and square pixels.
    np.testing.assert_allclose(found.distortion[2:4], 0, atol=1e-6)
    assert found.matrix[1, 1] == pytest.approx(found.matrix[0, 0], rel=1e-5)
    np.testing.assert_allclose(found.matrix[:2, 2], [959.5, 639.5], atol=1e-3)
    # The focal length is that of first-order optics, except for the pupil's spherical aberration wide open.
    expected = camera.focal_length_mm * 1920 / camera.film_size_mm[0]
    assert found.matrix[0, 0] == pytest.approx(expected, rel=0.01)
    fewer = [intrinsics(camera, coefficients=n) for n in (0, 2, 4)]
    assert fewer[0].residual_rms > fewer[1].residual_rms >= fewer[2].residual_rms >= found.residual_rms
    assert not fewer[0].distortion.any() and not fewer[1].distortion[2:].any()


def test_rays_of_the_picture_are_projected_where_they_began(samples):
    """Projects a ray's point in the plane of the fit, in OpenCV's axes, back to the ray's pixel."""
    camera = Camera("wide.22mm", resolution=(1920, 1280), focus_distance=2000.0, fnumber=11)
    found = intrinsics(camera)
    image_xy, lens_uv = samples(camera, 2000)
    rays = camera.rays(image_xy, lens_uv)
    passed = rays.weight > 0
    assert passed.mean() > 0.9
    rays, image_xy = rays[passed], image_xy[passed]
    plane = found.position[2] + found.distance
    points = rays.origin + rays.direction * ((plane - rays.origin[:, 2:]) / rays.direction[:, 2:])
    pixels = found.project((points - found.position) * [1, -1, 1])
    off = np.hypot(*(pixels + 0.5 - image_xy).T)
    # At f/11 the spot is at most some pixels wide; its centre is at the pixel.
    assert np.median(off) < 0.5
    assert np.abs((pixels + 0.5 - image_xy).mean(axis=0)).max() < 0.05


def test_the_plane_of_the_fit_is_counted_from_the_film():
    camera = Camera("dgauss.50mm", resolution=(1920, 1280), focus_distance=2000.0)
    given, default = intrinsics(camera, 2000.0), intrinsics(camera)
    np.testing.assert_allclose(given.matrix, default.matrix, rtol=1e-7)
    length = 32.04
    film = -(length + camera.film_distance)
    assert default.distance + default.position[2] - film == pytest.approx(2000, rel=1e-6)
    assert intrinsics(camera, np.inf).distance == np.inf
    metres = intrinsics(camera.replace(mm_per_unit=1000.0, focus_distance=2.0))
    np.testing.assert_allclose(metres.matrix, default.matrix, rtol=1e-5)
    np.testing.assert_allclose(metres.position * 1000, default.position, rtol=1e-4)


def test_pose_and_shutter_do_not_matter():
    camera = Camera("dgauss.50mm", resolution=(300, 200), focus_distance=1000.0)
    turned = camera.replace(
        camera_to_world=np.diag([1, -1, -1, 1]),
        shutter="focal-plane",
        shutter_slit=0.1,
    )
    np.testing.assert_array_equal(intrinsics(turned).matrix, intrinsics(camera).matrix)


def test_a_fisheye_states_its_residual():
    found = intrinsics(Camera("fisheye.10mm", resolution=(1920, 1280)))
    assert found.residual_max > 10 and found.coverage < 0.9


@pytest.mark.parametrize(
    ("camera", "arguments", "words"),
    [
        ({"model": "orthographic"}, {}, "no pinhole"),
        ({"model": "environment"}, {}, "no pinhole"),
        ({}, {"coefficients": 3}, "give 0, 2"),
        ({}, {"distance": -5.0}, "must be positive"),
        ({}, {"distance": 20.0}, "behind the pinhole; give a greater distance"),
    ],
)
def test_what_has_no_pinhole_is_refused(camera, arguments, words):
    with pytest.raises(ValueError, match=words):
        intrinsics(Camera(resolution=(300, 200), **camera), **arguments)


@pytest.mark.parametrize("lens", ["dgauss.50mm", "wide.22mm"])
def test_opencv_agrees(lens):
    """cv2 projects to the same pixels up to rounding error, and its own calibration of the points is no better."""
    cv2 = pytest.importorskip("cv2")
    camera = Camera(lens, resolution=(960, 640), focus_distance=1500.0)
    found = intrinsics(camera)
    random = np.random.default_rng(2)
    points = np.concatenate([random.uniform(-0.3, 0.3, (200, 2)), np.ones((200, 1))], axis=1)
    projected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), found.matrix, found.distortion)
    np.testing.assert_allclose(found.project(points), projected.reshape(-1, 2), rtol=1e-12, atol=1e-9)

    # Makes pixels, and the points on a wall in focus that the camera sees at them.
    x, y = np.meshgrid(np.linspace(0, 960, 25), np.linspace(0, 640, 17))
    image_xy = np.stack([x.ravel(), y.ravel()], axis=-1)
    middles = (np.arange(24) + 0.5) / 24
    uv = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    rays = camera.rays(image_xy[:, None, :], uv[None, :, :])
    plane = found.position[2] + found.distance
    dz = np.where(rays.weight > 0, rays.direction[..., 2], 1)[..., None]
    meets = rays.origin + rays.direction * ((plane - rays.origin[..., 2:]) / dz)
    weight = rays.weight[..., None].astype(float)
    wall = (meets * weight).sum(axis=1) / weight.sum(axis=1) * [1, -1, 1]
    wall[:, 2] = 0
    flags = cv2.CALIB_USE_INTRINSIC_GUESS
    rms, _matrix, _distortion, _turns, _moves = cv2.calibrateCamera(
        [wall.astype(np.float32)],
        [(image_xy - 0.5).astype(np.float32)],
        (960, 640),
        found.matrix.copy(),
        found.distortion.copy(),
        flags=flags,
    )
    # OpenCV also fits the wall's pose, which is six more numbers; here the pose is the one that the lens has.
    ours = np.sqrt(np.mean(np.sum((found.project(wall + [0, 0, found.distance]) + 0.5 - image_xy) ** 2, axis=1)))
    assert rms <= ours + 1e-3
    assert ours < rms + 0.05
