"""Untrusted robot files: reads outside their folder and unbounded growth are rejected."""

import os
import resource
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer import load
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.reading import model_text, robot_files
from kinesic.sim.importer.reading.screening import MAX_INCLUDE_DEPTH

PART_XML = '<mujoco><worldbody><body name="part"><joint/><geom size="0.1"/></body></worldbody></mujoco>'


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    """Create a robot folder with a secret file next to it."""
    (tmp_path / "secret.xml").write_text(PART_XML)
    (tmp_path / "robot" / "parts").mkdir(parents=True)
    (tmp_path / "robot" / "parts" / "arm.xml").write_text(PART_XML)
    return tmp_path / "robot" / "robot.xml"


def mjcf(inside: str = "", world: str = "") -> str:
    body = '<body name="b"><joint name="j"/><geom size="0.1"/></body>'
    return f"<mujoco>{inside}<worldbody>{body}{world}</worldbody></mujoco>"


def refused(robot: Path, text: str) -> str:
    robot.write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_robot_tree(robot)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_included_files_in_the_robot_folder_are_read(robot: Path):
    robot.write_text(mjcf('<include file="parts/arm.xml"/>'))
    assert len(load_robot_tree(robot).joints) == 2


@pytest.mark.parametrize(
    "name", ["../secret.xml", "parts/../../secret.xml", "{outside}", "linked.xml", "away/secret.xml"]
)
@pytest.mark.parametrize("element", ['<include file="{}"/>', '<asset><model name="m" file="{}"/></asset>'])
def test_include_or_model_outside_the_robot_folder_is_rejected(robot: Path, name: str, element: str):
    (robot.parent / "linked.xml").symlink_to("../secret.xml")
    (robot.parent / "away").symlink_to("..")
    name = name.format(outside=robot.parent.parent / "secret.xml")
    assert "outside of the robot's folder" in refused(robot, mjcf(element.format(name)))


@pytest.mark.parametrize(
    "name",
    [
        "..\\secret.xml",
        "parts\\..\\..\\secret.xml",
        "parts/..\\../secret.xml",
        "{outside}",
        "file://{outside}",
        "C:\\secret.xml",
        "C:secret.xml",
        "\\\\server\\secret.xml",
        "package://robot/secret.xml",
    ],
)
@pytest.mark.parametrize("element", ['<include file="{}"/>', '<asset><model name="m" file="{}"/></asset>'])
def test_include_by_backslash_drive_or_url_cannot_leave_the_robot_folder(robot: Path, name: str, element: str):
    name = name.format(outside=robot.parent.parent / "secret.xml")
    (robot.parent / name.rpartition("/")[2]).write_text(PART_XML)  # a file of the same name on this system only
    said = refused(robot, mjcf(element.format(name)))
    assert f"robot.xml:1: reads {name}, outside of the robot's folder" in said
    assert f"copy that file into {robot.parent}" in said


def test_attached_model_cannot_include_files_from_outside_the_robot_folder(robot: Path):
    (robot.parent / "hand.xml").write_text('<mujoco><include file="..\\secret.xml"/></mujoco>')
    said = refused(robot, mjcf('<asset><model name="m" file="hand.xml"/></asset>'))
    assert r"hand.xml:1: reads ..\secret.xml, outside" in said


def test_backslashes_in_robot_files_work_as_folder_separators(robot: Path):
    robot.write_text(mjcf('<include file="parts\\arm.xml"/>'))
    assert len(load_robot_tree(robot).joints) == 2


def test_model_with_an_include_can_be_attached_twice(robot: Path):
    (robot.parent / "parts" / "more.xml").write_text("<mujoco><worldbody/></mujoco>")
    text = PART_XML.replace("<mujoco>", '<mujoco><include file="more.xml"/>')
    (robot.parent / "parts" / "hand.xml").write_text(text)
    attach = '<attach model="m" body="part" prefix="{}_"/>'
    asset = '<asset><model name="m" file="parts\\hand.xml"/></asset>'
    robot.write_text(mjcf(asset, attach.format("left") + attach.format("right")))
    assert len(load_robot_tree(robot).joints) == 3


def test_mujoco_opens_no_files_named_like_the_internal_tokens(robot: Path, monkeypatch: pytest.MonkeyPatch):
    """Load a robot while the current folder has files with token names."""
    monkeypatch.chdir(robot.parent)
    (robot.parent / "model-0.xml").write_text("<nonsense/>")
    (robot.parent / "mesh-0.stl").write_bytes(bytes(1000))
    asset = '<asset><model name="m" file="parts/arm.xml"/><mesh name="x" file="nowhere.stl"/></asset>'
    robot.write_text(mjcf(asset, '<attach model="m" body="part" prefix="a_"/><geom type="mesh" mesh="x"/>'))
    tree = load_robot_tree(robot)
    assert len(tree.joints) == 2
    assert tree.left_out == ("nowhere.stl: not in the folder robot; copy it there, or the robot's file above it",)


def test_error_of_a_missing_included_file_names_the_expected_folder(robot: Path):
    said = refused(robot, mjcf('<include file="parts/leg.xml"/>'))
    assert f"robot.xml:1: reads parts/leg.xml, which is not there; copy that file into {robot.parent}" in said


def test_robot_model_that_attaches_itself_is_rejected(robot: Path):
    loop = '<mujoco><asset><model name="m" file="{}.xml"/></asset></mujoco>'
    (robot.parent / "a.xml").write_text(loop.format("b"))
    (robot.parent / "b.xml").write_text(loop.format("a"))
    assert "attaches a.xml, which holds this element" in refused(robot, loop.format("a"))


@pytest.mark.parametrize("part", ["pipe.xml", "parts", "sparse.xml"])
def test_included_pipe_folder_or_huge_file_is_rejected(robot: Path, part: str):
    os.mkfifo(robot.parent / "pipe.xml")
    with (robot.parent / "sparse.xml").open("wb") as file:
        file.truncate(10**11)
    said = refused(robot, mjcf(f'<include file="{part}"/>'))
    assert "not a regular file" in said or "Is a directory" in said or "at most 20000000" in said


def test_macro_without_the_xacro_namespace_is_rejected_with_the_expansion_command(robot: Path):
    text = '<robot name="r"><xacro:include filename="/etc/hostname"/></robot>'
    assert "expand the file first: xacro FILE > robot.urdf" in refused(robot, text)


@pytest.fixture
def small_memory() -> Iterator[None]:
    """Allow this process half a gigabyte of additional memory during a test."""
    usual = resource.getrlimit(resource.RLIMIT_DATA)
    pages = int(Path("/proc/self/statm").read_text().split()[5])  # pages of the data segment
    resource.setrlimit(resource.RLIMIT_DATA, (pages * resource.getpagesize() + 500_000_000, usual[1]))
    yield
    resource.setrlimit(resource.RLIMIT_DATA, usual)


MUSCLE_XML = '<actuator><muscle joint="j"/></actuator>'


@pytest.mark.parametrize(
    "inside",
    [
        '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>',
        '<size nuser_body="100000000" nuser_geom="100000000"/>',
        '<size nuserdata="2000000000" nkey="100000000" memory="900G" njmax="2000000000" nconmax="2000000000"/>',
        '<asset><mesh name="m" builtin="supersphere" params="5000 1 1"/></asset>',
        '<asset><texture name="t" type="2d" builtin="flat" width="60000" height="60000"/></asset>',
        '<custom><numeric name="n" size="2000000000"/></custom>',
        '<sensor><user name="s" dim="2000000000"/></sensor>',
        '<actuator><motor joint="j" nsample="1000000000" delay="1"/></actuator>',
        '<compiler><lengthrange mode="all" timestep="1e-9" inttotal="1e9"/></compiler>' + MUSCLE_XML,
    ],
    ids=["hfield", "user", "memory", "supersphere", "texture", "numeric", "sensor", "samples", "muscle"],
)
@pytest.mark.usefixtures("small_memory")
def test_robot_file_that_declares_huge_sizes_is_loaded_within_5_seconds_of_processor_time(robot: Path, inside: str):
    began = time.process_time()
    robot.write_text(mjcf(inside))
    assert [joint.name for joint in load_robot_tree(robot).joints] == ["j"]
    assert time.process_time() - began < 5.0


@pytest.mark.usefixtures("small_memory")
def test_robot_file_with_long_user_attributes_of_hundreds_of_bodies_is_loaded(robot: Path):
    bodies = (
        f'<body user="{"1 " * 3000}"/>' + '<body user="1"><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/></body>'
    )
    robot.write_text(mjcf(world=bodies * 900))
    assert len(load_robot_tree(robot).joints) == 1


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (mjcf('<actuator><general joint="j" dyntype="user" actdim="1000000000"/></actuator>'), "actdim"),
        (mjcf(f'<default><default class="{"a" * 201}"/></default>'), "class of <default> has 201 characters"),
        (mjcf(world=f'<geom size="1" rgba="{"1 " * 9000}"/>'), "rgba of <geom> has 18000 characters"),
        (
            mjcf(world='<replicate count="1e9"><geom size="1"/></replicate>'),
            'count="1e9" of <replicate> must be a whole',
        ),
        (
            mjcf(world='<replicate count="200">' + '<geom size="1"/>' * 600 + "</replicate>"),
            "more than 100000 elements",
        ),
        (mjcf('<include file="parts/arm.xml"><a/></include>'), "<include> holds elements"),
        (mjcf("<include/>"), "<include> names no file"),
        (mjcf('<include file="parts/arm.xml"/><include file="./parts/arm.xml"/>'), "is included once"),
    ],
)
def test_robot_file_values_beyond_the_limits_are_rejected(robot: Path, text: str, says: str):
    assert says in refused(robot, text)


def test_elements_of_repeatedly_attached_models_count_towards_the_element_limit(robot: Path):
    attach = "".join(f'<attach model="m" body="b" prefix="p{k}"/>' for k in range(10))
    for k in range(40):
        model = f'<asset><model name="m" file="{k + 1}.xml"/></asset>'
        (robot.parent / f"{k}.xml").write_text(
            f'<mujoco>{model}<worldbody><body name="b">{attach}</body></worldbody></mujoco>'
        )
    (robot.parent / "40.xml").write_text('<mujoco><worldbody><body name="b"/></worldbody></mujoco>')
    assert "attached models included" in refused(robot, (robot.parent / "0.xml").read_text())


def test_nested_include_of_a_file_outside_the_robot_folder_is_rejected(robot: Path):
    (robot.parent / "parts" / "one.xml").write_text('<mujoco><include file="two.xml"/></mujoco>')
    (robot.parent / "parts" / "two.xml").write_text('<mujoco><include file="../../secret.xml"/></mujoco>')
    assert "two.xml:1: reads ../../secret.xml" in refused(robot, mjcf('<include file="parts/one.xml"/>'))


def test_robot_file_that_includes_itself_is_refused(robot: Path):
    (robot.parent / "loop.xml").write_text('<mujoco><include file="loop.xml"/></mujoco>')
    refused(robot, mjcf('<include file="loop.xml"/>'))  # rejected by MuJoCo


ENTITY_BOMB_XML = (
    '<!DOCTYPE mujoco [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><mujoco model="&b;"><worldbody/></mujoco>'
)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (ENTITY_BOMB_XML, "declares a document type"),
        ('<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot name="r"/>', "declares a document type"),
        (mjcf(world='<replicate count="1000000000"><geom size="0.1"/></replicate>'), "makes 1000000000 copies"),
        (
            mjcf(world='<replicate count="99"><replicate count="99"><geom size="1"/></replicate></replicate>'),
            "9801 copies",
        ),
        (mjcf(world='<flexcomp name="f" type="grid" count="1000 1000 1000" dim="3"/>'), "holds a <flexcomp>"),
        (mjcf(world="<body>" * 10_000 + "</body>" * 10_000), "more than 200 deep"),
        (mjcf(world='<geom size="0.1"/>' * 1000), "more than 1000 elements"),
        (mjcf(world='<geom size="0.1"/>' * 200), "201 shapes"),
        ("<mujoco/>" + " " * 20_000_000, "more than 20 MB"),
    ],
    ids=["entities", "external", "replicate", "nested", "flexcomp", "deep", "elements", "shapes", "large"],
)
def test_robot_file_that_expands_beyond_the_limits_is_rejected(
    robot: Path, monkeypatch: pytest.MonkeyPatch, text: str, says: str
):
    monkeypatch.setattr(load, "MAX_GEOMS", 200)  # MuJoCo needs seconds for more geoms
    monkeypatch.setattr(model_text, "MAX_ELEMENTS", 1000)  # written one by one
    assert says in refused(robot, text)


def test_too_many_included_files_are_rejected(robot: Path):
    names = [f"{k}.xml" for k in range(robot_files.MAX_FILES)]
    for name in names:
        (robot.parent / name).write_text("<mujoco/>")
    assert "more than 500 files" in refused(robot, mjcf("".join(f'<include file="{name}"/>' for name in names)))


def test_includes_inside_one_another_are_rejected_beyond_a_depth(robot: Path):
    for k in range(MAX_INCLUDE_DEPTH + 1):
        (robot.parent / f"{k}.xml").write_text(f'<mujoco><include file="{k + 1}.xml"/></mujoco>')
    assert "includes are inside one another more than 50 deep" in refused(robot, mjcf('<include file="0.xml"/>'))


def test_mesh_and_texture_files_of_a_robot_are_not_opened(robot: Path):
    pipe = robot.parent / "endless.stl"
    os.mkfifo(pipe)  # opening it would block forever
    mesh = f'<asset><mesh name="m" file="endless.stl"/><texture name="t" type="2d" file="{pipe}"/></asset>'
    robot.write_text(mjcf(f'<size memory="900G"/>{mesh}', '<geom type="mesh" mesh="m"/>'))
    assert len(load_robot_tree(robot).joints) == 1


def test_urdf_file_with_a_document_type_is_rejected(robot: Path):
    robot.write_text('<robot name="r"><link name="a"/></robot>')
    load_robot_tree(robot)
    robot.write_text('<!DOCTYPE robot><robot name="r"><link name="a"/></robot>')
    with pytest.raises(ConfigError, match="declares a document type"):
        load_robot_tree(robot)
