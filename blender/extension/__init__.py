# SPDX-License-Identifier: GPL-3.0-or-later OR MIT OR Apache-2.0
"""Real lenses as cameras for Blender's Cycles. A panel of the camera lists the lenses, shows their cross-sections and
data, and sets the camera up. The shaders of the catalogue's lenses are in the folder `lenses`; shaders of lens files
are written by the program `realistic`, whose path is set in the preferences. A camera's shader is a text of the .blend
file, so that the file renders without this extension, too.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import shutil
import subprocess
import sys
from math import hypot
from pathlib import Path

import bpy
import bpy.utils.previews

LENSES = Path(__file__).parent / "lenses"
# Prefix of a shader's line of facts.
FACTS = "// facts: "
# Name of the camera's property for the focal length of a zoom lens, in mm, which can be animated.
ZOOM = "zoom"
# The option for paths that may begin with //, which stands for the folder of the .blend; Blender 4.5 allows // in every
# path.
RELATIVE = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (5, 0) else set()

# Blender keeps no reference to the entries of an enum: this list keeps them alive.
_entries: list[tuple[str, str, str, int, int]] = []
_facts: dict[str, dict[str, object]] = {}
_previews = None


def _load() -> None:
    """Reads the catalogue's facts and its pictures."""
    global _previews
    _facts.update(json.loads((LENSES / "lenses.json").read_text(encoding="utf-8")))
    _previews = bpy.utils.previews.new()
    for number, (name, facts) in enumerate(_facts.items()):
        icon = _previews.load(name, str(LENSES / f"{name}.png"), "IMAGE").icon_id
        _entries.append((name, name, str(facts["title"]), icon, number))


def _catalogue(_self, _context):
    return _entries


def facts_of(shader: str) -> dict[str, object]:
    """Returns the facts of the lens in a shader; empty for a shader of another origin."""
    line = next((line for line in shader.splitlines() if line.startswith(FACTS)), None)
    return json.loads(line.removeprefix(FACTS)) if line else {}


def _facts_of_text(text) -> dict[str, object]:
    """Returns the facts of the lens in a text of the .blend; they are in the text's first lines."""
    return facts_of("\n".join(line.body for line in text.lines[:12])) if text else {}


def shown_facts(camera) -> dict[str, object]:
    """Returns the facts of a camera's lens; empty for a camera without a lens of this extension."""
    is_custom = camera.type == "CUSTOM" and camera.custom_mode == "INTERNAL"
    return _facts_of_text(camera.custom_shader) if is_custom else {}


def _compiler():
    """Returns Blender's own function that compiles a camera's shader. If Blender is a Python module, the package that
    reads compiled shaders is in a folder outside Python's path, which this function adds for the import."""
    if importlib.util.find_spec("oslquery") is None:
        packages = Path(bpy.utils.resource_path("LOCAL")) / "python"
        found = [str(package.parent) for package in packages.glob("**/site-packages/oslquery*")]
        sys.path += found[:1]
        try:
            importlib.import_module("oslquery")
        finally:
            del sys.path[len(sys.path) - len(found[:1]) :]
    return importlib.import_module("cycles.osl").update_custom_camera_shader


def _compiled(camera, text, report, mode="INTERNAL") -> bool:
    """Sets a camera's shader, either a text or the file that the camera names; returns whether it compiles."""
    camera.type, camera.custom_mode, camera.custom_shader = "CUSTOM", mode, text
    return bool(_compiler()(camera, report))


def _compiles(camera, mode, text, report) -> bool:
    """Returns whether a shader compiles, either a text or the file that `camera` names; tries it on a temporary
    camera."""
    trial = bpy.data.cameras.new("trial")
    trial.custom_filepath = camera.custom_filepath
    try:
        return _compiled(trial, text, report, mode)
    except ImportError as error:
        report({"ERROR"}, f"this Blender cannot compile shaders: {error}")
        return False
    finally:
        bpy.data.cameras.remove(trial)


def _text(name: str, shader: str):
    """Returns the text of a shader in this .blend; reuses an equal text."""
    for text in bpy.data.texts:
        if text.name.startswith(name) and text.as_string().rstrip() == shader.rstrip():
            return text
    text = bpy.data.texts.new(f"{name}.osl")
    text.write(shader)
    return text


def _drop_unused(text) -> None:
    """Removes a shader of this extension that no camera uses any more."""
    if _facts_of_text(text) and not any(camera.custom_shader == text for camera in bpy.data.cameras):
        bpy.data.texts.remove(text)


def _follow_zoom(camera, path: str) -> None:
    """Drives a property of the camera by its zoom. Uses no expression: Blender may block those in files of other
    authors."""
    if any(curve.data_path == path for curve in (camera.animation_data.drivers if camera.animation_data else ())):
        # Keeps the artist's own driver.
        return
    driver = camera.driver_add(path).driver
    driver.type = "AVERAGE"
    variable = driver.variables.new()
    variable.targets[0].id_type, variable.targets[0].id = "CAMERA", camera
    variable.targets[0].data_path = f'cycles_custom["{ZOOM}"]'


def _stop_following(camera) -> None:
    """Removes the drivers of `_follow_zoom`."""
    animated = camera.animation_data
    for curve in list(animated.drivers) if animated else []:
        paths = [target.data_path for variable in curve.driver.variables for target in variable.targets]
        if paths == [f'cycles_custom["{ZOOM}"]']:
            camera.driver_remove(curve.data_path)


def set_up(context, camera, name: str, shader: str, report) -> bool:
    """Gives `camera` (a camera's data) the lens of a shader; returns whether that worked, and changes nothing if not.
    Shrinks a sensor that is larger than the lit film, and saves the artist's own sensor, with which the next lens
    begins."""
    if not hasattr(camera, "cycles_custom"):
        report({"ERROR"}, "Cycles is not enabled: enable its add-on, Cycles Render Engine, in the preferences")
        return False
    texts = set(bpy.data.texts)
    text = _text(name, shader)
    if not _compiles(camera, "INTERNAL", text, report):
        report({"ERROR"}, f"the shader of {name} does not compile in this Blender")
        if text not in texts:
            bpy.data.texts.remove(text)
        return False

    facts = facts_of(shader)
    _save_original(context.scene, camera)
    before = camera.custom_shader
    context.scene.render.engine = "CYCLES"
    _compiled(camera, text, report)  # It compiles, as the trial showed.
    if before != text:
        _drop_unused(before)
    reach = 2 * float(facts.get("film_reach_mm") or 0)
    width, height = _sensor(context.scene.render, camera)
    if 0 < reach < hypot(width, height):
        share = reach / hypot(width, height)
        camera.sensor_width *= share
        camera.sensor_height *= share
        report({"INFO"}, f"the lens has light for a sensor of {reach:.1f} mm across: the sensor is now one")
    _save_made(camera)
    shortest, longest = facts.get("focal_lengths_mm") or (camera.lens, camera.lens)
    custom = camera.cycles_custom
    _stop_following(camera)
    if ZOOM in custom:
        custom[ZOOM] = min(max(custom[ZOOM], shortest), longest)
    # Blender draws the view's frame from this focal length; the shader does not use it.
    camera.lens = max(1.0, custom.get(ZOOM, shortest))
    if ZOOM in custom:
        _follow_zoom(camera, "lens")
    if bpy.app.version < (5, 0):
        # Blender before 5.0 passes the stop to the shader as an aperture size, which it computes with this focal
        # length.
        custom["focal_length"] = camera.lens
        if ZOOM in custom:
            _follow_zoom(camera, 'cycles_custom["focal_length"]')
    camera.dof.use_dof = True
    camera.dof.aperture_fstop = float(facts.get("fnumber") or camera.dof.aperture_fstop)
    return True


# Names of the properties of the artist's own camera that are saved.
OWN = ("type", "lens", "sensor_width", "sensor_height", "custom_mode")


def _save_original(scene, camera) -> None:
    """Saves the properties of the artist's own camera at the first lens. For a later lens, restores the artist's
    sensor, unless the artist has changed the sensor since."""
    original = json.loads(camera.realistic.kept or "null")
    if original is None:
        original = {name: getattr(camera, name) for name in OWN}
        original |= {"use_dof": camera.dof.use_dof, "fstop": camera.dof.aperture_fstop, "engine": scene.render.engine}
        original["shader"] = camera.custom_shader.name if camera.custom_shader else ""
    elif [camera.sensor_width, camera.sensor_height] == original.get("made"):
        camera.sensor_width, camera.sensor_height = original["sensor_width"], original["sensor_height"]
    else:
        original |= {"sensor_width": camera.sensor_width, "sensor_height": camera.sensor_height}
    camera.realistic.kept = json.dumps(original)


def _save_made(camera) -> None:
    """Records the sensor that was set for a lens, to detect one that the artist sets later."""
    original = json.loads(camera.realistic.kept)
    camera.realistic.kept = json.dumps(original | {"made": [camera.sensor_width, camera.sensor_height]})


def take_off(context, camera, report) -> bool:
    """Restores the camera to its state before the first lens; returns whether that worked. A sensor that the artist has
    set since then stays. Changes nothing if the camera had a shader of its own that does not compile any more."""
    original = json.loads(camera.realistic.kept)
    own = bpy.data.texts.get(original["shader"])
    if original["type"] == "CUSTOM" and not _compiles(camera, original["custom_mode"], own, report):
        name = original["shader"] or camera.custom_filepath
        report({"ERROR"}, f'the camera had the shader "{name}" before its lens, which is missing or does not compile')
        return False
    _stop_following(camera)
    is_ours = [camera.sensor_width, camera.sensor_height] == original["made"]
    for name in OWN:
        if is_ours or not name.startswith("sensor"):
            setattr(camera, name, original[name])
    camera.dof.use_dof, camera.dof.aperture_fstop = original["use_dof"], original["fstop"]
    context.scene.render.engine = original["engine"]
    text, camera.custom_shader = camera.custom_shader, own
    camera.custom_bytecode = camera.custom_bytecode_hash = ""
    if camera.type == "CUSTOM":
        _compiler()(camera, report)
    _drop_unused(text)
    camera.realistic.kept = ""
    return True


def _sensor(render, camera) -> tuple[float, float]:
    """Returns width and height, mm, of the part of the sensor that a picture shows."""
    x, y = render.resolution_x * render.pixel_aspect_x, render.resolution_y * render.pixel_aspect_y
    fit = camera.sensor_fit
    if fit == "VERTICAL":
        return camera.sensor_height * x / y, camera.sensor_height
    if fit == "AUTO" and y > x:
        return camera.sensor_width * x / y, camera.sensor_width
    return camera.sensor_width, camera.sensor_width * y / x


def _holder(context):
    """Returns the object of the camera that an operator changes, or None, and whether the artist has chosen it.

    It is the active object if that is a camera, else the only selected camera. If the artist has chosen no camera, it
    is the scene's camera.
    """
    active, selected = getattr(context, "active_object", None), getattr(context, "selected_objects", None) or ()
    cameras = [each for each in selected if each.type == "CAMERA"]
    if active is not None and active.type == "CAMERA":
        return active, True
    if len(cameras) == 1:
        return cameras[0], True
    holder = context.scene.camera
    return (holder if holder is not None and holder.type == "CAMERA" else None), False


def _camera(context):
    """Returns the data of the camera that an operator changes: the open panel's camera, else that of `_holder`, or
    None."""
    shown = getattr(context, "camera", None)
    if shown is None:
        holder, _ = _holder(context)
        shown = holder.data if holder is not None else None
    return shown


def _changed_camera(context, report):
    """Returns the result of `_camera` when an operator begins; reports the camera's name if the artist has chosen
    none."""
    if getattr(context, "camera", None) is None:
        holder, chosen = _holder(context)
        if not chosen:
            report({"INFO"}, f'no camera is selected: this changes the scene\'s, "{holder.name}"')
    return _camera(context)


class _Changes:
    """Base class of the operators, which are available if there is a camera to change, and can be undone."""

    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context):
        camera = _camera(context)
        return camera is not None and camera.is_editable

    def execute(self, context):
        camera = _changed_camera(context, self.report)
        return {"FINISHED"} if self.change(context, camera) else {"CANCELLED"}


class REALISTIC_PG_camera(bpy.types.PropertyGroup):
    lens: bpy.props.EnumProperty(name="Lens", description="A lens of the catalogue", items=_catalogue)
    lens_file: bpy.props.StringProperty(
        name="Lens File",
        description="A prescription: own table, Zemax .zmx, Optical Bench text",
        subtype="FILE_PATH",
        options=RELATIVE,
    )
    end_focus_distance: bpy.props.FloatProperty(
        name="Focus at End", description="Focus distance at the last frame", default=1.0, min=0.01, subtype="DISTANCE"
    )
    kept: bpy.props.StringProperty(
        name="Kept", description="What the camera was before its first lens, as JSON", options={"HIDDEN"}
    )


class REALISTIC_OT_set_up(_Changes, bpy.types.Operator):
    """Make this camera the chosen lens of the catalogue"""

    bl_idname = "realistic.set_up"
    bl_label = "Use This Lens"

    def change(self, context, camera) -> bool:
        name = camera.realistic.lens
        shader = (LENSES / f"{name}.osl").read_text(encoding="utf-8")
        return set_up(context, camera, name, shader, self.report)


class REALISTIC_OT_from_file(_Changes, bpy.types.Operator):
    """Make this camera the lens of a file, by the program realistic"""

    bl_idname = "realistic.from_file"
    bl_label = "Use Lens File"

    def change(self, context, camera) -> bool:
        preferences = context.preferences.addons.get(__package__)
        named = preferences.preferences.program if preferences else ""
        program = bpy.path.abspath(named) if named else shutil.which("realistic")
        if not program:
            self.report({"ERROR"}, "the program realistic is not found: name it in this extension's preferences")
            return False
        if not camera.realistic.lens_file:
            self.report({"ERROR"}, "no lens file is given: choose one beside the button")
            return False
        # A new .blend has no folder yet.
        if camera.realistic.lens_file.startswith("//") and not bpy.data.filepath:
            self.report({"ERROR"}, f"{camera.realistic.lens_file} is relative to the .blend file: save that first")
            return False
        lens = bpy.path.abspath(camera.realistic.lens_file, library=camera.library)
        try:
            completed = subprocess.run(
                [program, "blender", lens, "--out", "-"],
                capture_output=True,
                text=True,
                encoding="utf-8",
                timeout=300,
                check=False,
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            self.report({"ERROR"}, f"{program} does not run: {error}")
            return False
        if completed.returncode != 0:
            self.report({"ERROR"}, completed.stderr.strip() or f"{program} failed")
            return False
        return set_up(context, camera, Path(lens).stem, completed.stdout, self.report)


class REALISTIC_OT_take_off(_Changes, bpy.types.Operator):
    """Make this camera what it was before its first lens"""

    bl_idname = "realistic.take_off"
    bl_label = "Take Lens Off"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and bool(_camera(context).realistic.kept)

    def change(self, context, camera) -> bool:
        return take_off(context, camera, self.report)


class REALISTIC_OT_pull_focus(_Changes, bpy.types.Operator):
    """Animate the focus from where it is to another distance, over the scene's frames"""

    bl_idname = "realistic.pull_focus"
    bl_label = "Animate Focus"

    def change(self, context, camera) -> bool:
        dof, scene = camera.dof, context.scene
        if dof.focus_object is not None:
            name = dof.focus_object.name
            self.report(
                {"ERROR"}, f'the camera focuses on the object "{name}": clear Focus on Object, or animate that object'
            )
            return False
        if scene.frame_start == scene.frame_end:
            self.report({"ERROR"}, f"the scene has one frame, {scene.frame_start}: set its end after its start")
            return False
        dof.keyframe_insert("focus_distance", frame=scene.frame_start)
        dof.focus_distance = camera.realistic.end_focus_distance
        dof.keyframe_insert("focus_distance", frame=scene.frame_end)
        return True


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
                text=f"{_lengths(facts)} mm   f/{facts['fnumber']:.1f}   nearest focus {facts['nearest_mm'] / 1000:.2f} m"
            )
        layout.operator("realistic.set_up", icon="CAMERA_DATA")
        row = layout.row(align=True)
        row.prop(chosen, "lens_file", text="")
        row.operator("realistic.from_file")
        layout.operator("realistic.take_off", icon="LOOP_BACK")
        used = shown_facts(camera)
        if not used:
            return
        column = layout.column(align=True)
        if ZOOM in camera.cycles_custom:
            column.prop(camera.cycles_custom, f'["{ZOOM}"]', text="Focal Length (mm)")
        column.prop(camera.dof, "focus_distance", text="Focus Distance")
        row = layout.row(align=True)
        row.prop(chosen, "end_focus_distance")
        row.operator("realistic.pull_focus", icon="KEYTYPE_KEYFRAME_VEC")
        for note in notes(camera, used):
            layout.label(text=note, icon="INFO")


def _lengths(facts) -> str:
    """Formats a lens's focal lengths, mm, from the shortest to the longest."""
    shortest, longest = facts["focal_lengths_mm"]
    return f"{shortest:.1f}" + (f" to {longest:.1f}" if longest > shortest else "")


def notes(camera, facts) -> list[str]:
    """Returns notes on settings of the camera, and on properties of its lens, that the shader ignores."""
    dof, custom = camera.dof, camera.cycles_custom
    mm_per_unit = custom.get("mm_per_unit", 1000)
    shortest, longest = facts["focal_lengths_mm"]
    messages = []
    if facts["could_zoom"] and shortest == longest:
        messages.append(f"The file's zoom is not followed: {shortest:.1f} mm only")
    if ZOOM in custom and not 0.999 * shortest <= custom[ZOOM] <= 1.001 * longest:
        messages.append(f"It zooms from {shortest:.1f} to {longest:.1f} mm, no farther")
    if facts["focuses_by_groups"]:
        messages.append("Its groups move to focus, the film stays")
    elif facts["could_focus_by_groups"]:
        messages.append("The whole lens moves to focus: the file's groups are not followed")
    if not dof.use_dof:
        return [*messages, "Depth of Field is off: wide open, at infinity"]
    if dof.focus_object is None and dof.focus_distance * mm_per_unit < 0.999 * facts["nearest_mm"]:
        messages.append(f"Nearer than it focuses: {facts['nearest_mm'] / mm_per_unit:.3g} in front of it is in focus")
    if dof.aperture_fstop < 0.98 * facts["fnumber"]:
        messages.append(f"It opens no wider than about f/{facts['fnumber']:.1f}")
    if dof.aperture_blades or dof.aperture_ratio != 1:
        messages.append("Blades and ratio are the lens file's, not the camera's")
    return messages


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
    REALISTIC_OT_take_off,
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
