"""Tests of the extension: installs it as Blender's preferences do, presses every button, draws the panel."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import zipfile
from math import hypot
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import tomllib
from stage import SHADERS, empty, picture, read

MODULE = "bl_ext.user_default.realistic"
ROOT = Path(__file__).parents[2]
LENSES = ROOT / "crates" / "optics" / "lenses"


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
    """A scene with a camera, and the extension enabled again, which Blender's factory settings disable."""
    scene, camera = empty((48, 32), 1)
    bpy.ops.preferences.addon_enable(module=MODULE)
    return scene, camera


class Layout:
    """Records a panel's drawing calls, instead of Blender's window."""

    def __init__(self, drawn):
        self.drawn = drawn

    def __getattr__(self, kind):
        def call(*given, **named):
            self.drawn.append((kind, given, named))
            return Layout(self.drawn) if kind in ("row", "column", "box") else SimpleNamespace()

        return call


def drawn(kind, **context):
    """Returns the drawing calls of a panel or of the preferences."""
    calls = []
    kind.draw(SimpleNamespace(layout=Layout(calls), program=""), SimpleNamespace(**context))
    return calls


def test_a_button_makes_the_camera_the_lens(stage, tmp_path):
    scene, camera = stage
    white_world(scene)
    # Each lens begins with the artist's sensor, whatever the lens before has changed.
    lenses = (("wide.22mm", 22.0, None), ("phone.4mm", 4.1, 6.3), ("zoom.24-70mm", 24.7, None), ("phone.4mm", 4.1, 6.3))
    for name, length, diagonal in lenses:
        camera.realistic.lens = name
        assert bpy.ops.realistic.set_up() == {"FINISHED"}
        assert scene.render.engine == "CYCLES" and camera.type == "CUSTOM" and camera.dof.use_dof
        assert camera.lens == pytest.approx(length, abs=0.1)
        # A phone's film is small: on the artist's sensor of 36 mm nearly all of the picture would be black.
        across = hypot(camera.sensor_width, camera.sensor_width / 1.5)
        assert across == pytest.approx(diagonal or hypot(36, 24), abs=0.05)
        camera.dof.focus_distance = 2.0
        seen = picture(scene, tmp_path)
        assert seen[16, 24] == pytest.approx(1.0, rel=0.15), name
        assert (seen > 0).mean() > 0.95


def panel_notes(camera):
    """Returns the panel's notes on settings that the shader ignores."""
    calls = drawn(bpy.types.REALISTIC_PT_camera, camera=camera)
    return [named["text"] for kind, _, named in calls if kind == "label" and named.get("icon") == "INFO"]


def state(camera):
    """Returns the artist's settings of a camera and its scene."""
    scene = bpy.context.scene
    return (
        *(
            getattr(camera, name)
            for name in ("type", "lens", "sensor_width", "sensor_height", "custom_mode", "custom_shader")
        ),
        *(
            camera.dof.use_dof,
            camera.dof.aperture_fstop,
            scene.render.engine,
            len(bpy.data.texts),
            len(bpy.data.cameras),
        ),
        *(len(camera.animation_data.drivers) if camera.animation_data else 0, camera.realistic.kept),
    )


def white_world(scene):
    """Makes a scene's world white."""
    tree = scene.world.node_tree
    light, world = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(light.outputs[0], world.inputs[0])
    light.inputs["Color"].default_value = (1, 1, 1, 1)


def test_the_artists_sensor_is_saved_and_restored(stage):
    scene, camera = stage
    scene.render.engine, camera.sensor_width, camera.lens = (
        "BLENDER_EEVEE_NEXT" if bpy.app.version < (5, 0) else "BLENDER_EEVEE",
        30.0,
        42.0,
    )
    before = state(camera)
    for name in ("phone.4mm", "phone.4mm", "zoom.24-70mm"):
        camera.realistic.lens = name
        assert bpy.ops.realistic.set_up() == {"FINISHED"}
        assert (camera.sensor_width < 6) is (name == "phone.4mm")
        # The text of a lens is removed when no camera uses it any more.
        assert [text.name for text in bpy.data.texts] == [f"{name}.osl"]
    assert camera.sensor_width == 30.0
    assert bpy.ops.realistic.take_off() == {"FINISHED"}
    assert state(camera) == before and not bpy.ops.realistic.take_off.poll()
    # The next lens begins with a sensor that the artist has set after the last one.
    camera.realistic.lens = "phone.4mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    camera.sensor_width = 24.0
    camera.realistic.lens = "wide.22mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"} and camera.sensor_width == 24.0
    assert bpy.ops.realistic.take_off() == {"FINISHED"} and camera.sensor_width == 24.0 and camera.type == before[0]


def test_undo_brings_all_back(stage):
    _, camera = stage
    name, before = camera.name, state(camera)
    camera.realistic.lens = "phone.4mm"
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="after")
    assert bpy.data.cameras[name].sensor_width < 6
    assert bpy.ops.ed.undo() == {"FINISHED"}
    assert state(bpy.data.cameras[name]) == before


def test_a_shader_that_does_not_compile_changes_nothing(stage, monkeypatch):
    scene, camera = stage
    scene.render.engine = "BLENDER_WORKBENCH"
    before = state(camera)
    extension = sys.modules[MODULE]
    messages = []
    assert not extension.set_up(
        bpy.context, camera, "broken", "shader broken(", lambda kind, text: messages.append(text)
    )
    assert state(camera) == before and any("compilation failed" in text for text in messages)

    def missing():
        raise ModuleNotFoundError("No module named 'oslquery'")

    monkeypatch.setattr(extension, "_compiler", missing)
    with pytest.raises(RuntimeError, match="this Blender cannot compile shaders: No module named 'oslquery'"):
        bpy.ops.realistic.set_up()
    assert state(camera) == before


# Script of a render farm's node: Blender without this extension opens the file and renders it.
NODE = """
import bpy, sys
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
assert not hasattr(bpy.types.Camera, "realistic")
bpy.context.scene.frame_set(int(sys.argv[3]))
bpy.context.scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
"""


def on_a_node(blend, out, frame=1):
    """Renders a file as a farm's node does, in a folder of its own; returns the picture."""
    room = out.parent / f"node-{out.stem}"
    room.mkdir()
    subprocess.run(
        [sys.executable, "-c", NODE, blend, out, str(frame)],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(room), "HOME": str(room), "PYTHONPATH": ""},
        cwd=room,
        check=True,
        timeout=300,
    )
    return read(out)


def test_the_file_renders_on_a_node_without_the_extension(stage, program, tmp_path):
    scene, camera = stage
    white_world(scene)
    bpy.context.preferences.addons[MODULE].preferences.program = program
    camera.realistic.lens, camera.realistic.lens_file = "wide.22mm", str(LENSES / "tessar.50mm.dat")
    for button in (bpy.ops.realistic.set_up, bpy.ops.realistic.from_file):
        assert button() == {"FINISHED"}
        here = picture(scene, tmp_path)
        blend = tmp_path / f"{camera.custom_shader.name}.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
        there = on_a_node(blend, tmp_path / f"{camera.custom_shader.name}.exr")
        assert here[16, 24] == pytest.approx(1.0, rel=0.15) and np.array_equal(here, there)


def widths(scene, folder):
    """Returns the width of the bright bar in the middle row of the picture, in pixels."""
    seen = picture(scene, folder)[..., 0]
    return np.count_nonzero(seen[seen.shape[0] // 2] > 0.5 * seen.max())


def test_a_zoom_is_keyed_and_its_picture_follows_on_a_node_too(stage, tmp_path):
    scene, camera = stage
    white_world(scene)
    # The gap between black boards is a bright bar, 2 m wide, 20 m away.
    for x in (-51.0, 51.0):
        bpy.ops.mesh.primitive_plane_add(size=100, location=(x, 0, -20))
        board = bpy.data.materials.new("black")
        tree = board.node_tree
        if tree is None:
            board.use_nodes = True
            tree = board.node_tree
        tree.nodes.clear()
        bpy.context.object.data.materials.append(board)
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 120, 80, 16
    scene.frame_start, scene.frame_end = 1, 25
    camera.realistic.lens = "zoom.24-70mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    camera.dof.focus_distance = 20.0
    custom = camera.cycles_custom
    calls = drawn(bpy.types.REALISTIC_PT_camera, camera=camera)
    assert ("prop", (custom, '["zoom"]'), {"text": "Focal Length (mm)"}) in calls
    limits = custom.id_properties_ui("zoom").as_dict()
    assert limits["min"] == pytest.approx(24.7, abs=0.1) and limits["max"] == pytest.approx(67.9, abs=0.1)
    for frame, length in ((1, 25.0), (25, 65.0)):
        custom["zoom"] = length
        custom.keyframe_insert('["zoom"]', frame=frame)
    found = {}
    for frame, length in ((1, 25.0), (25, 65.0), (13, 45.0)):
        scene.frame_set(frame)
        assert custom["zoom"] == pytest.approx(length, abs=0.1) and camera.lens == pytest.approx(length, abs=0.1)
        found[frame] = widths(scene, tmp_path)
        # The expected width is that of first-order optics, with 120 pixels on 36 mm. Zoom lenses distort by some
        # percent.
        assert found[frame] == pytest.approx(2 / 20 * length / 36 * 120, rel=0.08, abs=1.5), found
    blend = tmp_path / "zoom.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
    there = on_a_node(blend, tmp_path / "there.exr", 25)[..., 0]
    assert np.count_nonzero(there[40] > 0.5 * there.max()) == pytest.approx(found[25], abs=1)
    # A prime lens has no zoom and no drivers for it.
    camera.realistic.lens = "dgauss.50mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    assert "zoom" not in custom and camera.lens == pytest.approx(50.4, abs=0.1) and not camera.animation_data.drivers


def test_notes_name_what_the_shader_ignores(stage):
    _, camera = stage
    camera.realistic.lens = "zoom.70-200mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    assert panel_notes(camera) == ["Its groups move to focus, the film stays"]
    camera.cycles_custom["zoom"], camera.dof.focus_distance, camera.dof.aperture_fstop = 400.0, 0.5, 1.4
    camera.dof.aperture_blades = 6
    assert panel_notes(camera) == [
        "It zooms from 71.4 to 196.0 mm, no farther",
        "Its groups move to focus, the film stays",
        "Nearer than it focuses: 1.24 in front of it is in focus",
        "It opens no wider than about f/2.9",
        "Blades and ratio are the lens file's, not the camera's",
    ]
    facts = sys.modules[MODULE].shown_facts(camera)
    alone = {**facts, "focuses_by_groups": False, "focal_lengths_mm": [105.0, 105.0]}
    assert sys.modules[MODULE].notes(camera, alone)[0] == "The file's zoom is not followed: 105.0 mm only"
    assert "The whole lens moves to focus: the file's groups are not followed" in sys.modules[MODULE].notes(
        camera, alone
    )


def test_headless_works_as_the_page_has_it(zip_file, tmp_path):
    page = (ROOT / "docs/blender.md").read_text()
    block = re.search(r"```python\n(.*?)```", page, re.DOTALL)[1]
    assert "import bpy" in block
    room = tmp_path / "room"
    room.mkdir()
    (tmp_path / "realistic.zip").symlink_to(zip_file)
    completed = subprocess.run(
        [sys.executable, "-c", block],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(room), "PYTHONPATH": ""},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert completed.returncode == 0, completed.stderr
    import OpenImageIO

    image = OpenImageIO.ImageInput.open(str(tmp_path / "picture.png"))
    assert np.array(image.read_image("float"))[..., :3].mean() > 0.1


def test_the_extensions_licence_is_that_of_its_platform(zip_file):
    with zipfile.ZipFile(zip_file) as archive:
        assert {"LICENSE", "LICENSE-MIT", "LICENSE-APACHE"} <= set(archive.namelist())
        assert tomllib.loads(archive.read("blender_manifest.toml").decode())["license"] == ["SPDX:GPL-3.0-or-later"]
        assert "GNU GENERAL PUBLIC LICENSE\n                       Version 3" in archive.read("LICENSE").decode()
        code = archive.read("__init__.py").decode()
    assert code.startswith("# SPDX-License-Identifier: GPL-3.0-or-later OR MIT OR Apache-2.0\n")


def test_focus_is_animated(stage):
    scene, camera = stage
    scene.frame_start, scene.frame_end = 1, 25
    camera.realistic.lens = "dgauss.50mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    camera.dof.focus_distance, camera.realistic.end_focus_distance = 4.0, 1.0
    assert bpy.ops.realistic.pull_focus() == {"FINISHED"}
    for frame, expected in ((1, 4.0), (25, 1.0)):
        scene.frame_set(frame)
        assert camera.dof.focus_distance == pytest.approx(expected, abs=1e-6)
    scene.frame_set(13)
    assert 1.0 < camera.dof.focus_distance < 4.0


def second_camera(scene, name="second"):
    """Adds a camera object that is not the scene's active camera."""
    holder = bpy.data.objects.new(name, bpy.data.cameras.new(name))
    scene.collection.objects.link(holder)
    return holder


def test_operators_change_the_selected_camera_or_the_scenes(stage, program, capfd):
    scene, camera = stage
    bpy.context.preferences.addons[MODULE].preferences.program = program
    holder, objects = second_camera(scene), bpy.context.view_layer.objects
    cube = bpy.data.objects.new("cube", bpy.data.meshes.new("cube"))
    scene.collection.objects.link(cube)
    other, before = holder.data, state(camera)
    other.realistic.lens, other.realistic.lens_file, other.realistic.end_focus_distance = (
        "wide.22mm",
        str(LENSES / "tessar.50mm.dat"),
        3.0,
    )
    scene.frame_end = 25

    def choose(active, *selected):
        for each in scene.objects:
            each.select_set(each in selected)
        objects.active = active
        capfd.readouterr()

    # The camera is active but not selected; then it is selected while another object, or none, is active.
    for active, selected in ((holder, ()), (cube, (holder, cube)), (None, (holder,))):
        choose(active, *selected)
        engine = scene.render.engine
        assert bpy.ops.realistic.set_up() == {"FINISHED"} and other.custom_shader.name == "wide.22mm.osl"
        assert bpy.ops.realistic.from_file() == {"FINISHED"} and other.custom_shader.name == "tessar.50mm.osl"
        assert bpy.ops.realistic.pull_focus() == {"FINISHED"} and other.dof.focus_distance == 3.0
        assert bpy.ops.realistic.take_off() == {"FINISHED"} and other.type == "PERSP"
        assert "no camera is selected" not in capfd.readouterr().out
        assert scene.render.engine == engine and state(camera) == before

    # If no camera is chosen, or two are selected, the scene's camera is used, and reported.
    camera.realistic.lens = "wide.22mm"
    for active, selected in ((cube, (cube,)), (None, ()), (cube, (holder, scene.camera))):
        choose(active, *selected)
        assert bpy.ops.realistic.set_up() == {"FINISHED"} and camera.type == "CUSTOM" and other.type == "PERSP"
        assert 'this changes the scene\'s, "camera"' in capfd.readouterr().out
        assert bpy.ops.realistic.take_off() == {"FINISHED"} and camera.type == "PERSP"
    # The panel's camera has precedence; it may be pinned.
    choose(holder, holder)
    with bpy.context.temp_override(camera=camera):
        assert bpy.ops.realistic.set_up() == {"FINISHED"} and camera.type == "CUSTOM" and other.type == "PERSP"


def test_an_operator_that_fails_is_cancelled_and_changes_nothing(stage, monkeypatch):
    scene, camera = stage
    extension = sys.modules[MODULE]
    own = bpy.data.texts.new("own.osl")
    own.write("shader own(output color throughput = 1) {}")
    camera.type, camera.custom_mode, camera.custom_shader = "CUSTOM", "INTERNAL", own
    camera.realistic.lens = "wide.22mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    before = state(camera)

    def fails(button, message):
        """Checks that a button fails: it returns CANCELLED with a report, and bpy.ops raises an exception with that
        report."""
        reports = []
        operator = SimpleNamespace(report=lambda kind, text: reports.append((kind, text)))
        operator.change = lambda context, camera: button.change(operator, context, camera)
        assert button.execute(operator, bpy.context) == {"CANCELLED"}
        assert any("ERROR" in kind and message in text for kind, text in reports), reports
        with pytest.raises(RuntimeError, match=message):
            getattr(bpy.ops.realistic, button.bl_idname.split(".")[1])()
        assert state(camera) == before

    # The camera's own shader does not compile any more, or is missing.
    own.clear()
    own.write("shader own(")
    fails(extension.REALISTIC_OT_take_off, 'the shader "own.osl" before its lens, which is missing or does not compile')
    own.name = "renamed.osl"
    fails(extension.REALISTIC_OT_take_off, 'the shader "own.osl" before its lens')
    own.name = "own.osl"
    own.clear()
    own.write("shader own(output color throughput = 1) {}")

    # This compiler fails without giving a reason.
    monkeypatch.setattr(extension, "_compiler", lambda: lambda _camera, _report: False)
    camera.realistic.lens = "dgauss.50mm"
    fails(extension.REALISTIC_OT_set_up, "the shader of dgauss.50mm does not compile")
    monkeypatch.undo()
    camera.realistic.lens_file = ""
    fails(extension.REALISTIC_OT_from_file, "no lens file is given" if shutil.which("realistic") else "realistic")

    # In a scene with one frame, nothing would move.
    scene.frame_start = scene.frame_end = 7
    fails(extension.REALISTIC_OT_pull_focus, "the scene has one frame, 7")
    scene.frame_end = 25
    camera.dof.focus_object = scene.camera
    fails(extension.REALISTIC_OT_pull_focus, 'focuses on the object "camera"')
    camera.dof.focus_object = None
    assert camera.animation_data is None or camera.animation_data.action is None
    assert bpy.ops.realistic.take_off() == {"FINISHED"} and camera.custom_shader == own


def test_a_lens_file_lies_beside_the_blend(stage, program, tmp_path, recwarn):
    _, camera = stage
    bpy.context.preferences.addons[MODULE].preferences.program = program
    camera.realistic.lens_file = "//own.dat"
    with pytest.raises(RuntimeError, match=r"//own\.dat is relative to the \.blend file: save that first"):
        bpy.ops.realistic.from_file()
    (tmp_path / "lenses").mkdir()
    for name in ("own.dat", "lenses/other.dat"):
        (tmp_path / name).write_bytes((LENSES / "tessar.50mm.dat").read_bytes())
    assert bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend")) == {"FINISHED"}
    for path, text in (
        ("//own.dat", "own.osl"),
        ("//lenses/other.dat", "other.osl"),
        ("//lenses/../own.dat", "own.osl"),
    ):
        camera.realistic.lens_file = path
        assert bpy.ops.realistic.from_file() == {"FINISHED"} and camera.custom_shader.name == text
    assert not [str(each.message) for each in recwarn if "blend relative" in str(each.message)]


def test_a_lens_file_is_a_camera_by_the_program(stage, program, monkeypatch, tmp_path):
    _, camera = stage
    preferences = bpy.context.preferences.addons[MODULE].preferences
    monkeypatch.setenv("PATH", str(tmp_path))
    camera.realistic.lens_file = str(LENSES / "tessar.50mm.dat")
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
    assert camera.custom_shader.name == "tessar.50mm.osl" and camera.custom_shader.as_string().startswith("/* ")
    camera.realistic.lens_file = str(tmp_path / "nowhere.dat")
    with pytest.raises(RuntimeError, match=r"nowhere\.dat"):
        bpy.ops.realistic.from_file()
    broken = tmp_path / "broken.dat"
    broken.write_text("1 2 three 4\n")
    camera.realistic.lens_file = str(broken)
    with pytest.raises(RuntimeError, match="three"):
        bpy.ops.realistic.from_file()


def test_the_panel_shows_the_lens_and_has_every_button(stage):
    scene, camera = stage
    panel = bpy.types.REALISTIC_PT_camera
    assert panel.poll(SimpleNamespace(camera=camera)) and not panel.poll(SimpleNamespace(camera=None))
    camera.realistic.lens = "wide.22mm"
    calls = drawn(panel, camera=camera)
    words = [named["text"] for kind, _, named in calls if kind == "label"]
    assert words[0].startswith("Wide angle") and words[1].startswith("22.0 mm   f/2.8   nearest focus 0.")
    # Without a window, icons have no numbers; the picture's size shows that the icon exists.
    assert [kind for kind, *_ in calls].count("template_icon") == 1
    extension = sys.modules[MODULE]
    assert set(extension._previews) == set(extension._facts) == set(SHADERS)
    assert min(extension._previews["wide.22mm"].image_size) > 100
    buttons = [given[0] for kind, given, _ in calls if kind == "operator"]
    assert buttons == ["realistic.set_up", "realistic.from_file", "realistic.take_off"]
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    assert panel_notes(camera) == []
    camera.dof.use_dof = False
    assert panel_notes(camera) == ["Depth of Field is off: wide open, at infinity"]
    buttons = [given[0] for kind, given, _ in drawn(panel, camera=camera) if kind == "operator"]
    assert buttons[-1] == "realistic.pull_focus"
    settings = drawn(type(bpy.context.preferences.addons[MODULE].preferences))
    assert [(kind, given[1]) for kind, given, _ in settings] == [("prop", "program")]
    scene.camera = None
    assert not bpy.ops.realistic.set_up.poll()
    assert not bpy.ops.realistic.from_file.poll() and not bpy.ops.realistic.pull_focus.poll()
