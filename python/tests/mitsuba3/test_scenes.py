"""Scenes in XML and as dictionaries, and the messages for their errors."""

import numpy as np
import pytest

import realistic

XML = """<scene version="3.0.0">
    <sensor type="realistic">
        <string name="lens_file" value="{lens}"/>
        <float name="focus_distance" value="0.9"/>
        <float name="mm_per_unit" value="1000"/>
        <integer name="fnumber" value="4"/>
        <boolean name="differentials" value="false"/>
        <float name="shutter_close" value="0.5"/>
        <transform name="to_world"><lookat origin="1, 2, 3" target="1, 2, 9" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="60"/><integer name="height" value="40"/></film>
        <sampler type="stratified"><integer name="sample_count" value="9"/></sampler>
    </sensor>
</scene>"""


def test_xml_and_a_dictionary_mean_the_same(mi):
    by_xml = mi.load_string(XML.format(lens="wide.22mm")).sensors()[0]
    by_dict = mi.load_dict(
        {
            "type": "realistic",
            "lens_file": "wide.22mm",
            "focus_distance": 0.9,
            "mm_per_unit": 1000.0,
            "fnumber": 4,
            "differentials": False,
            "shutter_close": 0.5,
            "to_world": mi.ScalarTransform4f().look_at(origin=[1, 2, 3], target=[1, 2, 9], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": 60, "height": 40},
            "sampler": {"type": "stratified", "sample_count": 9},
        }
    )
    expected = {"lens_file": "wide.22mm", "focus_distance": 0.9, "mm_per_unit": 1000.0, "fnumber": 4}
    for sensor in (by_xml, by_dict):
        assert sensor.camera.parameters == {**expected, "weighting": "relative"}
        assert sensor.camera.resolution == (60, 40)
        assert sensor.shutter_open_time() == 0.5
        assert sensor.sampler().sample_count() == 9
        assert "wide.22mm" in str(sensor) and "to_world" in str(sensor)
        np.testing.assert_allclose(np.ravel(sensor.bbox().min), [1, 2, 3], rtol=1e-6)


def test_a_lens_file_lies_beside_the_scene(mi, checkout, tmp_path):
    file = checkout / "crates/optics/lenses/wide.22mm.dat"
    (tmp_path / "own.dat").write_bytes(file.read_bytes())
    (tmp_path / "scene.xml").write_text(XML.format(lens="own.dat").replace('"0.9"', '"9"'))
    sensor = mi.load_file(str(tmp_path / "scene.xml")).sensors()[0]
    assert sensor.camera.focal_length_mm == realistic.Lens(file).focal_length_mm


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ({"fnunber": 3.0}, 'there is no property "fnunber"; did you mean "fnumber"?'),
        ({"focus_distanse": 3.0}, 'did you mean "focus_distance"?'),
        ({"shutteropen": 0.0}, 'did you mean "shutter_open"?'),
        ({"near_clip": 0.5, "hither": 0.5}, "is given twice"),
        ({"fov": 40.0}, '"fov" is for cameras without a real lens'),
        ({"model": "perspective"}, "Mitsuba's own sensors"),
        ({"type": "thick", "model": "lens"}, '"model" is not one of a sensor "thick"'),
        ({"differentials": 1}, '"differentials" must be true or false'),
        ({"dispersion_tolerance": -1.0}, '"dispersion_tolerance" must be a number of pixels, 0 or more'),
        ({"dispersion_tolerence": 1.0}, 'did you mean "dispersion_tolerance"?'),
        ({"fnumber": "four"}, "fnumber must be a number, not 'four'"),
        ({"fnumber": -4.0}, '"fnumber"'),
        ({"lens_file": "nowhere.dat"}, 'no lens file "nowhere.dat"'),
        ({"focus_distance": 1.0}, "cannot focus at 1 mm from the film"),
        ({"to_world_end": 3.0}, '"to_world_end" must be a transform'),
        ({"focus_distance": 900.0, "film_distance": 40.0}, "film_distance"),
    ],
)
def test_errors_in_a_scene_are_reported(mi, properties, message):
    with pytest.raises(RuntimeError, match="failed to instantiate") as caught:
        mi.load_dict({"type": "realistic", **properties})
    assert message in str(caught.value)


def test_a_pose_that_scales_is_refused(mi):
    with pytest.raises(RuntimeError, match='"to_world" must not scale; the length of a unit is "mm_per_unit"'):
        mi.load_dict({"type": "realistic", "to_world": mi.ScalarTransform4f().scale(2)})


def test_a_line_of_the_scene_is_named(mi):
    text = XML.format(lens="wide.22mm").replace("fnumber", "fnunber")
    with pytest.raises(RuntimeError, match=r"line 2, col 6(.|\n)*did you mean \"fnumber\""):
        mi.load_string(text)


def test_a_zoom_takes_a_number_or_a_name(mi):
    for zoom in (35, 35.0, "35"):
        sensor = mi.load_dict({"type": "realistic", "lens_file": "zoom.24-70mm", "zoom": zoom})
        assert abs(sensor.camera.focal_length_mm - 35) < 1e-6


def test_the_film_and_the_pose_can_be_changed(mi):
    sensor = mi.load_dict({"type": "realistic", "film": {"type": "hdrfilm", "width": 60, "height": 40}})
    parameters = mi.traverse(sensor)
    assert {"to_world", "film.size", "shutter_open", "shutter_open_time"} <= set(parameters.keys())
    parameters["film.size"] = [90, 30]
    parameters["to_world"] = mi.Transform4f().translate([1, 2, 3])
    parameters.update()
    ray, _ = sensor.sample_ray(0.0, 0.5, mi.Point2f(0.5), mi.Point2f(0.5))
    np.testing.assert_allclose(np.ravel(ray.o), [1, 2, 3.001], rtol=1e-6)
    assert sensor.camera.resolution == (90, 30)
    np.testing.assert_allclose(np.ravel(sensor.bbox().min), [1, 2, 3], rtol=1e-6)


def test_the_lens_can_be_changed(mi):
    sensor = mi.load_dict(
        {
            "type": "realistic",
            "lens_file": "zoom.24-70mm",
            "focus_distance": 2.0,
            "mm_per_unit": 1000.0,
            "shutter": "focal-plane",
            "shutter_close": 1.0,
            "film": {"type": "hdrfilm", "width": 60, "height": 40},
        }
    )
    shown = mi.traverse(sensor)
    names = {"focus_distance", "film_distance", "fnumber", "film_diagonal", "zoom", "shutter_slit", "shutter_open_time"}
    assert names <= set(shown.keys()) and "shutter_ramp" not in shown
    assert shown["focus_distance"][0] == pytest.approx(2.0, rel=1e-6)
    assert shown["fnumber"][0] == sensor.camera.fnumber

    shown["focus_distance"], shown["fnumber"], shown["film_diagonal"] = 1.5, 8, 30.0
    shown["zoom"], shown["shutter_slit"] = 50.0, 0.5
    shown.update()
    expected = realistic.Camera(
        "zoom.24-70mm",
        resolution=(60, 40),
        focus_distance=1.5,
        fnumber=8,
        film_diagonal=30.0,
        zoom=50,
        mm_per_unit=1000.0,
        shutter="focal-plane",
        shutter_slit=0.5,
        weighting="relative",
        camera_to_world=np.diag([-1.0, 1.0, 1.0, 1.0]),
    )
    # Assigned values, and values that depend on them, are shown.
    assert shown["film_distance"][0] == pytest.approx(expected.film_distance, rel=1e-9)
    assert shown["zoom"][0] == pytest.approx(50) and shown["fnumber"][0] == pytest.approx(8)
    assert sensor.camera.parameters["shutter_slit"] == 0.5
    ray, weight = sensor.sample_ray(0.5, 0.5, mi.Point2f(0.2, 0.5), mi.Point2f(0.3, 0.6))
    rays = expected.rays([[12.0, 20.0]], [0.3, 0.6], [0.5])
    assert rays.weight[0] > 0
    np.testing.assert_allclose(np.ravel(ray.d), rays.direction[0], atol=1e-6)
    if not mi.is_spectral:
        np.testing.assert_allclose(np.ravel(weight)[0], rays.weight[0], rtol=1e-5)

    # Mitsuba's own numbers and NumPy's can both be assigned.
    for value in (mi.Float(1.25), np.float32(1.25), np.array([1.25]), [1.25]):
        shown["focus_distance"] = 1.5
        shown.update()
        shown["focus_distance"] = value
        shown.update()
        assert sensor.camera.parameters["focus_distance"] == 1.25 and shown["focus_distance"][0] == 1.25

    # An assigned film distance replaces the plane in focus.
    shown["film_distance"] = sensor.camera.film_distance + 1
    shown.update()
    assert "focus_distance" not in sensor.camera.parameters
    assert shown["focus_distance"][0] < 1.5


def test_a_change_that_cannot_be_leaves_the_sensor_as_it_was(mi):
    sensor = mi.load_dict({"type": "realistic", "focus_distance": 900.0})
    camera, shown = sensor.camera, mi.traverse(sensor)
    assert "zoom" not in shown
    for changes, message in (
        ({"focus_distance": 1.0}, "cannot focus at 1 mm"),
        ({"fnumber": -2.0}, "fnumber"),
        ({"focus_distance": 800.0, "film_distance": 40.0}, "film_distance"),
        ({"focus_distance": [800.0, 900.0]}, r'"focus_distance" takes one number, such as .* not 2'),
    ):
        with pytest.raises((realistic.Error, RuntimeError, ValueError), match=message):
            shown.update(changes)
        assert sensor.camera is camera
        assert shown["focus_distance"][0] == pytest.approx(900.0) and shown["fnumber"][0] == camera.fnumber
    shown["focus_distance"] = float("inf")
    shown.update()
    assert sensor.camera.focus_distance_mm == np.inf


def test_a_variant_without_the_sensors_names_the_reason(monkeypatch):
    mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed (pip install mitsuba)")
    mi.set_variant("scalar_rgb")
    import realistic.mitsuba

    for variant in ("cuda_ad_rgb", "llvm_ad_rgb_double"):
        monkeypatch.setattr(realistic.mitsuba.mi, "variant", lambda name=variant: name)
        with pytest.raises(ImportError, match=f"no sensor for Mitsuba's variant {variant}"):
            realistic.mitsuba.register()


@pytest.mark.parametrize(("version", "refused"), [((15, 0, 6), True), ((16, 0, 6), True), ((19, 1, 7), False)])
def test_a_library_that_ends_the_process_is_refused(monkeypatch, version, refused):
    mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed (pip install mitsuba)")
    mi.set_variant("scalar_rgb")
    import realistic.mitsuba as ours

    monkeypatch.setattr(ours.platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(ours.dr.detail, "llvm_version", lambda: version)
    monkeypatch.setattr(ours.mi, "variant", lambda: "llvm_ad_rgb")
    monkeypatch.setattr(ours.mi, "register_sensor", lambda *_: None)
    monkeypatch.setattr(ours, "sensor_class", lambda _model: None)
    if refused:
        with pytest.raises(
            ImportError, match=r"libLLVM 1[56]\.0\.6, with which .* ends the process(.|\n)*DRJIT_LIBLLVM_PATH"
        ):
            ours.register()
    else:
        ours.register()
