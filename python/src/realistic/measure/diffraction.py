"""The diffraction limit of an image, which no lens exceeds; geometric measures do not include it.

It is the MTF of a circular pupil without aberrations (J. W. Goodman, *Introduction to Fourier Optics*, 3rd edition,
2005, section 6.3.3).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import quietly
from .bundles import in_camera_space, pupil_rule

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..camera import Camera


def working_fnumber(camera: Camera) -> float:
    """Returns the working f-number: 1/(2 sin θ'), with θ' the half angle of the cone of rays at the middle of the
    picture.

    With focus at infinity it equals `camera.fnumber`, except for aberrations. With nearer focus, the film is farther
    from the lens and the working f-number is larger.

    Raises
    ------
    ValueError
        For a model without a lens, and if no light reaches the middle of the picture.
    """
    if camera.interfaces == 0:
        raise ValueError("a camera without a lens has no f-number")
    number = fnumber_if_lit(camera)
    if np.isinf(number):
        raise ValueError("no light gets to the middle of the picture")
    return number


def fnumber_if_lit(camera: Camera) -> float:
    """Returns `working_fnumber` of a camera with a lens; infinite if no light reaches the middle of the picture."""
    with in_camera_space(camera) as plain, quietly():
        # The mean weight is the projected solid angle of the cone, π sin²θ'.
        lit = plain.replace(weighting="radiometric", simple_weighting=None, transmission=None, ghosts=None)
        middle = np.array([camera.resolution], np.float64) / 2
        lens_uv, share = pupil_rule(lit, middle, 16)
        light = float((lit.rays(middle[:, None], lens_uv).weight * share).sum())
    return float(np.sqrt(np.pi / light) / 2) if light > 0 else float("inf")


def wavelength_of(camera: Camera) -> float:
    """Returns the wavelength at which a camera's lens is traced, nm."""
    return float(camera.parameters.get("wavelength", 587.5618))


def diffraction_mtf(camera: Camera, frequencies: ArrayLike) -> NDArray[np.float64]:
    """Returns the MTF of a lens without aberrations at this camera's f-number and wavelength, which no real lens
    exceeds.

    Parameters
    ----------
    frequencies : float or array_like (k,)
        Line pairs per mm on the film.

    Returns
    -------
    ndarray (k,)
        2/π (arccos s - s √(1 - s²)), with s the frequency divided by the cutoff 1/(λ N), and N the `working_fnumber`; 0
        from the cutoff on. The formula is valid in the middle of the picture; toward the corners, the pupil is narrower
        and the limit lower.

    Raises
    ------
    ValueError
        As `working_fnumber`.
    """
    return mtf_at(working_fnumber(camera), wavelength_of(camera), frequencies)


def mtf_at(fnumber: float, wavelength: float, frequencies: ArrayLike) -> NDArray[np.float64]:
    """Returns the MTF of a circular pupil without aberrations."""
    cutoff = 1e6 / (wavelength * fnumber)
    s = np.clip(np.abs(np.asarray(frequencies, np.float64)) / cutoff, 0.0, 1.0)
    return np.asarray(2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s * s)))
