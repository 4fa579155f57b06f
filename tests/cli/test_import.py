import json
from dataclasses import replace

import pytest

from kinesic.body.robot import Robot
from kinesic.sim.shells.shell import shell_of, write_shell

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


def test_own_meshes_are_kept_beside_the_robot(kinesic, model, tmp_path):
    named = '<asset><mesh name="m" file="m.obj"/><mesh name="n" file="n.dae"/></asset><worldbody>'
    seen = "".join(f'<geom type="mesh" mesh="{mesh}" contype="0" conaffinity="0"/>' for mesh in "mn")
    text = puppet().replace("<worldbody>", named)
    model.write_text(text.replace('size="0.03" mass="0.8"/>', f'size="0.03" mass="0.8"/>{seen}'), encoding="utf-8")
    corners = "v 0 0 0\nv .05 0 -.2\nv 0 .05 -.2\nv -.05 0 -.2\n"
    (tmp_path / "m.obj").write_text(f"{corners}f 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n")
    (tmp_path / "n.dae").write_text("<COLLADA/>")
    ended = kinesic("robots", "import", model)
    assert ended.code == 0, ended.err
    assert "shell: puppet.npz" in ended.out
    assert "left out: n.dae" in ended.out
    shell = shell_of(Robot.load(tmp_path / "puppet.toml"))
    assert shell is not None
    assert len(shell.segments["l_elbow"].triangles) == 4
    ended = kinesic("robots", "import", model)
    assert ended.code == 2
    (tmp_path / "puppet.toml").unlink()
    ended = kinesic("robots", "import", model)
    assert (ended.code, "puppet.npz" in ended.err) == (2, True), "a file of that name may be somebody's"


def test_a_robot_says_what_it_is_drawn_as(kinesic, tmp_path):
    path = tmp_path / "own.toml"
    path.write_text('[robot]\nname = "own"\nextends = "upper22"\n')
    assert kinesic("robots", "show", "upper22").out.splitlines()[-1] == "drawn in its shell"
    assert kinesic("robots", "show", "human").out.splitlines()[-1] == "drawn with its skin"
    assert kinesic("robots", "show", path).out.splitlines()[-1] == "drawn as capsules"
    shell = shell_of(Robot.load())
    assert shell is not None
    write_shell(replace(shell, made_from="another"), path.with_suffix(".npz"))
    said = kinesic("robots", "show", path).out.splitlines()[-1]
    assert said.endswith("made from another description; make it anew: python -m kinesic.sim.shells.bake own.toml")
