"""Cameras of Blender's Cycles that are real lenses: a panel of the camera that lists them, shows their cross-sections and
figures, and sets the camera up. The shaders of the catalogue's lenses are in the folder `lenses`; those of lens files are
written by the program `realistic`, whose path the preferences name.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import tempfile
from math import hypot
from pathlib import Path

import bpy
import bpy.utils.previews

LENSES = Path(__file__).parent / "lenses"

# Blender keeps no reference to the entries of a list: this one does.
_entries: list[tuple[str, str, str, int, int]] = []
_facts: dict[str, dict[str, object]] = {}
_previews = None


def _load() -> None:
    """Reads the catalogue's facts and its pictures."""
    global _previews
    _facts.update(json.loads((LENSES / "lenses.json").read_text()))
    _previews = bpy.utils.previews.new()
    for number, (name, facts) in enumerate(_facts.items()):
        icon = _previews.load(name, str(LENSES / f"{name}.png"), "IMAGE").icon_id
        _entries.append((name, name, str(facts["title"]), icon, number))


def _catalogue(_self, _context):
    return _entries


def _folder() -> Path:
    """Where shaders of lens files are kept: beside the saved scene, or else among this extension's files."""
    if bpy.data.filepath:
        return Path(bpy.data.filepath).parent
    try:
        return Path(bpy.utils.extension_path_user(__package__, path="shaders", create=True))
    except ValueError:
        return Path(tempfile.gettempdir())


def set_up(context, camera, shader: str, facts: dict[str, object], report) -> bool:
    """Makes `camera` (its data) the lens of a shader; whether that worked. A sensor beyond the film that gets light is made smaller."""
    from cycles.osl import update_custom_camera_shader

    context.scene.render.engine = "CYCLES"
    camera.type = "CUSTOM"
    camera.custom_mode = "EXTERNAL"
    camera.custom_filepath = shader
    if not update_custom_camera_shader(camera, report):
        return False
    reach = facts.get("film_reach_mm")
    if reach:
        width, height = _sensor(context.scene.render, camera)
        share = 2 * float(reach) / hypot(width, height)
        if share < 1:
            camera.sensor_width *= share
            camera.sensor_height *= share
            report(
                {"INFO"}, f"the lens has light for a sensor of {2 * float(reach):.1f} mm across: the sensor is now one"
            )
    focal_length = facts.get("focal_length_mm")
    if focal_length:
        # What Blender draws as the view's frame; the shader does not ask for it.
        camera.lens = max(1.0, float(focal_length))
    if bpy.app.version < (5, 0):
        # There the shader is given the stop as the aperture of a lens of this focal length.
        camera.cycles_custom["focal_length"] = camera.lens
    camera.dof.use_dof = True
    camera.dof.aperture_fstop = float(facts.get("fnumber") or camera.dof.aperture_fstop)
    return True


def _sensor(render, camera) -> tuple[float, float]:
    """Width and height in mm of what a picture shows of the sensor."""
    x, y = render.resolution_x * render.pixel_aspect_x, render.resolution_y * render.pixel_aspect_y
    fit = camera.sensor_fit
    if fit == "VERTICAL":
        return camera.sensor_height * x / y, camera.sensor_height
    if fit == "AUTO" and y > x:
        return camera.sensor_width * x / y, camera.sensor_width
    return camera.sensor_width, camera.sensor_width * y / x


def _camera(context):
    """The data of the camera whose panel is open, or else of the scene's; None where there is none."""
    shown = getattr(context, "camera", None)
    if shown is None and context.scene.camera is not None and context.scene.camera.type == "CAMERA":
        shown = context.scene.camera.data
    return shown


class REALISTIC_PG_camera(bpy.types.PropertyGroup):
    lens: bpy.props.EnumProperty(name="Lens", description="A lens of the catalogue", items=_catalogue)
    file: bpy.props.StringProperty(
        name="Lens File", description="A prescription: own table, Zemax .zmx, Optical Bench text", subtype="FILE_PATH"
    )
    distance: bpy.props.FloatProperty(
        name="Focus at End", description="Focus distance at the last frame", default=1.0, min=0.01, subtype="DISTANCE"
    )


class REALISTIC_OT_set_up(bpy.types.Operator):
    """Make this camera the chosen lens of the catalogue"""

    bl_idname = "realistic.set_up"
    bl_label = "Use This Lens"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context):
        return _camera(context) is not None

    def execute(self, context):
        camera = _camera(context)
        name = camera.realistic.lens
        done = set_up(context, camera, str(LENSES / f"{name}.osl"), _facts[name], self.report)
        return {"FINISHED"} if done else {"CANCELLED"}


class REALISTIC_OT_from_file(bpy.types.Operator):
    """Make this camera the lens of a file, by the program realistic"""

    bl_idname = "realistic.from_file"
    bl_label = "Use Lens File"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context):
        return _camera(context) is not None

    def execute(self, context):
        camera = _camera(context)
        preferences = context.preferences.addons.get(__package__)
        named = preferences.preferences.program if preferences else ""
        program = bpy.path.abspath(named) if named else shutil.which("realistic")
        if not program:
            self.report({"ERROR"}, "the program realistic is not found: name it in this extension's preferences")
            return {"CANCELLED"}
        lens = bpy.path.abspath(camera.realistic.file)
        shader = _folder() / (Path(lens).stem + ".osl")
        try:
            told = subprocess.run(
                [program, "blender", lens, "--out", str(shader)],
                capture_output=True,
                text=True,
                timeout=300,
                check=False,
            )
            facts = subprocess.run(
                [program, "lens", lens, "--json"], capture_output=True, text=True, timeout=60, check=False
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            self.report({"ERROR"}, f"{program} does not run: {error}")
            return {"CANCELLED"}
        if told.returncode != 0:
            self.report({"ERROR"}, told.stderr.strip() or f"{program} failed")
            return {"CANCELLED"}
        read = json.loads(facts.stdout) if facts.returncode == 0 else {}
        reach = re.search(r"film points up to ([\d.]+) mm", shader.read_text())
        read["film_reach_mm"] = reach and reach[1]
        return {"FINISHED"} if set_up(context, camera, str(shader), read, self.report) else {"CANCELLED"}


class REALISTIC_OT_pull_focus(bpy.types.Operator):
    """Animate the focus from where it is to another distance, over the scene's frames"""

    bl_idname = "realistic.pull_focus"
    bl_label = "Animate Focus"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context):
        return _camera(context) is not None

    def execute(self, context):
        camera = _camera(context)
        dof, scene = camera.dof, context.scene
        dof.keyframe_insert("focus_distance", frame=scene.frame_start)
        dof.focus_distance = camera.realistic.distance
        dof.keyframe_insert("focus_distance", frame=scene.frame_end)
        return {"FINISHED"}


class REALISTIC_PT_camera(bpy.types.Panel):
    bl_label = "Realistic Lens"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return context.camera is not None

    def draw(self, context):
        camera, layout = context.camera, self.layout
        chosen = camera.realistic
        layout.prop(chosen, "lens")
        facts = _facts.get(chosen.lens)
        if facts:
            layout.template_icon(icon_value=_previews[chosen.lens].icon_id, scale=10)
            column = layout.column(align=True)
            column.label(text=str(facts["title"]))
            column.label(
                text=f"{facts['focal_length_mm']:.1f} mm   f/{facts['fnumber']:.1f}   "
                f"nearest focus {facts['nearest_mm'] / 1000:.2f} m"
            )
        layout.operator("realistic.set_up", icon="CAMERA_DATA")
        row = layout.row(align=True)
        row.prop(chosen, "file", text="")
        row.operator("realistic.from_file")
        row = layout.row(align=True)
        row.prop(chosen, "distance")
        row.operator("realistic.pull_focus", icon="KEYTYPE_KEYFRAME_VEC")
        if camera.type == "CUSTOM" and not camera.dof.use_dof:
            layout.label(text="Depth of Field is off: wide open, at infinity", icon="INFO")


class REALISTIC_preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="Program realistic", description="For lens files; empty: looked for in PATH", subtype="FILE_PATH"
    )

    def draw(self, context):
        self.layout.prop(self, "program")


CLASSES = (
    REALISTIC_PG_camera,
    REALISTIC_OT_set_up,
    REALISTIC_OT_from_file,
    REALISTIC_OT_pull_focus,
    REALISTIC_PT_camera,
    REALISTIC_preferences,
)


def register() -> None:
    _load()
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Camera.realistic = bpy.props.PointerProperty(type=REALISTIC_PG_camera)


def unregister() -> None:
    del bpy.types.Camera.realistic
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
    bpy.utils.previews.remove(_previews)
    _entries.clear()
    _facts.clear()
