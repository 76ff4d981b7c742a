"""Building a camera: parameters, pose, errors, warnings, lifetime."""

import copy
import io
import logging
import pickle
import signal
import subprocess
import sys
import threading
import warnings
import weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import realistic
from realistic import Camera, _abi, _handle

SINGLET = "20 5 1.5 10\n-20 0 1 10\n"


def test_first_order_data_are_those_of_two_optics_programs(checkout):
    lines = (checkout / "tests/golden/first_order.csv").read_text().splitlines()
    rows = [line.split(",") for line in lines if line and line[0] not in "#l"]
    compared = 0
    for lens, wavelength, _program, _version, quantity, value in rows:
        # At other wavelengths the table uses its own refractive indices.
        if quantity not in ("focal_length", "back_focal_distance") or wavelength != "587.56":
            continue
        # In first-order optics, a film focused at infinity is at the focal point.
        camera = Camera(lens, model="thick", resolution=(30, 20), focus_distance=np.inf)
        found = camera.focal_length_mm if quantity == "focal_length" else camera.film_distance
        assert found == pytest.approx(float(value), rel=1e-9), (lens, quantity)
        compared += 1
    assert compared == 20


def test_the_facts_are_those_of_the_lens(camera):
    assert camera.lens_name == "dgauss.50mm"
    assert camera.focus_distance_mm == pytest.approx(1000.0, rel=1e-9)
    assert camera.interfaces == 11
    assert camera.film_diagonal == 35
    width, height = camera.film_size_mm
    assert np.hypot(width, height) == pytest.approx(35) and width / height == pytest.approx(1.5)
    assert "exact trace in f64" in camera.plan()
    assert Camera(resolution=(3, 2), lens_file="wide.22mm@35mm").focal_length_mm == pytest.approx(35, rel=1e-12)
    pinhole = Camera(resolution=(3, 2), model="perspective")
    assert (pinhole.lens_name, pinhole.interfaces) == ("", 0) and np.isnan(pinhole.fnumber)


def test_every_parameter_reaches_the_library():
    """Each parameter gives a message for a value outside every range."""
    bad = {"lens_text": "1 2 3\n", "screen_window": [1, 1, 0, 2], "simple_weighting": "yes"}
    bad["crop"] = (0, 0, 31, 20)
    projections = ("fov", "frame_aspect_ratio", "lens_radius", "focal_distance", "lens_plane", "screen_window")
    for name, kind in realistic.Parameters.__annotations__.items():
        value = bad.get(name, "nonsense" if str(kind).startswith("ForwardRef('str") else -1e300)
        needs = {"model": "perspective"} if name in projections else {}
        needs |= {
            "shutter_ramp": {"shutter": "leaf"},
            "shutter_slit": {"shutter": "focal-plane"},
            "focal_distance": {"lens_radius": 1.0},
        }.get(name, {})
        if name in ("shutter_open", "shutter_close", "focal_distance"):
            value = np.inf if name != "focal_distance" else -1.0
        if name == "film_curvature_radius":
            value = 0.0
        with pytest.raises((realistic.Error, TypeError)) as caught:
            Camera(resolution=(30, 20), **{**needs, name: value})
        words = str(caught.value)
        assert {"glass_catalog": "glass catalogue"}.get(name, name) in words, words


def test_a_crop_is_returned_and_changes_no_ray(samples):
    whole = Camera(resolution=(30, 20), film_distance=40)
    part = Camera(resolution=(30, 20), film_distance=40, crop=(3, 4, 30, 5))
    assert (whole.crop, part.crop) == ((0, 0, 30, 20), (3, 4, 30, 5))
    image_xy, lens_uv = samples(whole, 300)
    for own, other in zip(*((rays.origin, rays.weight) for rays in (c.rays(image_xy, lens_uv) for c in (whole, part)))):
        np.testing.assert_array_equal(own, other)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"film_diagonal": -1}, realistic.ParameterError, 'parameter "film_diagonal" is -1; it must be positive'),
        ({"fnumber": 2, "aperture_diameter": 9}, realistic.ParameterError, "say the same thing in two ways"),
        (
            {"lens_file": "no-such-lens"},
            realistic.LensFileError,
            "no lens file .* the catalogue; the names are dgauss.50mm",
        ),
        ({"lens_text": "29 3 1.6\n"}, realistic.LensFileError, "lens_text:1:1: .* four values"),
        ({"lens_text": b"\xff\xfe"}, realistic.LensFileError, "lens_text"),
        ({"focus_distance": 10}, realistic.FocusError, "cannot focus at 10 mm .* nearest it reaches"),
        ({"focusdist": 10}, TypeError, "no parameter 'focusdist'; did you mean 'focus_distance'"),
        ({"xyzzy": 10}, TypeError, "no parameter 'xyzzy'$"),
        ({"focusdistance": 10}, TypeError, "no parameter 'focusdistance'; did you mean 'focus_distance'"),
        ({"lensfile": "a"}, TypeError, "no parameter 'lensfile'; did you mean 'lens_file'"),
        ({"film_diagonal": "35"}, TypeError, "film_diagonal must be a number, not '35'"),
        ({"film_diagonal": float("nan")}, ValueError, "film_diagonal is NaN"),
        ({"simple_weighting": 1}, TypeError, "simple_weighting must be true or false, not 1"),
        ({"pupil": 3}, TypeError, "pupil must be text, not 3"),
        ({"lens_file": "dgauss\0.50mm"}, ValueError, "NUL"),
        ({"screen_window": (0, 1, 2)}, ValueError, "screen_window must be 4 numbers, not 3"),
        ({"screen_window": 1.0}, TypeError, "screen_window must be 4 numbers, not 1.0"),
        ({"resolution": (3.5, 2)}, TypeError, r"resolution must be two integers \(width, height\)"),
        ({"resolution": (3, 2, 1)}, TypeError, "resolution must be two integers"),
        ({"resolution": (0, 2)}, realistic.ParameterError, "image is 0 x 2 pixels; both must be 1 or more"),
        ({"resolution": (2**32 + 3, 2)}, ValueError, "more than the library counts"),
        ({"camera_to_world": np.eye(3)}, ValueError, r"camera_to_world must be a \(4, 4\).*shape \(3, 3\)"),
        ({"camera_to_world": np.eye(4) * 1j}, ValueError, "dtype complex128"),
        ({"camera_to_world_end": np.full((4, 4), np.nan)}, ValueError, "camera_to_world_end has an element"),
        ({"camera_to_world": np.zeros((4, 4))}, realistic.Error, "camera_to_world|transform"),
    ],
)
def test_bad_arguments_are_refused_in_words_that_help(arguments, error, words):
    with pytest.raises(error, match=words):
        Camera(**{"resolution": (30, 20), **arguments})


def test_errors_are_of_pythons_kinds_and_keep_their_status():
    with pytest.raises(realistic.ParameterError) as caught:
        Camera(resolution=(3, 2), film_diagonal=-1)
    assert isinstance(caught.value, ValueError) and caught.value.status == 3
    with pytest.raises(OSError) as caught:
        Camera(resolution=(3, 2), lens_file="no-such-lens")
    assert isinstance(caught.value, ValueError) and caught.value.status == 4
    with pytest.raises(realistic.Error) as caught:
        Camera(resolution=(3, 2), focus_distance=10)
    assert caught.value.status == 5


def test_messages_are_those_of_the_thread_that_failed():
    found = {}

    def work(i):
        for _ in range(20):
            try:
                Camera(resolution=(3, 2), film_diagonal=-1 - i)
            except realistic.Error as error:
                found.setdefault(i, set()).add(str(error))

    threads = [threading.Thread(target=work, args=(i,)) for i in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {i: {f'parameter "film_diagonal" is {-1 - i}; it must be positive, in mm'} for i in range(6)}


def test_warnings_come_at_the_callers_line():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        Camera("fisheye.16mm", resolution=(30, 20), pupil="disk")
    assert [warning.category for warning in caught] == [realistic.CameraWarning]
    assert caught[0].filename == __file__
    line = Path(__file__).read_text().splitlines()[caught[0].lineno - 1]
    assert 'Camera("fisheye.16mm", resolution=(30, 20), pupil="disk")' in line
    assert "misses part of the true pupil" in str(caught[0].message)


def test_a_warning_may_be_an_error():
    with pytest.raises(realistic.CameraWarning, match="fov"):
        Camera(resolution=(30, 20), fov=40.0)


def test_information_goes_to_the_logger(caplog):
    with caplog.at_level(logging.INFO, "realistic"):
        Camera(resolution=(30, 20), tolerance=0.1)
    assert "tolerance" in caplog.text


def test_a_lens_may_be_a_file_or_a_text(tmp_path):
    file = tmp_path / "singlet with a space é.dat"
    file.write_text(SINGLET)
    from_file = Camera(file, resolution=(30, 20), film_diagonal=4)
    from_text = Camera(resolution=(30, 20), lens_text=SINGLET, film_diagonal=4)
    # Biconvex in air: 1/f = (n - 1)(2/R - (n - 1)d/(nR²)).
    f = 1 / (0.5 * (2 / 20 - 0.5 * 5 / (1.5 * 400)))
    assert from_file.focal_length_mm == pytest.approx(f, rel=1e-12)
    assert from_text.focal_length_mm == pytest.approx(f, rel=1e-12)


def test_the_pose_moves_rays(samples):
    turned = np.array([[0, 0, 1, 5], [1, 0, 0, 6], [0, 1, 0, 7], [0, 0, 0, 1]], float)
    still = Camera(resolution=(300, 200))
    moved = Camera(resolution=(300, 200), camera_to_world=turned)
    image_xy, lens_uv = samples(still, 100)
    one, other = still.rays(image_xy, lens_uv), moved.rays(image_xy, lens_uv)
    np.testing.assert_allclose(other.direction, one.direction @ turned[:3, :3].T, atol=2e-7)
    np.testing.assert_allclose(other.origin, one.origin @ turned[:3, :3].T + turned[:3, 3], atol=2e-5)
    passing = Camera(
        resolution=(300, 200), camera_to_world_end=[[1, 0, 0, 8], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    )
    later = passing.rays(image_xy, lens_uv, 0.25)
    np.testing.assert_allclose(later.origin, one.origin + [2, 0, 0], atol=2e-5)
    assert (later.time == 0.25).all()
    early = passing.replace(transform_start=0.5, transform_end=1.5).rays(image_xy, lens_uv, 0.25)
    np.testing.assert_allclose(early.origin, one.origin, atol=2e-5)


def test_replace_removes_alternatives(camera):
    assert camera.replace(fnumber=8).fnumber == pytest.approx(8, rel=1e-12)
    assert camera.replace(fnumber=8).replace(aperture_diameter=3).parameters["aperture_diameter"] == 3
    assert "fnumber" not in camera.replace(fnumber=8).replace(aperture_diameter=3).parameters
    assert camera.replace(film_distance=40.0).film_distance == pytest.approx(40, rel=1e-14)
    assert camera.replace(focus_distance=None).focus_distance_mm == np.inf
    assert camera.replace(resolution=(7, 5)).resolution == (7, 5)
    assert camera.replace(lens_text=SINGLET, focus_distance=None, film_diagonal=4).interfaces == 2
    with pytest.raises(TypeError, match="no parameter"):
        camera.replace(focus=3)


def test_what_replace_takes_over_changes_no_ray(samples):
    frames = [Camera("zoom.24-70mm", resolution=(300, 200), zoom=35, focus_distance=2000.0)]
    pose = np.eye(4)
    pose[0, 3] = 7
    for change in (
        {"focus_distance": 1900.0},
        {"fnumber": 8},
        {"zoom": 36, "camera_to_world": pose},
        {"lens_file": "wide.22mm", "zoom": None},
    ):
        frames.append(frames[-1].replace(**change))
        # The donor may be closed before the camera is used.
        frames[-2].close()
        anew = Camera(**frames[-1]._arguments())
        image_xy, lens_uv = samples(anew, 500)
        rays, expected = (camera.rays(image_xy, lens_uv) for camera in (frames[-1], anew))
        for name in ("origin", "direction", "weight", "time"):
            assert np.array_equal(getattr(rays, name), getattr(expected, name)), (change, name)
    # A closed camera keeps its arguments.
    assert frames[0].replace(focus_distance=1500.0).focus_distance_mm == pytest.approx(1500, rel=1e-12)


def test_a_closed_camera_raises_and_frees_once(samples):
    with Camera(resolution=(30, 20)) as camera:
        image_xy, lens_uv = samples(camera, 5)
        handle = weakref.finalize(camera._handle, list)
        assert handle.alive
    assert not handle.alive
    camera.close()
    for use in (lambda: camera.rays(image_xy, lens_uv), camera.plan, lambda: camera.fnumber):
        with pytest.raises(ValueError, match="this camera is closed"):
            use()
    assert repr(camera) == "Camera(resolution=(30, 20))"


def test_a_camera_may_be_closed_while_others_trace(samples):
    for _ in range(10):
        camera = Camera(resolution=(300, 200))
        part = samples(camera, 200_000)
        ended = []

        def work(camera=camera, part=part, ended=ended):
            try:
                while True:
                    camera.rays(*part)
            except ValueError as error:
                ended.append(str(error))

        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        camera.close()
        for thread in threads:
            thread.join()
        assert ended == ["this camera is closed"] * 3


def test_a_pickled_camera_gives_the_same_rays(samples):
    with pytest.warns(realistic.CameraWarning):
        camera = Camera(
            "wide.22mm", resolution=(300, 200), fnumber=4, pupil="disk", camera_to_world=np.eye(4) * [1, 1, -1, 1]
        )
    part = samples(camera, 100)
    for again in (pickle.loads(pickle.dumps(camera)), copy.copy(camera), copy.deepcopy(camera)):
        assert repr(again) == repr(camera)
        np.testing.assert_array_equal(again.rays(*part).direction, camera.rays(*part).direction)


def test_autofocus_by_distance_and_by_contrast():
    camera = Camera("dgauss.50mm", resolution=(300, 200), focus_distance=5000.0)
    zone = [[140, 90, 160, 110]]
    wall = 900.0

    def to_the_wall(origin, direction):
        assert origin.shape == direction.shape == (3,)
        return (wall - origin[2]) / direction[2]

    by_distance = camera.autofocus(zone, distance=to_the_wall)
    uv = np.random.default_rng(1).random((256, 2))

    def sharpness(trial, edges):
        assert edges == (140, 90, 160, 110)
        rays = trial.rays([150, 100], uv)
        rays = rays[rays.weight > 0]
        points = rays.origin + rays.direction * ((wall - rays.origin[:, 2:]) / rays.direction[:, 2:])
        sharpness.last = trial
        return 1 / points[:, :2].std()

    by_contrast = camera.autofocus(zone, contrast=sharpness)
    assert by_contrast == pytest.approx(by_distance, abs=0.05)
    # The film plane lies behind z = 0 by the sum of the lens's length (front vertex to last vertex,
    # tests/golden/README.md) and the film distance.
    focused = camera.replace(film_distance=by_distance)
    assert focused.focus_distance_mm == pytest.approx(wall + 32.04 + by_distance, rel=1e-4)
    with pytest.raises(ValueError, match="closed"):
        sharpness.last.rays([150, 100], uv)


def test_an_interrupt_of_a_build_is_raised_after_the_call(monkeypatch):
    # The interrupt arrives while the library logs, in the callback's first instruction.
    log = _handle.LOG

    def interrupted(function):
        def called(*arguments):
            signal.raise_signal(signal.SIGINT)
            function(*arguments)

        return log(called)

    monkeypatch.setattr(_handle, "LOG", interrupted)
    handler = signal.getsignal(signal.SIGINT)
    for _ in range(3):
        with pytest.raises(KeyboardInterrupt):
            realistic.Camera("dgauss.50mm", resolution=(30, 20), wavelength=500)
    assert signal.getsignal(signal.SIGINT) is handler
    # Another thread gets no interrupts, and builds as usual.
    monkeypatch.undo()
    with ThreadPoolExecutor(1) as threads:
        assert threads.submit(realistic.Camera, "dgauss.50mm", resolution=(30, 20)).result().interfaces == 11


def test_autofocus_passes_failures_on(camera):
    zone = [[0, 0, 100, 100]]
    with pytest.raises(ZeroDivisionError):
        camera.autofocus(zone, distance=lambda o, d: 1 / 0)
    with pytest.raises(realistic.FocusError, match="nothing to focus on"):
        camera.autofocus(zone, distance=lambda o, d: None)
    for given in ({}, {"distance": lambda o, d: 1.0, "contrast": lambda c, z: 1.0}, {"distance": 3}):
        with pytest.raises(TypeError, match="one of distance and contrast"):
            camera.autofocus(zone, **given)
    with pytest.raises(ValueError, match="rule is 'farthest'"):
        camera.autofocus(zone, distance=lambda o, d: 1.0, rule="farthest")
    with pytest.raises(ValueError, match=r"zones must have shape \(n, 4\).*\(4,\)"):
        camera.autofocus(zone[0], distance=lambda o, d: 1.0)
    far, near = [[0, 0, 10, 10], [1800, 1200, 1900, 1270]]
    picked = [
        camera.autofocus([far, near], distance=lambda o, d: 9000.0 if d[0] < 0 else 900.0, rule=rule)
        for rule in ("nearest", "average")
    ]
    assert picked[0] > picked[1]


@pytest.mark.parametrize(
    ("content", "words"),
    [(None, "is not at .*install the package"), (b"no library", "is not a library that this package can use")],
)
def test_a_library_that_cannot_be_loaded_is_reported(tmp_path, content, words):
    file = tmp_path / "librealistic.so"
    if content is not None:
        file.write_bytes(content)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("REALISTIC_PLUGIN", str(file))
        with pytest.raises(ImportError, match=words):
            _abi._load()


def test_it_works_on_pythons_standard_streams_closed():
    """In a host without standard streams, the package can be imported, and builds and warns, because it prints
    nothing."""
    code = "import sys; sys.stdout = sys.stderr = None\nimport realistic\nrealistic.Camera(resolution=(3, 2), fov=3)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")


def test_the_version_is_the_workspaces(checkout):
    assert f'version = "{realistic.__version__}"' in (checkout / "Cargo.toml").read_text()
    assert isinstance(LensFileError := realistic.LensFileError("x"), io.UnsupportedOperation.__bases__)
    assert str(LensFileError) == "x"
