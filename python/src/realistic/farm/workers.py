"""Where work is done: in this process, in several of this machine, or wherever a Dask client's workers are."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, ProcessPoolExecutor
from typing import Any, TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")


def spread(
    function: Callable[[Job], Result], jobs: Iterable[Job], client: Any = None, processes: int | None = None
) -> list[Result]:
    """The results of a function for some jobs, in their order, wherever they were found.

    `client` is a `dask.distributed.Client` or a `concurrent.futures.Executor`; without one, `processes` of this machine do
    the work, as many as it has processors unless told otherwise.

    Raises
    ------
    ValueError
        For a number of processes that is none.
    """
    jobs = list(jobs)
    if client is not None:
        if isinstance(client, Executor):
            return list(client.map(function, jobs))
        # Not pure: equal jobs of another call must not find an old result, for lens files may change.
        return list(client.gather(client.map(function, jobs, pure=False)))
    if processes is not None and processes < 1:
        raise ValueError(f"processes is {processes}; give 1 or more")
    count = min(processes or _processors(), len(jobs))
    if count <= 1:
        return [function(job) for job in jobs]
    # A process that has threads, as many have, must not fork.
    with ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn")) as pool:
        return list(pool.map(function, jobs))


def _processors() -> int:
    """The processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
