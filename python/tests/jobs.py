"""Jobs that log when they begin, and jobs that kill their process; other processes import them."""

import os
import random
import signal
import threading
import time
from pathlib import Path

from realistic.farm.store import Store
from realistic.farm.study import _measured as MEASURED
from realistic.farm.tiles import _rendered as RENDERED


def begun(log, job):
    """Logs a line: the job, the time and the process."""
    with open(log, "a") as file:
        file.write(f"{job!r}\t{time.monotonic_ns()}\t{os.getpid()}\n")
    time.sleep(0.1)


def measured(log, job):
    begun(log, job)
    return MEASURED(job)


def rendered(log, job):
    begun(log, job)
    return RENDERED(job)


def deadly(log, job):
    """Measures a job; one lens kills its process."""
    begun(log, job)
    if job.lens == "wide.22mm":
        os.kill(os.getpid(), signal.SIGKILL)
    return MEASURED(job)


def clumsy(log, job):
    """Measures a job; one lens fails."""
    begun(log, job)
    if job.lens == "wide.22mm":
        raise OSError("the disk is full")
    return MEASURED(job)


def beginnings(log):
    """Returns the job and the time of each line in the log."""
    lines = [line.split("\t") for line in Path(log).read_text().splitlines()] if Path(log).exists() else []
    return [(job, int(at)) for job, at, _ in lines]


class Arrivals:
    """Times at which the results were kept."""

    def __init__(self, monkeypatch):
        self.at, names, key, put = {}, {}, Store.key, Store.put

        def remembered(store, job):
            found = key(store, job)
            names[found] = repr(job)
            return found

        def noted(store, key, result):
            put(store, key, result)
            assert names[key] not in self.at
            self.at[names[key]] = time.monotonic_ns()

        monkeypatch.setattr(Store, "key", remembered)
        monkeypatch.setattr(Store, "put", noted)


class Killer:
    """Progress callback that kills processes a while after certain numbers of results, which are random with a fixed
    seed."""

    def __init__(self, seed, processes, count, kills):
        self.random, self.processes = random.Random(seed), processes
        self.after = set(self.random.sample(range(1, count - 2), kills))
        self.killed, self.seen, self.threads = [], [], []

    def __call__(self, done, count):
        self.seen.append((done, count))
        if done in self.after:
            self.threads.append(threading.Timer(self.random.uniform(0, 0.15), self.kill))
            self.threads[-1].start()

    def kill(self):
        victims = [pid for pid in self.processes() if pid is not None and pid not in self.killed]
        if victims:
            self.killed.append(self.random.choice(victims))
            os.kill(self.killed[-1], signal.SIGKILL)

    def join(self):
        for thread in self.threads:
            thread.join()
