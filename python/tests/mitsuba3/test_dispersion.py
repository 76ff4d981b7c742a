"""Tests which wavelengths share a path through a lens with dispersion, and how noisy the pictures are."""

from itertools import pairwise

import numpy as np
import pytest

import realistic

MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])
SIZE = (384, 256)
LENS = "dgauss.100mm"


def sensor_of(mi, size=SIZE, film="hdrfilm", **properties):
    shown = {"type": film, "width": size[0], "height": size[1], **properties.pop("bands", {})}
    kind = {"type": "realistic", "lens_file": LENS, "focus_distance": 2000.0, "film": shown, **properties}
    return mi.load_dict(kind)


def camera_of(size=SIZE, **parameters):
    given = {"focus_distance": 2000.0, "weighting": "relative", "camera_to_world": MIRROR, **parameters}
    return realistic.Camera(LENS, resolution=size, **given)


def sampled(mi, sensor, number, picture, lens):
    """Returns directions (n, 3), wavelengths (4, n), weights (4, n) and the response of each wavelength (4, n)."""
    n = len(number)
    ray, weight = sensor.sample_ray_differential(0.0, mi.Float(number), mi.Point2f(picture), mi.Point2f(lens))
    wavelengths, response = sensor.sample_wavelengths(mi.SurfaceInteraction3f(), mi.Float(number))
    arrays = [np.broadcast_to(np.array(each, np.float64), (4, n)) for each in (wavelengths, weight, response)]
    return np.array(ray.d, np.float64).T, *arrays


def samples(n, seed=1):
    numbers = np.random.default_rng(seed).random((5, n), np.float32)
    return numbers[0], numbers[1:3], numbers[3:5]


@pytest.mark.parametrize("tolerance", [0.0, 1.0, 1e9])
def test_a_path_has_the_ray_of_one_of_its_wavelengths(spectral, tolerance):
    mi = spectral
    number, picture, lens = samples(2000)
    sensor = sensor_of(mi, dispersion_tolerance=tolerance)
    direction, wavelengths, weight, _ = sampled(mi, sensor, number, picture, lens)
    camera = camera_of()
    rays = [camera.rays(picture.T * SIZE, lens.T, wavelengths=np.clip(each, 380, 780)) for each in wavelengths]
    apart = np.array([np.linalg.norm(each.direction - direction, axis=1) for each in rays])
    passes = np.array([each.weight > 0 for each in rays])
    lit = weight.max(axis=0) > 0
    assert (apart[:, lit].min(axis=0) < 1e-6).all() and (lit == passes.any(axis=0)).all()
    # The path carries the hero, and no blocked wavelength.
    hero = apart.argmin(axis=0)
    assert (weight[hero, np.arange(2000)][lit] > 0).all() and not weight[~passes].any()
    carried = (weight > 0).sum(axis=0)
    if tolerance == 0:
        assert carried.max() == 1 and len(np.unique(hero)) == 4
    elif tolerance > 1:
        # Next to an aperture's edge, the size of a pixel is unknown, so wavelengths go alone.
        assert (carried == passes.sum(axis=0)).mean() > 0.98
    else:
        assert set(carried) >= {1, 2, 3, 4}


def test_on_the_mean_each_wavelength_has_its_own_weight(spectral):
    """The mean is over the choices of the hero, which the fine part of the random number makes."""
    mi = spectral
    n, points = 20_000, 6
    _, picture, lens = samples(points, seed=8)
    for tolerance in (0.0, 1.0):
        # In a picture of this size, the wavelengths fall into groups.
        sensor, camera = sensor_of(mi, (1920, 1280), dispersion_tolerance=tolerance), camera_of((1920, 1280))
        for at in range(points):
            number = np.float32((37 * at + (np.arange(n) + 0.5) / n) / 256)
            where = [np.repeat(each[:, at : at + 1], n, axis=1) for each in (picture, lens)]
            _, wavelengths, weight, response = sampled(mi, sensor, number, *where)
            middle = np.clip(wavelengths.mean(axis=1), 380, 780)
            own = camera.rays(picture[:, at] * [1920, 1280], lens[:, at], wavelengths=middle).weight
            np.testing.assert_allclose(weight.mean(axis=1) / response.mean(axis=1), own, rtol=0.03)


def test_wavelengths_of_one_path_land_together(spectral):
    """Traces a path's ray back through the lens at the other wavelengths that the path carries."""
    mi = spectral
    number, picture, lens = samples(3000, seed=2)
    tolerance = 0.7
    size = (960, 640)
    sensor, camera = sensor_of(mi, size, dispersion_tolerance=tolerance), camera_of(size)
    ray, weight = sensor.sample_ray(0.0, mi.Float(number), mi.Point2f(picture), mi.Point2f(lens))
    columns = ray.o, ray.d, ray.wavelengths, weight
    origin, direction, wavelengths, weight = (np.array(each, np.float64) for each in columns)
    scale = camera.film_diagonal / np.hypot(*size)
    film = realistic.Lens(LENS).rear_vertex_mm - camera.film_distance
    lenses = {}
    found, alone = [], []
    for k in range(0, 3000, 10):
        if not weight[:, k].any():
            continue
        positions = {}
        for wavelength, carried in zip(np.round(wavelengths[:, k]), weight[:, k] > 0):
            # Outside this range the lens's indices are extrapolated, and the lens warns.
            if 420 <= wavelength <= 700:
                at = lenses.setdefault(wavelength, realistic.Lens(LENS, wavelength=float(wavelength)))
                # Mitsuba's +x is to the left.
                back = at.trace(origin[:, k] * [-1, 1, 1], -direction[:, k] * [-1, 1, 1], side="scene")
                if back.passed.all():
                    o, d = back.origin.ravel(), back.direction.ravel()
                    positions[wavelength] = (o + d * (film - o[2]) / d[2])[:2] / scale, carried
        here = picture[:, k] * size * [-1, 1] + [size[0] / 2, -size[1] / 2]
        for position, carried in positions.values():
            (found if carried else alone).append(np.linalg.norm(position - here))
    # The sensor compares rays through the same point of the pupil, whereas this test traces one ray back at all
    # wavelengths. Hence the margin of a tenth.
    assert len(found) > 300 and max(found) < 1.1 * tolerance
    assert len(alone) > 50 and np.median(alone) > tolerance


def noise(values):
    return values.std(axis=-1) / values.mean(axis=-1)


def test_noise_is_at_most_twice_that_of_one_wavelength(spectral):
    """Measures noise in R, G and B of uniform light, at a picture size where one wavelength per path gave 20 times as
    much in G."""
    mi = spectral

    def rgb(**properties):
        sensor = sensor_of(mi, focus_distance=np.inf, bands={"rfilter": {"type": "box"}}, **properties)
        light = {"type": "constant"}
        scene = mi.load_dict({"type": "scene", "integrator": {"type": "path"}, "s": sensor, "light": light})
        pictures = np.array([np.array(mi.render(scene, spp=16, seed=seed), np.float64) for seed in range(4)])
        # The lens's own falloff is not noise.
        spread = np.sqrt(pictures.var(axis=0, ddof=1).mean(axis=(0, 1)))
        return pictures.mean(axis=(0, 1, 2)), spread / pictures.mean(axis=(0, 1, 2))

    mean, at_once = rgb(wavelength=550.0)
    own_mean, own = rgb()
    _, alone = rgb(dispersion_tolerance=0.0)
    assert (own < 2 * at_once).all() and (alone > 3 * at_once).all()
    np.testing.assert_allclose(own_mean, mean, rtol=0.01)


@pytest.mark.parametrize("size", [SIZE, (3840, 2560)])
def test_spectral_noise_is_at_most_twice_at_each_wavelength(spectral, size):
    """The bound holds however far apart the wavelengths land."""
    mi = spectral
    bands = {"band": {"type": "spectrum", "value": [(380.0, 1.0), (780.0, 1.0)]}}
    number, picture, lens = samples(200_000, seed=6)
    edges = np.arange(400, 701, 50)

    def of_bands(**properties):
        sensor = sensor_of(mi, size, "specfilm", bands=bands, fnumber=8, **properties)
        _, wavelengths, weight, _ = sampled(mi, sensor, number, picture, lens)
        inside = [(wavelengths >= a) & (wavelengths < b) for a, b in pairwise(edges)]
        return np.array([(weight * each).sum(axis=0) for each in inside])

    at_once, own = of_bands(wavelength=550.0), of_bands()
    assert (noise(own) < 2.1 * noise(at_once)).all()
    np.testing.assert_allclose(own.mean(axis=1), at_once.mean(axis=1), rtol=0.03)


def test_one_spectral_ray_is_that_of_many(llvm):
    mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed (pip install mitsuba)")
    number, picture, lens = samples(40, seed=9)
    found = []
    for variant in ("scalar_spectral", "llvm_ad_spectral"):
        if variant.startswith("llvm") and llvm:
            pytest.skip(llvm)
        mi.set_variant(variant)
        import realistic.mitsuba  # noqa: F401

        sensor = sensor_of(mi, (1920, 1280))
        if variant.startswith("llvm"):
            ray, weight = sensor.sample_ray(0.0, mi.Float(number), mi.Point2f(picture), mi.Point2f(lens))
            found.append((np.array(ray.o).T, np.array(ray.d).T, np.array(weight).T))
        else:
            rays = [
                sensor.sample_ray(0.0, float(a), mi.Point2f(b.tolist()), mi.Point2f(c.tolist()))
                for a, b, c in zip(number, picture.T, lens.T)
            ]
            columns = zip(*((ray.o, ray.d, weight) for ray, weight in rays))
            found.append([np.array([np.array(each) for each in column]) for column in columns])
    for one, many in zip(*found):
        np.testing.assert_allclose(one, many, rtol=1e-4, atol=1e-5)
