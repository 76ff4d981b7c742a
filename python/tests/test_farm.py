"""Studies, maps and tiles: equal results on all kinds of workers."""

import io
import os
import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import realistic
from realistic import Field, Table, farm, measure, study
from realistic.errors import quietly

SMALL = {"fields": [0.0, 0.8], "frequencies": [10, 30], "resolution": (300, 200)}


@pytest.fixture(scope="module")
def table():
    return study(
        ["dgauss.50mm", "wide.22mm"], [None, 8], [np.inf, 2000.0], wavelengths=[486.13, 587.56], processes=1, **SMALL
    )


def test_a_row_for_each_combination_in_order(table):
    assert len(table) == 2 * 2 * 2 * 2 * 2
    assert table.columns == (
        ("lens", "fnumber", "fnumber_used", "focus_distance", "defocus_mm", "field", "field_angle_deg", "x_mm", "y_mm")
        + ("wavelength", "focal_length_mm", "spot_rms_um", "airy_radius_um")
        + tuple(f"mtf_{curve}_{f}" for f in (10, 30) for curve in ("tangential", "sagittal", "diffraction"))
        + ("relative_illumination", "distortion", "acceptance", "failed", "note")
    )
    assert table["lens"].tolist() == ["dgauss.50mm"] * 16 + ["wide.22mm"] * 16
    np.testing.assert_allclose(table["fnumber_used"][:16], [realistic.Lens("dgauss.50mm").fnumber] * 8 + [8] * 8)
    np.testing.assert_array_equal(table["fnumber"][:16], [np.nan] * 8 + [8] * 8)
    assert table["focus_distance"][:8].tolist() == [np.inf] * 4 + [2000.0] * 4
    assert table["field"][:4].tolist() == [0, 0, 0.8, 0.8]
    assert table["wavelength"][:4].tolist() == [486.13, 587.56] * 2
    # The lens files have no dispersion.
    away = table["wavelength"] == 486.13
    assert set(table["note"][~away]) == {""} and len(set(table["note"][away])) == 2
    assert all("wavelength 486.13 nm changes nothing" in note for note in table["note"][away])
    assert not table["failed"].any()


def test_a_row_equals_its_measures(table):
    row = table[(table["lens"] == "wide.22mm") & (table["fnumber"] == 8) & (table["focus_distance"] == 2000)]
    row = row[(row["field"] == 0.8) & (row["wavelength"] == 486.13)][0]
    given = {"resolution": (300, 200), "fnumber": 8}
    film = realistic.Camera("wide.22mm", focus_distance=2000.0, **given).film_distance
    with quietly():
        # The lens file has no dispersion, and the camera warns of it.
        camera = realistic.Camera("wide.22mm", film_distance=film, wavelength=486.13, **given)
    point = [[150 + 0.8 * 150, 100 - 0.8 * 100]]
    pixel = 1000 * camera.film_size_mm[0] / 300
    assert row["focal_length_mm"] == camera.focal_length_mm
    np.testing.assert_allclose(
        row["spot_rms_um"], measure.spots(camera, point, distance=2000.0).rms[0] * pixel, rtol=1e-6
    )
    np.testing.assert_allclose(row["airy_radius_um"], measure.airy_radius(camera, point)[0] * pixel, rtol=1e-6)
    np.testing.assert_allclose([row["x_mm"], row["y_mm"]], [0.12 * pixel, 0.08 * pixel], rtol=1e-6)
    with quietly():
        # At f/8 the geometric MTF exceeds the diffraction limit.
        mtf = measure.mtf(camera, point, [10, 30], distance=2000.0)[0]
    found = [[row[f"mtf_{curve}_{f}"] for f in (10, 30)] for curve in ("tangential", "sagittal")]
    np.testing.assert_allclose(found, mtf, rtol=1e-6)
    limit = [row[f"mtf_diffraction_{f}"] for f in (10, 30)]
    np.testing.assert_allclose(limit, measure.diffraction_mtf(camera, [10, 30]))
    np.testing.assert_allclose(row["relative_illumination"], measure.relative_illumination(camera, point)[0], rtol=1e-6)
    distortion = measure.distortion(camera, point, distance=2000.0)[0]
    np.testing.assert_allclose(row["distortion"], distortion, rtol=1e-6)
    np.testing.assert_allclose(
        row["field_angle_deg"], measure.field_angle(camera, point, distance=2000.0)[0], rtol=1e-6
    )
    assert 0.9 < row["acceptance"] <= 1


def test_the_film_is_moved_through_focus_and_the_scene_stays():
    given = {"wavelengths": 587.56, "processes": 1, **SMALL}
    found = study("dgauss.50mm", 4, 2000.0, defocus_mm=[-0.2, 0.0, 0.2], mm_per_unit=2.0, **given)
    assert found["defocus_mm"].tolist() == [-0.2] * 2 + [0.0] * 2 + [0.2] * 2
    assert found["field"].tolist() == [0.0, 0.8] * 3
    lens = realistic.Camera("dgauss.50mm", resolution=(300, 200), fnumber=4, focus_distance=2000.0, mm_per_unit=2.0)
    moved = lens.replace(film_distance=lens.film_distance + 0.2)
    spot = measure.spots(moved, Field.fractions([0.0]), distance=2000.1).rms[0] * 1000 * lens.film_size_mm[0] / 300
    np.testing.assert_allclose(found["spot_rms_um"][4], spot, rtol=1e-6)
    # On the axis, the disk's diameter is the displacement over the f-number of the cone; its RMS radius is that over 2√2.
    cone = measure.working_fnumber(lens)
    np.testing.assert_allclose(found["spot_rms_um"][[0, 4]], 200 / cone / 8**0.5, rtol=0.1)
    assert found["spot_rms_um"][2] < 0.3 * found["spot_rms_um"][4]
    plain = study("dgauss.50mm", 4, 2000.0, **given)
    assert study("dgauss.50mm", 4, 2000.0, mm_per_unit=None, model=None, **given).equals(plain), "None is the default"
    with pytest.raises(ValueError, match="finite"):
        study("dgauss.50mm", defocus_mm=np.nan, **given)
    with pytest.raises(ValueError, match="leave out model"):
        study("dgauss.50mm", defocus_mm=0.1, model="thin", **given)


def test_several_processes_give_the_same_table(table):
    again = study(
        ["dgauss.50mm", "wide.22mm"], [None, 8], [np.inf, 2000.0], wavelengths=[486.13, 587.56], processes=2, **SMALL
    )
    assert again.equals(table) and not again[1:].equals(table) and not again[1:].equals(table[:-1])
    with ThreadPoolExecutor(2) as pool:
        threads = study(
            ["dgauss.50mm", "wide.22mm"],
            [None, 8],
            [np.inf, 2000.0],
            wavelengths=[486.13, 587.56],
            client=pool,
            **SMALL,
        )
    assert threads.equals(table)


def test_a_lens_that_cannot_focus_so_near_has_a_note():
    found = study("dgauss.50mm", focus_distances=[100.0, 1000.0], processes=1, **SMALL)
    assert [bool(note) for note in found["note"]] == [True, True, False, False]
    assert "cannot focus at 100 mm" in found["note"][0]
    near = found[:2]
    assert (
        np.isnan(near["spot_rms_um"]).all()
        and np.isnan(near["acceptance"]).all()
        and near["focus_distance"].tolist() == [100.0] * 2
    )
    assert np.isfinite(found["spot_rms_um"][2:]).all()


def test_a_camera_without_light_has_a_note_and_no_numbers():
    # Hardly any sample on the rear element's disk passes so small a stop.
    found = study("dgauss.50mm", [50_000.0, 8.0], processes=1, pupil="rear", **SMALL)
    assert found["note"][:2].tolist() == [found["note"][0]] * 2 and found["note"][2:].tolist() == [""] * 2
    assert found["note"][0].startswith("no ray gets through of 4096 over picture and pupil")
    assert found["note"][0].endswith("; no light gets to the middle of the picture")
    assert np.isnan(found["spot_rms_um"][:2]).all() and np.isfinite(found["spot_rms_um"][2:]).all()
    assert found["fnumber"].tolist() == [50_000.0] * 2 + [8.0] * 2
    assert found["failed"].tolist() == [True] * 2 + [False] * 2
    np.testing.assert_allclose(found["fnumber_used"], found["fnumber"], rtol=1e-9)


def test_a_stop_wider_than_the_lens_is_stated_as_what_it_is():
    """Each row's f-number equals that of a lens built alone; a note states where it differs from the request."""
    names = ["dgauss.50mm", "wide.22mm", "tessar.50mm", "phone.4mm", "triplet.210mm"]
    found = study(names, 2.0, fields=0, resolution=(30, 20), processes=1)
    used = []
    for name in names:
        with quietly():
            used.append(realistic.Lens(name, fnumber=2.0).fnumber)
    np.testing.assert_allclose(found["fnumber_used"], used, rtol=1e-9)
    assert set(found["fnumber"]) == {2.0}
    clamped = np.array(used) > 2.0 * (1 + 1e-9)
    assert 0 < clamped.sum() < len(names)
    for row, is_clamped in zip(found, clamped):
        assert ("is faster than the lens; f/" in row["note"]) == is_clamped, row


def test_one_bad_lens_is_rows_with_a_note_and_never_the_end(tmp_path):
    bad = tmp_path / "bad.dat"
    bad.write_text("20 5 1.5\n")
    found = study(["dgauss.50mm", "nowhere", bad], [8, -3], processes=1, **SMALL)
    failed = np.isnan(found["spot_rms_um"])
    assert found["failed"].tolist() == failed.tolist() == [False] * 2 + [True] * 10
    assert all("fnumber" in note for note in found["note"][2:4])
    assert all("no lens file" in note for note in found["note"][4:8])
    assert all("bad.dat" in note for note in found["note"][8:])
    assert found["field"].tolist() == [0.0, 0.8] * 6 and found["fnumber"].tolist() == [8, 8, -3, -3] * 3


def test_a_study_takes_field_angles(table):
    angle = table[(table["lens"] == "dgauss.50mm") & (table["fnumber"] == 8)]
    angle = float(angle[(angle["focus_distance"] == np.inf) & (angle["wavelength"] == 587.56)]["field_angle_deg"][1])
    found = study(["dgauss.50mm"], 8, fields=Field.angles([0.0, angle, 60.0]), processes=1, resolution=(300, 200))
    assert found["field_angle_deg"].tolist() == [0.0, angle, 60.0]
    np.testing.assert_allclose(found["field"], [0, 0.8, np.nan], rtol=1e-4)
    assert found["failed"].tolist() == [False, False, True]
    assert found["note"].tolist() == ["", "", "the picture does not reach to 60°"]
    same = study(["dgauss.50mm"], 8, fields=[0.0, 0.8], processes=1, resolution=(300, 200))
    np.testing.assert_allclose(found["spot_rms_um"][:2], same["spot_rms_um"], rtol=1e-3)
    alone = study("dgauss.50mm", fields=Field.angles(60.0), processes=1)
    assert alone["failed"].tolist() == [True]
    dark = study("fisheye.10mm", 8, fields=[0.0, 1.0], processes=1)
    assert dark["note"].tolist() == ["", "no light gets to this point of the picture"] and not dark["failed"].any()


def test_wrong_arguments_are_reported():
    with pytest.raises(TypeError, match="fnumber, focus_distance: give a study's lenses"):
        study("dgauss.50mm", fnumber=3, focus_distance=5)
    with pytest.raises(ValueError, match="fractions of the picture are from -1 to 1"):
        study("dgauss.50mm", fields=1.5)
    with pytest.raises(ValueError, match="fractions of the picture are from -1 to 1"):
        study("dgauss.50mm", fields=[0, -1.5])
    with pytest.raises(ValueError, match="not a finite number"):
        study("dgauss.50mm", fields=[0, np.nan])
    with pytest.raises(ValueError, match="processes is 0"):
        study("dgauss.50mm", processes=0)
    with pytest.raises(TypeError, match="no parameter 'filmdia'"):
        study("dgauss.50mm", filmdia=3, processes=1)
    with pytest.raises(ValueError, match="retries is -1"):
        study("dgauss.50mm", retries=-1)
    with pytest.raises(TypeError, match="resolution must be two integers"):
        study("dgauss.50mm", resolution=(3.5, 2))


def test_nothing_to_study_is_an_empty_table():
    found = study([], processes=3)
    assert len(found) == 0 and "spot_rms_um" in found.columns


def test_a_table_is_written_and_read_again(table, tmp_path):
    file = tmp_path / "study.csv"
    table.to_csv(file)
    written = io.StringIO()
    table.to_csv(written)
    text = file.read_text()
    assert text == written.getvalue()
    lines = text.splitlines()
    assert lines[0] == ",".join(table.columns) and len(lines) == 1 + len(table)
    read = np.genfromtxt(file, delimiter=",", names=True, dtype=None, encoding="utf-8")
    for name in table.columns[1:-2]:
        np.testing.assert_array_equal(read[name], table[name])
    assert "32 rows" in repr(table) and repr(table == table[0]).startswith("Table([")


def test_a_table_is_a_data_frame_as_it_is(table):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(table)
    assert tuple(frame.columns) == table.columns and len(frame) == len(table)
    for name in table.columns:
        np.testing.assert_array_equal(frame[name].to_numpy(table[name].dtype), table[name])
    assert tuple(pandas.DataFrame(table[:0]).columns) == table.columns


def test_a_table_is_an_array_of_rows(table):
    assert isinstance(table[3:5], Table) and isinstance(table[table["field"] > 0], Table) and len(table[:0]) == 0
    assert type(table["field"]) is np.ndarray and table[0]["lens"] == "dgauss.50mm"
    assert [row["field"] for row in table] == table["field"].tolist()
    assert pickle.loads(pickle.dumps(table)).equals(table)


def test_a_notebook_shows_a_table(table):
    """The HTML, read as XML, has a heading per column and a row per table row; of a long table, only the first and last
    rows."""
    import xml.etree.ElementTree as xml

    shown = xml.fromstring(table._repr_html_())
    assert [head.text for head in shown.find("thead").iter("th")] == list(table.columns)
    rows = [[cell.text or "" for cell in row] for row in shown.find("tbody")]
    assert len(rows) == 32 and rows[5][0] == table["lens"][5]
    assert float(rows[5][table.columns.index("spot_rms_um")]) == pytest.approx(table["spot_rms_um"][5], rel=1e-5)
    many = Table(np.concatenate([table] * 10))
    rows = [[cell.text or "" for cell in row] for row in xml.fromstring(many._repr_html_()).find("tbody")]
    assert len(rows) == 61 and rows[30] == ["… 260 rows …"] and rows[-1][5] == f"{table['field'][-1]:.6g}"
    odd = np.array([("<b>&",)], [("a<", "U4")])
    assert xml.fromstring(Table(odd)._repr_html_())[1][0][0].text == "<b>&"


def test_a_table_needs_columns():
    with pytest.raises(ValueError, match="structured array"):
        Table(np.zeros((2, 2)))


def program(checkout):
    """Returns the command-line program, if it has been built; otherwise skips the test."""
    named = os.environ.get("REALISTIC_PROGRAM")
    built = [checkout / f"target/{kind}/realistic" for kind in ("release", "debug")]
    found = [Path(named)] if named else [file for file in built if file.is_file()]
    if not found:
        pytest.skip("the program is not built: name it in REALISTIC_PROGRAM, or run cargo build --release")
    return found[0]


@pytest.mark.parametrize("ending", ["png", "exr"])
def test_tiles_make_the_bytes_of_the_whole(checkout, tmp_path, ending):
    import subprocess

    command = program(checkout)
    options = ["--lens", "wide.22mm", "--spp", "2", "--scene", "day", "--param", "fnumber=4"]
    whole = tmp_path / f"whole.{ending}"
    done = subprocess.run(
        [command, "render", *options, "--size", "90x60", "--out", whole], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    out = farm.render(tmp_path / f"tiles.{ending}", options, size=(90, 60), tile=(40, 25), processes=2, program=command)
    assert out.read_bytes() == whole.read_bytes()


def test_messages_of_the_program_are_passed_on(checkout, tmp_path):
    command = program(checkout)
    with pytest.raises(RuntimeError, match="no lens file"):
        farm.render(tmp_path / "a.png", ["--lens", "nowhere"], size=(20, 10), processes=1, program=command)
    with pytest.raises(RuntimeError, match="there is no program nowhere here"):
        farm.render(tmp_path / "a.png", program="nowhere", processes=1)
    for option in ("--size", "--crop=0,0,3,3", "--threads"):
        with pytest.raises(ValueError, match="is not an option of a picture in tiles"):
            farm.render(tmp_path / "a.png", [option], program=command)
    for options in (["--lens", "-"], ["--lens=-"]):
        with pytest.raises(ValueError, match="standard input cannot be read for each tile"):
            farm.render(tmp_path / "a.png", options, program=command)
    with pytest.raises(ValueError, match="a pixel at least"):
        farm.render(tmp_path / "a.png", tile=(0, 3), program=command)
    assert not list(tmp_path.iterdir())


def test_a_killed_worker_changes_nothing(checkout, tmp_path):
    """Runs tiles and a study on a local cluster and kills a worker meanwhile."""
    pytest.importorskip("distributed", reason='Dask is not installed (pip install "./python[farm]")')
    import subprocess
    import sys

    script = checkout / "examples/farm/cluster.py"
    done = subprocess.run(
        [sys.executable, script, "--program", program(checkout), "--kill"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(realistic.__file__))},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "a worker was killed" in done.stdout
    assert "picture: the bytes of the whole" in done.stdout
    assert "study: equal" in done.stdout
