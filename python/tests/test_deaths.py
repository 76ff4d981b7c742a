"""Tests that work continues when processes die, and resumes where it was interrupted; finished jobs are not
repeated."""

import dataclasses
import functools
import multiprocessing
import os
import subprocess
import sys
import time
from pathlib import Path

import jobs
import numpy as np
import pytest
from test_farm import program

import realistic
from realistic import farm, study
from realistic.farm import store as store_module
from realistic.farm import tiles
from realistic.farm.store import Store

study_module = sys.modules["realistic.farm.study"]
pytest.importorskip("diskcache", reason='diskcache is not installed (pip install "./python[farm]")')

WORK = {"lenses": ["dgauss.50mm", "wide.22mm"], "fnumbers": [4, 8], "focus_distances": [np.inf, 3000.0, 2000.0]}
WORK |= {"fields": [0.0, 0.8], "frequencies": [10], "resolution": (60, 40)}
# This model is quick to build.
WORK |= {"model": "thin"}
CAMERAS = 12
OPTIONS, SIZE, TILE = ["--lens", "wide.22mm", "--spp", "1", "--param", "model=thin"], (90, 60), (30, 15)
# The day scene has no lit lamps, whose light would be planned anew for each tile.
OPTIONS += ["--scene", "day"]
TILES = 12


@pytest.fixture(scope="module")
def table():
    return study(**WORK, processes=1)


@pytest.fixture(scope="module")
def picture(checkout, tmp_path_factory):
    command = program(checkout)
    whole = tmp_path_factory.mktemp("whole") / "whole.png"
    subprocess.run([command, "render", *OPTIONS, "--size", "90x60", "--out", whole], check=True, capture_output=True)
    return whole.read_bytes()


@pytest.fixture
def log(monkeypatch, tmp_path):
    """A log file to which jobs in every process write when they begin."""
    file = tmp_path / "log.txt"
    monkeypatch.setattr(study_module, "_measured", functools.partial(jobs.measured, str(file)))
    monkeypatch.setattr(tiles, "_rendered", functools.partial(jobs.rendered, str(file)))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)]))
    return file


def children():
    return [child.pid for child in multiprocessing.active_children()]


def check(log, arrivals, killer, count):
    """Checks that each job arrived once, that none began again after it had arrived, and that progress counted one by
    one."""
    killer.join()
    assert len(killer.killed) == len(killer.after) > 0
    begun = jobs.beginnings(log)
    assert len(arrivals.at) == count and {job for job, _ in begun} == set(arrivals.at)
    assert all(at < arrivals.at[job] for job, at in begun)
    assert killer.seen == [(done, count) for done in range(count + 1)]
    return len(begun)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_study_loses_nothing_with_children_killed_at_random(log, monkeypatch, tmp_path, table, seed):
    arrivals, killer = jobs.Arrivals(monkeypatch), jobs.Killer(seed, children, CAMERAS, 3)
    found = study(**WORK, processes=2, retries=3, keep=tmp_path / "kept", progress=killer)
    assert found.equals(table)
    # A child that dies loses only its own camera.
    assert check(log, arrivals, killer, CAMERAS) <= CAMERAS + 3
    assert not children()


def test_a_picture_loses_nothing_with_children_killed_at_random(checkout, log, monkeypatch, tmp_path, picture):
    arrivals, killer = jobs.Arrivals(monkeypatch), jobs.Killer(4, children, TILES, 3)
    given = {"size": SIZE, "tile": TILE, "program": program(checkout), "processes": 2, "retries": 3}
    out = farm.render(tmp_path / "tiles.png", OPTIONS, **given, keep=tmp_path / "kept", progress=killer)
    assert out.read_bytes() == picture
    assert check(log, arrivals, killer, TILES) <= TILES + 3


def test_dask_loses_nothing_with_workers_killed_at_random(checkout, log, monkeypatch, tmp_path, table, picture):
    distributed = pytest.importorskip("distributed", reason='Dask is not installed (pip install "./python[farm]")')
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        client.wait_for_workers(2)

        def workers():
            return [nanny.pid for nanny in cluster.workers.values()]

        given = {"client": client, "retries": 3, "keep": tmp_path / "kept"}
        with monkeypatch.context() as patch:
            arrivals, killer = jobs.Arrivals(patch), jobs.Killer(6, workers, CAMERAS, 2)
            assert study(**WORK, **given, progress=killer).equals(table)
            check(log, arrivals, killer, CAMERAS)
        log.unlink()
        arrivals, killer = jobs.Arrivals(monkeypatch), jobs.Killer(7, workers, TILES, 2)
        given |= {"size": SIZE, "tile": TILE, "program": program(checkout)}
        assert farm.render(tmp_path / "a.png", OPTIONS, **given, progress=killer).read_bytes() == picture
        check(log, arrivals, killer, TILES)


def stop_after(number):
    """Makes a progress callback that interrupts the work after `number` results."""

    def progress(done, _count):
        if done == number:
            raise KeyboardInterrupt

    return progress


@pytest.mark.parametrize("processes", [1, 2])
def test_an_interrupted_study_goes_on_where_it_stopped(log, monkeypatch, tmp_path, table, processes):
    given = {"processes": processes, "keep": tmp_path / "kept"}
    arrivals = jobs.Arrivals(monkeypatch)
    with pytest.raises(KeyboardInterrupt):
        study(**WORK, **given, progress=stop_after(5))
    assert not children()
    before = set(arrivals.at)
    assert len(before) == 5
    log.unlink()
    seen = []
    assert study(**WORK, **given, progress=lambda *numbers: seen.append(numbers)).equals(table)
    again = [job for job, _ in jobs.beginnings(log)]
    assert len(again) == CAMERAS - 5 and not before & set(again)
    assert seen == [(done, CAMERAS) for done in range(5, CAMERAS + 1)]
    # A finished study begins no job and starts no process.
    log.unlink()
    monkeypatch.setattr(study_module, "_measured", None)
    assert study(**WORK, **given, progress=lambda *numbers: seen.append(numbers)).equals(table)
    assert not log.exists() and seen[-1] == (CAMERAS, CAMERAS)


def test_a_picture_that_was_interrupted_goes_on(checkout, log, tmp_path, picture):
    given = {"size": SIZE, "tile": TILE, "program": program(checkout), "processes": 2, "keep": tmp_path / "kept"}
    with pytest.raises(KeyboardInterrupt):
        farm.render(tmp_path / "a.png", OPTIONS, **given, progress=stop_after(7))
    assert not (tmp_path / "a.png").exists()
    log.unlink()
    assert farm.render(tmp_path / "a.png", OPTIONS, **given).read_bytes() == picture
    assert len(jobs.beginnings(log)) == TILES - 7


def test_a_killed_study_goes_on_and_leaves_no_process_behind(log, tmp_path, table):
    """Kills the whole process with SIGKILL; its children end by themselves."""
    script = tmp_path / "script.py"
    script.write_text(
        "import functools, sys, numpy as np, jobs, realistic\n"
        "sys.modules['realistic.farm.study']._measured = functools.partial(jobs.measured, sys.argv[1])\n"
        "if __name__ == '__main__':\n"
        "    inf, show = np.inf, lambda *now: print(*now, flush=True)\n"
        f"    realistic.study(**{WORK!r}, processes=2, keep=sys.argv[2], progress=show)\n"
    )
    running = subprocess.Popen([sys.executable, script, log, tmp_path / "kept"], stdout=subprocess.PIPE, text=True)
    with running:
        for line in running.stdout:
            if int(line.split()[0]) == 4:
                break
        running.kill()
    processes = {int(line.split("\t")[2]) for line in log.read_text().splitlines()}
    assert len(processes) == 2
    deadline = time.monotonic() + 20
    while any(Path(f"/proc/{pid}").exists() for pid in processes):
        assert time.monotonic() < deadline, "a child outlived its parent"
        time.sleep(0.05)
    log.unlink()
    assert study(**WORK, processes=1, keep=tmp_path / "kept").equals(table)
    # Results before the kill are kept; the state after the fourth result is unknown.
    assert len(jobs.beginnings(log)) <= CAMERAS - 4


@pytest.mark.parametrize(
    ("job", "note"),
    [(jobs.deadly, "the process that measured this camera died each time"), (jobs.clumsy, "OSError: the disk is full")],
)
def test_a_job_that_always_fails_is_retried_and_becomes_rows(log, monkeypatch, tmp_path, table, job, note):
    monkeypatch.setattr(study_module, "_measured", functools.partial(job, str(log)))
    given = {**WORK, "fnumbers": 4, "focus_distances": [np.inf, 3000.0], "processes": 2, "keep": tmp_path / "kept"}
    found = study(**given, retries=1)
    wide = found["lens"] == "wide.22mm"
    assert set(found["note"][wide]) == {note} and found["failed"].tolist() == wide.tolist()
    assert np.isnan(found["spot_rms_um"][wide]).all() and np.isfinite(found["spot_rms_um"][~wide]).all()
    assert set(found["fnumber"]) == {4} and found["field"].tolist() == [0.0, 0.8] * 4
    begun = [name for name, _ in jobs.beginnings(log)]
    assert sorted(begun.count(name) for name in set(begun)) == [1, 1, 2, 2]
    # A failure is not kept.
    monkeypatch.setattr(study_module, "_measured", functools.partial(jobs.measured, str(log)))
    log.unlink()
    mended = study(**given)
    assert not mended["failed"].any() and len(jobs.beginnings(log)) == 2


def test_a_tile_that_always_fails_keeps_the_others(checkout, log, tmp_path):
    with pytest.raises(RuntimeError, match="no lens file"):
        farm.render(
            tmp_path / "a.png", ["--lens", "nowhere"], size=SIZE, program=program(checkout), processes=2, retries=2
        )
    assert len(jobs.beginnings(log)) == 3 and not (tmp_path / "a.png").exists()


def test_a_script_without_its_guard_gets_a_remedy(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import realistic\nrealistic.study('dgauss.50mm', [4, 8], processes=2)\nprint('on')\n")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr.splitlines()[-1].startswith(
        "realistic.farm.processes.NoProcessError: no process can be started: a script must keep its own work behind `if __"
    )


def test_results_are_keyed_by_all_that_determines_them(tmp_path, monkeypatch):
    """Anything that changes a result changes the key; the time and the folder do not."""
    monkeypatch.chdir(tmp_path)
    digest = store_module._digest_of_package()
    monkeypatch.setattr(store_module, "_digest_of_package", lambda: digest)
    lens, other = Path("lens.dat"), Path("other.dat")
    lens.write_text("20 5 1.5 10\n-20 0 1 10\n")
    field = realistic.Field.fractions([0.0, 0.5])
    given = {"field": field, "frequencies": [10.0], "resolution": (30, 20), "parameters": {"crop": np.arange(4)}}
    given |= {"focus_distance": np.inf, "defocus_mm": 0.0, "wavelength": 550.0}
    job = study_module._Job(lens="lens.dat", fnumber=4.0, **given)
    tile = tiles._Tile((0, 0, 3, 2), (30, 20), ("--lens=lens.dat",), None, ".png")

    def keys():
        store = Store(tmp_path / "kept")
        changed = [
            job,
            dataclasses.replace(job, lens="other.dat"),
            dataclasses.replace(job, lens="lens.dat@40mm"),
            dataclasses.replace(job, fnumber=None),
            dataclasses.replace(job, focus_distance=1e300),
            dataclasses.replace(job, defocus_mm=0.1),
            dataclasses.replace(job, field=realistic.Field.angles([0.0, 0.5])),
            dataclasses.replace(job, field=realistic.Field.fractions(x=[0.0, 0.5], y=[0.0, 0.5])),
            dataclasses.replace(job, parameters={"crop": np.arange(1, 5)}),
            tile,
            dataclasses.replace(tile, options=("--lens", "lens.dat")),
            dataclasses.replace(tile, crop=(0, 0, 3, 3)),
        ]
        found = [store.key(each) for each in changed]
        assert found == [store.key(each) for each in changed] and len(set(found)) == len(changed)
        store.close()
        return set(found)

    first = keys()
    os.utime(lens, (1, 1))
    assert keys() == first
    other.write_text(lens.read_text())
    assert len(keys() & first) == len(first) - 1
    lens.write_text("20 5 1.5 10\n-21 0 1 10\n")
    assert len(keys() & first) == 0
    lens.write_text("20 5 1.5 10\n-20 0 1 10\n")
    other.unlink()
    assert keys() == first
    # A lens file uses the glass catalogues beside it.
    Path("GLASS.AGF").write_text("NM N-BK7\n")
    # All keys change, except that of the missing lens.
    assert len(keys() & first) == 1
    Path("GLASS.AGF").unlink()
    monkeypatch.undo()
    monkeypatch.setattr(store_module, "library_file", lambda: tmp_path / "lens.dat")
    assert store_module._digest_of_package() != digest
    monkeypatch.setattr(store_module, "_digest_of_package", lambda: "another")
    monkeypatch.chdir(tmp_path)
    assert not keys() & first


def test_several_runs_share_a_folder(tmp_path, table):
    """The runs work at the same time, in separate processes."""
    code = f"import numpy as np, realistic; inf = np.inf; realistic.study(**{WORK!r}, processes=1, keep='kept')"
    running = [subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path) for _ in range(2)]
    assert [each.wait() for each in running] == [0, 0]
    seen = []
    assert study(**WORK, keep=tmp_path / "kept", progress=lambda *numbers: seen.append(numbers)).equals(table)
    assert seen == [(CAMERAS, CAMERAS)]


def test_without_a_library_for_it_nothing_is_kept(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "diskcache", None)
    with pytest.raises(ImportError, match=r'diskcache is needed: pip install "./python\[farm\]"'):
        study("dgauss.50mm", keep=tmp_path / "kept", processes=1)


def test_a_bar_shows_progress_where_there_is_one(monkeypatch, tmp_path):
    """tqdm gets the kept results at once, and then the others one by one; without tqdm there is no bar and no error."""
    tqdm = pytest.importorskip("tqdm.auto")
    updates, made = [], []

    class Bar(tqdm.tqdm):
        def __init__(self, **given):
            made.append(given)
            super().__init__(**given)

        def update(self, n=1):
            updates.append(n)
            super().update(n)

    monkeypatch.setattr(tqdm, "tqdm", Bar)
    given = {"fields": 0, "resolution": (30, 20), "processes": 1, "keep": tmp_path / "kept"}
    study("dgauss.50mm", [4, 8], **given)
    assert made[0] | {"total": 2, "unit": "camera"} == made[0] and updates == [0, 1, 1]
    study("dgauss.50mm", [4, 8, 11], **given)
    assert updates[3:] == [2, 1]
    study("dgauss.50mm", [4, 8], **given, progress=False)
    assert len(made) == 2
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    assert len(study("dgauss.50mm", [4, 8], **given)) == 2 and len(made) == 2


def test_what_lies_beside_a_lens_neither_ends_nor_stops_a_study(tmp_path):
    (tmp_path / "own.dat").write_text("50 5 1.5 20\n-50 48 1 20\n")
    (tmp_path / "dangling.agf").symlink_to(tmp_path / "nowhere")
    (tmp_path / "folder.agf").mkdir()
    (tmp_path / "good.agf").write_text("CC\n")
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.agf")
    read = {file.name for file in store_module._read_for(str(tmp_path / "own.dat"))}
    assert read == {"own.dat", "good.agf"}
    assert store_module._digest(tmp_path / "nowhere").startswith("unreadable")


def test_damaged_results_are_computed_anew(tmp_path):
    pytest.importorskip("diskcache")
    folder = tmp_path / "kept"
    results = {f"{number}": bytes([number]) * (10 if number % 2 else 100_000) for number in range(8)}

    def opened():
        return Store(folder)

    of_all = opened()
    for key, result in results.items():
        of_all.put(key, result)
    assert {key: of_all.get(key) for key in results} == results
    # This data is damaged, as another version or a disk fault may leave it.
    of_all._cache.set("1", b"{}")
    of_all._cache.set("3", "text")
    of_all.close()
    large = sorted(folder.rglob("*.val"), key=lambda file: file.stat().st_ino)
    large[0].write_bytes(large[0].read_bytes()[:-1])
    large[1].unlink()
    large[2].write_bytes(b"")
    again = opened()
    found = {key: again.get(key) for key in results}
    assert found["1"] is None and found["3"] is None
    assert sum(result is None for result in found.values()) == 5
    assert all(result in (None, results[key]) for key, result in found.items())
    again.put("1", results["1"])
    assert again.get("1") == results["1"]
    again.close()
    (folder / "cache.db").write_bytes(b"no database" * 1000)
    with pytest.warns(UserWarning, match="is damaged .* computed anew"):
        anew = opened()
    assert anew.get("1") is None
    anew.put("1", b"result")
    assert anew.get("1") == b"result"
    anew.close()
