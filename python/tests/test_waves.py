"""Diffraction: point spread functions, MTFs and wavefronts, against closed forms and against sums in NumPy."""

from __future__ import annotations

import numpy as np
import pytest

import realistic


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
