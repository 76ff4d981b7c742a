"""The overhead of `Camera.rays` over the C call, for a batch of 1e6 rays of dgauss.50mm in arrays of several layouts.

$ python benches/rays.py

Runs are interleaved. Each result is the median ratio of the thread CPU time to that of the C call that writes the same
columns. The C calls go through ctypes with pointers made beforehand; of their 15 ms, the Python code around them takes
some microseconds.
"""

import ctypes
import statistics
import time
from collections.abc import Callable

import numpy as np

import realistic
from realistic import _abi

N = 1_000_000
ROUNDS = 25


def cases(camera: realistic.Camera) -> dict[str, Callable[[], object]]:
    random = np.random.default_rng(1)
    xy = random.random((N, 2), np.float32) * np.float32(camera.resolution)
    uv = random.random((N, 2), np.float32)
    xy_columns, uv_columns = np.asfortranarray(xy), np.asfortranarray(uv)
    xy_double, uv_double = xy.astype(float), uv.astype(float)
    pointer = camera._live().pointer

    no_time = np.zeros(N, np.float32)
    out, lean = realistic.Rays.empty(N), realistic.Rays.empty(N)
    lean.mint = lean.maxt = lean.time = None
    rows = realistic.Rays(np.zeros((N, 3), np.float32), np.zeros((N, 3), np.float32), np.zeros(N, np.float32))

    def call(request: _abi.Request) -> None:
        assert _abi.library.realistic_camera_generate_batch(pointer, N, request) == 0

    def c(target: realistic.Rays) -> None:
        request = _abi.Request(struct_size=ctypes.sizeof(_abi.Request))
        request.image = _abi.Input(*(column.ctypes.data for column in xy_columns.T), 4)
        request.lens = _abi.Input(*(column.ctypes.data for column in uv_columns.T), 4)
        request.time = _abi.Input(no_time.ctypes.data, None, 4)
        request.origin = _abi.Output(*(column.ctypes.data for column in target.origin.T), 4)
        request.direction = _abi.Output(*(column.ctypes.data for column in target.direction.T), 4)
        for name in ("mint", "maxt", "time", "weight"):
            column = getattr(target, name)
            if column is not None:
                column_view = _abi.Output(column.ctypes.data, None, None, 4)
                setattr(request, "ray_time" if name == "time" else name, column_view)
        call(request)

    sample_rows = np.concatenate([xy, uv, np.zeros((N, 1), np.float32)], axis=1)
    ray_rows, weights = np.zeros((N, 9), np.float32), np.zeros(N, np.float32)

    def c_structures(ray_rows: np.ndarray = ray_rows, weights: np.ndarray = weights) -> None:
        sample, ray = sample_rows.ctypes.data, ray_rows.ctypes.data
        request = _abi.Request(struct_size=ctypes.sizeof(_abi.Request))
        request.image, request.lens = _abi.Input(sample, sample + 4, 20), _abi.Input(sample + 8, sample + 12, 20)
        request.time = _abi.Input(sample + 16, None, 20)
        request.origin = _abi.Output(ray, ray + 4, ray + 8, 36)
        request.direction = _abi.Output(ray + 12, ray + 16, ray + 20, 36)
        for name, at in (("mint", 24), ("maxt", 28), ("ray_time", 32)):
            setattr(request, name, _abi.Output(ray + at, None, None, 36))
        request.weight = _abi.Output(weights.ctypes.data, None, None, 4)
        call(request)

    return {
        "C, columns": lambda: c(out),
        "C, columns, new memory": lambda: c(realistic.Rays.empty(N)),
        "C, structures": c_structures,
        "C, structures, new memory": lambda: c_structures(np.zeros((N, 9), np.float32), np.zeros(N, np.float32)),
        "columns, out=": lambda: camera.rays(xy_columns, uv_columns, out=out),
        "columns": lambda: camera.rays(xy_columns, uv_columns),
        "(n, 2) in C order, out=": lambda: camera.rays(xy, uv, out=out),
        "(n, 2) in C order": lambda: camera.rays(xy, uv),
        "float64, out=": lambda: camera.rays(xy_double, uv_double, out=out),
        "C, columns, no mint, maxt, time": lambda: c(lean),
        "columns, out= without mint, maxt, time": lambda: camera.rays(xy_columns, uv_columns, out=lean),
        "(n, 2) in C order, out= (n, 3) in C order": lambda: camera.rays(xy, uv, out=rows),
    }


def main() -> None:
    camera = realistic.Camera("dgauss.50mm", resolution=(1920, 1280), focus_distance=1000.0)
    todo = cases(camera)
    taken: dict[str, list[float]] = {name: [] for name in todo}
    for _ in range(ROUNDS):
        for name, run in todo.items():
            begin = time.thread_time_ns()
            run()
            taken[name].append((time.thread_time_ns() - begin) / N)
    base = {name: "C, columns" for name in todo}
    of_structures = dict.fromkeys(todo, "C, structures")
    for name in ("C, columns, new memory", "columns", "(n, 2) in C order"):
        base[name], of_structures[name] = "C, columns, new memory", "C, structures, new memory"
    for name in ("columns, out= without mint, maxt, time", "(n, 2) in C order, out= (n, 3) in C order"):
        base[name] = "C, columns, no mint, maxt, time"
    print("| | ns per ray | of the C call with columns | of the C call with structures |\n|---|---|---|---|")
    for name, times in taken.items():
        ratios = [
            statistics.median(t / b for t, b in zip(times, taken[other])) for other in (base[name], of_structures[name])
        ]
        print(f"| {name} | {statistics.median(times):.2f} | {ratios[0]:.3f} | {ratios[1]:.3f} |")


if __name__ == "__main__":
    main()
