"""Expansion of xacro macros in a guarded process, and the message without the package xacro."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.reading import xacro_file
from kinesic.sim.importer.reading.robot_files import read_robot_files
from kinesic.sim.importer.reading.xacro_file import expand_xacro, is_xacro

ROOT = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
TWO_LINKS = """<xacro:property name="n" value="3"/>
    <xacro:macro name="part" params="name"><link name="${name}_${n * 2}"/></xacro:macro>
    <xacro:part name="a"/><xacro:part name="b"/>"""


@pytest.fixture
def xacro() -> None:
    pytest.importorskip("xacro")


def refusal(path: Path, content: str) -> str:
    path.write_text(ROOT.format(content))
    with pytest.raises(ConfigError) as caught:
        expand_xacro(path)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (ROOT.format(TWO_LINKS), True),
        (ROOT.format('<link name="${1 + 1}"/>'), True),
        (ROOT.format('<link name="$(arg side)"/>'), True),
        (ROOT.format('<link name="a"/>'), False),
        ('<robot><link name="${a}"/></robot>', False),
    ],
)
def test_file_with_the_xacro_namespace_and_macros_or_expressions_is_a_xacro_file(text: str, expected: bool):
    assert is_xacro(text.encode()) is expected


@pytest.mark.usefixtures("xacro")
def test_macros_are_expanded_before_a_robot_file_is_read(tmp_path: Path):
    (tmp_path / "robot.urdf.xacro").write_text(ROOT.format(TWO_LINKS))
    root = read_robot_files(tmp_path / "robot.urdf.xacro").root
    assert [link.get("name") for link in root.iter("link")] == ["a_6", "b_6"]


@pytest.mark.usefixtures("xacro")
def test_macros_include_files_of_neighbouring_ros_packages(tmp_path: Path):
    for name in ("arm", "bringup"):
        (tmp_path / name / "urdf").mkdir(parents=True)
        (tmp_path / name / "package.xml").write_text("<package/>")
    (tmp_path / "arm" / "urdf" / "arm.xacro").write_text(ROOT.format('<link name="${1 + 1}"/>'))
    main = tmp_path / "bringup" / "urdf" / "main.xacro"
    main.write_text(ROOT.format('<xacro:include filename="$(find arm)/urdf/arm.xacro"/>'))
    assert b'<link name="2"/>' in expand_xacro(main)
    assert "no package leg" in refusal(main, '<xacro:include filename="$(find leg)/urdf/arm.xacro"/>')


@pytest.mark.usefixtures("xacro")
@pytest.mark.parametrize(
    "content",
    [
        "<link name=\"${xacro.load_yaml('/etc/hosts')}\"/>",
        '<xacro:include filename="link.xacro"/>',
    ],
)
def test_macros_read_no_file_outside_the_folder_of_the_robot(tmp_path: Path, content: str):
    (tmp_path / "robot").mkdir()
    (tmp_path / "outside.xacro").write_text(ROOT.format('<link name="secret"/>'))
    (tmp_path / "robot" / "link.xacro").symlink_to(tmp_path / "outside.xacro")
    assert "macros may only read files in robot" in refusal(tmp_path / "robot" / "main.xacro", content)


@pytest.mark.usefixtures("xacro")
def test_expressions_start_no_program_and_see_no_environment_variable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("KINESIC_TEST_SECRET", "secret")
    escape = "(lambda o: [c for c in o.__subclasses__() if c.__name__ == '_wrap_close'][0].__init__.__globals__)"
    start = f"(lambda: {escape}(().__class__.__base__)['system']('touch {tmp_path}/started'))()"
    reason = refusal(tmp_path / "program.xacro", f'<link name="${{{start}}}"/>')
    assert "macros may only read files" in reason
    assert not (tmp_path / "started").exists()
    assert "KINESIC_TEST_SECRET" in refusal(tmp_path / "secret.xacro", '<link name="$(env KINESIC_TEST_SECRET)"/>')


@pytest.mark.usefixtures("xacro")
def test_expansion_is_stopped_after_a_time_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(xacro_file, "EXPANSION_TIMEOUT", 0.01)
    assert "take more than 0 s" in refusal(tmp_path / "robot.xacro", TWO_LINKS)


def test_without_the_package_xacro_the_command_and_the_extra_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(xacro_file, "find_spec", lambda _name: None)
    reason = refusal(tmp_path / "robot.urdf.xacro", TWO_LINKS)
    assert "xacro robot.urdf.xacro > robot.urdf" in reason
    assert '[xacro]"' in reason
