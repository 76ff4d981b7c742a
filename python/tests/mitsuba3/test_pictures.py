"""Pictures: framing, uniform light, and agreement with the command-line program's picture."""

import framing
import numpy as np
import pytest

import realistic


def box_film(width, height, **crop):
    return {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, **crop}


def rendered(mi, shapes, sensor, spp, seed=1, depth=2):
    scene = mi.load_dict({"type": "scene", "integrator": {"type": "path", "max_depth": depth}, "s": sensor, **shapes})
    return np.array(mi.render(scene, spp=spp, seed=seed), np.float64)[..., :3]


def in_focus(camera, image_xy):
    """Returns points of the plane in focus, in camera space, that intrinsics project to film points (n, 2)."""
    found = realistic.measure.intrinsics(camera)
    (fx, _, cx), (_, fy, cy), _ = found.matrix
    k1, k2, p1, p2, k3 = found.distortion
    distorted = (np.asarray(image_xy) - 0.5 - [cx, cy]) / [fx, fy]
    xy = distorted.copy()
    for _ in range(50):
        x, y = xy.T
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        turned = np.stack([2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y], axis=-1)
        xy = (distorted - turned) / radial[:, None]
    z = found.position[2] + found.distance
    return np.column_stack([xy * [1, -1] * found.distance, np.full(len(xy), z)])


@pytest.mark.parametrize("lens", ["wide.22mm", "dgauss.50mm"])
def test_lights_are_where_the_intrinsics_have_them(fast, lens):
    """Renders spheres in the plane in focus, each in a crop window of its own."""
    mi = fast
    size = (360, 240)
    camera = realistic.Camera(lens, resolution=size, focus_distance=1000.0, fnumber=11)
    image_xy = np.array([[180.0, 120.0], [300.3, 40.2], [40.6, 30.1], [60.0, 200.5], [330.2, 210.7]])
    points = in_focus(camera, image_xy)
    pose = mi.ScalarTransform4f().look_at(origin=[10, 20, 30], target=[300, 100, 500], up=[0, 1, 0])
    pixel = np.linalg.norm(in_focus(camera, [[181.0, 120.0]]) - points[:1])
    for (x, y), point in zip(image_xy, points):
        # Camera space has +x to the right, Mitsuba's to the left.
        centre = pose @ mi.ScalarPoint3f(*(point * [-1, 1, 1]).tolist())
        light = {"type": "sphere", "center": centre, "radius": 2 * pixel, "e": {"type": "area", "radiance": 1.0}}
        left, top = int(x) - 10, int(y) - 10
        crop = {"crop_offset_x": left, "crop_offset_y": top, "crop_width": 20, "crop_height": 20}
        sensor = {"type": "realistic", "lens_file": lens, "focus_distance": 1000.0, "fnumber": 11, "to_world": pose}
        picture = rendered(mi, {"light": light}, {**sensor, "film": box_film(*size, **crop)}, 2048)[..., 0]
        rows, columns = np.indices(picture.shape)
        total = picture.sum()
        centre = np.array([left + 0.5 + (columns * picture).sum() / total, top + 0.5 + (rows * picture).sum() / total])
        assert np.abs(centre - [x, y]).max() < 0.05


def test_an_even_light_shows_the_illumination(fast):
    """Each pixel equals the mean of the camera's weights, within its standard error; blocked rays count as dark."""
    mi = fast
    size, spp = (36, 24), 1024
    parameters = {"lens_file": "wide.22mm", "pupil": "rear"}
    camera = realistic.Camera(resolution=size, weighting="relative", **parameters)
    uv = np.random.default_rng(5).random((4096, 4), np.float32)
    corners = np.stack(np.meshgrid(np.arange(size[0]), np.arange(size[1])), axis=-1)
    weight = camera.rays(corners[:, :, None] + uv[:, :2], uv[:, 2:]).weight.astype(np.float64)
    mean, spread = weight.mean(axis=2), weight.std(axis=2)
    assert (weight == 0).mean() > 0.5 and mean.min() < 0.6 and abs(mean[12, 18] - 1) < 0.05
    sensor = {"type": "realistic", **parameters, "film": box_film(*size)}
    picture = rendered(mi, {"light": {"type": "constant"}}, sensor, spp)
    off = (picture[..., 0] - mean) / (spread * np.sqrt(1 / spp + 1 / weight.shape[2]))
    assert np.abs(off).max() < 5
    # All pixels of the expected picture share the same lens samples, so it may be off as a whole by some standard
    # errors.
    assert np.abs(off - off.mean()).std() < 1.1


def test_the_card_has_the_framing_of_the_programs_picture(fast, checkout, tmp_path):
    """Compares the edges of the test card, which stands left of the middle (cli/src/host/scene/props.rs)."""
    mi = fast
    command = framing.program(checkout)
    if command is None:
        pytest.skip("the program is not built: name it in REALISTIC_PROGRAM, or run cargo build --release")
    parameters = {"focus_distance": 1090.0, "fnumber": 8}
    out = tmp_path / "card.exr"
    framing.by_program(command, out, 32, parameters)
    program = np.array(mi.Bitmap(str(out)), np.float64)[..., :3].sum(axis=2)

    width, height = 196.0, 196 * 66 / 80
    middle = [270 - width / 2, 10 - height / 2, 1000]
    pose = mi.ScalarTransform4f().translate(middle).rotate([0, 1, 0], 180).scale([width / 2, height / 2, 1])
    card = {"type": "rectangle", "to_world": pose, "light": {"type": "area", "radiance": 1.0}}
    sensor = {"type": "realistic", "lens_file": "dgauss.50mm", **parameters, "film": box_film(*framing.SIZE)}
    by_mitsuba = rendered(mi, {"card": card}, sensor, 64).sum(axis=2)
    seen = [framing.edges(program), framing.edges(by_mitsuba)]
    assert np.abs(seen[0] - seen[1]).max() < 0.1, seen


def test_defocused_lamps_are_the_disks_of_the_programs_picture(fast, checkout, tmp_path):
    """Compares the nearer string of lamps, seven metres away, with the lens wide open and focused on the card."""
    mi = fast
    command = framing.program(checkout)
    if command is None:
        pytest.skip("the program is not built: name it in REALISTIC_PROGRAM, or run cargo build --release")
    out = tmp_path / "lamps.exr"
    framing.by_program(command, out, 32, {"focus_distance": 1071.0})
    program = np.array(mi.Bitmap(str(out)), np.float64)[..., :3].sum(axis=2)
    # As in cli/src/host/scene/props.rs; colours do not matter.
    lamps = {}
    for index in range(-4, 5):
        x = (index + 0.25) * 410.0
        across = ((x / 5200.0 + 0.5) % 1.0) * 2 - 1
        glow = {"type": "area", "radiance": 10.0}
        centre = [-x, 570.0 + 1250.0 * across * across, 7000.0]
        lamps[f"lamp_{index + 4}"] = {"type": "sphere", "center": centre, "radius": 23.0, "light": glow}
    sensor = {
        "type": "realistic",
        "lens_file": "dgauss.50mm",
        "focus_distance": 1071.0,
        "film": box_film(*framing.SIZE),
    }
    seen = framing.bokeh(program), framing.bokeh(rendered(mi, lamps, sensor, 128).sum(axis=2))
    print(seen)
    assert np.abs(seen[0][:, :2] - seen[1][:, :2]).max() < 0.6
    assert np.abs((seen[0] - seen[1])[:, :2].mean(axis=0)).max() < 0.2
    assert abs(seen[0][:, 2].mean() / seen[1][:, 2].mean() - 1) < 0.015
