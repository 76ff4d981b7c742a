"""Scenes for tests in the real Blender, and readers of its pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

import realistic

if TYPE_CHECKING:
    from pathlib import Path


# Lenses with mirrors have no shader.
SHADERS = tuple(
    name for name in realistic.catalogue() if not any(surface.is_mirror for surface in realistic.Lens(name).surfaces)
)


def empty(size: tuple[int, int], samples: int) -> tuple[Any, Any]:
    """Makes a scene with only a camera at the origin that looks along -z; returns it and the camera's data."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.view_settings.view_transform = "Raw"
    scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0):
        scene.world.use_nodes = True
    scene.world.node_tree.nodes.clear()
    # Without light sampling, Blender builds no importance map of the world.
    scene.world.cycles.sampling_method = "NONE"
    camera = bpy.data.cameras.new("camera")
    holder = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(holder)
    scene.camera = holder
    camera.clip_start = 1e-6
    return scene, camera


def show_directions(scene: Any) -> None:
    """Makes each ray's direction the colour that it sees in the world; all samples of a pixel share one film point."""
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    tree = scene.world.node_tree
    coordinates, light, world = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "Background", "OutputWorld")
    )
    tree.links.new(coordinates.outputs["Generated"], light.inputs["Color"])
    tree.links.new(light.outputs[0], world.inputs[0])


def use_shader(camera: Any, file: Path) -> None:
    """Sets a camera's shader from a file."""
    from cycles.osl import update_custom_camera_shader

    camera.type, camera.custom_mode, camera.custom_filepath = "CUSTOM", "EXTERNAL", str(file)
    messages: list[object] = []
    assert update_custom_camera_shader(camera, lambda kind, text: messages.append((kind, text))), messages


def picture(scene: Any, folder: Path) -> np.ndarray:
    """Renders a picture, (height, width, 3) of float64, top row first."""
    file = folder / "picture.exr"
    scene.render.filepath = str(file)
    bpy.ops.render.render(write_still=True)
    return read(file)


def read(file: Path) -> np.ndarray:
    """Reads a picture's file, (height, width, 3) of float64, top row first."""
    import OpenImageIO

    image = OpenImageIO.ImageInput.open(str(file))
    found = np.array(image.read_image("float"), np.float64)[..., :3]
    image.close()
    return found
