"""Runs jobs in this process, in several processes of this machine, or on the workers of an executor or Dask client."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, TypeVar

from .processes import NoProcessError, Processes

if TYPE_CHECKING:
    from .store import Store

Job = TypeVar("Job")

Progress = Callable[[int, int], object]
"""A function that gets the number of finished jobs and the number of all jobs."""

Submit = Callable[..., Future[bytes]]
"""A function that takes a function and a job for it, as `Executor.submit` does."""


@dataclass(frozen=True)
class Workers:
    """Workers for jobs, and the options for running the jobs.

    Attributes
    ----------
    client : dask.distributed.Client or concurrent.futures.Executor, optional
        Workers for the jobs; default processes of this machine.
    processes : int, optional
        Number of processes of this machine; default one per processor. 1 means this process itself.
    retries : int
        Number of further attempts for a failed job.
    keep : str or path-like, optional
        A folder for results; those that an earlier call left in it are not computed again.
    progress : bool or callable
        Whether to show a bar, or a function that gets the number of finished jobs and the number of all jobs.
    """

    client: Any = None
    processes: int | None = None
    retries: int = 2
    keep: str | os.PathLike[str] | None = None
    progress: bool | Progress = True

    def __post_init__(self) -> None:
        if self.processes is not None and self.processes < 1:
            raise ValueError(f"processes is {self.processes}; give 1 or more")
        if self.retries < 0:
            raise ValueError(f"retries is {self.retries}; give 0 or more")

    def do(
        self,
        function: Callable[[Job], bytes],
        jobs: Sequence[Job],
        failed: Callable[[Job, Exception], bytes],
        unit: str,
    ) -> list[bytes]:
        """Returns the results of a function for some jobs, in the jobs' order.

        Each result is kept, and reported as progress, when it arrives. `failed` gets a job that failed at every
        attempt, with the last exception; it returns a substitute for the result, which is not kept, or raises.
        """
        store = None if self.keep is None else _store(self.keep)
        try:
            keys = [] if store is None else [store.key(job) for job in jobs]
            results: list[bytes | None]
            results = [store.get(key) for key in keys] if store else [None] * len(jobs)
            left = [number for number, result in enumerate(results) if result is None]
            done = len(jobs) - len(left)
            with (
                _shown(self.progress, len(jobs), unit) as show,
                self._submitter(len(left)) as (submit, most),
                closing(self._arriving(partial(submit, function), most, jobs, left)) as arriving,
            ):
                show(done)
                for number, result in arriving:
                    if isinstance(result, Exception):
                        results[number] = failed(jobs[number], result)
                    else:
                        results[number] = result
                        if store is not None:
                            store.put(keys[number], result)
                    done += 1
                    show(done)
        finally:
            if store is not None:
                store.close()
        return [result for result in results if result is not None]

    def _arriving(
        self, submit: Callable[[Job], Future[bytes]], most: int, jobs: Sequence[Job], numbers: Sequence[int]
    ) -> Generator[tuple[int, bytes | Exception], None, None]:
        """Yields the results of jobs with the jobs' numbers, as they arrive; for a failed job, its exception."""
        waiting = deque((number, 0) for number in numbers)
        running: dict[Future[bytes], tuple[int, int]] = {}
        arrived: SimpleQueue[Future[bytes]] = SimpleQueue()
        try:
            while waiting or running:
                while waiting and len(running) < most:
                    number, failures = waiting.popleft()
                    future = submit(jobs[number])
                    running[future] = number, failures
                    future.add_done_callback(arrived.put)
                future = arrived.get()
                number, failures = running.pop(future)
                result = _outcome(future)
                # Dask keeps a result while its future exists, and computes it again if the worker dies. So the future
                # is deleted.
                del future
                if isinstance(result, NoProcessError):
                    raise result
                if isinstance(result, Exception) and failures < self.retries:
                    waiting.appendleft((number, failures + 1))
                else:
                    yield number, result
        finally:
            for future in running:
                future.cancel()

    @contextmanager
    def _submitter(self, jobs: int) -> Iterator[tuple[Submit, int]]:
        """Provides a `Submit` for the jobs, and the number of jobs to give it at once."""
        if self.client is not None:
            # `pure=False`, because Dask must not reuse the result of an equal job from an earlier call: lens files may
            # change.
            executor = self.client if isinstance(self.client, Executor) else self.client.get_executor(pure=False)
            yield executor.submit, max(jobs, 1)
            return
        count = min(self.processes or _processors(), jobs)
        if count <= 1:
            yield _run_here, 1
            return
        processes = Processes(count)
        try:
            with ThreadPoolExecutor(count) as threads:
                yield lambda function, job: threads.submit(processes.run, function, job), count
        finally:
            processes.close()


def _run_here(function: Callable[[Job], bytes], job: Job) -> Future[bytes]:
    """Runs a job in this process, at once."""
    future: Future[bytes] = Future()
    try:
        future.set_result(function(job))
    except Exception as error:  # noqa: BLE001  It is the job's outcome.
        future.set_exception(error)
    return future


def _outcome(future: Future[bytes]) -> bytes | Exception:
    """Returns the result of a finished future, or its exception, which may be its cancellation."""
    try:
        return future.result()
    except Exception as error:  # noqa: BLE001  It is the job's outcome.
        return error


def _store(folder: str | os.PathLike[str]) -> Store:
    # Imported only here, because the store needs sqlite3, which not every Python has.
    from .store import Store

    return Store(folder)


@contextmanager
def _shown(progress: bool | Progress, count: int, unit: str) -> Iterator[Callable[[int], object]]:
    """Reports the number of finished jobs to a callable, or in a bar if tqdm and a terminal are available."""
    if not isinstance(progress, bool):
        report = progress
        yield lambda done: report(done, count)
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        progress = False
    if not progress:
        yield lambda _done: None
        return
    # Work of less than a second needs no bar.
    with tqdm(total=count, unit=unit, disable=None, delay=1.0) as bar:
        before = 0

        def show(done: int) -> None:
            nonlocal before
            bar.update(done - before)
            before = done

        yield show


def _processors() -> int:
    """Returns the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
