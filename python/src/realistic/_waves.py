"""Wavefronts, point spread functions and MTFs of a lens, with diffraction: the reports of `realistic psf` and `realistic
mtf`, as objects."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._program import report
from .errors import Error

if TYPE_CHECKING:
    from .camera import Camera


@dataclass(frozen=True)
class Wavefront:
    """The wavefront of an object point at an image point. Path differences are to the chief ray, in waves."""

    image_point_mm: NDArray[np.float64]
    """Image point: x and y on the film in lens space, mm."""
    object_distance: float
    """Distance of the object from the film, mm; infinite for a distant one."""
    wavelengths: NDArray[np.float64]
    """Wavelengths, nm; the other numbers are those of the first one."""
    rms: float
    """Root mean square of the path difference about its mean, waves."""
    peak_to_valley: float
    """Largest path difference minus the smallest, waves."""
    strehl: float
    """Power at the image point, relative to that without path differences."""
    fnumber: float
    """f-number of the cone of light: 1 over its diameter in image-space direction cosines."""
    noll: NDArray[np.float64]
    """Coefficients of the first 37 Zernike polynomials in the order and normalisation of Noll, waves: `noll[3]` is
    defocus."""
    fringe: NDArray[np.float64]
    """The same in the fringe order, where every polynomial is 1 at the edge: `fringe[3]` is defocus."""
    circle: tuple[tuple[float, float], float]
    """The circle on which the polynomials are defined, in direction cosines: its centre and its radius."""
    seidel: NDArray[np.float64] | None
    """Seidel sums of each surface from the scene on (surfaces, 5), waves: spherical aberration, coma, astigmatism, field
    curvature, distortion. None for a lens that is not round or has terms of r^3."""


@dataclass(frozen=True)
class Psf:
    """The picture of a point."""

    energy: NDArray[np.float64]
    """Share of the energy on each pixel (rows, columns), with rows in the order of growing y of the film, in lens
    space."""
    pitch_mm: float
    """Side of a pixel, mm."""
    perfect_peak: float
    """Largest share of a pixel for a lens with this pupil and without path differences."""
    error: float
    """Largest difference, relative to the peak, from the function with three quarters of the rays."""
    wavefront: Wavefront
    """The wavefront."""


@dataclass(frozen=True)
class WaveMtf:
    """Contrast of fine detail, with diffraction and by rays alone; arrays have an element per frequency."""

    frequencies: NDArray[np.float64]
    """Frequencies, cycles per mm."""
    tangential: NDArray[np.float64]
    """Contrast of gratings that vary along the line from the film's centre to the image point."""
    sagittal: NDArray[np.float64]
    """Contrast of gratings that vary at right angles to that line."""
    geometric: NDArray[np.float64]
    """Contrast by rays alone (2, n): tangential and sagittal."""
    perfect: NDArray[np.float64]
    """Contrast of a perfect lens with the same pupil (2, n): tangential and sagittal."""
    defocus_mm: float
    """Distance by which the film was moved away from the lens, mm."""
    error: float
    """Largest difference from the contrast with three quarters of the rays."""
    wavefront: Wavefront
    """The wavefront, without defocus."""


def _words(
    at: Sequence[float], object_distance: float | None, spectrum: Mapping[float, float] | None, rays: int
) -> list[str]:
    """Returns the options of a command about an image point."""
    x, y = (repr(float(number)) for number in at)
    words = [f"--at={x},{y}", f"--rays={int(rays)}"]
    if object_distance is not None:
        words.append(f"--object-distance={float(object_distance)!r}")
    if spectrum:
        words.append("--spectrum=" + ",".join(f"{float(nm)!r}:{float(weight)!r}" for nm, weight in spectrum.items()))
    return words


def _wavefront(found: Mapping[str, Any]) -> Wavefront:
    distance = found["object_distance_mm"]
    (x, y), radius = found["zernike_circle"]["centre"], found["zernike_circle"]["radius"]
    return Wavefront(
        image_point_mm=np.asarray(found["image_point_mm"], dtype=np.float64),
        object_distance=float("inf") if distance is None else float(distance),
        wavelengths=np.asarray(found["wavelengths"], dtype=np.float64),
        rms=found["rms_waves"],
        peak_to_valley=found["peak_to_valley_waves"],
        strehl=found["strehl"],
        fnumber=found["fnumber_of_cone"],
        noll=np.asarray(found["zernike_noll_waves"], dtype=np.float64),
        fringe=np.asarray(found["zernike_fringe_waves"], dtype=np.float64),
        circle=((x, y), radius),
        seidel=None if found["seidel_waves"] is None else np.asarray(found["seidel_waves"], dtype=np.float64),
    )


def psf(
    parameters: Mapping[str, Any],
    at: Sequence[float],
    object_distance: float | None,
    spectrum: Mapping[float, float] | None,
    rays: int,
    pixels: int,
    pitch_um: float | None,
) -> Psf:
    """Returns the point spread function that `realistic psf` computes."""
    words = ["psf", *_words(at, object_distance, spectrum, rays), f"--pixels={int(pixels)}"]
    if pitch_um is not None:
        words.append(f"--pitch={float(pitch_um)!r}")
    with tempfile.TemporaryDirectory(prefix="realistic-") as folder:
        out = Path(folder) / "psf.npy"
        found = report([*words, "--out", str(out)], parameters)
        # The file has its rows from the top.
        energy = np.load(out)[::-1, :, 0].astype(np.float64)
    return Psf(
        energy=energy,
        pitch_mm=found["pitch_mm"],
        perfect_peak=found["peak_of_perfect_lens_per_mm2"] * found["pitch_mm"] ** 2,
        error=found["error"],
        wavefront=_wavefront(found),
    )


def mtf(
    parameters: Mapping[str, Any],
    frequencies: Sequence[float],
    at: Sequence[float],
    object_distance: float | None,
    spectrum: Mapping[float, float] | None,
    rays: int,
    defocus: Sequence[float],
) -> tuple[WaveMtf, ...]:
    """Returns the contrasts that `realistic mtf` computes, one for each position of the film."""
    numbers = ",".join(repr(float(number)) for number in frequencies)
    moved = ",".join(repr(float(number)) for number in defocus)
    words = ["mtf", *_words(at, object_distance, spectrum, rays), f"--frequencies={numbers}", f"--defocus={moved}"]
    found = report(words, parameters)
    wavefront = _wavefront(found)

    def one(table: Mapping[str, Any]) -> WaveMtf:
        def both(name: str) -> NDArray[np.float64]:
            return np.asarray([table["tangential"][name], table["sagittal"][name]], dtype=np.float64)

        tangential, sagittal = both("mtf")
        return WaveMtf(
            frequencies=np.asarray(found["frequencies_per_mm"], dtype=np.float64),
            tangential=tangential,
            sagittal=sagittal,
            geometric=both("geometric"),
            perfect=both("perfect_lens"),
            defocus_mm=table["defocus_mm"],
            error=table["error"],
            wavefront=wavefront,
        )

    return tuple(one(table) for table in found["tables"])


def parameters_of(camera: Camera) -> dict[str, Any]:
    """Returns the parameters of a camera's lens and film, for `psf` and `mtf`."""
    given = camera.parameters
    given.pop("model", None)
    if given.get("focus_by", "film") == "film":
        given.pop("focus_distance", None)
        given["film_distance"] = camera.film_distance
    return given


def from_the_middle(camera: Camera, image_xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns where raster positions (n, 2) lie on the film as in the upright picture: mm to the right and up from the
    middle, (n, 2). In lens space the image is upside down: x and y have the other sign."""
    pixel = camera.film_size_mm[0] / camera.resolution[0]
    across, down = ((image_xy - np.asarray(camera.resolution) / 2) * pixel).T
    return np.stack([across, 0.0 - down], axis=-1)


def is_dark(error: Error) -> bool:
    """Whether an error states that no light, or no chief ray, reaches an image point."""
    return "nearer the axis" in str(error)
