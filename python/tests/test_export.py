"""Reads exported models back with their target programs, which must project the points that a pixel sees to that
pixel."""

import numpy as np
import pytest

from realistic import Camera, Error, measure


@pytest.fixture(scope="module")
def wide():
    return Camera("wide.22mm", resolution=(960, 640))


def chief(camera, n=400):
    """Returns random pixels, the directions of their exact chief rays in OpenCV's axes (+y down), and the exported
    rays."""
    exact = camera.export("rays")
    width, height = camera.resolution
    random = np.random.default_rng(4)
    column, row = random.integers(0, width, n), random.integers(0, height, n)
    directions = exact["direction"][row, column] * [1.0, -1.0, 1.0]
    lit = np.abs(directions).sum(axis=1) > 0
    return np.stack([column, row], axis=1)[lit].astype(float), directions[lit].astype(float), exact


def worst(found, pixels):
    return np.hypot(*(found - pixels).T).max()


def test_the_rays_are_the_cameras_own(wide):
    """With a very narrow stop, every ray of the camera is a chief ray."""
    pixels, directions, exact = chief(wide)
    # The film stays where the open lens is in focus: the best focus moves with the stop.
    pinhole = wide.replace(aperture_diameter=0.02, film_distance=wide.film_distance)
    rays = pinhole.rays(pixels + 0.5, np.full((1, 2), 0.5))
    assert (rays.weight > 0).all()
    np.testing.assert_allclose(rays.direction * [1, -1, 1], directions, atol=2e-5)
    assert exact["errors"]["worst_px"] < 1e-3


@pytest.mark.parametrize("model", ["opencv", "opencv-rational"])
def test_opencv_projects_to_the_stated_error(wide, model, tmp_path):
    cv2 = pytest.importorskip("cv2")
    found = wide.export(model)
    (tmp_path / "camera.yml").write_text(found["text"])
    file = cv2.FileStorage(str(tmp_path / "camera.yml"), cv2.FILE_STORAGE_READ)
    matrix, distortion = (file.getNode(name).mat() for name in ("camera_matrix", "distortion_coefficients"))
    np.testing.assert_array_equal(distortion.ravel(), found["parameters"]["distortion"])
    assert file.getNode("image_width").real() == 960
    pixels, directions, _ = chief(wide)
    projected, _ = cv2.projectPoints(directions, np.zeros(3), np.zeros(3), matrix, distortion)
    # Directions are 32-bit floats.
    assert worst(projected.reshape(-1, 2), pixels) <= found["errors"]["worst_px"] + 1e-3


@pytest.mark.parametrize("lens", ["wide.22mm", "fisheye.16mm"])
def test_opencvs_fisheye_projects_to_the_stated_error(lens, tmp_path):
    cv2 = pytest.importorskip("cv2")
    if not hasattr(cv2, "fisheye"):
        pytest.skip("this OpenCV has no fisheye")
    camera = Camera(lens, resolution=(960, 640))
    found = camera.export("kannala-brandt")
    (tmp_path / "camera.yml").write_text(found["text"])
    file = cv2.FileStorage(str(tmp_path / "camera.yml"), cv2.FILE_STORAGE_READ)
    matrix, distortion = (file.getNode(name).mat() for name in ("camera_matrix", "distortion_coefficients"))
    pixels, directions, _ = chief(camera)
    # The model covers less than 90 degrees from the axis.
    ahead = directions[:, 2] > 0.02
    assert ahead.mean() > 0.5
    projected, _ = cv2.fisheye.projectPoints(
        directions[ahead][:, None], np.zeros(3), np.zeros(3), matrix, distortion.ravel()
    )
    assert worst(projected.reshape(-1, 2), pixels[ahead]) <= found["errors"]["worst_px"] + 2e-3


def test_usd_reads_the_camera(wide, tmp_path):
    usd = pytest.importorskip("pxr.Usd")
    geometry = pytest.importorskip("pxr.UsdGeom")
    found = wide.replace(focus_distance=1500.0).export("usd")
    file = tmp_path / "camera.usda"
    file.write_text(found["text"])
    stage = usd.Stage.Open(str(file))
    assert geometry.GetStageMetersPerUnit(stage) == 0.001
    camera = geometry.Camera(stage.GetDefaultPrim()).GetCamera()
    # Gf.Camera uses tenths of a unit, and a unit is a millimetre here.
    assert camera.focalLength / 10 == pytest.approx(found["parameters"]["fx_px"] * found["pixel_mm"], rel=1e-6)
    width, height = wide.film_size_mm
    assert (camera.horizontalAperture / 10, camera.verticalAperture / 10) == pytest.approx((width, height), rel=1e-6)
    pupil = found["entrance_pupil_from_film_mm"]
    assert camera.focusDistance + pupil == pytest.approx(1500.0, rel=1e-6)
    # Projects a point straight ahead of a pixel through the frustum of USD's own camera.
    frustum = camera.frustum
    x, y = 100.0, -50.0
    across = (np.array([x, y]) / [480.0, 320.0]).tolist()
    pick = frustum.ComputePickRay(pytest.importorskip("pxr.Gf").Vec2d(*across)).direction
    assert pick[0] / -pick[2] == pytest.approx(x / found["parameters"]["fx_px"], rel=1e-6)
    prim = stage.GetDefaultPrim()
    assert prim.GetAttribute("realistic:lens").Get() == "wide.22mm"
    assert prim.GetAttribute("realistic:pupilWalkMm").Get() == pytest.approx(found["pupil_walk_mm"])
    assert len(prim.GetAttribute("realistic:kannalaBrandt").Get()) == 5


def test_usds_f_theta_polynomial_meets_the_stated_error(wide, tmp_path):
    usd = pytest.importorskip("pxr.Usd")
    found = wide.export("ftheta")
    file = tmp_path / "ftheta.usda"
    file.write_text(found["text"])
    stage = usd.Stage.Open(str(file))
    prim = stage.GetDefaultPrim()
    get = lambda name: prim.GetAttribute(f"omni:lensdistortion:ftheta:{name}").Get()
    assert prim.GetAttribute("omni:lensdistortion:model").Get() == "ftheta"
    assert "OmniLensDistortionFthetaAPI" in prim.GetPrimTypeInfo().GetAppliedAPISchemas()
    pixels, directions, _ = chief(wide)
    radius = np.hypot(*(pixels + 0.5 - np.asarray(get("opticalCenter"))).T)
    angle = sum(get(f"k{power}") * radius**power for power in range(5))
    exact = np.arccos(np.clip(directions[:, 2], -1, 1))
    # Angles are compared relative to the angle of a pixel; USD's attributes are 32-bit floats.
    per_pixel = np.gradient(exact[np.argsort(radius)]).mean()
    assert per_pixel > 0
    off = np.abs(angle - exact) * found["parameters"]["k"][1] ** -1
    assert off.max() <= 1.3 * found["errors"]["worst_px"] + 5e-3
    assert get("maxFov") == pytest.approx(2 * found["half_field_deg"], rel=1e-6)


def test_an_st_map_resamples_a_picture_as_the_distortion_has_it(wide):
    cv2 = pytest.importorskip("cv2")
    found = wide.export("st-map")
    width, height = wide.resolution
    there, back = (
        [m[..., 0] * width - 0.5, (1 - m[..., 1]) * height - 0.5] for m in (found["undistort"], found["distort"])
    )
    # OpenCV's own resampling distorts a smooth function of the pinhole's pixels, and undistorts it again.
    y, x = np.mgrid[:height, :width].astype(np.float32)
    picture = np.stack([x, y], axis=-1)
    distorted = cv2.remap(picture, *(m.astype(np.float32) for m in back), cv2.INTER_LINEAR)
    again = cv2.remap(distorted, *(m.astype(np.float32) for m in there), cv2.INTER_LINEAR)
    inside = np.s_[60:-60, 60:-60]
    # OpenCV rounds its weights to 1/32 pixel each time.
    assert np.abs(again - picture)[inside].max() < 0.07
    assert (found["undistort"].shape, found["undistort"].dtype) == ((height, width, 3), np.float32)


def test_illumination_and_spots_are_arrays(wide):
    light = wide.export("illumination")
    assert light["map"].shape == (640, 960)
    middle, corner = light["map"][320, 480], light["map"][0, 0]
    assert middle == pytest.approx(1, abs=1e-3) and 0 < corner < 0.5
    polynomial = 1 + sum(a * 1.0 for a in light["illumination"]["polynomial"])
    assert polynomial == pytest.approx(corner, abs=light["illumination"]["worst_error"] + 0.01)
    spots = wide.export("spot")["spots"]
    assert spots[0]["angle_deg"] == 0 and spots[-1]["rms_px"] > spots[0]["rms_px"]


def test_the_cameras_parameters_are_the_programs():
    camera = Camera("dgauss.50mm", resolution=(300, 200), fnumber=8, mm_per_unit=1000.0, focus_distance=2.0)
    found = camera.export("opencv")
    assert found["focus_distance_mm"] == pytest.approx(2000)
    assert found["film_distance"] == pytest.approx(camera.film_distance, rel=1e-6)
    assert found["size_px"].tolist() == [300, 200]
    assert found["film_diagonal"] == pytest.approx(camera.film_diagonal)
    with pytest.raises(Error, match="opencv-rational"):
        camera.export("fish")
    with pytest.raises(ValueError, match="model"):
        Camera(model="perspective", resolution=(30, 20)).export("opencv")


@pytest.mark.parametrize(
    ("lens", "given"),
    [
        ("dgauss.50mm", {}),
        ("dgauss.50mm", {"focus_distance": 1000.0}),
        ("planar.50mm", {"focus_distance": 2000.0, "fnumber": 2.8}),
        ("wide.22mm", {"focus_distance": 500.0}),
        ("phone.4mm", {"film_diagonal": 6.1}),
    ],
)
def test_the_spots_of_the_program_are_those_of_measures(lens, given):
    """The program traces from the scene to the film, `measure` from the film to the scene."""
    camera = Camera(lens, resolution=(960, 640), **given)
    exported = camera.export("spot")["spots"]
    across = np.array([480.0, 320.0]) / np.hypot(480, 320)
    points = [np.array([480.0, 320.0]) + spot["film_radius_px"] * across for spot in exported[:-1]]
    found = measure.spots(camera, points).rms
    # The outermost spot, at the edge of the light, is left out. By design the program's object points are on chief
    # rays, those of `measure` on mean rays.
    np.testing.assert_allclose(found[0], exported[0]["rms_px"], rtol=2e-3)
    np.testing.assert_allclose(found, [spot["rms_px"] for spot in exported[:-1]], rtol=1.5e-2)


def test_chief_rays_and_mean_rays_are_one_behind_a_small_stop():
    """The exported model uses chief rays, the intrinsics mean rays; wide open, coma and vignetting make them differ."""

    def apart(fnumber):
        camera = Camera("planar.50mm", resolution=(1920, 1280), fnumber=fnumber)
        report, fitted = camera.export("opencv"), measure.intrinsics(camera)
        assert report["ray"] == "chief"
        k, tangent = report["parameters"]["distortion"], np.linspace(0.0, 0.25, 30)
        t2 = tangent**2
        chief = report["parameters"]["fx_px"] * tangent * (1 + t2 * (k[0] + t2 * (k[1] + t2 * k[4])))
        mean = fitted.project(np.stack([tangent, 0 * tangent, 0 * tangent + 1], axis=-1))[:, 0] - fitted.matrix[0, 2]
        return np.abs(chief - mean).max()

    assert apart(22.0) < 0.1 and apart(1.6) > 1.0
