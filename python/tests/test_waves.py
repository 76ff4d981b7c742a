"""Diffraction: point spread functions, MTFs and wavefronts, against closed forms and against sums in NumPy."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import realistic
from realistic import Camera, Field, farm, measure


def perfect_mtf(fraction: np.ndarray) -> np.ndarray:
    """Returns the contrast of a perfect round pupil at fractions of the cutoff."""
    inside = np.clip(fraction, 0.0, 1.0)
    contrast: np.ndarray = 2.0 / np.pi * (np.arccos(inside) - inside * np.sqrt(1.0 - inside**2))
    return contrast


def test_a_stopped_down_lens_has_the_contrast_of_overlapping_circles() -> None:
    lens = realistic.Lens("dgauss.50mm", fnumber=16)
    frequencies = np.array([10.0, 50.0, 100.0])
    found = lens.mtf(frequencies.tolist())
    cone = lens.wavefront().fnumber
    expected = perfect_mtf(frequencies * 587.56e-6 * cone)
    np.testing.assert_allclose(found.perfect, [expected, expected], atol=2e-3)
    np.testing.assert_allclose(found.tangential, expected, atol=2e-3)
    assert (found.geometric > 0.99).all()
    assert found.error < 0.01


def test_the_mtf_is_the_transform_of_the_point_spread_function() -> None:
    lens = realistic.Lens("planar.50mm", fnumber=5.6)
    spread = lens.psf((0.0, 6.0), pixels=256, pitch_um=0.8)
    assert spread.energy.shape == (256, 256)
    assert spread.energy.sum() == pytest.approx(0.99, abs=0.01)
    assert spread.energy.max() < spread.perfect_peak
    place = (np.arange(256) - 127.5) * spread.pitch_mm
    frequencies = np.array([20.0, 60.0])
    found = lens.mtf(frequencies.tolist(), (0.0, 6.0))
    for frequency, tangential, sagittal in zip(frequencies, found.tangential, found.sagittal, strict=True):
        wave = np.exp(-2j * np.pi * frequency * place)
        # Rows are y, and the point lies above the centre: tangential contrast varies along y.
        assert abs(wave @ spread.energy.sum(axis=1)) == pytest.approx(tangential, abs=5e-3)
        assert abs(wave @ spread.energy.sum(axis=0)) == pytest.approx(sagittal, abs=5e-3)


def test_noll_coefficients_add_up_to_the_rms_and_defocus_moves_the_fourth() -> None:
    lens = realistic.Lens("dgauss.50mm", fnumber=8)
    wavefront = lens.wavefront()
    assert np.sqrt((wavefront.noll[1:] ** 2).sum()) == pytest.approx(wavefront.rms, rel=0.02)
    assert wavefront.strehl == pytest.approx(np.exp(-((2 * np.pi * wavefront.rms) ** 2)), abs=0.02)
    assert wavefront.seidel is not None and wavefront.seidel.shape == (len(lens.surfaces), 5)
    assert realistic.Lens("mirror.500mm").wavefront(rays=32).seidel is None
    tables = lens.mtf_through_focus([40.0], [-0.1, 0.0, 0.1])
    contrasts = [table.tangential[0] for table in tables]
    assert [table.defocus_mm for table in tables] == [-0.1, 0.0, 0.1]
    assert contrasts[1] > contrasts[0] > contrasts[2] or contrasts[1] > contrasts[2]


def test_colours_and_distances_are_taken_and_mistakes_are_named() -> None:
    lens = realistic.Lens("dgauss.100mm", fnumber=8)
    one = lens.psf(pixels=32, rays=64)
    many = lens.psf(pixels=32, rays=64, spectrum={486.0: 1.0, 588.0: 2.0, 656.0: 1.0})
    assert many.energy.max() / many.perfect_peak < one.energy.max() / one.perfect_peak
    assert many.wavefront.wavelengths.tolist() == [486.0, 588.0, 656.0]
    assert lens.wavefront(object_distance=float("inf"), rays=32).object_distance == float("inf")
    with pytest.raises(realistic.Error, match="nearer the axis"):
        lens.psf((500.0, 0.0))
    with pytest.raises(realistic.Error, match="rays"):
        lens.psf(rays=4)


def test_optical_paths_are_those_of_the_points_on_the_surfaces() -> None:
    lens = realistic.Lens("zoom.24-70mm")
    rng = np.random.default_rng(7)
    origins = np.column_stack([rng.uniform(-6.0, 6.0, (200, 2)), np.full(200, 60.0)])
    directions = np.column_stack([rng.uniform(-0.05, 0.05, (200, 2)), np.full(200, -1.0)])
    plain = lens.trace(origins, directions)
    assert plain.optical_path is None
    traced = lens.trace(origins, directions, optical_path=True)
    np.testing.assert_array_equal(traced.origin, plain.origin)
    walked = lens.trace(origins, directions, points=True, optical_path=True)
    assert traced.optical_path is not None and walked.optical_path is not None and walked.points is not None
    np.testing.assert_allclose(traced.optical_path, walked.optical_path, atol=1e-11)
    through = walked.passed
    assert through.sum() > 50
    indices = [1.0, *(surface.index_film for surface in lens.surfaces)]
    points = np.concatenate([origins[:, None], walked.points], axis=1)[through]
    lengths = np.linalg.norm(np.diff(points, axis=1), axis=2)
    np.testing.assert_allclose((lengths * indices[:-1]).sum(axis=1), walked.optical_path[through], atol=1e-10)


def test_studies_and_measures_take_lenses_that_are_not_round() -> None:
    camera = realistic.Camera("anamorphic.129mm", resolution=(300, 200), focus_distance=50000.0)
    fields = realistic.Field.fractions([0, 0.4])
    tangential, sagittal = realistic.measure.mtf(camera, fields, [10])[0, :, 0]
    assert tangential != pytest.approx(sagittal, abs=1e-3), "its two meridians differ on the axis"
    assert realistic.measure.relative_illumination(camera, fields)[1] < 1.0
    table = realistic.study(
        ["planar.50mm"], [4, 16], 1e5, [0, 0.6], frequencies=40, processes=1, diffraction=True, progress=False
    )
    assert not table["failed"].any()
    wave = table["wave_mtf_tangential_40"]
    assert (wave < table["mtf_diffraction_40"] + 5e-3).all() and (wave > 0.2).all()
    assert (table["strehl"] <= 1.0).all() and table["wavefront_rms"][2] < table["wavefront_rms"][0]
    table = realistic.study(["mirror.500mm"], focus_distances=[50000.0], fields=[0], frequencies=[10])
    assert not table["failed"].any()


def test_plots_show_the_point_and_its_contrast() -> None:
    plot = pytest.importorskip("realistic.plot")
    lens = realistic.Lens("dgauss.50mm", fnumber=8)
    lines = plot.wave_mtf(lens, points=[(0.0, 0.0), (0.0, 10.0)]).get_lines()
    frequencies, tangential = lines[0].get_data()
    np.testing.assert_allclose(tangential[7], lens.mtf([frequencies[7]]).tangential[0], atol=1e-9)
    ax = plot.psf(lens, pixels=32)
    assert ax.images[0].get_array().max() == 0.0
    assert "Strehl" in ax.get_title()


def third_moments(place: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Returns the skewness of points (n, 2) with weights (n,) along x and y: their mean third powers about their mean."""
    away = place - np.average(place, axis=0, weights=weight)
    skewness: np.ndarray = np.average(away**3, axis=0, weights=weight)
    return skewness


def test_a_map_of_points_is_upright_and_the_same_on_all_workers() -> None:
    camera = Camera("planar.50mm", resolution=(300, 200), fnumber=2)
    found = farm.psf_map(camera, (3, 2), pixels=64, pitch_um=1.5, processes=1)
    assert found.energy.shape == (2, 3, 64, 64) and found.strehl.shape == (2, 3)
    width, height = camera.film_size_mm
    np.testing.assert_allclose(found.x_mm, [-width / 3, 0, width / 3], atol=1e-9)
    np.testing.assert_allclose(found.y_mm, [height / 4, -height / 4])
    with ThreadPoolExecutor(2) as pool:
        again = farm.psf_map(camera, (3, 2), pixels=64, pitch_um=1.5, client=pool)
    np.testing.assert_array_equal(again.energy, found.energy)
    # Rays of the camera itself are skewed to the same sides as the waves.
    across, down = np.meshgrid(np.arange(64.0), np.arange(64.0))
    place = np.stack([across.ravel(), down.ravel()], axis=-1)
    spots = measure.spots(camera, Field.grid(3, 2))
    for at in ((0, 0), (0, 2), (1, 0), (1, 2)):
        own = third_moments(place, found.energy[at].ravel())
        rays = third_moments(spots.offset[at], spots.weight[at])
        assert (np.sign(own) == np.sign(rays)).all(), (at, own, rays)
    lens = realistic.Lens("planar.50mm", fnumber=2)
    alone = lens.psf((0.0, -found.y_mm[0]), pixels=64, pitch_um=1.5, rays=128)
    assert found.strehl[0, 1] == pytest.approx(alone.wavefront.strehl, rel=1e-6)
    assert found.rms[0, 1] == pytest.approx(alone.wavefront.rms, rel=1e-6)
    dark = farm.psf_map(Camera("fisheye.10mm", resolution=(300, 200)), (7, 7), pixels=8, rays=16, processes=1)
    assert np.isfinite(dark.strehl[3, 3]) and np.isnan(dark.strehl[0, 0]) and np.isnan(dark.energy[0, 0]).all()
    # Tilted about its x axis, the film is out of focus above and below, but not in the middle.
    tilted = farm.psf_map(
        camera.replace(film_tilt_x=2.0), (1, 3), pixels=64, pitch_um=1.5, distance=np.inf, processes=1
    )
    flat = farm.psf_map(camera, (1, 3), pixels=64, pitch_um=1.5, distance=np.inf, processes=1)
    assert tilted.strehl[1, 0] == pytest.approx(flat.strehl[1, 0], rel=1e-4)
    assert (tilted.rms[[0, 2], 0] > 1.5 * flat.rms[[0, 2], 0]).all()


def test_a_study_maps_its_columns_over_the_picture() -> None:
    plot = pytest.importorskip("realistic.plot")
    given = {"frequencies": 40, "processes": 1, "diffraction": True, "resolution": (300, 200)}
    table = realistic.study("planar.50mm", [4, 8], fields=Field.grid(3, 2), **given)
    one = table[table["fnumber"] == 4]
    ax = plot.field_map(one, "strehl")
    shown = ax.images[0].get_array()
    # Rows of the picture are from the bottom, those of the table from the top.
    np.testing.assert_array_equal(shown[::-1].ravel(), one["strehl"])
    assert shown[0, 1] > shown[0, 0] and "f/4" in ax.get_title()
    with pytest.raises(ValueError, match="differ in fnumber"):
        plot.field_map(table, "strehl")
    with pytest.raises(ValueError, match="points of a grid"):
        plot.field_map(one[1:], "strehl")
    tilted = realistic.study("planar.50mm", 4, fields=[0, 0.5], film_tilt_x=3.0, **given)
    assert not tilted["failed"].any() and tilted["wavefront_rms"][1] > 3 * tilted["wavefront_rms"][0]


def test_a_study_through_focus_is_drawn_a_line_for_each_field_and_column() -> None:
    plot = pytest.importorskip("realistic.plot")
    moved = [-0.05, 0.0, 0.05]
    table = realistic.study(
        "dgauss.50mm", [8], fields=[0, 0.6], defocus_mm=moved, frequencies=40, processes=1, diffraction=True
    )
    lens = realistic.Lens("dgauss.50mm", fnumber=8)
    alone = [found.tangential[0] for found in lens.mtf_through_focus([40.0], moved, object_distance=float("inf"))]
    names = ["wave_mtf_tangential_40", "wave_mtf_sagittal_40"]
    lines = plot.through_focus(table, names).get_lines()
    assert len(lines) == 4 and lines[0].get_label() == "field 0, wave_mtf_tangential_40"
    np.testing.assert_array_equal(lines[0].get_xdata(), moved)
    np.testing.assert_allclose(lines[0].get_ydata(), alone, atol=2e-3)
    np.testing.assert_array_equal(lines[3].get_ydata(), table[table["field"] == 0.6]["wave_mtf_sagittal_40"])
    other = table.copy()
    other["fnumber"][0] = 4.0
    with pytest.raises(ValueError, match="differ in fnumber"):
        plot.through_focus(other, names)
    with pytest.raises(ValueError, match="no rows"):
        plot.through_focus(table[:0], names)
    with pytest.raises(ValueError, match="different field points"):
        plot.through_focus(table[:-1], names)


def test_a_map_of_points_has_each_at_its_place() -> None:
    plot = pytest.importorskip("realistic.plot")
    camera = Camera("planar.50mm", resolution=(300, 200), fnumber=8, focus_distance=np.inf)
    found = farm.psf_map(camera, (3, 2), pixels=16, rays=32, processes=1)
    ax = plot.psf_map(found)
    picture = ax.images[0].get_array()
    assert picture.shape == (2 * 17, 3 * 17)
    np.testing.assert_allclose(picture[17:33, 34:50] ** 2 * found.energy[1, 2].max(), found.energy[1, 2])
    left, right, bottom, top = ax.images[0].get_extent()
    np.testing.assert_allclose([right - left, top - bottom], camera.film_size_mm)
