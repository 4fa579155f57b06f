"""XML given to MuJoCo: original line numbers, mesh tokens and limits."""

from pathlib import Path
from xml.etree.ElementTree import Element, tostring

import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.reading import model_text, robot_files, screening
from kinesic.sim.importer.reading.robot_files import RobotFiles, read_robot_files
from kinesic.sim.importer.reading.screening import UnfitError, count_copies, is_unused, screen_element


@pytest.fixture
def read(tmp_path: Path):
    """Return a function that reads a robot with its included files."""

    def of(text: str, **files: str) -> RobotFiles:
        (tmp_path / "robot.xml").write_text(text)
        for name, content in files.items():
            (tmp_path / f"{name}.xml").write_text(content)
        return read_robot_files(tmp_path / "robot.xml")

    return of


@pytest.fixture
def refused(read):
    def of(text: str, **files: str) -> str:
        with pytest.raises(ConfigError) as caught:
            read(text, **files)
        return str(caught.value)

    return of


def shape(element: Element) -> object:
    """Return the tags of an element and its descendants."""
    return (element.tag, [shape(child) for child in element]) if len(element) else element.tag


def lines_of(found: RobotFiles) -> dict[str, int]:
    """Return the line of each named element in the XML given to MuJoCo."""
    lines = enumerate(tostring(found.root).decode().split("\n"), 1)
    return {name: number for number, line in lines for name in "abcdefg" if f'name="{name}"' in line}


def test_parsed_elements_of_a_robot_file_keep_their_line_numbers(read):
    text = '<mujoco>\n<worldbody><body name="a">\n\n<geom name="b"/><geom name="c"/>\n</body>\n\n\n<body name="d"/>'
    assert lines_of(read(f"{text}</worldbody></mujoco>")) == {"a": 2, "b": 4, "c": 4, "d": 8}


def test_included_elements_do_not_shift_line_numbers_of_a_robot_file(read):
    text = '<mujoco><worldbody>\n<body name="a"/><include file="part.xml"/>\n<body name="d"/>\n</worldbody></mujoco>'
    part = '<mujoco>\n\n\n\n<body name="b"/>\n\n\n<body name="c"/></mujoco>'
    assert lines_of(read(text, part=part)) == {"a": 2, "b": 2, "c": 2, "d": 3}


def test_include_element_of_a_robot_file_is_replaced_by_the_contents_of_its_file(read):
    result = read(
        '<mujoco><worldbody><include file="one.xml"/><body/></worldbody><include file="two.xml"/></mujoco>',
        one="<anything><body><geom/></body><site/></anything>",
        two="<mujoco><actuator><motor/></actuator></mujoco>",
    )
    assert shape(result.root) == (
        "mujoco",
        [("worldbody", [("body", ["geom"]), "site", "body"]), ("actuator", ["motor"])],
    )
    assert (result.path.name, result.models, result.meshes) == ("robot.xml", {}, {})


def test_mesh_file_names_in_a_robot_file_are_replaced_by_tokens_and_mesh_names_kept(read):
    assets = (
        '<mesh name="arm" file="x/arm.STL" scale="1 1 1" inertia="exact"/><mesh file="x\\leg.v2.obj"/>'
        '<mesh name="hand"/><mesh name="arm2" file="x/arm.STL"/>'
    )
    result = read(
        f'<mujoco><compiler meshdir="m\\n"/><asset>{assets}</asset><default><mesh scale="2 2 2"/></default></mujoco>'
    )
    meshes = [item for item in result.root.iter("mesh") if "file" in item.attrib]
    assert [(mesh.get("name"), mesh.get("file")) for mesh in meshes] == [
        ("arm", "mesh-0.stl"),
        ("leg.v2", "mesh-1.stl"),
        ("hand", "mesh-2.stl"),
        ("arm2", "mesh-3.stl"),
    ]
    assert meshes[0].attrib == {"name": "arm", "file": "mesh-0.stl", "scale": "1 1 1"}
    assert [(mesh.file, mesh.name, mesh.below) for mesh in result.meshes.values()] == [
        ("x/arm.STL", "arm", "m/n"),
        ("x\\leg.v2.obj", "leg.v2", "m/n"),
        ("", "hand", "m/n"),
        ("x/arm.STL", "arm2", "m/n"),
    ]
    assert result.root.find("default/mesh").attrib == {"scale": "2 2 2"}
    assert not result.is_urdf


@pytest.mark.parametrize(
    ("compilers", "below"),
    [
        ('<compiler assetdir="a"/>', "a"),
        ('<compiler assetdir="a" meshdir="m"/>', "m"),
        ('<compiler meshdir="m"/><compiler angle="degree"/>', "m"),
        ('<compiler meshdir="m"/><compiler meshdir="n"/>', "n"),
        ("", ""),
    ],
)
def test_last_meshdir_of_a_robot_file_takes_precedence_over_earlier_ones_and_assetdir(read, compilers: str, below: str):
    result = read(f'<mujoco>{compilers}<asset><mesh file="a.stl"/></asset></mujoco>')
    assert [mesh.below for mesh in result.meshes.values()] == [below]
    assert "dir" not in tostring(result.root).decode()


def test_repeated_urdf_mesh_has_one_token(read):
    def geometry(name: str) -> str:
        return f'<link name="{name}"><visual><geometry><mesh filename="package://r/{name[0]}.stl"/></geometry></visual></link>'

    result = read(f'<robot name="r">{geometry("a1")}{geometry("a2")}{geometry("b1")}</robot>')
    assert result.is_urdf
    assert [item.get("filename") for item in result.root.iter("mesh")] == ["mesh-0.stl", "mesh-0.stl", "mesh-1.stl"]
    assert [mesh.file for mesh in result.meshes.values()] == ["package://r/a.stl", "package://r/b.stl"]


def test_attached_model_is_read_once_with_separate_mesh_tokens(read):
    asset = '<asset><mesh file="a.stl"/><model name="m" file="hand.xml"/><model name="n" file="./hand.xml"/></asset>'
    result = read(f"<mujoco>{asset}</mujoco>", hand='<mujoco><asset><mesh file="b.stl"/></asset></mujoco>')
    assert [item.get("file") for item in result.root.iter("model")] == ["model-0.xml", "model-0.xml"]
    assert result.models == {"model-0.xml": b'<mujoco><asset><mesh name="b" file="mesh-1.stl" /></asset></mujoco>'}
    assert {token: each.file for token, each in result.meshes.items()} == {"mesh-0.stl": "a.stl", "mesh-1.stl": "b.stl"}


def test_unused_elements_of_a_robot_file_are_removed_with_their_children(read):
    result = read(
        '<mujoco><size nkey="1"/><sensor><gyro/></sensor><keyframe><key/></keyframe><custom><text/></custom>'
        "<deformable><skin/></deformable><asset><hfield/><texture/><skin/><material/></asset>"
        '<compiler><lengthrange/></compiler><worldbody><body user="1"><size/></body></worldbody></mujoco>'
    )
    assert shape(result.root) == (
        "mujoco",
        [("asset", ["material"]), "compiler", ("worldbody", [("body", ["size"])])],
    )
    assert result.root.find("worldbody/body").attrib == {}
    urdf = read('<robot name="r"><mujoco><size/><compiler><lengthrange/></compiler></mujoco><link name="a"/></robot>')
    assert shape(urdf.root) == ("robot", [("mujoco", ["compiler"]), "link"])


def test_includes_inside_removed_elements_of_a_robot_file_are_not_read(read):
    result = read('<mujoco><sensor><include file="nowhere.xml"/></sensor><worldbody/></mujoco>')
    assert shape(result.root) == ("mujoco", ["worldbody"])


@pytest.mark.parametrize(
    ("tag", "around", "unused"),
    [
        ("sensor", ["mujoco"], True),
        ("sensor", ["mujoco", "worldbody"], False),
        ("texture", ["mujoco", "asset"], True),
        ("texture", ["mujoco"], False),
        ("lengthrange", ["mujoco", "compiler"], True),
        ("lengthrange", ["mujoco"], False),
        ("mujoco", [], False),
    ],
)
def test_parents_of_an_xml_element_decide_whether_it_is_unused(tag: str, around: list[str], unused: bool):
    assert is_unused(tag, around) is unused


@pytest.mark.parametrize(
    ("attribute", "most"), [("name", 200), ("prefix", 200), ("childclass", 200), ("pos", 10_000), ("rgba", 10_000)]
)
def test_attribute_values_of_a_robot_file_have_a_length_limit(attribute: str, most: int):
    assert screen_element("body", {attribute: "x" * most}) == {attribute: "x" * most}
    with pytest.raises(UnfitError, match=rf"{attribute} of <body> has {most + 1} characters, at most {most} are taken"):
        screen_element("body", {attribute: "x" * (most + 1)})
    assert screen_element("body", {"user": "x" * 20_000}) == {}


def test_number_of_actuator_states_of_a_robot_is_limited():
    for states in ("100", " 7 ", "-1", "-99", "many"):
        assert screen_element("general", {"actdim": states}) == {"actdim": states}
    for states in ("101", " 101", "1" * 30):
        with pytest.raises(UnfitError, match="of <general>: at most 100 are taken"):
            screen_element("general", {"actdim": states})


@pytest.mark.parametrize(("count", "copies"), [("1", 1), ("0", 1), (" +7 ", 7), ("200", 200), ("9" * 18, 10**18 - 1)])
def test_replicate_count_is_read_with_signs_and_spaces_and_is_at_least_one(count: str, copies: int):
    assert count_copies({"count": count}) == copies


@pytest.mark.parametrize("count", ["", "-1", "1.0", "1e3", "two", "7 7", "9" * 19])
def test_replicate_count_must_be_a_whole_number(count: str):
    with pytest.raises(UnfitError, match="of <replicate> must be a whole number"):
        count_copies({"count": count})


def test_copy_count_of_nested_replicates_is_the_product_and_is_limited(read, refused):
    def nested(outer: int, inner: int, more: str = "") -> str:
        inside = f'<replicate count="{outer}"><replicate count="{inner}"><geom/></replicate></replicate>'
        return f"<mujoco><worldbody>{inside}{more}</worldbody></mujoco>"

    result = read(nested(20, 10, '<replicate count="200"/>'))
    assert [item.get("count") for item in result.root.iter("replicate")] == ["20", "10", "200"]
    assert "robot.xml:1: <replicate> makes 201 copies, at most 200 are taken" in refused(nested(67, 3))
    skipped = '<mujoco><custom><replicate count="9999"/></custom></mujoco>'
    assert shape(read(skipped).root) == "mujoco"


def test_xml_element_count_of_a_robot_includes_copies(read, refused, monkeypatch):
    text = '<mujoco><worldbody>\n<replicate count="3"><geom/><geom/></replicate><site/></worldbody></mujoco>'
    monkeypatch.setattr(model_text, "MAX_ELEMENTS", 2 + 3 + 2 * 3 + 1)
    read(text)
    monkeypatch.setattr(model_text, "MAX_ELEMENTS", 2 + 3 + 2 * 3)
    assert "robot.xml:2: more than 11 elements, copies and attached models included" in refused(text)


def test_element_count_of_a_robot_file_includes_each_attached_model(read, refused, monkeypatch):
    model = '<asset><model name="m" file="hand.xml"/></asset>'
    text = f'<mujoco>{model}<worldbody><attach/><replicate count="2"><attach/></replicate></worldbody></mujoco>'
    hand = "<mujoco><worldbody><body/></worldbody></mujoco>"  # three elements
    monkeypatch.setattr(model_text, "MAX_ELEMENTS", 9 + 3 * 3)
    read(text, hand=hand)
    monkeypatch.setattr(model_text, "MAX_ELEMENTS", 8 + 3 * 3)
    assert "more than 17 elements" in refused(text, hand=hand)


def test_nesting_depth_of_robot_xml_elements_is_limited(read, refused, monkeypatch):
    monkeypatch.setattr(model_text, "MAX_DEPTH", 4)
    read("<mujoco><a><b><c/></b></a></mujoco>")
    assert "more than 4 deep" in refused("<mujoco><a><b><c><d/></c></b></a></mujoco>")
    read('<mujoco><a><include file="part.xml"/></a></mujoco>', part="<mujoco><b><c/></b></mujoco>")
    assert "part.xml:1: elements are inside one another" in refused(
        '<mujoco><a><include file="part.xml"/></a></mujoco>', part="<mujoco><b><c><d/></c></b></mujoco>"
    )


def test_total_size_and_number_of_the_xml_files_of_a_robot_are_limited(read, refused, monkeypatch):
    text = '<mujoco><asset><model file="one.xml"/><model file="./one.xml"/></asset><include file="two.xml"/></mujoco>'
    files = {"one": "<mujoco/>", "two": "<mujoco/>"}
    size = len(text) + 2 * len("<mujoco/>")
    monkeypatch.setattr(robot_files, "MAX_MODEL_SIZE", size)
    monkeypatch.setattr(robot_files, "MAX_FILES", 3)
    read(text, **files)
    monkeypatch.setattr(robot_files, "MAX_FILES", 2)
    assert "robot.xml: consists of more than 2 files" in refused(text, **files)
    monkeypatch.setattr(robot_files, "MAX_MODEL_SIZE", size - 1)
    assert "robot.xml: more than 0 MB of XML" in refused(text, **files)


def test_included_files_are_searched_in_the_robot_folder_then_in_the_referring_folder(read, refused, tmp_path: Path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "one.xml").write_text('<mujoco><include file="two.xml"/></mujoco>')
    (tmp_path / "parts" / "two.xml").write_text("<mujoco><beside/></mujoco>")
    text = '<mujoco><include file="parts/one.xml"/></mujoco>'
    assert shape(read(text).root) == ("mujoco", ["beside"])
    assert shape(read(text, two="<mujoco><above/></mujoco>").root) == ("mujoco", ["above"])
    (tmp_path / "parts" / "one.xml").write_text('<mujoco>\n<include file="three.xml"/></mujoco>')
    assert "parts/one.xml:2: reads three.xml, which is not there" in refused(text)


def test_include_element_must_name_a_file_and_be_empty_and_not_repeat_a_file(refused):
    assert "robot.xml:2: <include> names no file" in refused("<mujoco>\n<include/></mujoco>")
    part = "<mujoco/>"
    assert "<include> holds elements" in refused('<mujoco><include file="part.xml"><a/></include></mujoco>', part=part)
    again = '<mujoco><include file="part.xml"/>\n<include file="part.xml"/></mujoco>'
    assert "robot.xml:2: includes part.xml again" in refused(again, part=part)


@pytest.mark.parametrize("tag", screening.REFUSED_TAGS)
def test_robot_file_with_a_composite_body_or_xacro_macro_is_rejected_with_the_line(refused, tag: str):
    assert f"robot.xml:2: holds a <{tag}>" in refused(f"<mujoco><worldbody>\n<{tag}/></worldbody></mujoco>")
    assert "is a macro; expand the file first" in refused("<robot><xacro:if/></robot>")


@pytest.mark.parametrize("declared", ["mujoco", 'mujoco [<!ENTITY a "aaaa">]', 'mujoco SYSTEM "file:///etc/passwd"'])
def test_robot_file_that_declares_a_document_type_is_rejected_with_its_line(refused, declared: str):
    assert f"robot.xml:2: {model_text.DOCTYPE_REASON}" in refused(f"\n<!DOCTYPE {declared}><mujoco/>")
