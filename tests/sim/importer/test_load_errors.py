"""Robot files that are read whole: names, notes and errors."""

from types import SimpleNamespace
from xml.etree import ElementTree

import mujoco
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer import load
from kinesic.sim.importer.load import _ignore_warning, _read_spec
from kinesic.sim.importer.model_tree import Follow

BODIES = """<worldbody><body><joint name="a"/><geom size="0.1"/>
  <body pos="0 0 1"><joint name="b"/><geom size="0.1"/></body></body></worldbody>"""


def test_mujoco_warning_about_a_robot_file_is_ignored():
    assert _ignore_warning("text") is None


def test_loaded_robot_is_named_after_its_file_and_notes_what_is_left_out(tmp_path):
    path = tmp_path / "one.xml"
    coupling = '<equality><joint joint1="b" joint2="a" polycoef="0.1 2 0 0 0"/><joint joint1="b"/></equality>'
    path.write_text(f"<mujoco>{BODIES}{coupling}</mujoco>", encoding="utf-8")
    tree = load.load_robot_tree(path)
    assert tree.name == "one"
    assert [joint.follows for joint in tree.joints] == [None, Follow("a", 2.0, 0.1)]
    assert tree.left_out == ("the equality b is left out: only joint couplings are supported",)


def test_error_names_the_missing_robot_file_of_an_import(tmp_path):
    with pytest.raises(ConfigError, match=r"absent\.xml: no such file"):
        load.load_robot_tree(tmp_path / "absent.xml")


def test_mujoco_warning_handler_is_reset_after_an_error(tmp_path, monkeypatch):
    handlers = []
    monkeypatch.setattr(load.mujoco, "set_mju_user_warning", handlers.append)
    with pytest.raises(ConfigError):
        load.load_robot_tree(tmp_path / "absent.xml")
    assert handlers[-1:] == [None]


def test_error_names_the_model_that_mujoco_cannot_build(tmp_path, monkeypatch):
    def fail(root, files):
        raise mujoco.FatalError("no\n  memory")

    monkeypatch.setattr(load, "_read_spec", fail)
    path = tmp_path / "one.xml"
    path.write_text("<mujoco/>", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"one\.xml: MuJoCo cannot build a model from it: no memory"):
        load.load_robot_tree(path)


@pytest.mark.parametrize(
    ("body", "shape"), [('pos="0 0 nan"', ""), ("", 'pos="nan 0 0"'), ('quat="nan 0 0 1"', ""), ("", 'euler="inf 0 0"')]
)
def test_body_or_shape_at_no_finite_place_is_refused_with_its_name(tmp_path, body, shape):
    path = tmp_path / "one.urdf.xml"
    bodies = f'<body name="arm" {body}><joint name="a"/><geom size="0.1" {shape}/></body>'
    path.write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"one\.urdf\.xml: the position or rotation of arm is not finite"):
        load.load_robot_tree(path)


def test_mujoco_specification_is_read_from_xml_text():
    root = ElementTree.fromstring(f"<mujoco>{BODIES}</mujoco>")
    spec = _read_spec(root, SimpleNamespace(models={}))
    assert [joint.name for joint in spec.joints] == ["a", "b"]
