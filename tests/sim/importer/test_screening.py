"""Files of strangers: what reads outside their folder, or grows without end, is refused in one line."""

import os
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer import load, screening
from kinesic.sim.importer.load import load_model
from kinesic.sim.importer.screening import screen_model

PART = '<mujoco><worldbody><body name="part"><joint/><geom size="0.1"/></body></worldbody></mujoco>'


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    """A folder for a robot, with a secret beside it."""
    (tmp_path / "secret.xml").write_text(PART)
    (tmp_path / "robot" / "parts").mkdir(parents=True)
    (tmp_path / "robot" / "parts" / "arm.xml").write_text(PART)
    return tmp_path / "robot" / "robot.xml"


def mjcf(inside: str = "", world: str = "") -> str:
    body = '<body name="b"><joint name="j"/><geom size="0.1"/></body>'
    return f"<mujoco>{inside}<worldbody>{body}{world}</worldbody></mujoco>"


def refused(robot: Path, text: str) -> str:
    robot.write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_model(robot)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_parts_in_the_robots_own_folder_are_read(robot: Path):
    robot.write_text(mjcf('<include file="parts/arm.xml"/>'))
    assert len(load_model(robot).joints) == 2


@pytest.mark.parametrize(
    "name", ["../secret.xml", "parts/../../secret.xml", "{outside}", "linked.xml", "away/secret.xml"]
)
@pytest.mark.parametrize("element", ['<include file="{}"/>', '<asset><model name="m" file="{}"/></asset>'])
def test_nothing_outside_of_the_robots_folder_is_read(robot: Path, name: str, element: str):
    (robot.parent / "linked.xml").symlink_to("../secret.xml")
    (robot.parent / "away").symlink_to("..")
    name = name.format(outside=robot.parent.parent / "secret.xml")
    assert "outside of the robot's folder" in refused(robot, mjcf(element.format(name)))


def test_what_an_included_file_includes_is_screened_too(robot: Path):
    (robot.parent / "parts" / "one.xml").write_text('<mujoco><include file="two.xml"/></mujoco>')
    (robot.parent / "parts" / "two.xml").write_text('<mujoco><include file="../../secret.xml"/></mujoco>')
    assert "two.xml: reads ../../secret.xml" in refused(robot, mjcf('<include file="parts/one.xml"/>'))


def test_a_file_that_includes_itself_is_read_once(robot: Path):
    (robot.parent / "loop.xml").write_text('<mujoco><include file="loop.xml"/></mujoco>')
    refused(robot, mjcf('<include file="loop.xml"/>'))  # by MuJoCo


BOMB = '<!DOCTYPE mujoco [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><mujoco model="&b;"><worldbody/></mujoco>'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (BOMB, "declares a document type"),
        ('<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot name="r"/>', "declares a document type"),
        (mjcf(world='<replicate count="1000000000"><geom size="0.1"/></replicate>'), "makes 1000000000 copies"),
        (
            mjcf(world='<replicate count="99"><replicate count="99"><geom size="1"/></replicate></replicate>'),
            "9801 copies",
        ),
        (mjcf(world='<flexcomp name="f" type="grid" count="1000 1000 1000" dim="3"/>'), "holds a <flexcomp>"),
        (mjcf(world="<body>" * 10_000 + "</body>" * 10_000), "more than 200 deep"),
        (mjcf(world='<geom size="0.1"/>' * 100_000), "more than 100000 elements"),
        (mjcf(world='<geom size="0.1"/>' * 200), "201 shapes"),
        ("<mujoco/>" + " " * 20_000_000, "more than 20 MB"),
    ],
    ids=["entities", "external", "replicate", "nested", "flexcomp", "deep", "elements", "shapes", "large"],
)
def test_what_would_grow_beyond_any_robot_is_refused(
    robot: Path, monkeypatch: pytest.MonkeyPatch, text: str, says: str
):
    monkeypatch.setattr(load, "GEOMS", 200)  # so many more take MuJoCo seconds
    assert says in refused(robot, text)


def test_many_files_are_too_many(robot: Path):
    for k in range(screening.FILES + 1):
        (robot.parent / f"{k}.xml").write_text(f'<mujoco><include file="{k + 1}.xml"/></mujoco>')
    assert "more than 50 files" in refused(robot, mjcf('<include file="0.xml"/>'))


def test_meshes_and_textures_are_never_opened_and_no_memory_is_taken_at_their_word(robot: Path):
    pipe = robot.parent / "endless.stl"
    os.mkfifo(pipe)  # whoever opened it would wait for ever
    mesh = f'<asset><mesh name="m" file="endless.stl"/><texture name="t" type="2d" file="{pipe}"/></asset>'
    robot.write_text(mjcf(f'<size memory="900G"/>{mesh}', '<geom type="mesh" mesh="m"/>'))
    assert len(load_model(robot).joints) == 1


def test_a_urdf_is_screened_too(robot: Path):
    robot.write_text('<robot name="r"><link name="a"/></robot>')
    screen_model(robot)
    robot.write_text('<!DOCTYPE robot><robot name="r"><link name="a"/></robot>')
    with pytest.raises(ConfigError, match="declares a document type"):
        screen_model(robot)
