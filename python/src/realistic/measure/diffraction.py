"""The diffraction limit of an image, which no lens exceeds; geometric measures do not include it.

It is the MTF and the Airy disk of a circular pupil without aberrations (J. W. Goodman, *Introduction to Fourier Optics*,
3rd edition, 2005, sections 6.3.3 and 4.4.2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import quietly
from .bundles import in_camera_space, pupil_rule
from .points import film_points

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..camera import Camera
    from .points import FieldLike

_AIRY = 1.21967
"""Radius of the Airy disk over wavelength times f-number: the first zero of the Bessel function J1, over π."""


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
    return float(_fnumbers(camera, np.array([camera.resolution], np.float64) / 2)[0])


def _fnumbers(camera: Camera, image_xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the working f-numbers at film points (n, 2) in pixels, those of round cones with as much light, (n,);
    infinite without light."""
    with in_camera_space(camera) as plain, quietly():
        # The mean weight is the projected solid angle of the cone, π sin²θ'.
        lit = plain.replace(weighting="radiometric", simple_weighting=None, transmission=None, ghosts=None)
        lens_uv, share = pupil_rule(lit, image_xy, 16)
        light = (lit.rays(image_xy[:, None], lens_uv).weight * share).sum(axis=1)
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(np.pi / light) / 2, np.float64)


def airy_radius(camera: Camera, field: FieldLike, *, distance: float | None = None) -> NDArray[np.float64]:
    """Returns the radius of the Airy disk, the picture that a perfect lens makes of a point: smaller spots are not real.

    Parameters
    ----------
    field : Field or array_like (n, 2)
        Field points.
    distance : float, optional
        Distance of the plane to which field angles refer, given like `focus_distance`; default the plane in focus.

    Returns
    -------
    ndarray (n,)
        1.22 λ N in pixels, to the first dark ring, N being the f-number of a round cone with as much light as reaches the
        point; NaN where there is no light.

    Raises
    ------
    ValueError
        For a model without a lens.
    """
    if camera.interfaces == 0:
        raise ValueError("a camera without a lens has no Airy disk")
    image_xy, shape = film_points(camera, field, distance)
    numbers = _fnumbers(camera, image_xy)
    pixel = camera.film_size_mm[0] / camera.resolution[0]
    radius = _AIRY * 1e-6 * wavelength_of(camera) * np.where(np.isfinite(numbers), numbers, np.nan) / pixel
    return np.asarray(radius.reshape(shape))


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
