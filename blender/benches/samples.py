"""Time per camera sample in Blender, for lens shaders and for Blender's own cameras.

$ python benches/samples.py SHADER.osl …

Run it with a Python that has bpy. It renders a uniform world on one thread and measures process CPU time. Subtracting
the time with few samples from that with many removes the fixed cost of a picture. All cameras run in turn; results are
medians over rounds.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import conftest
import stage

SIZE, LOW, HIGH, ROUNDS = (240, 160), 16, 112, 9
TEMPLATE = "advanced_camera.osl"


def seconds(kind: str, samples: int, folder: Path) -> float:
    """Returns the process CPU time of one picture."""
    scene, camera = stage.empty(SIZE, samples)
    nodes = scene.world.node_tree.nodes
    light, world = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
    scene.world.node_tree.links.new(light.outputs[0], world.inputs[0])
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = kind != "perspective", 2.0, 0.5
    if kind.endswith(".osl"):
        stage.use_shader(camera, Path(kind))
    if kind.endswith(TEMPLATE):
        camera.cycles_custom["do_dof"] = 1
    begin = time.process_time()
    stage.picture(scene, folder)
    return time.process_time() - begin


def main(shaders: list[str]) -> None:
    template = conftest.HOME / "scripts/templates_osl" / TEMPLATE
    kinds = [*shaders, str(template), "thin lens", "perspective"]
    taken: dict[str, list[float]] = {kind: [] for kind in kinds}
    with tempfile.TemporaryDirectory() as room:
        for _ in range(ROUNDS):
            for kind in kinds:
                both = [seconds(kind, samples, Path(room)) for samples in (LOW, HIGH)]
                taken[kind].append(1e9 * (both[1] - both[0]) / (HIGH - LOW) / SIZE[0] / SIZE[1])
    print(f"Blender {'.'.join(map(str, stage.bpy.app.version))}; the template is {TEMPLATE} with depth of field")
    print("| camera | ns per sample | times the template's |\n|---|---|---|")
    for kind, times in taken.items():
        ratio = statistics.median(a / b for a, b in zip(times, taken[str(template)]))
        print(f"| {Path(kind).name} | {statistics.median(times):.0f} | {ratio:.2f} |")


if __name__ == "__main__":
    main(sys.argv[1:])
