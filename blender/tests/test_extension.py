"""The extension: installed as Blender's preferences do it, every button pressed, the panel drawn."""

from __future__ import annotations

import sys
from math import hypot
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest
from stage import empty, picture

import realistic

MODULE = "bl_ext.user_default.realistic"
LENSES = Path(__file__).parents[2] / "lenses"


@pytest.fixture(scope="module")
def installed(zip_file):
    """The extension, installed and enabled; removed at the end."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    done = bpy.ops.extensions.package_install_files(filepath=str(zip_file), repo="user_default", enable_on_install=True)
    assert done == {"FINISHED"} and MODULE in bpy.context.preferences.addons
    yield
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert not hasattr(bpy.types.Camera, "realistic") and not hasattr(bpy.types, "REALISTIC_PT_camera")
    index = next(i for i, repo in enumerate(bpy.context.preferences.extensions.repos) if repo.module == "user_default")
    assert bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id="realistic") == {"FINISHED"}


@pytest.fixture
def stage(installed):
    """A scene with a camera, with the extension enabled; Blender's factory settings have none."""
    scene, camera = empty((48, 32), 1)
    bpy.ops.preferences.addon_enable(module=MODULE)
    return scene, camera


class Layout:
    """Writes down what a panel asks for, in place of Blender's window."""

    def __init__(self, drawn):
        self.drawn = drawn

    def __getattr__(self, kind):
        def call(*given, **named):
            self.drawn.append((kind, given, named))
            return Layout(self.drawn) if kind in ("row", "column", "box") else SimpleNamespace()

        return call


def drawn(kind, **context):
    """What a panel, or the preferences, draw."""
    told = []
    kind.draw(SimpleNamespace(layout=Layout(told), program=""), SimpleNamespace(**context))
    return told


def test_a_button_makes_the_camera_the_lens(stage, tmp_path):
    scene, camera = stage
    light = scene.world.node_tree.nodes.new("ShaderNodeBackground")
    world = scene.world.node_tree.nodes.new("ShaderNodeOutputWorld")
    scene.world.node_tree.links.new(light.outputs[0], world.inputs[0])
    light.inputs["Color"].default_value = (1, 1, 1, 1)
    for name, length, diagonal in (("wide.22mm", 22.0, None), ("phone.4mm", 4.1, 6.3), ("zoom.24-70mm", 24.7, None)):
        camera.sensor_width = 36.0
        camera.realistic.lens = name
        assert bpy.ops.realistic.set_up() == {"FINISHED"}
        assert scene.render.engine == "CYCLES" and camera.type == "CUSTOM" and camera.dof.use_dof
        assert camera.lens == pytest.approx(length, abs=0.1)
        # A phone's film is small: on a sensor of 36 mm nearly all of the picture would be black.
        across = hypot(camera.sensor_width, camera.sensor_width / 1.5)
        assert across == pytest.approx(diagonal or hypot(36, 24), abs=0.05)
        camera.dof.focus_distance = 2.0
        seen = picture(scene, tmp_path)
        assert seen[16, 24] == pytest.approx(1.0, rel=0.15), name
        assert (seen > 0).mean() > 0.95


def test_focus_is_animated(stage):
    scene, camera = stage
    scene.frame_start, scene.frame_end = 1, 25
    camera.realistic.lens = "dgauss.50mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    camera.dof.focus_distance, camera.realistic.distance = 4.0, 1.0
    assert bpy.ops.realistic.pull_focus() == {"FINISHED"}
    for frame, wanted in ((1, 4.0), (25, 1.0)):
        scene.frame_set(frame)
        assert camera.dof.focus_distance == pytest.approx(wanted, abs=1e-6)
    scene.frame_set(13)
    assert 1.0 < camera.dof.focus_distance < 4.0


def test_a_lens_file_is_a_camera_by_the_program(stage, program, monkeypatch, tmp_path):
    _, camera = stage
    preferences = bpy.context.preferences.addons[MODULE].preferences
    monkeypatch.setenv("PATH", str(tmp_path))
    camera.realistic.file = str(LENSES / "tessar.50mm.dat")
    with pytest.raises(
        RuntimeError, match="the program realistic is not found: name it in this extension's preferences"
    ):
        bpy.ops.realistic.from_file()
    preferences.program = str(tmp_path)
    with pytest.raises(RuntimeError, match="does not run"):
        bpy.ops.realistic.from_file()
    preferences.program = program
    assert bpy.ops.realistic.from_file() == {"FINISHED"}
    assert camera.type == "CUSTOM" and camera.lens == pytest.approx(50.0, abs=0.1)
    assert camera.dof.aperture_fstop == pytest.approx(2.8, abs=0.1)
    assert Path(camera.custom_filepath).read_text().startswith("/* ")
    camera.realistic.file = str(tmp_path / "nowhere.dat")
    with pytest.raises(RuntimeError, match=r"nowhere\.dat"):
        bpy.ops.realistic.from_file()
    broken = tmp_path / "broken.dat"
    broken.write_text("1 2 three 4\n")
    camera.realistic.file = str(broken)
    with pytest.raises(RuntimeError, match="three"):
        bpy.ops.realistic.from_file()


def test_the_panel_shows_the_lens_and_has_every_button(stage):
    scene, camera = stage
    panel = bpy.types.REALISTIC_PT_camera
    assert panel.poll(SimpleNamespace(camera=camera)) and not panel.poll(SimpleNamespace(camera=None))
    camera.realistic.lens = "wide.22mm"
    told = drawn(panel, camera=camera)
    words = [named["text"] for kind, _, named in told if kind == "label"]
    assert words[0].startswith("Wide angle") and words[1].startswith("22.0 mm   f/2.7   nearest focus 0.")
    # Without a window icons have no numbers; that there is a picture to show is seen in its size.
    assert [kind for kind, *_ in told].count("template_icon") == 1
    extension = sys.modules[MODULE]
    assert set(extension._previews) == set(extension._facts) == set(realistic.catalogue())
    assert min(extension._previews["wide.22mm"].image_size) > 100
    buttons = [given[0] for kind, given, _ in told if kind == "operator"]
    assert buttons == ["realistic.set_up", "realistic.from_file", "realistic.pull_focus"]
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    camera.dof.use_dof = False
    assert "Depth of Field is off" in drawn(panel, camera=camera)[-1][2]["text"]
    settings = drawn(type(bpy.context.preferences.addons[MODULE].preferences))
    assert [(kind, given[1]) for kind, given, _ in settings] == [("prop", "program")]
    scene.camera = None
    assert not bpy.ops.realistic.set_up.poll()
    assert not bpy.ops.realistic.from_file.poll() and not bpy.ops.realistic.pull_focus.poll()
