"""Compares the lens with exact arithmetic and with two optics programs (tests/golden)."""

import csv
import pickle
import warnings

import matplotlib
import numpy as np
import pytest

import realistic
from realistic import Lens
from realistic.surfaces import outlines, sag

CATALOGUE = ["dgauss.50mm", "dgauss.100mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"]


def lens_called(checkout, name):
    return Lens(name if name in CATALOGUE else checkout / f"tests/golden/{name}.dat")


@pytest.mark.parametrize("side", ["film", "scene"])
@pytest.mark.parametrize("name", [*CATALOGUE, "planar", "crossed"])
def test_rays_are_those_of_exact_arithmetic(checkout, name, side):
    table = checkout / f"tests/golden/truth_{'scene_' if side == 'scene' else ''}{name}.csv"
    rows = list(csv.DictReader(table.read_text().splitlines()))
    given = np.array([[float(row[k]) for k in ("x", "y", "z", "dx", "dy", "dz")] for row in rows])
    with warnings.catch_warnings():
        # The surfaces of one of these lenses cross deliberately.
        warnings.simplefilter("ignore", realistic.CameraWarning)
        lens = lens_called(checkout, name)
    found = lens.trace(given[:, :3], given[:, 3:], side=side)
    status = [realistic.Reason(reason).name.lower() for reason in found.reason]
    assert status == [row["status"] for row in rows]
    passed = [row for row in rows if row["status"] == "ok"]
    assert len(passed) >= 30
    origin = np.array([[float(row[k]) for k in ("ox", "oy", "oz")] for row in passed])
    direction = np.array([[float(row[k]) for k in ("ux", "uy", "uz")] for row in passed])
    np.testing.assert_allclose(found.direction[found.passed], direction, rtol=0, atol=1e-14)
    np.testing.assert_allclose(found.origin[found.passed], origin, rtol=0, atol=2e-13)


@pytest.mark.parametrize("program", ["optiland", "rayoptics"])
def test_rays_are_those_of_two_optics_programs(checkout, program):
    rows = list(csv.DictReader((checkout / f"tests/golden/rays_{program}.csv").read_text().splitlines()))
    compared = 0
    for name in CATALOGUE:
        # At other wavelengths the table uses its own refractive indices.
        own = [row for row in rows if row["lens"] == name and row["wavelength_nm"] == "587.56"]
        columns = ("x", "y", "z", "dx", "dy", "dz", "ox", "oy", "oz", "ux", "uy", "uz")
        numbers = np.array([[float(row[k]) for k in columns] for row in own])
        found = Lens(name).trace(numbers[:, 0:3], numbers[:, 3:6])
        # The optics programs do not clip rays.
        np.testing.assert_allclose(found.origin[found.passed], numbers[found.passed, 6:9], rtol=0, atol=2e-13)
        np.testing.assert_allclose(found.direction[found.passed], numbers[found.passed, 9:12], rtol=0, atol=1e-14)
        compared += np.count_nonzero(found.passed)
    assert compared > 100


def test_first_order_data_are_those_of_two_optics_programs(checkout):
    lines = (checkout / "tests/golden/first_order.csv").read_text().splitlines()
    compared = 0
    for line in lines:
        if not line or line[0] in "#l":
            continue
        name, wavelength, _program, _version, quantity, value = line.split(",")
        if wavelength != "587.56":
            # At other wavelengths the table uses its own refractive indices.
            continue
        # The table's pupils are paraxial images of the stop, even if another aperture limits the beam. With a stop as
        # small as a pinhole, the stop alone limits the beam, and the beam is paraxial.
        stop = next(surface for surface in Lens(name).surfaces if surface.is_stop)
        lens = Lens(name, aperture_diameter=2e-6 * stop.semi_diameter_mm)
        # The table measures from a vertex toward the film, lens space from the front vertex toward the scene.
        found = {
            "focal_length": lens.focal_length_mm,
            "back_focal_distance": lens.back_focal_distance_mm,
            "front_focal_distance": -lens.focal_points_mm[0],
            "front_principal_plane": -lens.principal_planes_mm[0],
            "rear_principal_plane": lens.rear_vertex_mm - lens.principal_planes_mm[1],
            "entrance_pupil_position": -lens.pupils.entrance_mm,
            "entrance_pupil_diameter": 1e6 * lens.pupils.entrance_diameter_mm,
            "exit_pupil_position": lens.rear_vertex_mm - lens.pupils.exit_mm,
            "exit_pupil_diameter": 1e6 * lens.pupils.exit_diameter_mm,
            "f_number": lens.fnumber_paraxial / 1e6,
        }[quantity]
        assert found == pytest.approx(float(value), rel=1e-10, abs=1e-10 * abs(lens.focal_length_mm)), line
        compared += 1
    assert compared == 100


def test_the_f_number_is_that_of_the_beam_of_exact_rays():
    lens = Lens("planar.50mm")
    assert lens.fnumber == pytest.approx(1.4, abs=1e-4) and lens.fnumber_paraxial == pytest.approx(1.5096, abs=1e-4)
    height = lens.focal_length_mm / lens.fnumber / 2
    rays = lens.trace([[0, share * height, 50] for share in (1 - 1e-9, 1 + 1e-9)], [0, 0, -1])
    assert rays.passed.tolist() == [True, False]
    assert lens.pupils.entrance_diameter_mm == pytest.approx(2 * height, rel=1e-12)


def test_an_eye_has_its_film_in_a_medium():
    # One surface of radius 6 before the index 1.336: 1/φ = 6/0.336, and both nodal points are the centre.
    eye = Lens(lens_text="6 0 1.336 8\n")
    assert eye.outer_indices == (1.0, 1.336)
    assert eye.focal_length_mm == pytest.approx(6 / 0.336)
    assert eye.focal_points_mm == pytest.approx((6 / 0.336, -6 * 1.336 / 0.336))
    assert eye.principal_planes_mm == pytest.approx((0, 0), abs=1e-12) and eye.nodal_points_mm == pytest.approx(
        (-6, -6)
    )


def test_surfaces_are_those_of_the_file():
    lens = Lens(lens_text="20 5 1.5 10\n-40 2 1 8\n0 3 0 6\n-30 4 1.7 12\n50 0 1 12\n")
    assert [surface.radius_mm for surface in lens.surfaces] == [20, -40, np.inf, -30, 50]
    assert [surface.vertex_mm for surface in lens.surfaces] == [0, -5, -7, -10, -14]
    assert [surface.thickness_mm for surface in lens.surfaces] == [5, 2, 3, 4, 0]
    assert [surface.index_film for surface in lens.surfaces] == [1.5, 1, 1, 1.7, 1]
    assert [surface.index_scene for surface in lens.surfaces] == [1, 1.5, 1, 1, 1.7]
    assert [surface.semi_diameter_mm for surface in lens.surfaces] == [5, 4, 3, 6, 6]
    assert [surface.is_stop for surface in lens.surfaces] == [False, False, True, False, False]
    assert lens.rear_vertex_mm == -14 and lens.wavelength == 587.56


def test_an_aspheres_constants_are_those_of_the_file(checkout):
    lens = Lens("phone.4mm")
    bent = [surface for surface in lens.surfaces if surface.conic != 0 or any(surface.aspheric)]
    assert len(bent) >= 6
    for surface in lens.surfaces:
        a2 = surface.aspheric[1]
        assert len(surface.aspheric) == 30
        assert 1 / surface.radius_mm == pytest.approx(1 / surface.conic_radius_mm + 2 * a2, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("side", ["film", "scene"])
@pytest.mark.parametrize("name", ["wide.22mm", "phone.4mm"])
def test_points_lie_on_their_surfaces_and_end_where_the_ray_does(name, side):
    lens = Lens(name)
    toward = -1 if side == "scene" else 1
    start = 20.0 if side == "scene" else lens.rear_vertex_mm - 20.0
    height = np.linspace(-1.2, 1.2, 40) * lens.surfaces[0 if side == "scene" else -1].semi_diameter_mm
    origins = np.stack([0.3 * height, height, np.full(40, start)], -1)
    plain = lens.trace(origins, [0, 0, toward], side=side)
    found = lens.trace(origins, [0, 0, toward], side=side, points=True)
    assert plain.points is None and found.points.shape == (40, len(lens.surfaces), 3)
    assert 5 < plain.passed.sum() < 40
    np.testing.assert_array_equal(found.reason, plain.reason)
    np.testing.assert_allclose(found.origin, plain.origin, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.direction, plain.direction, rtol=0, atol=1e-13)
    last = found.points[:, -1 if side == "scene" else 0]
    np.testing.assert_array_equal(last[found.passed], found.origin[found.passed])
    assert np.isnan(last[~found.passed]).any()
    for number, surface in enumerate(lens.surfaces):
        x, y, z = found.points[:, number][~np.isnan(found.points[:, number, 0])].T
        r = np.hypot(x, y)
        inside = r <= surface.semi_diameter_mm
        c = 1 / surface.conic_radius_mm
        depth = c * r**2 / (1 + np.sqrt(1 - (1 + surface.conic) * c**2 * r**2))
        depth += sum(a * r ** (i + 1) for i, a in enumerate(surface.aspheric))
        np.testing.assert_allclose((surface.vertex_mm - depth - z)[inside], 0, atol=1e-12)


def test_focus_there_and_back():
    lens = Lens("telephoto.250mm", fnumber=8)
    for distance in (3000.0, 20_000.0, np.inf):
        film = lens.focus(distance)
        assert lens.focused_on(film) == pytest.approx(distance, rel=1e-9)
        camera = realistic.Camera("telephoto.250mm", resolution=(3, 2), fnumber=8, focus_distance=distance)
        assert camera.film_distance == pytest.approx(film, rel=1e-12)
    with pytest.raises(realistic.FocusError, match="nearest"):
        lens.focus(100.0)


def test_a_camera_ray_is_a_ray_of_its_lens(samples):
    """A camera ray, traced back from where it leaves the lens, reaches its film point."""
    camera = realistic.Camera("wide.22mm", resolution=(300, 200), focus_distance=900.0)
    lens = Lens("wide.22mm")
    image_xy, lens_uv = samples(camera, 400)
    rays = camera.rays(image_xy, lens_uv)
    passed = rays.weight > 0
    back = lens.trace(rays.origin + rays.direction, -rays.direction)
    # Single precision may move a ray across an edge.
    same = passed & back.passed
    assert same.sum() > 0.98 * passed.sum()
    film = lens.rear_vertex_mm - camera.film_distance
    origin, direction = back.origin[same], back.direction[same]
    t = (film - origin[:, 2]) / direction[:, 2]
    meets = origin[:, :2] + direction[:, :2] * t[:, None]
    # The film is upside down.
    film_xy = (image_xy / 300 - [0.5, 1 / 3]) * camera.film_size_mm[0] * [-1, 1]
    np.testing.assert_allclose(meets, film_xy[same], atol=2e-4)


def test_arrays_of_every_kind_are_right_or_refused():
    lens = Lens()
    origins = np.array([[0, 0, 10], [1, 2, 10], [0, 100, 10]], np.float32)
    expected = lens.trace(origins, [0, 0, -1])
    assert (
        expected.origin.shape == (3, 3)
        and repr(expected) == "<LensRays (3,), 2 of 3 get through>"
        and len(expected) == 3
    )
    for same in (origins.astype(int), np.asfortranarray(origins), origins.tolist(), origins[::-1][::-1]):
        found = lens.trace(same, [[0, 0, -2]] * 3)
        np.testing.assert_array_equal(found.origin, expected.origin)
        np.testing.assert_array_equal(found.reason, expected.reason)
    assert lens.trace(origins[:, None], np.zeros((4, 3)) - [0, 0, 1]).direction.shape == (3, 4, 3)
    assert lens.trace([0, 0, 10], [0, 0, -1]).reason.shape == ()
    assert lens.trace(np.zeros((0, 3)), np.zeros((0, 3))).origin.shape == (0, 3)
    assert (lens.trace([[0, 0, np.nan], [0, 0, 1]], [[0, 0, -1], [0, 0, 0]]).reason == realistic.Reason.MISSED).all()
    for arguments, error, words in (
        ((origins[:, :2], [0, 0, -1]), ValueError, r"origins must have shape \(n, 3\), and has \(3, 2\)"),
        ((origins, np.zeros((2, 3))), ValueError, r"origins \(3, 3\), directions \(2, 3\)"),
        ((origins * 1j, [0, 0, -1]), TypeError, "origins .* complex64"),
        ((origins, [0, 0, "a"]), TypeError, "directions .* dtype <U"),
    ):
        with pytest.raises(error, match=words):
            lens.trace(*arguments)
    with pytest.raises(ValueError, match='give "scene" or "film"'):
        lens.trace(origins, [0, 0, -1], side="left")


def test_bad_lenses_are_refused():
    with pytest.raises(realistic.LensFileError, match="no lens file"):
        Lens("no-such-lens")
    with pytest.raises(realistic.ParameterError, match="two ways"):
        Lens(fnumber=4, aperture_diameter=3)
    with pytest.raises(ValueError, match="wavelength"):
        Lens(wavelength=20)


def test_a_lens_can_be_pickled_and_printed():
    lens = Lens("wide.22mm", fnumber=8)
    assert repr(pickle.loads(pickle.dumps(lens))) == repr(lens) == "Lens('wide.22mm', fnumber=8)"
    assert lens.name == "wide.22mm" and np.isnan(lens.nominal_film_distance_mm)


@pytest.mark.parametrize("name", CATALOGUE)
def test_the_cross_section_is_drawn(name):
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from realistic import plot

    lens = Lens(name)
    ax = plot.section(lens)
    assert ax.get_title().startswith(name)
    glasses = sum(surface.index_film > 1 for surface in lens.surfaces)
    assert len(ax.patches) == glasses > 3
    # A surface's line goes through its vertex and bends toward its centre.
    surface = lens.surfaces[0]
    x, y = ax.lines[0].get_data()
    assert x[50] == pytest.approx(0) and (x[0] > 0) == (surface.radius_mm > 0) and y[0] == -surface.semi_diameter_mm
    ax.figure.canvas.draw()
    plt.close(ax.figure)


def test_every_name_of_the_catalogue_is_a_lens(checkout):
    names = realistic.catalogue()
    assert names[0] == "dgauss.50mm"
    assert set(names) == {file.stem for file in (checkout / "crates/optics/lenses").glob("*.dat")}
    for name in names:
        assert Lens(name).name == name


def test_a_zoom_lens_has_the_given_focal_length():
    for zoom in ("35", 35, 35.0, np.float32(35), np.int64(35)):
        assert abs(Lens("zoom.24-70mm", zoom=zoom).focal_length_mm - 35) < 1e-9
    assert abs(realistic.Camera("zoom.24-70mm", zoom=35, resolution=(3, 2)).focal_length_mm - 35) < 1e-9
    with pytest.raises(realistic.ParameterError, match="zoom"):
        Lens("dgauss.50mm", zoom="35")
    with pytest.raises(ValueError, match="zoom is NaN"):
        Lens("zoom.24-70mm", zoom=float("nan"))
    with pytest.raises(TypeError, match="zoom must be text"):
        Lens("zoom.24-70mm", zoom=True)


@pytest.mark.parametrize("text", [3, 2.5, ["20 5 1.5 10"], True])
def test_a_lens_text_that_is_no_text_is_refused(text):
    with pytest.raises(TypeError, match="lens_text must be the text of a lens file"):
        realistic.Camera(lens_text=text, resolution=(3, 2))
    with pytest.raises(TypeError, match="lens_text must be the text of a lens file"):
        Lens(lens_text=text)


@pytest.mark.parametrize("name", ["dgauss.50mm", "phone.4mm", "zoom.24-70mm"])
def test_a_notebook_shows_the_cross_section(name):
    """The drawing, read as XML, has a closed shape per glass and a line per surface, all in the frame."""
    import xml.etree.ElementTree as xml

    lens = Lens(name)
    figure = xml.fromstring(lens._repr_html_())
    svg = "{http://www.w3.org/2000/svg}"
    paths = [path.get("d") for path in figure.iter(f"{svg}path")]
    glasses = sum(surface.index_film > 1 for surface in lens.surfaces)
    assert sum(path.endswith("Z") for path in paths) == glasses > 3
    # The other lines are the axis and the stop's two blades.
    stops = sum(surface.is_stop for surface in lens.surfaces)
    assert len(paths) == glasses + len(lens.surfaces) - stops + 1 + 2 * stops
    left, top, width, height = map(float, figure.find(f"{svg}svg").get("viewBox").split())
    for path in paths:
        if "H" not in path:
            x, y = np.array([point.split() for point in path[1:].rstrip("Z").split("L")], float).T
            assert (x > left).all() and (x < left + width).all()
            assert (y > top).all() and (y < top + height).all()
    assert figure.find("figcaption").text.startswith(f"{name}: {lens.focal_length_mm:.4g} mm, f/")


def test_a_notebook_shows_a_lens_whatever_its_name_is(tmp_path):
    import xml.etree.ElementTree as xml

    file = tmp_path / "<b>&.dat"
    file.write_text("20 5 1.5 10\n-20 0 1 10\n")
    assert "<b>&" in xml.fromstring(Lens(file)._repr_html_()).find("figcaption").text


def test_rays_are_drawn_through_the_cross_section():
    matplotlib.use("Agg")
    from realistic import plot

    lens = Lens("dgauss.50mm", fnumber=5.6)
    film = lens.focus(np.inf)
    for given in ({}, {"film_distance": film + 1}):
        ax = plot.section(lens, angles=[0.0, 12.0], rays=5, **given)
        paths = [line.get_xydata() for line in ax.lines if len(line.get_xdata()) == len(lens.surfaces) + 2]
        assert len(paths) == 10
        x = -lens.rear_vertex_mm + given.get("film_distance", film)
        np.testing.assert_allclose([path[-1, 0] for path in paths], x)
        ends = np.array([path[-1, 1] for path in paths])
        # On the film in focus, the bundles are points at f tan(angle), upside down; on the film 1 mm behind, a bundle
        # is 1/N mm wide.
        wide = 1 / lens.fnumber if given else 0.02
        assert np.ptp(ends[:5]) == pytest.approx(wide, rel=0.05) if given else np.ptp(ends[:5]) < wide
        assert ends[5:].mean() == pytest.approx(lens.focal_length_mm * np.tan(np.radians(12)), rel=0.05)
        ax.figure.canvas.draw()
        matplotlib.pyplot.close(ax.figure)


@pytest.mark.parametrize("name", ["phone.4mm", "dgauss.50mm"])
def test_the_drawn_surfaces_are_where_rays_meet_them(name):
    lens = Lens(name)
    h = np.linspace(-0.8, 0.8, 41) * lens.surfaces[0].semi_diameter_mm
    points = lens.trace(np.stack([0 * h, h, 0 * h + 50], axis=-1), [0, 0, -1], points=True).points
    met = 0
    for k, surface in enumerate(lens.surfaces):
        there = np.isfinite(points[:, k]).all(axis=1)
        y, z = points[there, k, 1:].T
        np.testing.assert_allclose(surface.vertex_mm - sag(surface, y), z, atol=1e-9)
        met += there.sum()
    assert met > 5 * len(lens.surfaces)


def test_a_coating_makes_a_lens_faster_and_its_ghosts_weaker() -> None:
    lens = Lens("dgauss.50mm")
    assert lens.fnumber < lens.tnumber_quarter_wave < lens.tnumber_bare
    # Ten surfaces lose about two fifths of the light.
    assert (lens.fnumber / lens.tnumber_bare) ** 2 == pytest.approx(0.59, abs=0.01)
    bare, coated = (lens.ghosts((15, 0), coating=coating) for coating in ("bare", "quarter-wave"))
    assert len(bare) == len(coated) == 45
    assert sum(ghost.watts for ghost in coated) < 0.05 * sum(ghost.watts for ghost in bare)
    assert bare[0].watts >= bare[1].watts and bare[0].surfaces[0] < bare[0].surfaces[1]
    with pytest.raises(realistic.Error, match="quarter-wave"):
        lens.ghosts(coating="five-layer")


@pytest.mark.parametrize("given", ["x", "5", None, [1.0], b"1"])
def test_a_distance_that_is_no_number_is_a_type_error(given):
    lens = realistic.Lens("dgauss.50mm")
    for method, name in ((lens.focus, "focus_distance_mm"), (lens.focused_on, "film_distance")):
        with pytest.raises(TypeError, match=f"^{name} must be a number, not "):
            method(given)
    assert lens.focus(np.float32(1000)) == lens.focus(1000)


def test_a_tilted_film_is_in_focus_on_its_plane():
    """Rays from film points of the camera with the computed film meet on the plane, over a wide range of depths."""
    lens = Lens("dgauss.50mm", fnumber=8)
    points = np.array([[-200.0, -150.0, 700.0], [250.0, -150.0, 900.0], [0.0, -150.0, 1600.0]])
    film = lens.plane_of_focus(points)
    camera = realistic.Camera("dgauss.50mm", resolution=(300, 200), fnumber=8, **film)
    u, v = np.meshgrid(*2 * [(np.arange(12) + 0.5) / 12])
    samples = np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32)
    depths = []
    for image in ([150, 140], [110, 160], [200, 190]):
        rays = camera.rays(np.broadcast_to(image, (len(samples), 2)).astype(np.float32), samples)
        origin, direction = (part[rays.weight > 0].astype(float) for part in (rays.origin, rays.direction))
        hits = origin + direction * ((-150.0 - origin[:, 1:2]) / direction[:, 1:2])
        assert hits[:, 0].std() < 0.5
        depths.append(hits[:, 2].mean())
    assert np.ptp(depths) > 200
    with pytest.raises(realistic.FocusError, match="point 1 at z = 10 mm has no real image"):
        lens.plane_of_focus([[0, 0, 10], [1, 0, 900], [0, 1, 900]])
    with pytest.raises(ValueError, match="three points"):
        lens.plane_of_focus([[0, 0, 900]])


def test_lenses_that_are_not_round_have_two_focal_lengths():
    """The two anamorphic lenses of the catalogue squeeze x by two; the mirror lens is one of revolution."""
    lens = realistic.Lens("anamorphic.129mm")
    assert lens.focal_length_mm == pytest.approx(128.651, abs=1e-3)
    assert lens.focal_length_x_mm == pytest.approx(65.586, abs=1e-3)
    assert lens.back_focal_distance_x_mm == pytest.approx(32.886, abs=1e-3)
    # A small object in the exit pupil is enlarged by the ratio of the diameters; the pupils of a round lens are the same.
    assert lens.fnumber_x == pytest.approx(lens.focal_length_x_mm / lens.pupils_x.entrance_diameter_mm)
    assert lens.pupils_x.exit_mm != pytest.approx(lens.pupils.exit_mm, rel=0.01)
    cylinder = lens.surfaces[12]
    assert np.isinf(cylinder.radius_mm) and cylinder.radius_x_mm == pytest.approx(-99.505)
    assert not lens.is_round and not cylinder.is_round
    assert "<svg" not in lens._repr_html_()
    with pytest.raises(ValueError, match="surface 12 is a mirror, tilted or not symmetric"):
        outlines(lens.surfaces)
    mirror = realistic.Lens("mirror.500mm")
    assert mirror.focal_length_x_mm == mirror.focal_length_mm and not mirror.is_round
    assert mirror.pupils_x == mirror.pupils and mirror.fnumber_x == mirror.fnumber
    assert [number for number, surface in enumerate(mirror.surfaces) if surface.is_mirror] == [3, 6]
