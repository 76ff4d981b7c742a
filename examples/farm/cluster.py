"""A picture in tiles and a study of lenses, on a cluster of two processes on this machine.

$ python cluster.py

writes tiles.png and study.csv. On a farm only the cluster changes, as docs/python.md explains. With --kill, one of the
workers is killed while it renders, as happens on farms; the picture's bytes and the table stay the same. With --large,
the study is so large that two processes are faster than one.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

from dask.distributed import Client, LocalCluster

import realistic
from realistic import farm

SIZE, OPTIONS = (240, 160), ["--lens", "wide.22mm", "--spp", "8"]


def kill_one(client: Client, after: float) -> threading.Thread:
    """Kills a worker's process after a delay, in seconds; its nanny starts another."""
    victim = next(iter(client.run(os.getpid).values()))

    def kill() -> None:
        time.sleep(after)
        os.kill(victim, signal.SIGKILL)
        print("a worker was killed")

    thread = threading.Thread(target=kill)
    thread.start()
    return thread


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", help="the command-line program [default: that of the installed package]")
    parser.add_argument("--kill", action="store_true", help="kill a worker while it renders")
    parser.add_argument("--large", action="store_true", help="study every lens of the catalogue, at many stops")
    given = parser.parse_args()
    work = {"lenses": ["dgauss.50mm", "wide.22mm", "tessar.50mm", "triplet.210mm"], "fnumbers": [5.6, 8.0]}
    if given.large:
        stops, colours = [8.0, 11.0, 16.0, 22.0], [430.0, 486.13, 546.07, 587.56, 656.27]
        work = {"lenses": list(realistic.catalogue()), "fnumbers": stops, "wavelengths": colours}
    work["focus_distances"] = [float("inf"), 3000.0]
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.wait_for_workers(2)
        killer = kill_one(client, 1.0) if given.kill else None
        begin = time.perf_counter()
        farm.render("tiles.png", OPTIONS, size=SIZE, tile=(80, 54), client=client, program=given.program)
        print(
            f"tiles.png in {time.perf_counter() - begin:.1f} s on {len(client.scheduler_info()['workers'])} processes"
        )
        if killer is not None:
            killer.join()
        begin = time.perf_counter()
        table = realistic.study(**work, client=client)
        print(f"study.csv, {len(table)} rows, in {time.perf_counter() - begin:.1f} s")
    table.to_csv("study.csv")

    begin = time.perf_counter()
    alone = realistic.study(**work, processes=1)
    print(
        f"study: {'equal' if alone.equals(table) else 'DIFFERENT'} in one process, in {time.perf_counter() - begin:.1f} s"
    )
    size = f"{SIZE[0]}x{SIZE[1]}"
    program = [given.program] if given.program else [sys.executable, "-m", "realistic"]
    subprocess.run(
        [*program, "render", *OPTIONS, "--size", size, "--out", "whole.png"], check=True, capture_output=True
    )
    same = Path("tiles.png").read_bytes() == Path("whole.png").read_bytes()
    print(f"picture: {'the bytes of the whole' if same else 'DIFFERENT'}")


if __name__ == "__main__":
    main()
