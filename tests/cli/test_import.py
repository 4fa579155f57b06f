import json

import pytest

BML = b"""<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
<gesture id="g" lexeme="beat" mode="RIGHT_HAND" start="0.2"/><head id="h" lexeme="NOD" start="0.4"/></bml>"""


def arm(name: str, side: int, elbow: str = "0 1 0") -> str:
    """Four hinges that hang, and a hand's weight."""
    return f"""<body pos="0 {0.2 * side} 0.4"><joint name="{name}_pitch" axis="0 1 0" range="-2.5 1"/>
      <joint name="{name}_roll" axis="{side} 0 0" range="-0.3 2"/>
      <joint name="{name}_yaw" axis="0 0 {side}" range="-1 1"/>
      <geom type="capsule" fromto="0 0 -0.05 0 0 -0.28" size="0.03" mass="1"/>
      <body pos="0 0 -0.28"><joint name="{name}_elbow" axis="{elbow}" range="-2.2 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.03" mass="0.8"/></body></body>"""


def puppet(elbow: str = "0 1 0") -> str:
    return f"""<mujoco model="puppet"><compiler angle="radian"/><worldbody><body pos="0 0 0.8">
      <geom type="capsule" fromto="0 0 0 0 0 0.35" size="0.09" mass="5"/>
      <body pos="0 0 0.45"><joint name="pan" axis="0 0 1" range="-1 1"/>
        <joint name="tilt" axis="0 1 0" range="-0.5 0.5"/>
        <geom size="0.09" pos="0.02 0 0.1" mass="1"/></body>
      {arm("left", 1, elbow)}{arm("right", -1, elbow)}</body></worldbody></mujoco>"""


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "puppet.xml"
    path.write_text(puppet(), encoding="utf-8")
    return path


def test_an_imported_robot_performs_like_the_default(kinesic, model, tmp_path):
    ended = kinesic("robots", "import", model)
    assert ended.code == 0, ended.err
    assert "l_elbow_flexion" in ended.out
    assert "left_elbow" in ended.out
    assert ended.out.splitlines()[-1] == "robot: puppet.toml"
    assert kinesic("robots", "check", "puppet.toml").code == 0
    ended = kinesic("perform", "-", "--robot", "puppet.toml", "--no-film", "--json", "--out", "report", stdin=BML)
    data = json.loads(ended.out)
    assert ended.code == 0, data["checks"]
    assert data["robot"] == "puppet"
    assert [entry["outcome"] for entry in data["behaviours"]] == ["realised", "realised"]
    assert data["collision"]["penetrations"] == 0


def test_a_file_is_not_replaced_unless_forced(kinesic, model, tmp_path):
    target = tmp_path / "mine.toml"
    target.write_text("mine", encoding="utf-8")
    ended = kinesic("robots", "import", model, "--out", target)
    assert (ended.code, target.read_text()) == (2, "mine")
    assert "exists already" in ended.err
    assert kinesic("robots", "import", model, "--out", target, "--force").code == 0
    assert target.read_text().startswith("# Mapped from puppet.xml")


def test_a_doubtful_robot_is_written_and_asks_for_review(kinesic, tmp_path):
    path = tmp_path / "odd.xml"
    path.write_text(puppet(elbow="0.05 0 1"), encoding="utf-8")
    ended = kinesic("robots", "import", path)
    assert ended.code == 1
    assert len(ended.err.splitlines()) == 1
    assert ended.err.startswith("kinesic: review odd.toml before it moves: confidence 0.")
    assert (tmp_path / "odd.toml").read_text().startswith("# REVIEW before it moves: confidence 0.")


def test_what_is_no_robot_is_bad_input(kinesic, tmp_path):
    (tmp_path / "no.xml").write_text("<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>")
    for name, message in (("no.xml", "no arms found"), ("nowhere.urdf", "no such file")):
        ended = kinesic("robots", "import", name)
        assert ended.code == 2
        assert message in ended.err
