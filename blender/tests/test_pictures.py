"""Framing and bokeh of the test scene, compared with the command-line program's picture of it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from stage import picture, read

ROOT = Path(__file__).parents[2]
sys.path += [str(ROOT / "python/tests"), str(ROOT / "examples/blender")]

import framing
import studio

import realistic


@pytest.fixture(scope="module")
def shader(lenses, tmp_path_factory) -> str:
    file = tmp_path_factory.mktemp("shader") / "dgauss.osl"
    file.write_text(lenses["dgauss.50mm"][0])
    return str(file)


def prepared(shader: str, fnumber: float, samples: int):
    """Sets up the test scene with a camera, for a picture to measure."""
    scene = studio.new(framing.SIZE, samples)
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.view_settings.view_transform = "Raw"
    studio.with_nodes(scene.world)
    return scene, studio.camera(shader, fnumber)


def from_film(fnumber: float | None) -> float:
    """Returns the card's distance from the film, mm, at which the program focuses; Blender measures from the lens."""
    distance = 1070.0
    rear = realistic.Lens("dgauss.50mm").surfaces[-1].vertex_mm
    for _ in range(4):
        camera = realistic.Camera("dgauss.50mm", resolution=framing.SIZE, focus_distance=distance, fnumber=fnumber)
        distance = studio.DISTANCE - rear + camera.film_distance
    return distance


def test_the_card_has_the_framing_of_the_programs_picture(shader, program, tmp_path):
    scene, _ = prepared(shader, 8.0, 64)
    studio.board("card", studio.CARD, studio.CARD_WIDTH, 66 / 80 * studio.CARD_WIDTH, studio.light("white", (1, 1, 1)))
    framing.by_program(program, tmp_path / "card.exr", 32, {"focus_distance": from_film(8.0), "fnumber": 8.0})
    seen = [framing.edges(each.sum(axis=2)) for each in (read(tmp_path / "card.exr"), picture(scene, tmp_path))]
    print(seen)
    assert np.abs(seen[0] - seen[1]).max() < 0.1, seen


def test_defocused_lamps_are_the_disks_of_the_programs_picture(shader, program, tmp_path):
    scene, _ = prepared(shader, 0.5, 96)
    studio.lamps(1)
    framing.by_program(program, tmp_path / "lamps.exr", 32, {"focus_distance": from_film(None)})
    seen = [framing.bokeh(each.sum(axis=2)) for each in (read(tmp_path / "lamps.exr"), picture(scene, tmp_path))]
    print(seen)
    assert np.abs(seen[0][:, :2] - seen[1][:, :2]).max() < 0.6
    assert np.abs((seen[0] - seen[1])[:, :2].mean(axis=0)).max() < 0.2
    assert abs(seen[0][:, 2].mean() / seen[1][:, 2].mean() - 1) < 0.015


def test_the_pages_picture_is_what_the_example_makes(shader, tmp_path):
    studio.main(shader, str(tmp_path / "studio.png"), 120, 80, 32)
    pictures = [read(file) for file in (tmp_path / "studio.png", ROOT / "docs/images/blender-studio.jpg")]
    assert framing.difference(*pictures) < 0.1
