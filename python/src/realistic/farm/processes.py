"""A pool of processes on this machine, which survives the death of a process."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from queue import SimpleQueue
from typing import TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")

_STARTS = 3
"""Number of attempts to start a process that ends before it takes a job."""


class NoProcessError(RuntimeError):
    """No process can be started on this machine, whatever the job."""


class Processes:
    """A set of processes, each of which runs one job at a time.

    A `ProcessPoolExecutor` fails all its jobs when one of its processes dies. Therefore each process has an executor of
    its own: when a process dies, only its own job fails, and another process replaces it.
    """

    def __init__(self, count: int) -> None:
        self._idle: SimpleQueue[ProcessPoolExecutor | None] = SimpleQueue()
        for _ in range(count):
            self._idle.put(None)

    def run(self, function: Callable[[Job], Result], job: Job) -> Result:
        """Waits for an idle process and runs a function for a job in it; returns the result or raises the exception.

        Raises
        ------
        concurrent.futures.process.BrokenProcessPool
            If the process dies.
        NoProcessError
            If no process can be started.
        """
        process = self._idle.get()
        try:
            if process is None or not _is_alive(process):
                process = _started()
            return process.submit(function, job).result()
        finally:
            self._idle.put(process)

    def close(self) -> None:
        """Ends the processes; no job may be running."""
        while not self._idle.empty():
            process = self._idle.get()
            if process is not None:
                process.shutdown()


def _started() -> ProcessPoolExecutor:
    """Starts a process and returns it once it is ready for a job."""
    failure: RuntimeError | None = None
    for _ in range(_STARTS):
        # A process with threads must not fork, and many callers have threads.
        context = multiprocessing.get_context("spawn")
        process = ProcessPoolExecutor(1, mp_context=context, initializer=_end_with_the_parent)
        try:
            process.submit(os.getpid).result()
            return process
        except RuntimeError as error:
            failure = error
            process.shutdown()
    raise NoProcessError(
        'no process can be started: a script must keep its own work behind `if __name__ == "__main__":`, because each '
        "process reads the script; or give processes=1"
    ) from failure


def _is_alive(process: ProcessPoolExecutor) -> bool:
    """Whether a process still accepts jobs; a job would fail in a dead process."""
    try:
        process.submit(os.getpid).result()
    except RuntimeError:
        process.shutdown()
        return False
    return True


def _end_with_the_parent() -> None:
    """Makes this process end if its parent is killed and so cannot end it. Leaves interrupts to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
