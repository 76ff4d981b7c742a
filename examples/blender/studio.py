"""The program's test scene in Blender: a card in focus, balls in front of and behind it, and lamps far behind.

$ python studio.py SHADER.osl studio.png

runs with a Python that has Blender's module (`pip install bpy`, Python 3.11), or in Blender itself:
`blender --background --python studio.py -- SHADER.osl studio.png`. `realistic blender dgauss.50mm` writes the shader.
The picture has the framing and the blur of `realistic render --scene day --lens dgauss.50mm`; materials are Blender's
own and look a little different. The scene is in millimetres with +z forward; in Blender it is in metres, and the
camera looks along -z.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import bpy

FLOOR = -155.0
# Width of a 3:2 film with a diagonal of 35 mm; and distance of the card from the front vertex; both in mm.
FILM_WIDTH, DISTANCE = 29.12, 1000.0
CORAL, TEAL, AMBER = (0.66, 0.11, 0.07), (0.02, 0.33, 0.35), (0.76, 0.39, 0.05)
PLUM, CREAM, LEAF = (0.30, 0.08, 0.34), (0.76, 0.70, 0.60), (0.15, 0.36, 0.08)
GOLD, CHROME, CLEAR = (0.95, 0.68, 0.28), (0.86, 0.87, 0.90), (1.0, 1.0, 1.0)
# x, z, radius, colour, material.
BALLS = [
    (50, 990, 46, CLEAR, "glass"),
    (190, 1015, 64, CHROME, "metal"),
    (136, 490, 45, CORAL, "coated"),
    (-320, 620, 70, AMBER, "coated"),
    (430, 690, 92, TEAL, "coated"),
    (-170, 1800, 74, GOLD, "metal"),
    (390, 1640, 100, TEAL, "coated"),
    (-820, 1600, 190, CORAL, "coated"),
    (500, 3000, 150, AMBER, "coated"),
    (1300, 2100, 260, CREAM, "coated"),
    (-800, 4200, 240, PLUM, "coated"),
    (1500, 5600, 330, CORAL, "coated"),
    (-2300, 9500, 520, TEAL, "coated"),
    (950, 10000, 280, CREAM, "coated"),
    (-2600, 3000, 480, LEAF, "coated"),
]
PAPER, INK, RED, GREEN = (0.88, 0.85, 0.75), (0.019, 0.028, 0.091), (0.617, 0.03, 0.019), (0.01, 0.258, 0.141)
CARD, CARD_WIDTH = (-270.0, 10.0, 1000.0), 196.0


def at(x: float, y: float, z: float) -> tuple[float, float, float]:
    return (x / 1000, y / 1000, -z / 1000)


def with_nodes(made: Any) -> Any:
    """Clears the nodes of a material or a world, and returns its node tree."""
    if bpy.app.version < (5, 0):
        made.use_nodes = True
    made.node_tree.nodes.clear()
    return made.node_tree


def material(name: str, **inputs: Any) -> Any:
    """Makes a material with Blender's Principled BSDF."""
    made = bpy.data.materials.new(name)
    tree = with_nodes(made)
    surface, out = tree.nodes.new("ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(surface.outputs[0], out.inputs[0])
    for key, value in inputs.items():
        socket = surface.inputs[key.replace("_", " ")]
        socket.default_value = (*value, 1.0) if isinstance(value, tuple) else value
    return made


def light(name: str, colour: tuple[float, float, float]) -> Any:
    """Makes an emissive material of this colour and strength, without light sampling."""
    made = bpy.data.materials.new(name)
    tree = with_nodes(made)
    glow, out = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(glow.outputs[0], out.inputs[0])
    glow.inputs["Color"].default_value = (*colour, 1.0)
    made.cycles.emission_sampling = "NONE"
    return made


def shape(name: str, corners: list[tuple[float, float, float]], of: Any) -> Any:
    """Makes a polygon from corners in the scene's millimetres."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([at(*corner) for corner in corners], [], [list(range(len(corners)))])
    mesh.materials.append(of)
    return put(name, mesh)


def board(name: str, corner: tuple[float, float, float], width: float, height: float, of: Any) -> Any:
    """Makes an upright board, given its top left corner."""
    x, y, z = corner
    return shape(name, [(x, y - height, z), (x + width, y - height, z), (x + width, y, z), (x, y, z)], of)


def put(name: str, data: Any) -> Any:
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def ball(name: str, centre: tuple[float, float, float], radius: float, of: Any) -> None:
    """Makes a ball; all balls share one mesh, scaled."""
    mesh = bpy.data.meshes.get("ball")
    if mesh is None:
        bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=1.0)
        first = bpy.context.object
        mesh = first.data
        mesh.name = "ball"
        mesh.shade_smooth()
        mesh.materials.append(None)
        bpy.data.objects.remove(first)
    made = put(name, mesh)
    made.location, made.scale = at(*centre), (radius / 1000,) * 3
    made.material_slots[0].link = "OBJECT"
    made.material_slots[0].material = of


def card() -> None:
    """Makes the card, 80 by 66 units, and the print on it."""
    unit = CARD_WIDTH / 80
    paper, ink, red, green = (material(name, Base_Color=colour, Roughness=1.0, Specular_IOR_Level=0.0) for name, colour in
                              (("paper", PAPER), ("ink", INK), ("red", RED), ("green", GREEN)))  # fmt: skip
    board("card", CARD, CARD_WIDTH, 66 * unit, paper)

    def on_card(u: float, v: float) -> tuple[float, float, float]:
        return CARD[0] + u * unit, CARD[1] - v * unit, CARD[2] - 0.2

    def printed(name: str, corners: list[tuple[float, float]], of: Any) -> None:
        # The corners are reversed, because v increases downward.
        shape(name, [on_card(u, v) for u, v in reversed(corners)], of)

    for u0, v0, u1, v1 in ((2, 2, 78, 3), (2, 63, 78, 64), (2, 2, 3, 64), (77, 2, 78, 64), (6, 16.5, 74, 17.5)):
        printed("line", [(u0, v0), (u1, v0), (u1, v1), (u0, v1)], ink)
    arrow = [(0, 0), (7.2, 9), (2.5, 9), (2.5, 30), (-2.5, 30), (-2.5, 9), (-7.2, 9)]
    printed("up", [(14 + u, 21 + v) for u, v in arrow], red)
    printed("right", [(53 - v, 37 + u) for u, v in arrow], green)
    from math import cos, pi, sin

    for ray in range(16):
        turn = [2 * pi * (ray + half) / 16 for half in (0.0, 0.5)]
        printed("star", [(66, 37), *((66 + 10 * cos(a), 37 + 10 * sin(a)) for a in turn)], ink)
    for words, u, v, size, of in (
        ("realistic", 40, 14, 14.5, ink),
        ("UP", 14, 62, 11, red),
        ("RIGHT", 53, 62, 11, green),
    ):
        text = bpy.data.curves.new(words, "FONT")
        text.body, text.size, text.align_x = words, size * unit / 1000, "CENTER"
        text.materials.append(of)
        put(words, text).location = at(*on_card(u, v))


def lamps(strings: int = 2) -> None:
    """Makes strings of lamps that hang in spans, the nearer one first."""
    glows = [
        light(f"lamp {k}", colour) for k, colour in enumerate(((13.0, 7.4, 2.6), (13.0, 4.2, 1.5), (11.0, 8.8, 5.0)))
    ]
    span = 5200.0
    both = ((7000.0, 23.0, 410.0, 570.0, 1820.0), (12000.0, 38.0, 640.0, 620.0, 1500.0))
    for z, radius, pitch, low, high in both[:strings]:
        half = int(3 * span / pitch) // 2
        for index in range(-half, half + 1):
            x = (index + 0.25) * pitch
            across = ((x / span + 0.5) % 1.0) * 2 - 1
            ball("lamp", (x, low + (high - low) * across * across, z), radius, glows[index % 3])


def sky(world: Any) -> None:
    """Makes a dusk sky, with colours at the horizon, at one elevation above it and at the zenith, by the sine of the
    elevation."""
    tree = with_nodes(world)
    place, split = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(place.outputs["Generated"], split.inputs[0])

    def calculated(operation: str, a: Any, b: Any, clamp: bool = False) -> Any:
        node = tree.nodes.new("ShaderNodeMath")
        node.operation, node.use_clamp = operation, clamp
        for socket, value in zip(node.inputs, (a, b)):
            if isinstance(value, float):
                socket.default_value = value
            else:
                tree.links.new(value, socket)
        return node.outputs[0]

    def mixed(share: Any, low: Any, high: tuple[float, float, float]) -> Any:
        node = tree.nodes.new("ShaderNodeMix")
        node.data_type = "RGBA"
        tree.links.new(share, node.inputs[0])
        if isinstance(low, tuple):
            node.inputs[6].default_value = (*low, 1.0)
        else:
            tree.links.new(low, node.inputs[6])
        node.inputs[7].default_value = (*high, 1.0)
        return node.outputs[2]

    height = calculated("MAXIMUM", split.outputs[1], 0.0)
    # The power is e to the -6.5 h.
    falling = calculated("POWER", 0.0015034391929775724, height)
    low = mixed(calculated("SUBTRACT", 1.0, falling), (0.93, 0.42, 0.23), (0.09, 0.14, 0.38))
    colour = mixed(calculated("MULTIPLY", height, 1.6, clamp=True), low, (0.06, 0.10, 0.26))
    back, out = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(colour, back.inputs[0])
    tree.links.new(back.outputs[0], out.inputs[0])


def floor() -> None:
    """Makes a floor of polished tiles that are 155 mm wide."""
    tiles = material("tiles", Roughness=0.2)
    tree = tiles.node_tree
    place, scale = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeVectorMath")
    scale.operation = "MULTIPLY"
    # Height is ignored: the floor lies exactly on the boundary of two layers of the 3D checker.
    scale.inputs[1].default_value = (1000 / 155, 0.0, -1000 / 155)
    squares = tree.nodes.new("ShaderNodeTexChecker")
    squares.inputs["Color1"].default_value = (0.60, 0.55, 0.46, 1.0)
    squares.inputs["Color2"].default_value = (0.08, 0.13, 0.18, 1.0)
    squares.inputs["Scale"].default_value = 1.0
    tree.links.new(place.outputs["Position"], scale.inputs[0])
    tree.links.new(scale.outputs[0], squares.inputs["Vector"])
    tree.links.new(squares.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    wide = 40000.0
    shape("floor", [(-wide, FLOOR, -wide), (-wide, FLOOR, wide), (wide, FLOOR, wide), (wide, FLOOR, -wide)], tiles)


def things() -> None:
    """Makes everything except the card and the lamps."""
    floor()
    wood = material("wood", Base_Color=(0.11, 0.09, 0.08), Roughness=1.0)
    for part in (0.15, 0.85):
        x = CARD[0] + part * CARD_WIDTH
        board("leg", (x - CARD_WIDTH / 60, CARD[1] - 1, 1001.0), CARD_WIDTH / 30, CARD[1] - 1 - FLOOR, wood)
    for k in (-3, -1, 1, 3):
        board("pole", (2600.0 * k - 17, FLOOR + 1980, 7010.0), 34.0, 1980.0, wood)
    kinds: dict[str, dict[str, Any]] = {
        "glass": {"Transmission_Weight": 1.0, "IOR": 1.5, "Roughness": 0.0},
        "metal": {"Metallic": 1.0, "Roughness": 0.25},
        "coated": {"Roughness": 0.05, "IOR": 1.5},
    }
    for x, z, radius, colour, kind in BALLS:
        of = material(kind, Base_Color=colour, **kinds[kind])
        ball(kind, (x, FLOOR + radius, z), radius, of)
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.color, sun.angle = 1.0, (3.3, 2.6, 1.9), 0.07
    holder = put("sun", sun)
    from mathutils import Vector

    # A sun shines along its -z.
    holder.rotation_euler = Vector(at(0.55, -0.52, 0.75)).to_track_quat("-Z", "Y").to_euler()


def camera(shader: str, fnumber: float) -> Any:
    """Makes a camera at the origin with a lens's shader, focused on the card."""
    from cycles.osl import update_custom_camera_shader

    made = bpy.data.cameras.new("camera")
    made.sensor_fit, made.sensor_width = "HORIZONTAL", FILM_WIDTH
    made.type, made.custom_mode, made.custom_filepath = "CUSTOM", "EXTERNAL", shader
    if not update_custom_camera_shader(made, lambda _, text: print(text)):
        raise SystemExit(f"{shader} cannot be used")
    if bpy.app.version < (5, 0):
        made.cycles_custom["focal_length"] = made.lens
    made.dof.use_dof, made.dof.focus_distance, made.dof.aperture_fstop = True, DISTANCE / 1000, fnumber
    made.clip_start = 1e-6
    bpy.context.scene.camera = put("camera", made)
    return made


def new(size: tuple[int, int], samples: int) -> Any:
    """Makes an empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    made = bpy.context.scene
    made.render.engine = "CYCLES"
    made.render.resolution_x, made.render.resolution_y = size
    made.cycles.samples = samples
    made.cycles.use_adaptive_sampling = made.cycles.use_denoising = False
    made.cycles.pixel_filter_type, made.cycles.filter_width = "BOX", 1.0
    made.view_settings.view_transform = "Standard"
    made.world = bpy.data.worlds.new("sky")
    return made


def main(shader: str, out: str, width: int = 480, height: int = 320, samples: int = 256) -> None:
    # Blender as a module, unlike the program, does not have its own packages on the path.
    home = next((parent for parent in Path(bpy.__file__).resolve().parents if parent.name[0].isdigit()), None)
    if home is not None:
        sys.path += [str(home / "python/lib/python3.11/site-packages"), str(home / "scripts/addons_core")]
    scene = new((width, height), samples)
    camera(shader, 0.5)
    sky(scene.world)
    things()
    card()
    lamps()
    scene.render.filepath = str(Path(out).resolve())
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    if len(given) != 2:
        print(
            "usage: python studio.py SHADER.osl PICTURE.png, as in: python studio.py lens.osl studio.png",
            file=sys.stderr,
        )
        sys.exit(2)
    main(*given)
