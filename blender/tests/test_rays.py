"""Compares rays of the shaders in Blender with the same rays in double precision."""

from __future__ import annotations

import subprocess

import bpy
import numpy as np
import pytest
from stage import SHADERS, empty, picture, show_directions, use_shader

import realistic

SIZE = (64, 48)
# f-number, focus distance in m; f/0.5 opens every lens fully.
SETTINGS = ((0.5, 3.0), (8.0, 20.0))


def instrumented(text: str, screen: float) -> str:
    """Returns the shader, changed so that each pixel of a third of the picture has one film point and one lens sample,
    which are the same in all thirds.

    The left third shows each ray's direction in the scene; the middle third its direction on the film's side. The right
    third shows its start (x, y) on the plane of the last vertex, as the direction to it from a point `screen` mm
    behind.
    """
    width, height = SIZE
    pixel = f"""point raster = camera_shader_raster_position();
  int column = int(floor(raster[0]*{3 * width}));
  int shown = column/{width};
  raster = point((column - shown*{width} + 0.5)/{width}, (floor(raster[1]*{height}) + 0.5)/{height}, 0);"""
    for old, new in (
        ("point raster = camera_shader_raster_position();", pixel),
        ("camera_shader_random_sample()", f"cellnoise(point(raster[0]*{width}, raster[1]*{height}, 0))"),
        ("throughput = color(weight)", "throughput = 1"),
    ):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    before, trace, after = text.rpartition("  if (!trace(")
    direction = f"normalize(shown == 1 ? vector(vx, vy, vz) : vector(x, y, {screen}))"
    return f"{before}  if (shown > 0) {{\n    direction = {direction};\n    throughput = 1;\n    return;\n  }}\n{trace}{after}"


@pytest.mark.parametrize("name", SHADERS)
def test_rays_are_those_of_double_precision(lenses, program, name, tmp_path):
    text, facts = lenses[name]
    if facts["focuses_by_groups"]:
        # `cargo test` compares the groups' positions at every focus; here they stay at the file's first positions.
        still = ["--focus-by", "film", *(["--zoom", "wide"] if facts["could_zoom"] else [])]
        text = subprocess.run(
            [program, "blender", name, *still, "--out", "-"], stdout=subprocess.PIPE, check=True
        ).stdout.decode()
    scene, camera = empty((3 * SIZE[0], SIZE[1]), 1)
    show_directions(scene)
    rear = realistic.Lens(name).surfaces[-1]
    screen = rear.semi_diameter_mm
    shader = tmp_path / "shader.osl"
    shader.write_text(instrumented(text, screen))
    use_shader(camera, shader)
    # The sensor is four times as wide as high; its corners reach the film's edge.
    camera.sensor_width = 1.93 * facts["film_reach_mm"]
    camera.dof.use_dof = True
    if bpy.app.version < (5, 0):
        camera.cycles_custom["focal_length"] = camera.lens
    errors, differ, count = [], 0, 0
    for fnumber, distance in SETTINGS:
        camera.dof.aperture_fstop, camera.dof.focus_distance = fnumber, distance
        # Blender looks along -z.
        thirds = np.split(picture(scene, tmp_path), 3, axis=1)
        found, heading, start = (third.reshape(-1, 3) * [1, 1, -1] for third in thirds)
        is_sampled = np.linalg.norm(heading, axis=1) > 0.5
        found, heading, start = found[is_sampled], heading[is_sampled], start[is_sampled]
        x, y = (start[:, :2] / start[:, 2:] * screen).T
        origin = np.stack([x, y, np.full_like(x, rear.vertex_mm)], 1) - 2 * screen * heading / heading[:, 2:]
        lens = realistic.Lens(name, fnumber=fnumber) if fnumber > facts["fnumber"] else realistic.Lens(name)
        exact = lens.trace(origin, heading, side="film")
        passed = np.linalg.norm(found, axis=1) > 0.5
        errors.append(np.linalg.norm(found - exact.direction, axis=1)[exact.passed & passed])
        differ += int((exact.passed != passed).sum())
        count += len(found)
    error = np.concatenate(errors)
    print(
        f"{name}: {count} rays, {len(error)} get through, {differ} fates differ, directions off by {np.median(error):.1e} (median), "
        f"{error.max():.1e} (most) radians",
        flush=True,
    )
    assert count > 0.9 * len(SETTINGS) * SIZE[0] * SIZE[1]
    assert len(error) > (0.95 if realistic.Lens(name).is_round else 0.84) * count
    assert differ <= 2 and np.median(error) < 2e-6 and error.max() < 1e-5
