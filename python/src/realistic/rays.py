"""Rays as arrays: samples in, `Rays` out, by the C ABI's structure of arrays.

The ABI wants each number of a sample (x, y, u, v, time) and of a ray as an array of its own without gaps. Where the columns
of the caller's arrays are such arrays they are handed over as they are; otherwise a block at a time is copied.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ._abi import RaysPointers, SamplesPointers, library
from .errors import check

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Rays whose numbers are copied at a time; those of the samples stay in a processor's second cache.
_BLOCK = 32768

_FLOAT32, _INT32 = np.dtype(np.float32), np.dtype(np.int32)


class Reason(enum.IntEnum):
    """What became of a sample: the numbers in `Rays.reason`."""

    OK = 0
    """The ray gets through."""
    MISSED = 1
    """It passes beside a surface's sphere."""
    CLIPPED = 2
    """It meets a surface outside the clear aperture."""
    REFLECTED = 3
    """It is totally reflected."""
    TURNED_BACK = 4
    """The next surface lies behind it, or it travels backward."""
    REDRAW = 5
    """With `disk` "rejection": the lens sample fell outside the disk; draw another."""
    SHUT = 6
    """The shutter is closed over this film point at this time."""
    WAVELENGTH = 7
    """The wavelength asked for is not a number from 380 to 780 nm, or one at which a glass has no index."""


@dataclass(eq=False, repr=False)
class Rays:
    """Rays in world space; `n` stands for the shape of the samples, mostly one number.

    Attributes
    ----------
    origin : ndarray (n, 3) of float32
        World units: for a lens, where the ray leaves its front surface.
    direction : ndarray (n, 3) of float32
        Unit length.
    weight : ndarray (n,) of float32
        Positive; 0 for a ray that is blocked. What it measures is the camera's `weighting`.
    mint, maxt : ndarray (n,) of float32, or None
        Distance from the origin at which the ray begins, and ends, world units.
    time : ndarray (n,) of float32, or None
        Between the camera's `shutteropen` and `shutterclose`.
    reason : ndarray (n,) of int32, or None
        A `Reason` each.
    rx, ry : Rays, or None
        The rays of the same lens and time sample one pixel to the right (image x + 1), and one pixel down (image y + 1).
        They have an origin, a direction and a weight. Where a neighbour is blocked its weight is 0 and the ray's own
        origin and direction stand in its place.

    Notes
    -----
    A blocked ray has weight 0, and no other number of it is written: what `Camera.rays` makes has zeros there, what is
    handed to it as `out` keeps what it had.
    """

    origin: NDArray[np.float32]
    direction: NDArray[np.float32]
    weight: NDArray[np.float32]
    mint: NDArray[np.float32] | None = None
    maxt: NDArray[np.float32] | None = None
    time: NDArray[np.float32] | None = None
    reason: NDArray[np.int32] | None = None
    rx: Rays | None = None
    ry: Rays | None = None

    def __len__(self) -> int:
        return len(self.weight)

    def __getitem__(self, which: Any) -> Rays:
        """Some of the rays, by an index, a slice or a mask over `n`: `rays[rays.weight > 0]`."""
        return replace(self, **{name: array[which] for name, array in vars(self).items() if array is not None})

    def __repr__(self) -> str:
        passed = np.count_nonzero(self.weight)
        return f"<Rays {self.weight.shape}, {passed} of {self.weight.size} get through>"

    @classmethod
    def empty(cls, shape: int | tuple[int, ...], *, reasons: bool = False, differentials: bool = False) -> Rays:
        """Rays with zeros everywhere, to be handed as `out` to `Camera.rays` again and again.

        Parameters
        ----------
        shape : int or tuple of int
            The shape of the samples.
        reasons, differentials : bool
            Whether there are `reason`, and `rx` and `ry`.
        """
        shape = (shape,) if isinstance(shape, int) else tuple(shape)
        n = math.prod(shape)
        # Fresh memory is zero: zeros cost nothing.
        numbers = np.zeros((10, n), np.float32)
        mint, maxt, time, weight = (row.reshape(shape) for row in numbers[6:])
        rays = cls(_vectors(numbers[0:3], shape), _vectors(numbers[3:6], shape), weight, mint, maxt, time)
        if reasons:
            rays.reason = np.zeros(shape, np.int32)
        if differentials:
            rays.rx, rays.ry = (
                cls(_vectors(numbers[0:3], shape), _vectors(numbers[3:6], shape), numbers[6].reshape(shape))
                for numbers in np.zeros((2, 7, n), np.float32)
            )
        return rays


def _vectors(rows: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Three rows as vectors, (*shape, 3), in the same memory."""
    return rows.T if len(shape) == 1 else rows.T.reshape(*shape, 3)


def _is_packed(array: NDArray[Any], dtype: np.dtype[Any]) -> bool:
    """Whether the columns of (n, k), or (n,) itself, are what the ABI takes."""
    return array.dtype == dtype and (array.strides[0] == dtype.itemsize or len(array) <= 1) and array.flags.aligned


def _addresses(array: NDArray[Any]) -> Iterator[int]:
    """Where the columns of (n, k), or (n,) itself, begin."""
    first: int = array.__array_interface__["data"][0]
    if array.ndim == 1:
        return iter((first,))
    step = array.strides[1]
    return iter(range(first, first + step * array.shape[1], step)) if step else iter((first,) * array.shape[1])


@dataclass
class _Samples:
    """The samples of a call: (n, 2), (n, 2), and (n,) for the others, of any real type and strides."""

    image_xy: NDArray[Any]
    lens_uv: NDArray[Any]
    time: NDArray[Any] | None
    wavelengths: NDArray[Any] | None = None

    def columns(self) -> list[int] | None:
        """The addresses of the six columns, the last 0 where there are no wavelengths; None where they must be copied."""
        given = (self.image_xy, self.lens_uv, self.time, self.wavelengths)
        if not all(_is_packed(array, _FLOAT32) for array in given if array is not None):
            return None
        if self.time is None:
            # Kept here, as long as its address is in use.
            self.time = np.zeros(len(self.image_xy), np.float32)
        arrays = (self.image_xy, self.lens_uv, self.time)
        addresses = [address for array in arrays for address in _addresses(array)]
        return [*addresses, *([0] if self.wavelengths is None else _addresses(self.wavelengths))]

    def read(self, begin: int, end: int, room: NDArray[np.float32]) -> None:
        """Copies a block into the six rows of `room`; those of what is not given stay as they are."""
        count = end - begin
        for row, array in ((0, self.image_xy), (2, self.lens_uv)):
            for k in range(2):
                np.copyto(room[row + k, :count], array[begin:end, k], casting="same_kind")
        for row, numbers in ((4, self.time), (5, self.wavelengths)):
            if numbers is not None:
                np.copyto(room[row, :count], numbers[begin:end], casting="same_kind")


class _Target:
    """The arrays that a call writes, flat: (n, 3), (n, 3), and (n,) or None for the others, in the ABI's order."""

    def __init__(self, rays: Rays, n: int, name: str | None) -> None:
        """`name` is that of the rays where they are a caller's, to be checked and told."""
        fields = ("origin", "direction", "mint", "maxt", "time", "weight", "reason")
        arrays = [getattr(rays, field) for field in fields]
        if name is not None:
            shape = np.shape(rays.weight)
            for field, array in zip(fields, arrays):
                _check_output(f"{name}.{field}", array, shape)
        self.vectors = [_flat(name, array, (n, 3)) for array in arrays[:2]]
        self.numbers = [None if array is None else _flat(name, array, (n,)) for array in arrays[2:]]

    def columns(self) -> list[int] | None:
        """The addresses of the eleven columns, 0 for none; None where they must be copied."""
        reason = self.numbers[4]
        floats = [*self.vectors, *(array for array in self.numbers[:4] if array is not None)]
        if not all(_is_packed(array, _FLOAT32) for array in floats):
            return None
        if reason is not None and not _is_packed(reason, _INT32):
            return None
        addresses = [address for array in self.vectors for address in _addresses(array)]
        for array in self.numbers:
            addresses += [0] if array is None else _addresses(array)
        return addresses

    def write(self, begin: int, end: int, room: _Room, passed: NDArray[np.bool_] | bool) -> None:
        """Copies a block from `room`: of every ray what tells its fate, the rest of those that pass."""
        count = end - begin
        for row, array in zip((0, 3), self.vectors):
            for k in range(3):
                np.copyto(array[begin:end, k], room.floats[row + k, :count], casting="same_kind", where=passed)
        *extent, weight, reason = self.numbers
        for row, number in zip((6, 7, 8), extent):
            if number is not None:
                np.copyto(number[begin:end], room.floats[row, :count], casting="same_kind", where=passed)
        assert weight is not None
        np.copyto(weight[begin:end], room.floats[9, :count], casting="same_kind")
        if reason is not None:
            np.copyto(reason[begin:end], room.reasons[:count], casting="same_kind")

    def all(self) -> Iterator[NDArray[Any]]:
        """Each array that is there."""
        yield from self.vectors
        yield from (array for array in self.numbers if array is not None)


class _Room:
    """A block of rays as the ABI writes them."""

    def __init__(self, count: int, target: _Target) -> None:
        self.floats = np.zeros((10, count), np.float32)
        self.reasons = np.zeros(count, np.int32)
        is_there = [True] * 6 + [array is not None for array in target.numbers]
        addresses = [*_addresses(self.floats.T), *_addresses(self.reasons)]
        self.columns = [address if there else 0 for address, there in zip(addresses, is_there)]


def _check_output(name: str, array: Any, shape: tuple[int, ...]) -> None:
    """Refuses what cannot be written to."""
    field = name.rpartition(".")[2]
    if array is None:
        if field in ("origin", "direction", "weight"):
            raise ValueError(f"{name} must not be None")
        return
    dtype = _INT32 if field == "reason" else _FLOAT32
    wanted = (*shape, 3) if field in ("origin", "direction") else shape
    if not isinstance(array, np.ndarray):
        raise TypeError(f"{name} must be a NumPy array, not {type(array).__name__}")
    if array.shape != wanted:
        raise ValueError(f"{name} must have shape {wanted}, and has {array.shape}")
    if not np.can_cast(dtype, array.dtype, "same_kind"):
        raise TypeError(f"{name} must hold {dtype}, and has dtype {array.dtype}")
    if not array.flags.writeable:
        raise ValueError(f"{name} is read-only")


def _flat(name: str | None, array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    """An array to write to with other dimensions, in the same memory."""
    if array.shape == shape:
        return array
    flat = array.reshape(shape)
    if array.size > 0 and not np.may_share_memory(flat, array):
        raise ValueError(
            f"an array of {name} with shape {array.shape} and strides {array.strides} cannot be filled in one go; give "
            "one of fewer dimensions, or without gaps"
        )
    return flat


def _input(name: str, given: ArrayLike, last: int | None) -> NDArray[Any]:
    """An array of samples, whose last dimension has `last` numbers."""
    array = np.asarray(given)
    if array.dtype != _FLOAT32 and not np.can_cast(array.dtype, np.float32, "same_kind"):
        raise TypeError(f"{name} must hold real numbers, and has dtype {array.dtype}")
    if last is not None and (array.ndim == 0 or array.shape[-1] != last):
        raise ValueError(f"{name} must have shape (n, {last}), and has {array.shape}")
    return array


def _inputs(
    image_xy: ArrayLike, lens_uv: ArrayLike, time: ArrayLike | None, wavelengths: ArrayLike | None
) -> tuple[_Samples, tuple[int, ...]]:
    """The samples, flat, and the shape that they came in."""
    xy, uv = _input("image_xy", image_xy, 2), _input("lens_uv", lens_uv, 2)
    singles = {
        name: _input(name, given, None)
        for name, given in (("time", time), ("wavelengths", wavelengths))
        if given is not None
    }
    shape = xy.shape[:-1]
    if len(shape) != 1 or any(other != shape for other in (uv.shape[:-1], *(each.shape for each in singles.values()))):
        try:
            shape = np.broadcast_shapes(shape, uv.shape[:-1], *(each.shape for each in singles.values()))
        except ValueError:
            told = {"image_xy": xy, "lens_uv": uv, **singles}
            shapes = ", ".join(f"{name} {array.shape}" for name, array in told.items())
            raise ValueError(f"the samples are not equally many: {shapes}") from None
        xy, uv = (np.broadcast_to(array, (*shape, 2)).reshape(-1, 2) for array in (xy, uv))
        singles = {name: np.broadcast_to(each, shape).reshape(-1) for name, each in singles.items()}
    return _Samples(xy, uv, singles.get("time"), singles.get("wavelengths")), shape


def trace(
    camera: int,
    samples: tuple[ArrayLike, ArrayLike, ArrayLike | None, ArrayLike | None],
    out: Rays | None,
    reasons: bool,
    differentials: bool,
) -> Rays:
    """The rays of samples (image_xy, lens_uv, time, wavelengths) of a live camera's pointer. See `Camera.rays`."""
    given, shape = _inputs(*samples)
    n = len(given.image_xy)
    if out is None:
        out = Rays.empty(shape, reasons=reasons, differentials=differentials)
        targets = [_Target(rays, n, None) for rays in (out, out.rx, out.ry) if rays is not None]
    else:
        targets = _targets(out, n, shape, reasons, differentials)
        _separate(given, targets)
    if given.wavelengths is not None and len(targets) > 1:
        raise ValueError(
            "rays at wavelengths have no differentials; ask for the rays one pixel to the right and one down: "
            "image_xy + [1, 0], image_xy + [0, 1]"
        )
    _run(camera, n, given, targets)
    return out


def _targets(out: Rays, n: int, shape: tuple[int, ...], reasons: bool, differentials: bool) -> list[_Target]:
    """What a caller's `out` has, checked."""
    if not isinstance(out, Rays):
        raise TypeError(f"out must be realistic.Rays, not {type(out).__name__}")
    if reasons and out.reason is None:
        raise ValueError("out.reason is None, and reasons are asked for")
    if (out.rx is None) != (out.ry is None):
        raise ValueError("out has one of rx and ry; give both or none")
    if differentials and out.rx is None:
        raise ValueError("out.rx and out.ry are None, and differentials are asked for")
    targets = []
    for name, rays in (("out", out), ("out.rx", out.rx), ("out.ry", out.ry)):
        if rays is None:
            continue
        if name != "out":
            # All that there is of a neighbour.
            rays = Rays(rays.origin, rays.direction, rays.weight)
        if np.shape(rays.weight) != shape:
            raise ValueError(f"{name}.weight must have shape {shape}, and has {np.shape(rays.weight)}")
        targets.append(_Target(rays, n, name))
    return targets


def _separate(samples: _Samples, targets: list[_Target]) -> None:
    """Copies samples that share memory with an output, and refuses outputs that share memory with each other."""
    written = [array for target in targets for array in target.all()]
    for i, array in enumerate(written):
        if any(np.shares_memory(array, other) for other in written[:i]):
            raise ValueError("two arrays of out share memory")
    for name, given in vars(samples).items():
        if given is not None and any(np.shares_memory(given, array) for array in written):
            setattr(samples, name, given.copy())


def _run(camera: int, n: int, samples: _Samples, targets: list[_Target]) -> None:
    """Calls the library, once where all arrays are as it wants them, otherwise block by block."""
    asked, found = samples.columns(), [target.columns() for target in targets]
    if asked is not None and None not in found:
        _call(camera, n, asked, [columns for columns in found if columns])
        return
    count = min(n, _BLOCK)
    read_to = np.zeros((6, count), np.float32)
    read_from = [*_addresses(read_to[:5].T), 0 if samples.wavelengths is None else read_to[5].ctypes.data]
    rooms = [_Room(count, target) if columns is None else None for target, columns in zip(targets, found)]
    for begin in range(0, n, _BLOCK):
        end = min(begin + _BLOCK, n)
        if asked is None:
            samples.read(begin, end, read_to)
        columns_of = [_moved(columns, begin) if room is None else room.columns for columns, room in zip(found, rooms)]
        _call(camera, end - begin, read_from if asked is None else _moved(asked, begin), columns_of)
        passed: NDArray[np.bool_] | bool | None = None
        for target, room in zip(targets, rooms):
            if room is not None:
                if passed is None:
                    passed = _passed(targets[0], rooms[0], begin, end)
                target.write(begin, end, room, passed)


def _call(camera: int, n: int, asked: list[int], found: list[list[int]]) -> None:
    """The library's function for what is asked: the addresses of six columns of samples, and eleven for each ray."""
    samples, rays = SamplesPointers(*asked[:5]), [RaysPointers(*columns) for columns in found]
    if len(rays) > 1:
        check(library.realistic_camera_generate_ray_differentials_soa(camera, n, samples, *rays))
    elif asked[5]:
        check(library.realistic_camera_generate_rays_at_soa(camera, n, samples, asked[5], *rays))
    else:
        check(library.realistic_camera_generate_rays_soa(camera, n, samples, *rays))


def _moved(columns: list[int] | None, begin: int) -> list[int]:
    """The columns of a caller's arrays from ray `begin` on; a number has 4 bytes, and 0 stays "none"."""
    return [address and address + 4 * begin for address in columns or ()]


def _passed(target: _Target, room: _Room | None, begin: int, end: int) -> NDArray[np.bool_] | bool:
    """Which rays of a block get through; True for all."""
    weight = target.numbers[3]
    assert weight is not None
    weights = weight[begin:end] if room is None else room.floats[9, : end - begin]
    passed: NDArray[np.bool_] = weights > 0
    return True if passed.all() else passed
