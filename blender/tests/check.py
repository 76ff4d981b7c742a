"""The extension and its shaders in the real Blender: run by the Python that has bpy.

    python blender/tests/check.py EXTENSION.zip PROGRAM [LENS …]

PROGRAM is the built `realistic`. Installs the extension as Blender's preferences do, sets a camera up by its button, and
compares the rays of each lens (dgauss.50mm and tessar.50mm by default) with the same in double precision: the world has each
ray's direction as its colour, and the shader's copies show the ray's start instead. Ends with an error where a fate differs or a
direction is off by more than 1e-5.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

SIZE = (48, 32)
LENS_SAMPLES = ((0.37, 0.81), (0.93, 0.12), (0.97, 0.6))
# mm: how far from the rear vertex plane a copy shows x and y.
SCREEN = 20.0


def bundled() -> None:
    """Puts on the path what the program Blender has there by itself."""
    home = next(parent for parent in Path(bpy.__file__).resolve().parents if parent.name[0].isdigit())
    sys.path += [str(home / "python/lib/python3.11/site-packages"), str(home / "scripts/addons_core")]


def scene():
    """An empty scene whose world shows directions; its camera's data."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.view_settings.view_transform = "Raw"
    scene.world = bpy.data.worlds.new("directions")
    if bpy.app.version < (5, 0):
        scene.world.use_nodes = True
    tree = scene.world.node_tree
    tree.nodes.clear()
    nodes = [tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "Background", "OutputWorld")]
    tree.links.new(nodes[0].outputs["Generated"], nodes[1].inputs["Color"])
    tree.links.new(nodes[1].outputs[0], nodes[2].inputs[0])
    camera = bpy.data.cameras.new("camera")
    holder = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(holder)
    scene.camera = holder
    return scene, camera


def directions(shader: str, sample: tuple[float, float], folder: Path) -> np.ndarray:
    """What the camera of a shader's text shows, in its own space; 0 where there is no ray."""
    import OpenImageIO
    from cycles.osl import update_custom_camera_shader

    picture, camera = scene()
    file, out = folder / "shader.osl", folder / "picture.exr"
    file.write_text(shader)
    camera.type, camera.custom_mode, camera.custom_filepath = "CUSTOM", "EXTERNAL", str(file)
    told: list[object] = []
    assert update_custom_camera_shader(camera, lambda kind, text: told.append(text)), told
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 2.0, 1.0
    camera.cycles_custom["lens_u"], camera.cycles_custom["lens_v"] = sample
    camera.clip_start = 1e-6
    picture.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)
    image = OpenImageIO.ImageInput.open(str(out))
    read = np.asarray(image.read_image("float"), float)[..., :3].reshape(-1, 3)
    image.close()
    return read * [1, 1, -1]


def compare(program: str, lens: str, folder: Path) -> None:
    """Prints how far Blender's rays are off; fails where that is too far."""
    text = subprocess.run([program, "blender", lens, "--out", "-"], capture_output=True, text=True, check=True).stdout
    text = text.replace("camera_shader_random_sample()", "point(lens_u, lens_v, 0)")
    text = text.replace("float fnumber = 0", "float lens_u = 0.5, float lens_v = 0.5, float fnumber = 0")
    text = text.replace("throughput = color(weight)", "throughput = 1")
    before = text[: text.rindex("  if (!trace(")]

    def shows(vector: str) -> str:
        return f"{before}  direction = normalize({vector});\n  throughput = 1;\n}}\n"

    facts = json.loads(
        subprocess.run([program, "lens", lens, "--json"], capture_output=True, text=True, check=True).stdout
    )
    rear = facts["rear_focal_point_z_mm"] + facts["back_focal_distance_mm"]
    errors, differ, count = [], 0, 0
    for sample in LENS_SAMPLES:
        found = directions(text, sample, folder)
        heading = directions(shows("vector(vx, vy, vz)"), sample, folder)
        start = directions(shows(f"vector(x, y, {SCREEN})"), sample, folder)
        asked = np.linalg.norm(heading, axis=1) > 0.5
        found, heading, start = found[asked], heading[asked], start[asked]
        slopes = heading / heading[:, 2:]
        x, y = (start[:, :2] / start[:, 2:] * SCREEN).T
        origin = np.stack([x, y, np.full_like(x, rear)], 1) - SCREEN * slopes
        lines = "\n".join(",".join(map(repr, map(float, [*o, *d]))) for o, d in zip(origin, heading))
        traced = subprocess.run(
            [program, "trace", lens, "--method", "f64"], input=lines, capture_output=True, text=True, check=True
        ).stdout
        rows = [line.split(",") for line in traced.split()]
        passes = np.array([row[6] == "ok" for row in rows])
        exact = np.array([row[3:6] for row in rows], float)
        passed = np.linalg.norm(found, axis=1) > 0.5
        errors.append(np.linalg.norm(found - exact, axis=1)[passes & passed])
        differ += int((passes != passed).sum())
        count += len(rows)
    error = np.concatenate(errors)
    print(
        f"{lens}: {count} rays, {differ} fates differ, directions off by {np.median(error):.1e} (median), "
        f"{error.max():.1e} (most) radians",
        flush=True,
    )
    assert differ <= 2 and error.max() < 1e-5 and len(error) > 0.9 * count, lens


def extension(zip_file: str) -> None:
    """Installs the extension and uses its buttons."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.extensions.package_install_files(filepath=zip_file, repo="user_default", enable_on_install=True)
    picture, camera = scene()
    bpy.ops.preferences.addon_enable(module="bl_ext.user_default.realistic")
    camera.realistic.lens = "wide.22mm"
    assert bpy.ops.realistic.set_up() == {"FINISHED"}
    assert camera.type == "CUSTOM" and camera.dof.use_dof and abs(camera.lens - 22.0) < 0.1
    assert bpy.ops.realistic.pull_focus() == {"FINISHED"}
    picture.frame_set(picture.frame_end)
    assert abs(camera.dof.focus_distance - 1.0) < 1e-6
    bpy.ops.render.render()
    print("the extension: installed, a camera set up by its button and rendered", flush=True)


def main(arguments: list[str]) -> None:
    """Runs everything."""
    zip_file, program, *lenses = arguments
    bundled()
    extension(zip_file)
    with tempfile.TemporaryDirectory() as folder:
        for lens in lenses or ("dgauss.50mm", "tessar.50mm"):
            compare(program, lens, Path(folder))


if __name__ == "__main__":
    main(sys.argv[1:])
