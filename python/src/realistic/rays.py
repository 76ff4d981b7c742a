"""Rays as arrays: turns arrays of samples into `Rays` with the C ABI's batch call.

The ABI accepts arrays of any strides, so this module copies only arrays of other number types.
"""

from __future__ import annotations

import ctypes
import enum
import math
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ._abi import Input, Output, Request, Vectors, library
from .errors import check

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_FLOAT32, _INT32 = np.dtype(np.float32), np.dtype(np.int32)

_View = TypeVar("_View", Input, Output, Vectors)


class Reason(enum.IntEnum):
    """Outcome of a sample: the values of `Rays.reason`."""

    OK = 0
    """The ray passes the lens."""
    MISSED = 1
    """The ray misses a surface."""
    CLIPPED = 2
    """The ray meets a surface outside the clear aperture."""
    REFLECTED = 3
    """The ray is totally reflected."""
    TURNED_BACK = 4
    """The next surface lies behind the ray, or the ray travels backward."""
    REDRAW = 5
    """With `disk` "rejection": the lens sample fell outside the disk; draw another."""
    SHUT = 6
    """The shutter covers this film point at this time."""
    WAVELENGTH = 7
    """The wavelength is invalid: NaN, outside 380 to 780 nm, or one at which a glass has no index."""


@dataclass(eq=False, repr=False)
class Rays:
    """Rays in world space; `n` denotes the shape of the samples, usually one number.

    Attributes
    ----------
    origin : ndarray (n, 3) of float32
        Start of the ray, world units; for a lens, the point where it leaves the front surface.
    direction : ndarray (n, 3) of float32
        Unit vectors.
    weight : ndarray (n,) of float32
        Weight of each ray, as the camera's `weighting` defines it; positive, or 0 for a blocked ray.
    mint, maxt : ndarray (n,) of float32, or None
        Distances from the origin at which the ray begins and ends, world units.
    time : ndarray (n,) of float32, or None
        Time between the camera's `shutter_open` and `shutter_close`.
    reason : ndarray (n,) of int32, or None
        `Reason` of each sample.
    rx, ry : Rays, or None
        The rays of the same lens and time sample one pixel to the right (image x + 1) and one pixel down (image y + 1).
        They have only an origin, a direction and a weight. A blocked neighbour has weight 0 and the ray's own origin
        and direction.

    Notes
    -----
    A blocked ray has weight 0, and its other numbers are not written: they are 0 in new arrays of `Camera.rays`, and
    stay unchanged in arrays passed as `out`.
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
        """Selects rays by an index, a slice or a mask over `n`: `rays[rays.weight > 0]`."""
        return replace(self, **{name: array[which] for name, array in vars(self).items() if array is not None})

    def __repr__(self) -> str:
        passed = np.count_nonzero(self.weight)
        return f"<Rays {self.weight.shape}, {passed} of {self.weight.size} get through>"

    @classmethod
    def empty(cls, shape: int | tuple[int, ...], *, reasons: bool = False, differentials: bool = False) -> Rays:
        """Makes rays of zeros, to pass as `out` to `Camera.rays` repeatedly.

        Parameters
        ----------
        shape : int or tuple of int
            The shape of the samples.
        reasons, differentials : bool
            Whether to include `reason`, and `rx` and `ry`.
        """
        shape = (shape,) if isinstance(shape, int) else tuple(shape)
        n = math.prod(shape)
        # Fresh memory from the system is zero already, so zeros cost nothing.
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
    """Returns three rows as vectors, (*shape, 3), in the same memory."""
    return rows.T if len(shape) == 1 else rows.T.reshape(*shape, 3)


def view(kind: type[_View], array: NDArray[Any]) -> _View:
    """Returns the view of an array (n, k) or (n,): the address of the first element of each component, and the
    stride."""
    first = array.__array_interface__["data"][0]
    stride, *step = array.strides
    parts = [first + k * step[0] for k in range(array.shape[1])] if step else [first]
    return kind(**dict(zip("xyz", parts)), stride=stride)


@dataclass
class _Samples:
    """The samples of a call: `image_xy` and `lens_uv` are (n, 2), the others (n,), of any real type and any strides."""

    image_xy: NDArray[Any]
    lens_uv: NDArray[Any]
    time: NDArray[Any] | None
    wavelengths: NDArray[Any] | None = None

    def fill(self, request: Request) -> None:
        """Sets a request's pointers to the samples; copies numbers of other types."""
        if self.time is None:
            # Fresh memory is zero already. If all arrays are contiguous columns, the library reads them without copies.
            self.time = np.zeros(len(self.image_xy), np.float32)
        for field, name in (
            ("image", "image_xy"),
            ("lens", "lens_uv"),
            ("time", "time"),
            ("wavelength", "wavelengths"),
        ):
            array = getattr(self, name)
            if array is None:
                continue
            if array.dtype != _FLOAT32:
                # The copy must stay alive while its address is in use.
                array = array.astype(np.float32, casting="same_kind")
                setattr(self, name, array)
            setattr(request, field, view(Input, array))


class _Target:
    """The arrays that a call writes, flattened to (n, 3) and (n,), by their names in the ABI."""

    def __init__(self, rays: Rays, n: int, name: str | None, prefix: str = "") -> None:
        """Collects the arrays of `rays`. If `name` is given, as for a caller's rays, checks them; messages contain the
        name."""
        self.prefix = prefix
        self.arrays: dict[str, NDArray[Any]] = {}
        for field in ("origin", "direction", "mint", "maxt", "time", "weight", "reason"):
            array = getattr(rays, field)
            if name is not None:
                _check_output(f"{name}.{field}", array, np.shape(rays.weight))
            if array is not None:
                shape = (n, 3) if field in ("origin", "direction") else (n,)
                flat = self.arrays["ray_time" if field == "time" else field] = _flat(name, array, shape)
                if name is not None and _overlaps_itself(flat):
                    raise ValueError(
                        f"{name}.{field} overlaps itself: elements of it share memory, strides {array.strides}"
                    )
        self.temporary: dict[str, NDArray[Any]] = {}

    def fill(self, request: Request) -> None:
        """Sets a request's pointers to the arrays, or to temporary arrays in place of those of other number types."""
        for field, array in self.arrays.items():
            dtype = _INT32 if field == "reason" else _FLOAT32
            if array.dtype != dtype:
                array = self.temporary[field] = np.zeros(array.shape, dtype)
            if field == "reason":
                reasons = view(Output, array)
                request.reason, request.reason_stride = reasons.x, reasons.stride
            else:
                setattr(request, self.prefix + field, view(Output, array))

    def passed(self) -> NDArray[np.bool_]:
        """Returns a mask of the rays that pass the lens."""
        found: NDArray[np.bool_] = self.temporary.get("weight", self.arrays["weight"]) > 0
        return found

    def finish(self, passed: NDArray[np.bool_]) -> None:
        """Copies results from the temporary arrays: weight and reason of every ray, and other numbers of rays that
        pass."""
        for field, numbers in self.temporary.items():
            rows = passed[:, np.newaxis] if numbers.ndim == 2 else passed
            where = True if field in ("weight", "reason") else rows
            np.copyto(self.arrays[field], numbers, casting="same_kind", where=where)


def _check_output(name: str, array: Any, shape: tuple[int, ...]) -> None:
    """Raises for an output array of the wrong kind."""
    field = name.rpartition(".")[2]
    if array is None:
        if field in ("origin", "direction", "weight"):
            raise ValueError(f"{name} must not be None")
        return
    dtype = _INT32 if field == "reason" else _FLOAT32
    expected = (*shape, 3) if field in ("origin", "direction") else shape
    if not isinstance(array, np.ndarray):
        raise TypeError(f"{name} must be a NumPy array, not {type(array).__name__}")
    if array.shape != expected:
        raise ValueError(f"{name} must have shape {expected}, and has {array.shape}")
    # NumPy would also cast numbers to strings, times and bytes.
    if array.dtype.kind not in "iufcO" or not np.can_cast(dtype, array.dtype, "same_kind"):
        raise TypeError(f"{name} must hold {dtype}, and has dtype {array.dtype}")
    if isinstance(array, np.ma.MaskedArray):
        raise TypeError(f"{name} is a masked array, whose mask would be lost; give its data, {name}.data")
    if not array.flags.writeable:
        raise ValueError(f"{name} is read-only")


def _overlaps_itself(flat: NDArray[Any]) -> bool:
    """Whether two elements of an output array, (n, 3) or (n,), share memory."""
    if flat.flags.forc:
        return False
    columns = flat.T if flat.ndim == 2 else flat[np.newaxis]
    one_by_one = len(flat) < 2 or abs(flat.strides[0]) >= flat.itemsize
    return not one_by_one or any(np.shares_memory(one, other) for one, other in combinations(columns, 2))


def _flat(name: str | None, array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    """Returns an output array reshaped to `shape`, in the same memory."""
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
    """Returns samples as an array; checks their type and, if `last` is given, the size of the last dimension."""
    array = np.asarray(given)
    if array.dtype != _FLOAT32 and not np.can_cast(array.dtype, np.float32, "same_kind"):
        raise TypeError(f"{name} must hold real numbers, and has dtype {array.dtype}")
    if last is not None and (array.ndim == 0 or array.shape[-1] != last):
        raise ValueError(f"{name} must have shape (n, {last}), and has {array.shape}")
    return array


def _inputs(
    image_xy: ArrayLike, lens_uv: ArrayLike, time: ArrayLike | None, wavelengths: ArrayLike | None
) -> tuple[_Samples, tuple[int, ...]]:
    """Returns the flattened samples, and the shape that they had before."""
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
            arrays = {"image_xy": xy, "lens_uv": uv, **singles}
            shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
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
    """Traces the samples (image_xy, lens_uv, time, wavelengths) with the pointer of an open camera; see
    `Camera.rays`."""
    given, shape = _inputs(*samples)
    n = len(given.image_xy)
    if out is None:
        out = Rays.empty(shape, reasons=reasons, differentials=differentials)
        parts = {"": out, "rx_": out.rx, "ry_": out.ry}
        targets = [
            _Target(_neighbour_arrays(rays) if prefix else rays, n, None, prefix)
            for prefix, rays in parts.items()
            if rays is not None
        ]
    else:
        targets = _targets(out, n, shape, reasons, differentials)
        _separate(given, targets)
    _run(camera, n, given, targets)
    return out


def _targets(out: Rays, n: int, shape: tuple[int, ...], reasons: bool, differentials: bool) -> list[_Target]:
    """Checks a caller's `out` and returns its arrays."""
    if not isinstance(out, Rays):
        raise TypeError(f"out must be realistic.Rays, not {type(out).__name__}")
    if reasons and out.reason is None:
        raise ValueError("out.reason is None, and reasons are asked for")
    if (out.rx is None) != (out.ry is None):
        raise ValueError("out has one of rx and ry; give both or none")
    if differentials and out.rx is None:
        raise ValueError("out.rx and out.ry are None, and differentials are asked for")
    targets = []
    for name, prefix, rays in (("out", "", out), ("out.rx", "rx_", out.rx), ("out.ry", "ry_", out.ry)):
        if rays is None:
            continue
        if np.shape(rays.weight) != shape:
            raise ValueError(f"{name}.weight must have shape {shape}, and has {np.shape(rays.weight)}")
        targets.append(_Target(_neighbour_arrays(rays) if prefix else rays, n, name, prefix))
    return targets


def _neighbour_arrays(rays: Rays) -> Rays:
    """Returns the arrays that neighbours have: origin, direction and weight."""
    return Rays(rays.origin, rays.direction, rays.weight)


def _separate(samples: _Samples, targets: list[_Target]) -> None:
    """Copies samples that share memory with an output, and refuses outputs that share memory with each other."""
    written = [array for target in targets for array in target.arrays.values()]
    for i, array in enumerate(written):
        if any(np.shares_memory(array, other) for other in written[:i]):
            raise ValueError("two arrays of out share memory")
    for name, given in vars(samples).items():
        if given is not None and any(np.shares_memory(given, array) for array in written):
            setattr(samples, name, given.copy())


def _run(camera: int, n: int, samples: _Samples, targets: list[_Target]) -> None:
    """Calls the library and copies results from temporary arrays."""
    request = Request(struct_size=ctypes.sizeof(Request))
    samples.fill(request)
    for target in targets:
        target.fill(request)
    check(library.realistic_camera_generate_batch(camera, n, request))
    if any(target.temporary for target in targets):
        passed = targets[0].passed()
        for target in targets:
            target.finish(passed)
