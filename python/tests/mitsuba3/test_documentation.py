"""Checks that the code in docs/mitsuba.md, the lines for Mitsuba in README and the example work as stated."""

import os
import re
import subprocess
import sys

import framing
import numpy as np
import pytest


def blocks(checkout, language, page="docs/mitsuba.md"):
    found = re.findall(rf"```{language}\n(.*?)```", (checkout / page).read_text(), re.DOTALL)
    found = [block for block in found if "mitsuba" in block or language != "python"]
    assert found
    return found


@pytest.mark.parametrize("page", ["docs/mitsuba.md", "README.md"])
def test_the_pages_code_runs(fast, checkout, tmp_path, monkeypatch, page):
    monkeypatch.chdir(tmp_path)
    for block in blocks(checkout, "python", page):
        exec(compile(block, page, "exec"), {})
    picture = np.array(fast.Bitmap("ball.png"))
    assert picture.shape[:2] == (200, 300) and picture.std() > 10


def test_the_pages_xml_is_a_sensor(mi, checkout):
    for block in blocks(checkout, "xml"):
        sensor = mi.load_string(f'<scene version="3.0.0">{block}</scene>').sensors()[0]
        assert sensor.camera.fnumber == pytest.approx(4)


def test_the_example_runs(fast, checkout, tmp_path):
    pytest.importorskip("matplotlib")
    # This code does the command's work, at a smaller size to save time.
    code = "import studio; studio.main('dgauss.50mm', 'studio.png', 90, 60, 4, 2)"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{checkout / 'examples/mitsuba'}:{checkout / 'python/src'}"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("studio.png: Camera('dgauss.50mm'")
    picture = np.array(fast.Bitmap(str(tmp_path / "studio.png")), float)
    # The white card is lighter than the floor beside it.
    assert picture[35:50, 8:28].mean() > 1.3 * picture[52:60, 40:60].mean()
    # The right of the page's picture shows the example's present result at full size.
    page = np.array(fast.Bitmap(str(checkout / "docs/images/mitsuba-studio.jpg")), float)[:, -720:, :3]
    assert framing.difference(picture / 255, page / 255) < 0.1
