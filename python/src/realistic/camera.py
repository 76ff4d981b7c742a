"""The camera, which is built from parameters and generates rays."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _export
from . import autofocus as _autofocus
from . import rays as _rays
from ._abi import CameraInfo, library, text_of
from ._handle import Borrowed, Handle, build
from .errors import check, quietly, warn
from .parameters import INSTEAD_OF, checked, matrix_of, options_of, resolution_of

if TYPE_CHECKING:
    import os
    from types import TracebackType

    from numpy.typing import ArrayLike, NDArray

    # Every type checker knows this module; it is not needed at run time.
    from typing_extensions import Self, Unpack

    from ._parameters import Parameters


class Camera:
    """A camera with a real lens: rays start on the film, pass every surface of the lens and leave for the scene.

    Parameters
    ----------
    lens_file : str or path-like, optional
        A lens file, or a name that `realistic.catalogue` lists, such as "wide.22mm"; default "dgauss.50mm".
        "NAME@35mm" scales a lens of the catalogue to a focal length of 35 mm.
    resolution : (int, int)
        Width and height of the picture in pixels.
    camera_to_world : array_like (4, 4), optional
        Transform from camera space to world space, for column vectors. Camera space has +z forward, +x right, +y up, a
        unit of `mm_per_unit` millimetres, and its origin at the lens's front vertex. Default: the identity.
    camera_to_world_end : array_like (4, 4), optional
        Pose of a moving camera at `transform_end`; `camera_to_world` is the pose at `transform_start`.
    transform_start, transform_end : float, optional
        Times of the two poses; default `shutter_open` and `shutter_close`.
    **parameters
        Parameters of `realistic.Parameters`, which have the same names in every host program: `focus_distance`,
        `fnumber`, `film_diagonal`, `mm_per_unit`, `model` and so on. None means the default.

    Raises
    ------
    realistic.Error
        Usually a `ParameterError`, `LensFileError` or `FocusError`, with the library's message.
    TypeError, ValueError
        For an unknown name, text in place of a number, NaN, or a matrix of the wrong shape.

    Warns
    -----
    realistic.CameraWarning
        For a warning of the library, reported at the caller's line. Informational messages go to the logger
        "realistic".

    Notes
    -----
    Cameras are immutable and thread-safe. A pickled camera consists of its parameters: unpickling builds the camera
    again, and reads a lens file by the same name. `close`, leaving a `with` block and deletion free the memory.

    Examples
    --------
    >>> import numpy as np, realistic
    >>> camera = realistic.Camera("dgauss.50mm", resolution=(1920, 1280), focus_distance=1000.0)
    >>> rays = camera.rays(np.array([[960.0, 640.0]]), np.array([[0.5, 0.5]]))
    >>> round(float(rays.direction[0, 2]), 6)
    1.0
    """

    def __init__(
        self,
        lens_file: str | os.PathLike[str] | None = None,
        *,
        resolution: Iterable[int],
        camera_to_world: ArrayLike | None = None,
        camera_to_world_end: ArrayLike | None = None,
        transform_start: float | None = None,
        transform_end: float | None = None,
        **parameters: Unpack[Parameters],
    ) -> None:
        self._set_up(
            None,
            {"lens_file": lens_file, **parameters},
            resolution,
            {"camera_to_world": camera_to_world, "camera_to_world_end": camera_to_world_end},
            {"transform_start": transform_start, "transform_end": transform_end},
        )

    def _set_up(
        self,
        donor: Handle | Borrowed | None,
        parameters: dict[str, Any],
        resolution: Iterable[int],
        matrices: dict[str, ArrayLike | None],
        times: dict[str, float | None],
    ) -> None:
        """Builds the camera, from a donor if there is one."""
        self._parameters = checked(parameters)
        self._resolution = resolution_of(resolution)
        self._pose: dict[str, Any] = {}
        for name, matrix in matrices.items():
            if matrix is not None:
                self._pose[name] = matrix_of(name, matrix)
        for name, time in times.items():
            if time is not None:
                self._pose[name] = time
        self._handle: Handle | Borrowed | None = None
        options = options_of(self._parameters, self._resolution, self._pose)
        if donor is not None:
            options.donor = donor.pointer
        self._handle, messages = build(options, library.realistic_camera_new, library.realistic_camera_free)
        for message in messages:
            warn(message)

    # Properties.

    @property
    def resolution(self) -> tuple[int, int]:
        """Width and height of the picture, pixels."""
        return self._resolution

    @property
    def crop(self) -> tuple[int, int, int, int]:
        """Pixels to render: first x, first y, end x, end y (ends exclusive); the whole picture unless `crop` was
        given."""
        x_from, y_from, x_to, y_to = self._info().crop
        return x_from, y_from, x_to, y_to

    @property
    def parameters(self) -> dict[str, Any]:
        """The given parameters, by name."""
        return dict(self._parameters)

    @property
    def lens_name(self) -> str:
        """The lens's name; empty for a model without a lens."""
        handle = self._live()
        status, text = text_of(library.realistic_camera_get_lens_name, handle.pointer)
        check(status)
        return text

    @property
    def interfaces(self) -> int:
        """Interfaces of the lens, the stop included; 0 for a model without a lens."""
        return int(self._info().interfaces)

    @property
    def focal_length_mm(self) -> float:
        """Effective focal length; infinite for an afocal lens, NaN for a model without a lens."""
        return float(self._info().focal_length_mm)

    @property
    def fnumber(self) -> float:
        """Focal length divided by the axial beam's diameter at the current stop, from exact rays; NaN without a
        lens."""
        return float(self._info().fnumber)

    @property
    def film_distance(self) -> float:
        """Distance from the last vertex to the film, mm; NaN for a model without a lens."""
        return float(self._info().film_distance)

    @property
    def focus_distance_mm(self) -> float:
        """Distance from the film plane to the plane in focus; infinity if focused at infinity or beyond.

        NaN if nothing in front of the lens is in focus, and for a model without a lens.
        """
        return float(self._info().focus_distance_mm)

    @property
    def film_diagonal(self) -> float:
        """Film diagonal, mm; NaN for a model without a lens."""
        return float(self._info().film_diagonal)

    @property
    def film_size_mm(self) -> tuple[float, float]:
        """Width and height of the film; its pixels are square."""
        width, height = self._resolution
        scale = self.film_diagonal / float(np.hypot(width, height))
        return width * scale, height * scale

    def plan(self) -> str:
        """Returns a readable description of what the camera keeps and omits, and of the lens model chosen for a
        tolerance."""
        handle = self._live()
        status, text = text_of(library.realistic_camera_plan, handle.pointer)
        check(status)
        return text

    # Operations.

    def rays(
        self,
        image_xy: ArrayLike,
        lens_uv: ArrayLike,
        time: ArrayLike | None = None,
        *,
        wavelengths: ArrayLike | None = None,
        out: _rays.Rays | None = None,
        reasons: bool = False,
        differentials: bool = False,
    ) -> _rays.Rays:
        """Generates the rays of samples.

        Parameters
        ----------
        image_xy : array_like (n, 2)
            Raster position in pixels: (0, 0) is the top left corner of the picture, `resolution` the bottom right one;
            the centre of pixel (i, j) is (i + 0.5, j + 0.5).
        lens_uv : array_like (n, 2)
            Lens sample (u, v), each in [0, 1]; values outside are clamped.
        time : array_like (n,), optional
            Time as a fraction of the shutter's interval, in [0, 1]; default 0, when the shutter opens.
        wavelengths : array_like (n,), optional
            Wavelengths of the rays, nm, from 380 to 780; default the camera's wavelength. Film, stop and exposure stay
            as they are at the camera's wavelength.
        out : Rays, optional
            Arrays to write to; members that are None are not written. `Rays.empty` makes such arrays.
        reasons : bool
            Whether to report the outcome of each sample, in `reason`.
        differentials : bool
            Whether to also return the rays one pixel to the right and one pixel down, in `rx` and `ry`, at each ray's
            own wavelength.

        Returns
        -------
        Rays
            `out`, if given. New arrays are stored by column: `origin[:, 0]` is contiguous.

        Raises
        ------
        TypeError, ValueError
            For arrays of the wrong dtype or shape, which the message states; for a closed camera.

        Notes
        -----
        The inputs are broadcast together: `n` may be any shape, and a single (u, v) may serve all film points.

        Rays are traced from float32 samples; other dtypes are converted. A float32 array with contiguous columns (an
        array (2, n), transposed) is not copied. Other arrays, including (n, 2) in C order, are copied block by block,
        at about a nanosecond per ray. A sample that contains NaN or infinity is blocked, except that an infinite u or v
        is clamped. Output arrays may share memory with the input; outputs that share memory with each other are an
        error.
        """
        handle = self._live()
        samples = (image_xy, lens_uv, time, wavelengths)
        return _rays.trace(handle.pointer, samples, out, reasons, differentials)

    def replace(self, **changes: Any) -> Camera:
        """Returns a new camera with some arguments changed; None removes an argument.

        A parameter replaces its alternative: `fnumber` replaces `aperture_diameter`, `film_distance` replaces
        `focus_distance`.

        Notes
        -----
        The rays equal those of a newly built camera to the last bit. Building is faster, because the new camera reuses
        everything that depends only on unchanged arguments. It does not read the lens again; nor does it set the lens
        up again if the stop, the wavelength and the positions of the lens groups stay the same. In an animation of the
        focus, build each frame's camera by `replace` of the previous frame's.
        """
        arguments = self._arguments()
        for name in changes:
            for displaced in {name, *INSTEAD_OF.get(name, ())}:
                arguments.pop(displaced, None)
        arguments.update(changes)
        handle = self._handle
        if handle is None:
            return Camera(**arguments)
        pose = ("camera_to_world", "camera_to_world_end"), ("transform_start", "transform_end")
        matrices, times = ({name: arguments.pop(name, None) for name in names} for names in pose)
        other = Camera.__new__(Camera)
        other._set_up(
            handle,
            arguments,
            arguments.pop("resolution"),
            matrices,
            times,
        )
        return other

    def autofocus(
        self,
        zones: ArrayLike,
        *,
        distance: Callable[[NDArray[np.float32], NDArray[np.float32]], float | None] | None = None,
        contrast: Callable[[Camera, tuple[float, float, float, float]], float | None] | None = None,
        rule: str = "nearest",
    ) -> float:
        """Returns the film distance, mm, that focuses the camera on what some zones of the picture show.

        `camera.replace(film_distance=camera.autofocus(...))` is the focused camera.

        Parameters
        ----------
        zones : array_like (n, 4)
            Left, top, right and bottom edge of each zone, pixels.
        distance : callable, optional
            Gets a ray's origin (3,) and direction (3,); returns the distance along the ray to the first surface in
            world units, inf for a miss, or None if unknown. It is called for several rays per zone.
        contrast : callable, optional
            Gets a trial camera, which is valid until the function returns, and a zone; returns the contrast of that
            camera's picture in the zone, 0 or more, or None if unknown. It is called for tens to hundreds of cameras.
            Give either this or `distance`.
        rule : str
            Choice among several zones: "nearest" takes the zone that sees the nearest object, "centre" the zone nearest
            the middle of the picture, "average" the mean of their film distances.

        Raises
        ------
        realistic.FocusError
            If autofocus finds no film distance in any zone.
        TypeError
            If neither or both of `distance` and `contrast` are given, or the given one is not callable.
        """
        given = [function for function in (distance, contrast) if function is not None]
        if len(given) != 1 or not callable(given[0]):
            raise TypeError("autofocus needs one of distance and contrast, a function")
        parameters = {**self._parameters}
        for name in ("film_distance", "focus_distance"):
            parameters.pop(name, None)

        def with_trial(pointer: int, zone: tuple[float, float, float, float]) -> float | None:
            trial = Camera.__new__(Camera)
            trial._parameters, trial._resolution, trial._pose = parameters, self._resolution, self._pose
            trial._handle = Borrowed(pointer)
            with trial:
                return contrast(trial, zone)  # type: ignore[misc]

        self._live()
        options = options_of(parameters, self._resolution, self._pose)
        of_trial = with_trial if contrast is not None else None
        return _autofocus.film_distance(options, zones, rule, distance, of_trial)

    def export(self, model: str) -> dict[str, Any]:
        """Exports the lens for other programs, from its chief rays: a distortion model, or maps with a value for every
        pixel.

        `measure.intrinsics` instead fits a model to mean rays, and so to the camera's pictures.

        Parameters
        ----------
        model : str
            Format, as for `realistic export --as`: "opencv", "opencv-rational", "kannala-brandt", "ftheta",
            "opentrackio", "usd", "st-map", "rays", "illumination" or "spot".

        Returns
        -------
        dict
            The program's report, with lists of numbers as arrays: `parameters`, those of the model; `errors`, its
            deviations from exact chief rays, pixels; `breathing`, the errors at other focus distances; and
            `pupil_walk_mm`. A format that is written to a file adds the file's contents as `text`. "st-map" adds
            `undistort` and `distort`, (height, width, 3); "rays" adds `origin`, mm in lens space, and `direction`, each
            (height, width, 3); "illumination" adds `map`, (height, width).

        Raises
        ------
        FileNotFoundError
            If the program `realistic` is not found.
        realistic.Error
            With the program's message, if it fails.
        ValueError
            For a camera of another model than "lens".

        Notes
        -----
        docs/export.md has the formulas. The package's own program writes the export, which does not depend on the
        camera's pose, shutter or sampling.
        """
        return _export.export(self._parameters, self._resolution, self.film_diagonal, model)

    def close(self) -> None:
        """Frees the camera's memory once calls in other threads have returned; a second call does nothing."""
        self._handle = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        given = dict(self._parameters)
        words = [repr(given.pop("lens_file"))] if "lens_file" in given else []
        words.append(f"resolution={self._resolution}")
        words += [f"{name}={value if name != 'lens_text' else '...'!r}" for name, value in given.items()]
        words += [f"{name}=..." for name in self._pose]
        return f"Camera({', '.join(words)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self._arguments(),)

    def _arguments(self) -> dict[str, Any]:
        return {**self._parameters, **self._pose, "resolution": self._resolution}

    def _live(self) -> Handle | Borrowed:
        handle = self._handle
        if handle is None:
            raise ValueError("this camera is closed")
        return handle

    def _info(self) -> CameraInfo:
        handle = self._live()
        info = CameraInfo(struct_size=ctypes.sizeof(CameraInfo))
        check(library.realistic_camera_get_info(handle.pointer, ctypes.byref(info)))
        return info


def _again(arguments: dict[str, Any]) -> Camera:
    """Rebuilds a pickled camera, without the warnings that the first one gave."""
    with quietly():
        return Camera(**arguments)
