"""Scenes in XML and as dictionaries; what is wrong in them is told."""

import numpy as np
import pytest

import realistic

XML = """<scene version="3.0.0">
    <sensor type="realistic">
        <string name="lensfile" value="{lens}"/>
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


def test_xml_and_a_dictionary_say_the_same(mi):
    by_xml = mi.load_string(XML.format(lens="wide.22mm")).sensors()[0]
    by_dict = mi.load_dict(
        {
            "type": "realistic",
            "lensfile": "wide.22mm",
            "focusdistance": 0.9,
            "mmperunit": 1000.0,
            "fnumber": 4,
            "differentials": False,
            "shutter_close": 0.5,
            "to_world": mi.ScalarTransform4f().look_at(origin=[1, 2, 3], target=[1, 2, 9], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": 60, "height": 40},
            "sampler": {"type": "stratified", "sample_count": 9},
        }
    )
    expected = {"specfile": "wide.22mm", "focusdistance": 0.9, "mmperunit": 1000.0, "fnumber": 4}
    for sensor in (by_xml, by_dict):
        assert sensor.camera.parameters == {**expected, "weighting": "relative"}
        assert sensor.camera.resolution == (60, 40)
        assert sensor.shutter_open_time() == 0.5
        assert sensor.sampler().sample_count() == 9
        assert "wide.22mm" in str(sensor) and "to_world" in str(sensor)
        np.testing.assert_allclose(np.ravel(sensor.bbox().min), [1, 2, 3], rtol=1e-6)


def test_a_lens_file_lies_beside_the_scene(mi, checkout, tmp_path):
    file = checkout / "lenses/wide.22mm.dat"
    (tmp_path / "own.dat").write_bytes(file.read_bytes())
    (tmp_path / "scene.xml").write_text(XML.format(lens="own.dat").replace('"0.9"', '"9"'))
    sensor = mi.load_file(str(tmp_path / "scene.xml")).sensors()[0]
    assert sensor.camera.focal_length_mm == realistic.Lens(file).focal_length_mm


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ({"fnunber": 3.0}, 'there is no property "fnunber"; did you mean "fnumber"?'),
        ({"focus_distanse": 3.0}, 'did you mean "focusdistance"?'),
        ({"shutteropen": 0.0}, '"shutteropen" is written "shutter_open" in Mitsuba'),
        ({"focus_distance": 500.0, "focusdistance": 500.0}, "is given twice"),
        ({"fov": 40.0}, '"fov" is for cameras without a real lens'),
        ({"model": "perspective"}, "Mitsuba's own sensors"),
        ({"type": "thick", "model": "lens"}, '"model" is not one of a sensor "thick"'),
        ({"differentials": 1}, '"differentials" must be true or false'),
        ({"fnumber": "four"}, "fnumber must be a number, not 'four'"),
        ({"fnumber": -4.0}, '"fnumber"'),
        ({"lensfile": "nowhere.dat"}, 'no lens file "nowhere.dat"'),
        ({"focus_distance": 1.0}, "cannot focus at 1 mm from the film"),
        ({"to_world_end": 3.0}, '"to_world_end" must be a transform'),
        ({"focusdistance": 900.0, "filmdistance": 40.0}, "filmdistance"),
    ],
)
def test_what_is_wrong_in_a_scene_is_told(mi, properties, message):
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
        sensor = mi.load_dict({"type": "realistic", "lensfile": "zoom.24-70mm", "zoom": zoom})
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


def test_a_variant_without_the_sensors_says_why(monkeypatch):
    mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed (pip install mitsuba)")
    mi.set_variant("scalar_rgb")
    import realistic.mitsuba

    for variant in ("cuda_ad_rgb", "llvm_ad_rgb_double"):
        monkeypatch.setattr(realistic.mitsuba.mi, "variant", lambda name=variant: name)
        with pytest.raises(ImportError, match=f"no sensor for Mitsuba's variant {variant}"):
            realistic.mitsuba.register()
