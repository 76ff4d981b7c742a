"""Compares measures with closed forms and with independent computations."""

import matplotlib
import numpy as np
import pytest

import realistic
from realistic import Camera, Field, measure
from realistic.measure.bundles import pupil_rule


def thin(**parameters):
    return Camera("dgauss.50mm", model="thin", resolution=(600, 400), **parameters)


def bessel1(x):
    """Computes the Bessel function J1 by its integral."""
    tau = (np.arange(4000) + 0.5) * np.pi / 4000
    return np.cos(tau - np.asarray(x)[..., None] * np.sin(tau)).mean(axis=-1)


def test_a_defocused_thin_lens_has_the_spot_of_a_disk():
    """A lens of radius R focused at infinity, f from the film, images a point at g as a disk of radius R f / g."""
    # The disk is uniform if every sample has the same weight.
    camera = thin(fnumber=4, weighting="none")
    f, distance = camera.focal_length_mm, 3000.0
    # The distance from the film to the thin lens is f minus half of the 5.4 mm by which the principal planes are
    # crossed (tests/golden/first_order.csv). The disk keeps the cone of the lens at f/4; the sine of its half angle is
    # 1/8.
    radius = f * np.tan(np.arcsin(1 / 8)) * f / (distance - f + 2.7)
    points = [[300, 200], [420, 120]]
    pixel = camera.film_size_mm[0] / 600
    found = measure.spots(camera, points, distance=distance, side=64)
    np.testing.assert_allclose(found.rms * pixel, radius / np.sqrt(2), rtol=2e-3)
    frequencies = np.array([5.0, 20.0, 60.0])
    x = 2 * np.pi * frequencies * radius
    transfer = measure.mtf(camera, points, frequencies, distance=distance)
    np.testing.assert_allclose(transfer, np.broadcast_to(np.abs(2 * bessel1(x) / x), (2, 2, 3)), atol=3e-3)
    np.testing.assert_allclose(measure.mtf(camera, points, [0.0]), 1, rtol=1e-12)
    # In focus, the spot is a point.
    assert (measure.spots(camera, points).rms < 1e-3).all()


def test_a_small_stop_darkens_by_the_fourth_power_of_the_cosine():
    camera = thin(fnumber=32)
    points = np.array([[300, 200], [450, 200], [599, 399]])
    pixel = camera.film_size_mm[0] / 600
    angle = np.arctan(np.hypot(*((points - [300, 200]) * pixel).T) / camera.focal_length_mm)
    found = measure.relative_illumination(camera, points)
    np.testing.assert_allclose(found, np.cos(angle) ** 4, rtol=1e-3)
    np.testing.assert_allclose(measure.relative_illumination(camera.replace(weighting="none"), points), found)


def test_ideal_lenses_do_not_distort():
    for camera in (thin(), thin(focus_distance=800.0), Camera(model="perspective", resolution=(600, 400), fov=40.0)):
        np.testing.assert_allclose(measure.distortion(camera, Field.fractions([0.15, 0.6, 1.0])), 0, atol=5e-6)


def test_the_distortion_is_that_of_the_intrinsics():
    camera = Camera("wide.22mm", resolution=(1920, 1280), fnumber=8)
    found = measure.intrinsics(camera)
    k1, k2, _, _, k3 = found.distortion
    tangent = np.array([0.2, 0.4, 0.6])
    factor = 1 + tangent**2 * (k1 + tangent**2 * (k2 + tangent**2 * k3))
    radii = found.matrix[0, 0] * tangent * factor
    points = [960, 640] + radii[:, None] * np.array([3, -2]) / np.sqrt(13)
    np.testing.assert_allclose(measure.distortion(camera, points), factor - 1, atol=2e-4)


def test_spots_are_where_rays_of_one_object_point_meet_the_film():
    """Brute force: searches, for each lens sample, for the film point whose ray meets the object point."""
    camera = Camera("dgauss.50mm", resolution=(1920, 1280), focus_distance=2000.0)
    start = np.array([1500.0, 300.0])
    found = measure.spots(camera, [start], side=8)
    lit = found.weight[0] > 0
    assert lit.mean() > 0.9
    uv = pupil_rule(camera, start[None], 8)[0][0, lit]
    plane = measure.intrinsics(camera)
    z = plane.position[2] + plane.distance

    def meets(image_xy):
        rays = camera.rays(image_xy, uv)
        assert (rays.weight > 0).all()
        o, d = rays.origin.astype(float), rays.direction.astype(float)
        return o[:, :2] + d[:, :2] * ((z - o[:, 2:]) / d[:, 2:])

    weight = found.weight[0, lit, None]

    def centred(points):
        return points - (points * weight).sum(axis=0) / weight.sum()

    target = (meets(np.broadcast_to(start, uv.shape)) * weight).sum(axis=0) / weight.sum()
    image_xy = np.broadcast_to(start, uv.shape).copy()
    for _ in range(6):
        here = meets(image_xy)
        slopes = np.stack([meets(image_xy + step) - here for step in np.eye(2) * 4], axis=-1) / 4
        image_xy += np.linalg.solve(slopes, (target - here)[..., None])[..., 0]
    size = found.rms[0]
    assert size > 1
    assert np.abs(centred(image_xy) - found.offset[0, lit]).max() < 0.005 * size


@pytest.mark.parametrize("name", ["dgauss.50mm", "tessar.50mm", "planar.50mm", "zoom.24-70mm"])
def test_the_spot_on_the_axis_is_that_of_rays_from_the_scene(name):
    """A beam from infinity has uniform light over its cross-section, so rays of the lens alone are weighted by their
    height."""
    camera, lens = Camera(name, resolution=(600, 400), focus_distance=np.inf), realistic.Lens(name)

    def trace(height):
        start = np.stack([0 * height, height, 0 * height + 100.0], axis=-1)
        return lens.trace(start, [0, 0, -1])

    dark = np.array([0.0, 2 * max(surface.semi_diameter_mm for surface in lens.surfaces)])
    for _ in range(50):
        middle = dark.mean()
        dark[0 if trace(np.array([middle])).passed[0] else 1] = middle
    nodes, weights = np.polynomial.legendre.leggauss(60)
    height = (nodes + 1) / 2 * dark[0]
    rays = trace(height)
    film = lens.rear_vertex_mm - camera.film_distance
    meets = rays.origin + rays.direction * ((film - rays.origin[:, 2:]) / rays.direction[:, 2:])
    expected = np.sqrt((meets[:, 1] ** 2 * weights * height).sum() / (weights * height).sum())
    pixel = camera.film_size_mm[0] / 600
    np.testing.assert_allclose(measure.spots(camera, [300, 200]).rms * pixel, expected, rtol=3e-3)


def test_the_sampling_of_spots_is_fine_enough():
    for name in ("dgauss.50mm", "wide.22mm", "planar.50mm"):
        camera = Camera(name, resolution=(600, 400), focus_distance=2000.0)
        field = Field.fractions([0, 0.5, 0.9])
        np.testing.assert_allclose(
            measure.spots(camera, field).rms, measure.spots(camera, field, side=96).rms, rtol=5e-3, err_msg=name
        )


def test_the_limit_of_diffraction_is_that_of_the_cone_of_light():
    """At infinity sin θ' = 1/(2 N). At magnification m, tan θ' is 1 + m/p times smaller; p is the pupil magnification."""
    camera = thin(fnumber=8)
    pupils = realistic.Lens("dgauss.50mm", fnumber=8).pupils
    for distance in (np.inf, 500.0):
        here = camera.replace(focus_distance=distance)
        m = (here.film_distance - camera.film_distance) / camera.focal_length_mm
        number = np.sqrt(8**2 - 0.5**2) * (1 + m * pupils.entrance_diameter_mm / pupils.exit_diameter_mm)
        np.testing.assert_allclose(measure.working_fnumber(here), np.hypot(number, 0.5), rtol=1e-3)
    # The choice of weights does not change the cone.
    assert measure.working_fnumber(camera.replace(weighting="none")) == measure.working_fnumber(camera)
    cutoff = 1e6 / (587.5618 * measure.working_fnumber(camera))
    found = measure.diffraction_mtf(camera, [0, cutoff / 2, cutoff, 2 * cutoff])
    # At half the cutoff, the MTF is 2/3 - √3/(2π).
    np.testing.assert_allclose(found, [1, 2 / 3 - np.sqrt(3) / (2 * np.pi), 0, 0], atol=1e-9)


def test_the_airy_disk_grows_as_the_cone_narrows():
    """A small stop darkens by cos⁴, so a cone's f-number grows by 1/cos²."""
    camera = thin(fnumber=32)
    points = np.array([[300, 200], [450, 200], [599, 399]])
    pixel = camera.film_size_mm[0] / 600
    angle = np.arctan(np.hypot(*((points - [300, 200]) * pixel).T) / camera.focal_length_mm)
    found = measure.airy_radius(camera, points) * pixel
    # The first dark ring of (2 J1(x)/x)² is at x = π r/(λ N).
    x = np.linspace(3.8, 3.9, 1001)
    ring = x[np.abs(bessel1(x)).argmin()] / np.pi
    expected = ring * 587.5618e-6 * measure.working_fnumber(camera) / np.cos(angle) ** 2
    np.testing.assert_allclose(found, expected, rtol=1e-3)
    assert measure.airy_radius(camera, Field.fractions(0.0)).shape == ()
    assert np.isnan(measure.airy_radius(Camera("fisheye.10mm", resolution=(1920, 1280)), [2.0, 2.0]))
    with pytest.raises(ValueError, match="no Airy disk"):
        measure.airy_radius(Camera(model="perspective", resolution=(600, 400), fov=40.0), points)


def test_an_mtf_that_light_cannot_have_is_warned_of():
    with pytest.warns(realistic.CameraWarning, match="above 0.82, which diffraction leaves at f/8"):
        assert measure.mtf(thin(fnumber=8), [300, 200], 30).min() > 0.99
    # There is no warning if the lens itself blurs more than diffraction.
    camera = Camera("dgauss.50mm", resolution=(600, 400), focus_distance=2000.0)
    measure.mtf(camera, [300, 200], [10, 30])


def test_defocus_is_a_straight_fan():
    """Moving the film by d changes a fan by d tan u'; sin u' of the marginal ray is 1/(2N) for a lens free of coma."""
    camera = Camera("dgauss.50mm", resolution=(600, 400), fnumber=8)
    film = camera.film_distance
    here, behind = (
        measure.fans(
            Camera("dgauss.50mm", resolution=(600, 400), fnumber=8, film_distance=film + d),
            [[300, 200]],
            distance=np.inf,
        )
        for d in (0.0, 0.5)
    )
    slope = (behind.tangential - here.tangential)[0] / 0.5
    expected = np.tan(np.arcsin(here.pupil / (2 * camera.fnumber)))
    # On film behind the focus, light that entered above the axis is below it: farther up in the upright picture.
    inner = np.abs(here.pupil) < 0.99
    np.testing.assert_allclose(slope[inner], expected[inner], atol=0.01 * expected.max())
    np.testing.assert_allclose(here.tangential, here.sagittal, atol=1e-9)


def test_a_fans_ray_ends_at_the_film_point_of_its_object():
    """Inverse search: finds the film point whose ray through a given pupil coordinate meets the object point."""
    camera = Camera("dgauss.50mm", resolution=(1500, 1000), focus_distance=2000.0, fnumber=4)
    start = np.array([1200.0, 250.0])
    found = measure.fans(camera, [start], rays=5)
    pixel = camera.film_size_mm[0] / 1500
    outward = (start - [750, 500]) / np.hypot(*(start - [750, 500])) * [1, -1]
    axes = np.array([outward, [-outward[1], outward[0]]])
    intrinsics = measure.intrinsics(camera)
    z = intrinsics.position[2] + intrinsics.distance

    def grid(side):
        middles = (np.arange(side) + 0.5) / side
        return np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)

    def passes(image_xy, side):
        """Returns the points where a film point's rays meet the plane in focus and that of the front vertex, along the
        axes."""
        rays = camera.rays(image_xy, grid(side))
        o, d = rays.origin[rays.weight > 0].astype(float), rays.direction[rays.weight > 0].astype(float)
        return [(o + d * ((at - o[:, 2:]) / d[:, 2:]))[:, :2] @ axes.T for at in (z, 0.0)]

    far, _ = passes(start, 32)
    target = far.mean(axis=0)
    # Positions of the outermost lens samples.
    _, edge = passes(start, 256)
    low, high = edge.min(axis=0), edge.max(axis=0)

    def meets(through, axis):
        """Returns the film point's distance from `start` along an axis, pixels."""
        misses = []
        for moved in (-2.0, 2.0):
            there, here = passes(start + moved * axes[axis] * [1, -1], 128)
            nearest = np.argsort(np.hypot(*(here - through).T))[:60]
            plane = np.column_stack([np.ones(60), here[nearest] - through])
            misses.append(np.linalg.lstsq(plane, there[nearest], rcond=None)[0][0, axis] - target[axis])
        return -2.0 + 4.0 * misses[0] / (misses[0] - misses[1])

    for axis, fan in enumerate((found.tangential[0], found.sagittal[0])):
        at = []
        for share in (-0.5, 0.0, 0.5):
            through = (low + high) / 2
            through[axis] += share * (high - low)[axis] / 2
            at.append(meets(through, axis))
        np.testing.assert_allclose((np.array(at) - at[1]) * pixel, fan[1:4], atol=0.02 * np.abs(fan[1:4]).max() + 1e-5)


def test_field_curvature_is_where_a_narrow_bundle_is_sharpest():
    """Far from the middle, the tangential and sagittal widths of the spot of a small stop are least at the two
    focuses."""
    given = {"resolution": (600, 400), "fnumber": 22}
    camera = Camera("dgauss.50mm", **given)
    radius = 250.0
    tangential, sagittal = measure.field_curvature(camera, [300 + radius, 200], distance=np.inf)
    assert abs(tangential - sagittal) > 0.02

    def widths(shift):
        moved = Camera("dgauss.50mm", film_distance=camera.film_distance + shift, **given)
        found = measure.spots(moved, [[300 + radius, 200]], distance=np.inf)
        return np.sqrt((found.offset[0] ** 2 * found.weight[0, :, None]).sum(axis=0) / found.weight[0].sum())

    shifts = np.linspace(-0.6, 0.6, 25)
    curves = np.array([widths(shift) for shift in shifts])
    for axis, expected in enumerate((tangential, sagittal)):
        # The square of the width is a quadratic function of the shift.
        a, b, _ = np.polyfit(shifts, curves[:, axis] ** 2, 2)
        assert abs(-b / (2 * a) - expected) < 0.03


@pytest.mark.parametrize("distance", [np.inf, 800.0])
def test_an_ideal_lens_has_the_field_angle_of_the_film_point(distance):
    """A film point at height r, at a distance v behind a lens with its pupil in the lens plane, sees in the direction r
    / v."""
    for camera, unit in (
        # The lens is stopped down, so that the weighted mean of the pupil is near its middle.
        (thin(focus_distance=distance, fnumber=16), None),
        (Camera(model="perspective", resolution=(600, 400), fov=40.0), 200 / np.tan(np.radians(20))),
    ):
        if unit is None:
            # 1/f = 1/v + 1/g, where v + g is the distance plus the 5.4 mm of the first test; for infinity v = f.
            f, total = camera.focal_length_mm, distance + 5.4
            v = f if np.isinf(distance) else (total - np.sqrt(total * total - 4 * total * f)) / 2
            unit = v / camera.film_size_mm[0] * 600
        points = np.array([[300, 200], [400, 200], [300, 100], [450, 120], [5, 5]])
        angles = np.degrees(np.arctan(np.hypot(*(points - [300, 200]).T) / unit))
        np.testing.assert_allclose(measure.field_angle(camera, points), angles, rtol=2e-4, atol=1e-5)
        x, y = np.degrees(np.arctan((points - [300, 200]).T * [[1], [-1]] / unit))
        np.testing.assert_allclose(Field.angles(x=x, y=y).image_xy(camera), points, atol=0.05)


@pytest.mark.parametrize("lens", ["dgauss.50mm", "fisheye.10mm", "zoom.24-70mm"])
def test_field_angles_and_film_points_are_each_others_inverse(lens):
    camera = Camera(lens, resolution=(600, 400), focus_distance=3000.0)
    most = measure.field_angle(camera, Field.fractions(0.5))
    angles = np.linspace(-0.99, 0.99, 7) * most
    found = Field.angles(angles).image_xy(camera)
    np.testing.assert_allclose(measure.field_angle(camera, found), np.abs(angles), rtol=1e-5, atol=1e-9)
    # The points are on the diagonal from the lower left to the upper right, in order.
    np.testing.assert_allclose((found[:, 0] - 300) / 300, -(found[:, 1] - 200) / 200, atol=1e-6)
    assert (np.diff(found[:, 0]) > 0).all()
    across = Field.angles(x=[most, 0.0], y=[0.0, most]).image_xy(camera)
    np.testing.assert_allclose(np.hypot(*(across - [300, 200]).T), 0.5 * np.hypot(300, 200), rtol=1e-4)


MEASURES = {
    "spots": lambda camera, field: measure.spots(camera, field, side=4).offset,
    "rms": lambda camera, field: measure.spots(camera, field, side=4).rms,
    "mtf": lambda camera, field: measure.mtf(camera, field, [10, 30], side=4),
    "mtf at one frequency": lambda camera, field: measure.mtf(camera, field, 30, side=4),
    "relative illumination": lambda camera, field: measure.relative_illumination(camera, field, side=4),
    "distortion": measure.distortion,
    "fans": lambda camera, field: measure.fans(camera, field, rays=5).tangential,
    "field curvature": measure.field_curvature,
    "field angle": measure.field_angle,
}


@pytest.mark.parametrize("name", MEASURES)
def test_every_measure_takes_field_points_of_every_kind(name):
    camera, measured = Camera("dgauss.50mm", resolution=(300, 200)), MEASURES[name]
    rows = measured(camera, [[150, 100], [225, 50]])
    one = measured(camera, [225, 50])
    assert one.shape == rows.shape[1:]
    np.testing.assert_array_equal(one, rows[1])
    np.testing.assert_array_equal(measured(camera, Field.fractions([0, 0.5])), rows)
    np.testing.assert_array_equal(measured(camera, Field.fractions(x=[0, 0.5], y=[0, 0.5])), rows)
    square = measured(camera, np.array([[150, 100], [225, 50]] * 3).reshape(3, 2, 2))
    np.testing.assert_array_equal(square, np.stack([rows] * 3))
    angle = float(measure.field_angle(camera, [225, 50]))
    np.testing.assert_allclose(measured(camera, Field.angles(angle)), one, rtol=2e-3, atol=2e-3)


def test_the_mtf_of_one_point_at_one_frequency():
    camera = Camera("dgauss.50mm", resolution=(1500, 1000))
    found = measure.mtf(camera, [750, 500], 30)
    assert found.shape == (2,) and (found > 0).all() and (found <= 1).all()
    np.testing.assert_array_equal(found, measure.mtf(camera, [[750, 500]], [30])[0, :, 0])


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: Field.pixels([1, 2, 3]), ValueError, r"shape \(n, 2\)"),
        (lambda: Field.pixels(3), ValueError, "Field.fractions and Field.angles take single numbers"),
        (lambda: Field.pixels([np.nan, 1]), ValueError, "not a finite number"),
        (lambda: Field.fractions([0, 1.5]), ValueError, "from -1 to 1"),
        (lambda: Field.fractions(x=2), ValueError, "from -1 to 1"),
        (lambda: Field.angles([90]), ValueError, "less than 90 degrees"),
        (lambda: Field.angles([10], x=5), TypeError, "along the diagonal, or x and y"),
        (
            lambda: measure.spots(thin(), Field.angles([10, 80])),
            ValueError,
            r"the picture does not reach to 80°: its corner is at 19\.\d°",
        ),
        (
            lambda: measure.field_angle(Camera(model="orthographic", resolution=(3, 2)), [1, 1]),
            ValueError,
            "no pinhole",
        ),
    ],
)
def test_what_is_no_field_point_is_refused(make, error, words):
    with pytest.raises(error, match=words):
        make()


def test_fans_need_surfaces():
    with pytest.raises(ValueError, match="there are no surfaces to trace"):
        measure.fans(thin(), [[300, 200]])
    with pytest.raises(ValueError, match="odd number of rays"):
        measure.fans(Camera(resolution=(30, 20)), [[15, 10]], rays=4)


def test_where_there_is_no_light_there_is_no_spot():
    camera = Camera("fisheye.10mm", resolution=(1920, 1280))
    corner = [[2.0, 2.0]]
    assert measure.relative_illumination(camera, corner) == 0
    found = measure.spots(camera, corner)
    assert np.isnan(found.rms).all() and not found.offset.any()
    assert np.isnan(measure.mtf(camera, corner, [10.0])).all()
    assert np.isnan(measure.distortion(camera, corner)).all()
    dark = measure.fans(camera, corner)
    assert np.isnan(dark.tangential).all() and np.isnan(dark.sagittal).all()
    assert np.isnan(measure.field_curvature(camera, corner)).all()
    assert np.isnan(measure.field_angle(camera, corner)).all()


@pytest.mark.parametrize("lens", ["dgauss.50mm", "fisheye.10mm"])
def test_every_plot_draws_what_is_measured(lens):
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from realistic import plot

    camera = Camera(lens, resolution=(300, 200))
    for draw in (plot.illumination, plot.spots, plot.mtf, plot.distortion, plot.field_curvature):
        ax = draw(camera)
        assert lens in ax.get_title()
        ax.figure.canvas.draw()
        plt.close(ax.figure)
    ax = plot.spots(camera, fields=[0.0, 0.5])
    pixel = 1000 * camera.film_size_mm[0] / camera.resolution[0]
    np.testing.assert_allclose(
        [circle.radius for circle in ax.patches], measure.airy_radius(camera, Field.fractions([0.0, 0.5])) * pixel
    )
    plt.close(ax.figure)
    ax = plot.mtf(camera, fields=Field.angles(x=[0, 5], y=3))
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        *("field (0°, 3°)", "field (5°, 3°)"),
        *("tangential", "sagittal", "limit of diffraction"),
    ]
    plt.close(ax.figure)
    figure = plot.fans(camera)
    assert lens in figure.get_suptitle() and len(figure.axes) == 8
    figure.canvas.draw()
    plt.close(figure)
    ax = plot.distortion(camera, ax=plt.subplots()[1])
    x, y = ax.lines[0].get_data()
    np.testing.assert_allclose(x, 100 * measure.distortion(camera, Field.fractions(y)), equal_nan=True)
    plt.close(ax.figure)
