import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from kinesic.body.config import CONFIGS
from kinesic.body.robot import Robot
from kinesic.sim.importer.apart import imported
from kinesic.sim.importer.apart.answer import answer_import
from kinesic.sim.shells.shell import load_shell, write_shell

BML = b"""<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
<gesture id="g" lexeme="beat" mode="RIGHT_HAND" start="0.2"/><head id="h" lexeme="NOD" start="0.4"/></bml>"""


def make_arm(name: str, side: int, elbow: str = "0 1 0") -> str:
    """Return MJCF of an arm with four hinges."""
    return f"""<body pos="0 {0.2 * side} 0.4"><joint name="{name}_pitch" axis="0 1 0" range="-2.5 1"/>
      <joint name="{name}_roll" axis="{side} 0 0" range="-0.3 2"/>
      <joint name="{name}_yaw" axis="0 0 {side}" range="-1 1"/>
      <geom type="capsule" fromto="0 0 -0.05 0 0 -0.28" size="0.03" mass="1"/>
      <body pos="0 0 -0.28"><joint name="{name}_elbow" axis="{elbow}" range="-2.2 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.03" mass="0.8"/></body></body>"""


def make_puppet(elbow: str = "0 1 0") -> str:
    return f"""<mujoco model="puppet"><compiler angle="radian"/><worldbody><body pos="0 0 0.8">
      <geom type="capsule" fromto="0 0 0 0 0 0.35" size="0.09" mass="5"/>
      <body pos="0 0 0.45"><joint name="pan" axis="0 0 1" range="-1 1"/>
        <joint name="tilt" axis="0 1 0" range="-0.5 0.5"/>
        <geom size="0.09" pos="0.02 0 0.1" mass="1"/></body>
      {make_arm("left", 1, elbow)}{make_arm("right", -1, elbow)}</body></worldbody></mujoco>"""


@pytest.fixture
def within(monkeypatch):
    """Import robots in this process, as another process is slow to start."""

    def run(command, **_):
        return subprocess.CompletedProcess(command, 0, answer_import(Path(command[-3])), b"")

    monkeypatch.setattr(imported.subprocess, "run", run)


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "puppet.xml"
    path.write_text(make_puppet(), encoding="utf-8")
    return path


def test_robot_written_by_the_import_verb_performs_a_document(kinesic, model, tmp_path):
    ended = kinesic("robots", "import", model)
    assert ended.code == 0, ended.err
    assert "l_elbow_flexion" in ended.out
    assert "left_elbow" in ended.out
    assert "confidence of the joint mapping: 1.00 of 1\n" in ended.out
    assert "to check: the base is fixed\n" in ended.out
    assert re.search(r"to check: \d+ of \d+ servos have assumed values", ended.out)
    assert ended.out.splitlines()[-2:] == ["robot: puppet.toml", "picture: puppet.mapping.png"]
    assert kinesic("robots", "check", "puppet.toml").code == 0
    ended = kinesic("perform", "-", "--robot", "puppet.toml", "--no-film", "--json", "--out", "report", stdin=BML)
    data = json.loads(ended.out)
    assert ended.code == 0, data["checks"]
    assert data["robot"] == "puppet"
    assert [entry["outcome"] for entry in data["behaviours"]] == ["realised", "realised"]
    assert data["collision"]["penetrations"] == 0


@pytest.mark.usefixtures("within")
def test_import_replaces_a_file_only_with_force(kinesic, model, tmp_path):
    target = tmp_path / "mine.toml"
    target.write_text("mine", encoding="utf-8")
    ended = kinesic("robots", "import", model, "--out", target)
    assert (ended.code, target.read_text()) == (2, "mine")
    assert "exists already" in ended.err
    assert kinesic("robots", "import", model, "--out", target, "--force").code == 0
    assert target.read_text().startswith("# Mapped from puppet.xml")


@pytest.mark.usefixtures("within")
def test_import_without_matplotlib_names_the_extra_of_the_mapping_picture(kinesic, model, tmp_path, monkeypatch):
    for module in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    ended = kinesic("robots", "import", model)
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.splitlines()[-1].startswith("no picture of the mapping: this needs matplotlib: ")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["puppet.toml", "puppet.xml"]


@pytest.mark.usefixtures("within")
def test_mapping_picture_replaces_a_file_only_with_force(kinesic, model, tmp_path):
    picture = tmp_path / "puppet.mapping.png"
    picture.write_text("mine", encoding="utf-8")
    ended = kinesic("robots", "import", model)
    assert (ended.code, picture.read_text(), (tmp_path / "puppet.toml").exists()) == (2, "mine", False)
    assert kinesic("robots", "import", model, "--force").code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.usefixtures("within")
def test_robot_imported_with_low_confidence_is_written_with_a_review_request(kinesic, tmp_path):
    path = tmp_path / "odd.xml"
    path.write_text(make_puppet(elbow="0.05 0 1"), encoding="utf-8")
    ended = kinesic("robots", "import", path)
    assert ended.code == 1
    assert len(ended.err.splitlines()) == 1
    assert ended.err.startswith("kinesic: review odd.toml before it moves: confidence 0.")
    assert (tmp_path / "odd.toml").read_text().startswith("# REVIEW before it moves: confidence 0.")


@pytest.mark.usefixtures("within")
def test_robots_import_refuses_a_file_without_a_robot(kinesic, tmp_path):
    (tmp_path / "no.xml").write_text("<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>")
    for name, message in (("no.xml", "no arms found"), ("nowhere.urdf", "no such file")):
        ended = kinesic("robots", "import", name)
        assert ended.code == 2
        assert message in ended.err


@pytest.mark.usefixtures("within")
def test_readable_meshes_of_an_imported_robot_are_stored_in_a_shell_file(kinesic, model, tmp_path):
    assets = '<asset><mesh name="m" file="m.obj"/><mesh name="n" file="n.dae"/></asset><worldbody>'
    mesh_geoms = "".join(f'<geom type="mesh" mesh="{mesh}" contype="0" conaffinity="0"/>' for mesh in "mn")
    text = make_puppet().replace("<worldbody>", assets)
    text = text.replace('size="0.03" mass="0.8"/>', f'size="0.03" mass="0.8"/>{mesh_geoms}')
    model.write_text(text, encoding="utf-8")
    vertices = "v 0 0 0\nv .05 0 -.2\nv 0 .05 -.2\nv -.05 0 -.2\n"
    (tmp_path / "m.obj").write_text(f"{vertices}f 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n")
    (tmp_path / "n.dae").write_text("<COLLADA/>")
    ended = kinesic("robots", "import", model)
    assert ended.code == 0, ended.err
    assert "shell: puppet.npz" in ended.out
    assert "note: n.dae" in ended.out
    shell = load_shell(Robot.load(tmp_path / "puppet.toml"))
    assert shell is not None
    assert len(shell.segments["l_elbow"].triangles) == 4
    ended = kinesic("robots", "import", model)
    assert ended.code == 2
    (tmp_path / "puppet.toml").unlink()
    ended = kinesic("robots", "import", model)
    assert (ended.code, "puppet.npz" in ended.err) == (2, True), "a user may own a file of that name"


def test_robots_show_prints_how_the_robot_is_drawn(kinesic, tmp_path):
    path = tmp_path / "own.toml"
    path.write_text('[robot]\nname = "own"\nextends = "upper22"\n')
    assert kinesic("robots", "show", "upper22").out.splitlines()[-1] == "drawn in its shell"
    assert kinesic("robots", "show", "human").out.splitlines()[-1] == "drawn with its skin"
    assert kinesic("robots", "show", path).out.splitlines()[-1] == "drawn in the shell of the robot that it extends"
    path.write_text((CONFIGS / "robots" / "upper22.toml").read_text(encoding="utf-8"), encoding="utf-8")
    remedy = "drawn as capsules; build a shell: python -m kinesic.sim.shells.bake own.toml"
    assert kinesic("robots", "show", path).out.splitlines()[-1] == remedy
    shell = load_shell(Robot.load())
    assert shell is not None
    write_shell(replace(shell, made_from="another"), path.with_suffix(".npz"))
    last_line = kinesic("robots", "show", path).out.splitlines()[-1]
    remedy = "rebuild it: python -m kinesic.sim.shells.bake own.toml"
    assert last_line.endswith(f"made from another robot description; {remedy}")
