"""Lists collections, and uses the names that are listed."""

import zipfile

import pytest

import realistic

SINGLET = "# by Nikon\n50 2 1.5 10\n-50 0 1 10\n"


@pytest.fixture
def collection(tmp_path, monkeypatch):
    """A folder with two lenses, one of them in an archive, a file that cannot be read, and another file."""
    folder = tmp_path / "lenses"
    folder.mkdir()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (folder / "fifty.dat").write_text(SINGLET)
    (folder / "broken.zmx").write_text("SURF 0\n")
    (folder / "README.txt").write_text("lenses\n")
    with zipfile.ZipFile(folder / "stock.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a/thirty.dat", SINGLET.replace("50", "30") + 100 * "# packed\n")
    return folder


def test_a_collection_is_a_table(collection):
    rows = realistic.lenses(collection)
    assert [row["name"] for row in rows] == ["broken.zmx", "fifty.dat", "stock.zip/a/thirty.dat"]
    assert all(row.keys() == realistic.LensRow.__annotations__.keys() for row in rows)
    broken, fifty, thirty = rows
    assert broken["error"] and broken["focal_length_mm"] is None
    assert fifty["error"] is None and fifty["maker"] == "Nikon" and fifty["is_symmetric"] is True
    for row in (fifty, thirty):
        lens = realistic.Lens(row["lens_file"])
        assert lens.focal_length_mm == pytest.approx(row["focal_length_mm"], rel=1e-8)
        assert lens.fnumber == pytest.approx(row["fnumber"], rel=1e-8)
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(rows)
    assert table[table.error.isna()].focal_length_mm.round().tolist() == [50, 30]


def test_a_lens_of_the_search_path_has_a_short_name(collection, monkeypatch):
    monkeypatch.setenv("REALISTIC_LENSES", str(collection))
    assert {row["name"] for row in realistic.lenses()} >= {"fifty.dat"}
    assert realistic.Lens("thirty").focal_length_mm == realistic.Lens("stock.zip/a/thirty.dat").focal_length_mm
    with pytest.raises(realistic.Error, match='did you mean "fifty.dat"'):
        realistic.Lens("fiftyy")


def test_without_collections_the_catalogue_is_listed(monkeypatch):
    monkeypatch.delenv("REALISTIC_LENSES", raising=False)
    assert tuple(row["lens_file"] for row in realistic.lenses()) == realistic.catalogue()
    with pytest.raises(realistic.Error, match="does not exist"):
        realistic.lenses("/nowhere")
