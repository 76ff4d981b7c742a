"""Arrays of every dtype, shape and layout give the right rays or a clear error."""

import ctypes
import sys
import threading
import time

import numpy as np
import pytest

import realistic
from realistic import Camera, Rays, Reason, _abi
from realistic import rays as engine

FIELDS = ("origin", "direction", "weight", "mint", "maxt", "time")


class Sample(ctypes.Structure):
    _fields_ = [(name, ctypes.c_float) for name in ("x", "y", "u", "v", "time")]


def one_by_one(camera, image_xy, lens_uv, time=None):
    """Traces the samples by `realistic_generate_ray`, the C ABI's call for one ray."""
    library = ctypes.CDLL(str(_abi.library_file()))
    generate = library.realistic_generate_ray
    generate.argtypes = [
        ctypes.c_void_p,
        ctypes.POINTER(Sample),
        ctypes.POINTER(_abi.Request),
        ctypes.POINTER(_abi.Ray),
    ]
    generate.restype = ctypes.c_float
    time = np.zeros(len(image_xy), np.float32) if time is None else time
    found = Rays.empty(len(image_xy))
    for i, (xy, uv, t) in enumerate(zip(image_xy, lens_uv, time)):
        ray = _abi.Ray()
        found.weight[i] = generate(camera._live().pointer, ctypes.byref(Sample(*xy, *uv, t)), None, ctypes.byref(ray))
        found.origin[i], found.direction[i] = ray.o, ray.d
        found.mint[i], found.maxt[i], found.time[i] = ray.mint, ray.maxt, ray.time
    return found


def assert_equal(found, expected, names=FIELDS):
    for name in names:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name, strict=True)


def test_a_batch_is_to_the_bit_what_single_rays_are(camera, samples):
    image_xy, lens_uv = samples(camera, 500)
    time = np.random.default_rng(3).random(500, np.float32)
    rays = camera.rays(image_xy, lens_uv, time)
    assert 0 < np.count_nonzero(rays.weight) < 500
    assert_equal(rays, one_by_one(camera, image_xy, lens_uv, time))


def layouts():
    """Returns functions that take float32 in C order and return the same numbers in another layout."""

    def in_structures(array):
        wide = np.full((len(array), 5), np.nan, np.float32)
        wide[:, 1:3] = array
        return wide[:, 1:3]

    def unaligned(array):
        bytes_ = np.zeros(array.nbytes + 1, np.uint8)
        view = np.frombuffer(bytes_, np.float32, array.size, 1).reshape(array.shape)
        view[:] = array
        return view

    def backward(array):
        return np.ascontiguousarray(array[::-1, ::-1])[::-1, ::-1]

    return {
        "columns": lambda array: np.asfortranarray(array),
        "in structures": in_structures,
        "every second": lambda array: np.repeat(array, 2, axis=0)[::2],
        "backward": backward,
        "unaligned": unaligned,
        "float64": lambda array: array.astype(np.float64),
        "big-endian": lambda array: array.astype(">f4"),
        "a list": lambda array: array.tolist(),
        "read-only": lambda array: np.frombuffer(array.tobytes(), np.float32).reshape(array.shape),
    }


# The sizes are less than one block of the library, and several blocks with a remainder.
@pytest.mark.parametrize("n", [1, 7, 1027])
@pytest.mark.parametrize("layout", layouts())
def test_every_layout_gives_the_same_rays(camera, samples, layout, n):
    image_xy, lens_uv = samples(camera, n)
    expected = camera.rays(image_xy, lens_uv)
    change = layouts()[layout]
    assert_equal(camera.rays(change(image_xy), change(lens_uv)), expected)
    assert_equal(camera.rays(np.asfortranarray(image_xy), change(lens_uv)), expected)


@pytest.mark.parametrize("layout", [np.ascontiguousarray, np.asfortranarray, lambda array: array[::-1]])
def test_numbers_of_the_librarys_type_are_not_copied(camera, samples, monkeypatch, layout):
    image_xy, lens_uv = map(layout, samples(camera, 100))

    def refuse(*_):
        raise AssertionError("copied")

    monkeypatch.setattr(engine._Target, "finish", refuse)
    out = Rays.empty(100, reasons=True, differentials=True)
    handed = engine._Samples(image_xy, lens_uv, None)
    handed.fill(_abi.Request())
    assert handed.image_xy is image_xy and handed.lens_uv is lens_uv
    camera.rays(image_xy, lens_uv, out=out)
    assert out.weight.any()
    out.weight = np.zeros(100)
    with pytest.raises(AssertionError, match="copied"):
        camera.rays(image_xy, lens_uv, out=out)


def test_integers_are_numbers(camera):
    pixels = np.array([[960, 640], [100, 200]])
    assert_equal(camera.rays(pixels, [[0, 1], [1, 0]]), camera.rays(pixels.astype(float), [[0.0, 1.0], [1.0, 0.0]]))


@pytest.mark.parametrize(
    ("image_xy", "lens_uv", "time", "error", "words"),
    [
        (np.zeros((4, 3)), np.zeros((4, 2)), None, ValueError, r"image_xy must have shape \(n, 2\), and has \(4, 3\)"),
        (np.zeros((4, 2)), np.zeros(4), None, ValueError, r"lens_uv must have shape \(n, 2\), and has \(4,\)"),
        (np.float32(3), np.zeros((4, 2)), None, ValueError, r"image_xy must have shape \(n, 2\), and has \(\)"),
        (np.zeros((4, 2)), np.zeros((5, 2)), None, ValueError, r"image_xy \(4, 2\), lens_uv \(5, 2\)"),
        (np.zeros((4, 2)), np.zeros((4, 2)), np.zeros(3), ValueError, r"time \(3,\)"),
        (np.zeros((4, 2), complex), np.zeros((4, 2)), None, TypeError, "image_xy .* dtype complex128"),
        (np.zeros((4, 2)), np.full((4, 2), "x"), None, TypeError, "lens_uv .* dtype <U1"),
        (np.zeros((4, 2)), np.zeros((4, 2)), np.zeros(4, object), TypeError, "time .* dtype object"),
        (None, np.zeros((4, 2)), None, TypeError, "image_xy .* dtype object"),
    ],
)
def test_wrong_arrays_are_refused_with_what_they_are(camera, image_xy, lens_uv, time, error, words):
    with pytest.raises(error, match=words):
        camera.rays(image_xy, lens_uv, time)


def test_no_samples_give_no_rays(camera):
    rays = camera.rays(np.zeros((0, 2), np.float32), np.zeros((0, 2), np.float32), reasons=True, differentials=True)
    assert rays.origin.shape == (0, 3) and rays.weight.shape == (0,) and len(rays) == 0
    out = Rays(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))
    assert camera.rays(np.zeros((0, 2)), np.zeros((0, 2)), out=out) is out


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("where", ["x", "u"])
def test_a_sample_that_is_no_number_is_blocked(camera, samples, bad, where):
    image_xy, lens_uv = samples(camera, 100)
    expected = camera.rays(image_xy, lens_uv)
    (image_xy if where == "x" else lens_uv)[::7, 0] = bad
    rays = camera.rays(image_xy, lens_uv)
    # An infinite u is outside [0, 1] and clamped.
    clamped = where == "u" and np.isinf(bad)
    assert clamped or not rays.weight[::7].any()
    rest = np.arange(100) % 7 != 0
    assert_equal(rays[rest], expected[rest])
    for name in FIELDS:
        assert np.isfinite(getattr(rays, name)).all()


def test_blocked_rays_are_zero_in_what_is_new(camera, samples):
    rays = camera.rays(*samples(camera, 1000), reasons=True, differentials=True)
    blocked = rays.weight == 0
    assert blocked.any()
    for array in (rays.origin, rays.direction, rays.mint, rays.rx.origin, rays.ry.direction, rays.rx.weight):
        assert not array[blocked].any()
    assert (rays.reason[blocked] != realistic.Reason.OK).all()
    assert (rays.reason[~blocked] == realistic.Reason.OK).all()


def outs(n):
    """Returns outputs of several layouts, all filled with -1."""
    rows = Rays(np.zeros((n, 3), np.float32), np.zeros((n, 3), np.float32), np.zeros(n, np.float32))
    full = Rays.empty(n, reasons=True, differentials=True)
    wide = np.zeros((n, 9), np.float32)
    structures = Rays(
        wide[:, 0:3], wide[:, 3:6], np.zeros(n, np.float32), wide[:, 6], wide[:, 7], wide[:, 8], np.zeros(n, np.int64)
    )
    double = Rays(np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n), time=np.zeros(n))
    mixed = Rays(Rays.empty(n).origin, np.zeros((2 * n, 3), np.float32)[::2], np.zeros(n, np.float32))
    part = Rays.empty(n, differentials=True)
    part.rx.origin = np.zeros((n, 3), np.float32)
    return {"rows": rows, "full": full, "structures": structures, "double": double, "mixed": mixed, "part": part}


@pytest.mark.parametrize("n", [5, 1027])
@pytest.mark.parametrize("layout", outs(1))
@pytest.mark.parametrize("order", ["C", "F"])
def test_out_is_filled_whatever_its_layout(camera, samples, layout, n, order):
    image_xy, lens_uv = (np.array(array, order=order) for array in samples(camera, n))
    out = outs(n)[layout]
    expected = camera.rays(image_xy, lens_uv, reasons=True, differentials=True)
    for rays in (out, out.rx, out.ry):
        for array in () if rays is None else vars(rays).values():
            if isinstance(array, np.ndarray):
                array[...] = -1
    assert camera.rays(image_xy, lens_uv, out=out) is out
    passed = expected.weight > 0
    for name in ("weight", "reason"):
        if getattr(out, name) is not None:
            np.testing.assert_array_equal(getattr(out, name), getattr(expected, name))
    for found, right in ((out, expected), (out.rx, expected.rx), (out.ry, expected.ry)):
        for name in ("origin", "direction", "mint", "maxt", "time"):
            array = None if found is None else getattr(found, name)
            if array is not None and getattr(right, name) is not None:
                np.testing.assert_array_equal(array[passed], getattr(right, name)[passed], err_msg=name)
                assert (array[~passed] == -1).all(), name
    if out.rx is not None:
        np.testing.assert_array_equal(out.rx.weight, expected.rx.weight)
        np.testing.assert_array_equal(out.ry.weight, expected.ry.weight)


def strided(shape, strides):
    """Makes an array of float32 in its own memory, with any strides."""
    return np.lib.stride_tricks.as_strided(np.zeros(200, np.float32), shape, strides)


def wrong_out(n):
    def change(**fields):
        rays = Rays.empty(n)
        for name, array in fields.items():
            setattr(rays, name, array)
        return rays

    frozen = np.zeros((n, 3), np.float32)
    frozen.flags.writeable = False
    shared = np.zeros((n, 6), np.float32)
    return [
        (
            change(origin=np.zeros((n, 2), np.float32)),
            ValueError,
            r"out.origin must have shape \(4, 3\), and has \(4, 2\)",
        ),
        (change(weight=np.zeros(n + 1, np.float32)), ValueError, r"out.weight must have shape \(4,\), and has \(5,\)"),
        (change(direction=np.zeros((n, 3), int)), TypeError, "out.direction must hold float32, and has dtype int64"),
        (
            change(reason=np.zeros(n, np.float32).astype(bool)),
            TypeError,
            "out.reason must hold int32, and has dtype bool",
        ),
        (change(weight=np.zeros(n, "S32")), TypeError, "out.weight must hold float32, and has dtype .S32"),
        (change(origin=np.zeros((n, 3), "U32")), TypeError, "out.origin must hold float32, and has dtype <U32"),
        (change(time=np.zeros(n, "V8")), TypeError, "out.time must hold float32, and has dtype .V8"),
        (change(reason=np.zeros(n, "m8[s]")), TypeError, "out.reason must hold int32, and has dtype timedelta64"),
        (change(origin=frozen), ValueError, "out.origin is read-only"),
        (change(direction=None), ValueError, "out.direction must not be None"),
        (change(mint=[0.0] * n), TypeError, "out.mint must be a NumPy array, not list"),
        (change(origin=shared[:, :3], direction=shared[:, 2:5]), ValueError, "share memory"),
        # All rays at one address; each ray overlaps half of the next one; all three components at one address.
        (change(weight=strided((n,), (0,))), ValueError, "out.weight overlaps itself"),
        (change(origin=strided((n, 3), (0, 4))), ValueError, "out.origin overlaps itself"),
        (change(direction=strided((n, 3), (4, 4))), ValueError, "out.direction overlaps itself"),
        (change(direction=strided((n, 3), (12, 0))), ValueError, "out.direction overlaps itself"),
        (change(direction=strided((n, 3), (8, 16))), ValueError, "out.direction overlaps itself"),
        (change(mint=strided((n,), (2,))), ValueError, "out.mint overlaps itself"),
        (
            change(weight=np.ma.masked_array(np.zeros(n, np.float32), [True] * n)),
            TypeError,
            "out.weight is a masked array",
        ),
        (change(origin=np.ma.zeros((n, 3), np.float32)), TypeError, "whose mask would be lost; give its data"),
        (change(rx=Rays.empty(n)), ValueError, "one of rx and ry"),
        (np.zeros((n, 3)), TypeError, "out must be realistic.Rays, not ndarray"),
    ]


@pytest.mark.parametrize("case", range(len(wrong_out(4))))
def test_a_wrong_out_is_refused_with_what_it_is(camera, samples, case):
    out, error, words = wrong_out(4)[case]
    with pytest.raises(error, match=words):
        camera.rays(*samples(camera, 4), out=out)


def test_an_out_with_gaps_or_turned_around_is_taken(camera, samples):
    """Tests strides that look like an overlap but are none: interleaved columns, and negative strides."""
    n, given = 4, samples(camera, 4)
    expected = camera.rays(*given)
    for origin, weight in (
        (strided((n, 3), (8, 36)), np.zeros(n, np.float32)[::-1]),
        (strided((n, 3), (12, 4))[::-1, ::-1], strided((n,), (20,))),
    ):
        out = camera.rays(*given, out=Rays(origin, strided((n, 3), (4, 16)), weight))
        passed = expected.weight > 0
        for name in ("origin", "direction", "weight"):
            np.testing.assert_array_equal(getattr(out, name)[passed], getattr(expected, name)[passed])


def test_requested_arrays_must_be_in_out(camera, samples):
    with pytest.raises(ValueError, match="out.reason is None"):
        camera.rays(*samples(camera, 4), out=Rays.empty(4), reasons=True)
    with pytest.raises(ValueError, match="out.rx and out.ry are None"):
        camera.rays(*samples(camera, 4), out=Rays.empty(4), differentials=True)


@pytest.mark.parametrize("order", ["C", "F"])
def test_an_out_over_the_samples_is_as_good_as_any(camera, samples, order):
    image_xy, lens_uv = samples(camera, 50)
    expected = camera.rays(image_xy, lens_uv)
    memory = np.zeros((50, 3), np.float32, order=order)
    memory[:, :2] = image_xy
    out = Rays(memory, np.zeros((50, 3), np.float32, order=order), np.zeros(50, np.float32))
    camera.rays(memory[:, :2], lens_uv, out=out)
    passed = expected.weight > 0
    np.testing.assert_array_equal(out.origin[passed], expected.origin[passed])
    np.testing.assert_array_equal(out.weight, expected.weight)


def test_samples_broadcast_like_arrays(camera):
    x, y = np.meshgrid(np.arange(6) * 300.0, np.arange(4) * 300.0)
    image_xy = np.stack([x, y], axis=-1)
    rays = camera.rays(image_xy, [0.5, 0.25], reasons=True, differentials=True)
    assert rays.origin.shape == (4, 6, 3) and rays.weight.shape == (4, 6) and rays.rx.direction.shape == (4, 6, 3)
    flat = camera.rays(image_xy.reshape(-1, 2), np.full((24, 2), [0.5, 0.25]))
    np.testing.assert_array_equal(rays.direction.reshape(-1, 3), flat.direction)
    np.testing.assert_array_equal(rays.weight.ravel(), flat.weight)
    assert rays[1].origin.shape == (6, 3)
    out = Rays.empty((4, 6))
    assert camera.rays(image_xy, [0.5, 0.25], out=out) is out
    np.testing.assert_array_equal(out.origin, rays.origin)
    one = camera.rays([0.0, 0.0], [0.5, 0.25], 0.5)
    assert one.origin.shape == (3,) and one.weight == rays.weight[0, 0] and one.time == 0.5
    gap = Rays(np.zeros((4, 12, 3))[:, :6], np.zeros((4, 6, 3)), np.zeros((4, 6)))
    with pytest.raises(ValueError, match="cannot be filled in one go"):
        camera.rays(image_xy, [0.5, 0.25], out=gap)


def test_neighbours_are_the_rays_of_neighbouring_pixels(camera, samples):
    image_xy, lens_uv = samples(camera, 300)
    rays = camera.rays(image_xy, lens_uv, differentials=True)
    passed = rays.weight > 0
    for neighbour, shift in ((rays.rx, [1, 0]), (rays.ry, [0, 1])):
        alone = camera.rays(image_xy + np.float32(shift), lens_uv)
        there = passed & (alone.weight > 0)
        assert there.sum() > 50
        np.testing.assert_array_equal(neighbour.direction[there], alone.direction[there])
        np.testing.assert_array_equal(neighbour.origin[there], alone.origin[there])
        lost = passed & (alone.weight == 0)
        np.testing.assert_array_equal(neighbour.direction[lost], rays.direction[lost])
        assert not neighbour.weight[lost].any()


def test_any_number_of_threads_may_trace(camera, samples):
    parts = [samples(camera, 20_000, seed) for seed in range(8)]
    expected = [camera.rays(*part) for part in parts]
    found = [None] * 8

    def work(i):
        for _ in range(5):
            found[i] = camera.rays(*parts[i])

    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one, other in zip(found, expected):
        assert_equal(one, other)


def test_the_interpreter_is_free_during_a_call(camera, samples):
    """Another thread counts during a call. Only a released lock allows that, because the switch interval is very
    long."""
    n = 200_000
    given, out = engine._Samples(*samples(camera, n), None), Rays.empty(n)
    request = _abi.Request(struct_size=ctypes.sizeof(_abi.Request))
    given.fill(request)
    engine._Target(out, n, None).fill(request)
    function, pointer = _abi.library.realistic_camera_generate_batch, camera._live().pointer
    counts, running, done = [0], threading.Event(), threading.Event()

    def count():
        running.set()
        while not done.is_set():
            counts[0] += 1
            time.sleep(1e-5)

    thread = threading.Thread(target=count)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(100)
    try:
        thread.start()
        running.wait()
        before = counts[0]
        for _ in range(100):
            assert function(pointer, n, request) == 0
        after = counts[0]
    finally:
        sys.setswitchinterval(interval)
        done.set()
        thread.join()
    assert after > before


def test_rays_can_be_printed_and_indexed(camera, samples):
    rays = camera.rays(*samples(camera, 10), reasons=True, differentials=True)
    assert repr(rays) == f"<Rays (10,), {np.count_nonzero(rays.weight)} of 10 get through>"
    passed = rays[rays.weight > 0]
    assert len(passed) == len(passed.rx) == np.count_nonzero(rays.weight) and (passed.weight > 0).all()
    assert rays[3].origin.shape == (3,)


def test_rays_at_wavelengths(samples):
    """Each ray equals the ray of a camera at that wavelength with the same film and stop."""
    given = {"resolution": (300, 200), "pupil": "rear", "weighting": "none"}
    camera = Camera("tessar.50mm", focus_distance=1000.0, **given)
    xy, uv = samples(camera, 300)
    wavelengths = np.float32([450.0, 587.56, 650.0])
    rays = camera.rays(xy[:, None], uv[:, None], wavelengths=wavelengths)
    assert rays.origin.shape == (300, 3, 3)
    for k, wavelength in enumerate(wavelengths):
        other = Camera("tessar.50mm", film_distance=camera.film_distance, wavelength=float(wavelength), **given)
        expected = other.rays(xy, uv)
        same = (rays.weight[:, k] > 0) == (expected.weight > 0)
        assert same.mean() > 0.99
        passed = same & (expected.weight > 0)
        np.testing.assert_allclose(rays.direction[passed, k], expected.direction[passed], atol=3e-7)
        np.testing.assert_allclose(rays.origin[passed, k], expected.origin[passed], atol=3e-5)
    colours = rays.direction[(rays.weight > 0).all(axis=1)]
    assert np.abs(colours[:, 0] - colours[:, 2]).max() > 1e-4


@pytest.mark.parametrize("lens", ["tessar.50mm", "fisheye.10mm"])
def test_differentials_at_wavelengths(samples, lens):
    """The neighbours are those of the same wavelength; the ray itself replaces a blocked neighbour."""
    camera = Camera(lens, resolution=(300, 200))
    xy, uv = samples(camera, 5000)
    wavelengths = np.random.default_rng(3).uniform(370, 790, 5000).astype(np.float32)
    rays = camera.rays(xy, uv, wavelengths=wavelengths, reasons=True, differentials=True)
    own = camera.rays(xy, uv, wavelengths=wavelengths, reasons=True)
    np.testing.assert_array_equal(rays.direction, own.direction)
    np.testing.assert_array_equal(rays.reason, own.reason)
    lit = own.weight > 0
    for beside, step in ((rays.rx, [1, 0]), (rays.ry, [0, 1])):
        alone = camera.rays(xy + np.float32(step), uv, wavelengths=wavelengths)
        np.testing.assert_array_equal(beside.weight, np.where(lit, alone.weight, 0))
        passed = lit & (alone.weight > 0)
        assert passed.any() and not (beside.weight[~passed] > 0).any()
        np.testing.assert_array_equal(beside.direction[passed], alone.direction[passed])
        blocked = lit & ~passed
        np.testing.assert_array_equal(beside.direction[blocked], own.direction[blocked])
    assert (rays.rx.direction != rays.direction)[lit].any()


def test_wavelengths_of_any_layout_and_kind(samples):
    camera = Camera("tessar.50mm", resolution=(300, 200))
    xy, uv = samples(camera, 70_000)
    wavelengths = np.random.default_rng(2).choice(np.float32([430, 550, 640]), 70_000)
    expected = camera.rays(xy, uv, wavelengths=wavelengths, reasons=True)
    for other in (wavelengths.astype(float), np.stack([wavelengths] * 2, axis=1)[:, 0], wavelengths.tolist()):
        assert_equal(camera.rays(np.asfortranarray(xy), uv, wavelengths=other, reasons=True), expected)
    assert_equal(
        camera.rays(np.asfortranarray(xy), np.asfortranarray(uv), wavelengths=wavelengths, reasons=True), expected
    )
    out = Rays.empty(70_000, reasons=True)
    assert camera.rays(xy, uv, wavelengths=wavelengths, out=out) is out
    assert_equal(out, expected)


def test_wavelengths_that_are_none(camera, samples):
    xy, uv = samples(camera, 5)
    rays = camera.rays(xy, uv, wavelengths=[np.nan, 379, 781, np.inf, -500], reasons=True)
    assert not rays.weight.any() and (rays.reason == Reason.WAVELENGTH).all()
    with pytest.raises(ValueError, match=r"not equally many: image_xy \(5, 2\), lens_uv \(5, 2\), wavelengths \(4,\)"):
        camera.rays(xy, uv, wavelengths=[500.0] * 4)
    with pytest.raises(TypeError, match="wavelengths must hold real numbers"):
        camera.rays(xy, uv, wavelengths=["blue"] * 5)
