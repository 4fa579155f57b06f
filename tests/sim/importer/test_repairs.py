"""Invalid values of robot files that are repaired with a note."""

from xml.etree import ElementTree

import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.reading.file_kinds import LFS_POINTER
from kinesic.sim.importer.reading.mesh_folders import list_mesh_folders
from kinesic.sim.importer.repairs import repair

LINK = '<robot name="r"><link name="a"><inertial><mass value="{}"/><inertia {}/></inertial>{}</link></robot>'
GOOD = 'ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"'


@pytest.mark.parametrize(
    ("mass", "inertia", "inside", "note"),
    [
        ("1", GOOD, "", ()),
        ("1", 'ixx="1" iyy="2" izz="3" ixy="5" ixz="0" iyz="0"', "", ("inertia of link a",)),
        ("1", 'ixx="0" iyy="0" izz="0"', "", ("inertia of link a",)),
        ("1", 'ixx="nan" iyy="1" izz="1"', "", ("inertia of link a",)),
        ("-1", GOOD, "", ("mass of link a",)),
        ("0", GOOD, "", ()),
        ("1", GOOD, '<visual><geometry><sphere radius="0"/></geometry></visual>', ("sphere of link a",)),
        ("1", GOOD, '<collision><geometry><box size="1 0 1"/></geometry></collision>', ("box of link a",)),
        ("1", GOOD, '<visual><geometry><cylinder radius="1"/></geometry></visual>', ("cylinder of link a",)),
        ("1", GOOD, '<visual><geometry><sphere radius="1"/></geometry></visual>', ()),
        ("1", GOOD, "<inertial/>", ("link a has <inertial> twice",)),
    ],
)
def test_invalid_value_of_a_link_is_repaired_with_a_note(mass, inertia, inside, note):
    root = ElementTree.fromstring(LINK.format(mass, inertia, inside))
    notes = repair(root)
    assert len(notes) == len(note)
    assert all(text in found for text, found in zip(note, notes, strict=True))
    assert repair(root) == ()


def test_invalid_inertia_of_a_link_is_replaced_by_the_mean_of_its_positive_diagonal():
    root = ElementTree.fromstring(LINK.format(1, 'ixx="2" iyy="4" izz="-1" ixy="0" ixz="0" iyz="0"', ""))
    repair(root)
    assert root.find("link/inertial/inertia").get("izz") == "3.0"


def test_joint_limits_in_the_wrong_order_are_exchanged_with_a_note():
    root = ElementTree.fromstring('<robot><joint name="j"><limit lower="1" upper="-2"/></joint></robot>')
    (note,) = repair(root)
    assert "joint j" in note
    assert root.find("joint/limit").attrib == {"lower": "-2", "upper": "1"}


def test_mjcf_with_a_zero_radius_and_an_impossible_inertia_is_loaded(tmp_path):
    path = tmp_path / "r.xml"
    path.write_text(
        '<mujoco><worldbody><body name="b"><inertial pos="0 0 0" mass="1" diaginertia="-1 1 1"/><joint name="j"/>'
        '<geom type="sphere" size="0"/><geom type="capsule" size="0.1" fromto="0 0 0 0 0 1"/></body></worldbody>'
        "</mujoco>",
        encoding="utf-8",
    )
    tree = load_robot_tree(path)
    assert len(tree.parts[0].shapes) == 1
    assert ["body b" in tree.left_out[0], "shape of b" in tree.left_out[1]] == [True, True]


@pytest.mark.parametrize(
    ("name", "data", "remedy"),
    [
        ("r.urdf", LFS_POINTER + b"v1\noid sha256:0\n", "git lfs pull"),
        ("r.bvh", b"HIERARCHY\nROOT Hips", "captured motion"),
        ("r.urdf", b"HIERARCHY\nROOT Hips", "captured motion"),
        ("r.stl", b"solid", "it is a mesh"),
        ("r.xml", b"<sdf/>", "it is SDF"),
        ("r.xml", b"<html/>", "begins with <robot>"),
        ("r.toml", b"", "use it with --robot"),
    ],
)
def test_imported_file_without_a_robot_is_refused_with_a_remedy(tmp_path, name, data, remedy):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(ConfigError, match=remedy):
        load_robot_tree(tmp_path / name)


def test_mesh_files_are_searched_in_the_ros_package_neighbouring_packages_and_sibling_folders(tmp_path):
    urdf = tmp_path / "pkg" / "robots" / "urdf"
    for folder in (urdf, tmp_path / "other", tmp_path / "plain", urdf.parent / "meshes"):
        folder.mkdir(parents=True)
    for folder in ("pkg", "other"):
        (tmp_path / folder / "package.xml").write_text("<package/>")

    def homes(reference):
        return [place.home for place in list_mesh_folders(urdf, reference, "")]

    own = [urdf, urdf, tmp_path / "pkg"]
    assert homes("package://pkg/meshes/a.stl")[:3] == own
    assert homes("package://other/a.stl") == [*own, tmp_path / "other", urdf.parent / "meshes"]
    assert homes("package://plain/a.stl") == [*own, urdf.parent / "meshes"]
    assert homes("package://../a.stl") == [*own, urdf.parent / "meshes"]


@pytest.mark.parametrize(("upper", "ends"), [("2.0", (-1.5, 2.0)), ("inf", (None, None))])
def test_imported_joint_with_an_infinite_limit_counts_as_unlimited(tmp_path, upper, ends):
    joint = '<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>{}</joint>'
    limit = f'<limit lower="-1.5" upper="{upper}" effort="1" velocity="1"/>'
    path = tmp_path / "r.urdf"
    path.write_text(f'<robot name="r"><link name="a"/><link name="b"/>{joint.format(limit)}</robot>', encoding="utf-8")
    (found,) = load_robot_tree(path).joints
    assert (found.lower, found.upper) == ends


@pytest.mark.parametrize("mass", ["-1", "nan", "inf", "heavy", "1 2", "", "10001", "1e308"])
def test_mjcf_body_with_an_impossible_mass_gets_another_one_with_a_note(mass):
    root = ElementTree.fromstring(
        f'<mujoco><worldbody><body name="b"><inertial mass="{mass}" pos="0 0 0" diaginertia="1 1 1"/></body>'
        "</worldbody></mujoco>"
    )
    (note,) = repair(root)
    assert note.startswith("the mass of body b is replaced by ")
    assert float(root.find(".//inertial").get("mass")) > 0.0
    assert repair(root) == ()


def test_inertia_that_is_no_number_is_replaced_with_a_note():
    root = ElementTree.fromstring(LINK.format("1", 'ixx="one" iyy="1" izz="1"', ""))
    (note,) = repair(root)
    assert note.startswith("the inertia of link a is replaced")


@pytest.mark.parametrize(
    ("shape", "is_kept"),
    [
        ('<capsule radius="0.1" length="0.2"/>', True),
        ('<capsule radius="0.1" length="-0.2"/>', False),
        ('<capsule length="0.2"/>', False),
        ('<cylinder radius="inf" length="0.2"/>', False),
        ('<sphere radius="wide"/>', False),
        ('<box size="1 2 3"/>', True),
        ('<box size="1 2 nan"/>', False),
        ('<mesh filename="a.stl"/>', True),
    ],
)
@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_shape_of_a_link_without_a_positive_size_is_removed(kind, shape, is_kept):
    root = ElementTree.fromstring(f'<robot><link name="a"><{kind}><geometry>{shape}</geometry></{kind}></link></robot>')
    notes = repair(root)
    assert (root.find(f"link/{kind}") is not None, len(notes)) == (is_kept, 0 if is_kept else 1)
    if not is_kept:
        assert notes[0] == f"a {shape[1:].split()[0]} of link a is left out: its size is not positive"


def test_first_of_repeated_elements_of_links_and_joints_is_kept():
    text = """<robot><link><visual><geometry/><geometry><box size="1 1 1"/></geometry><material name="m"/></visual>
    <inertial><mass value="1"/><mass value="2"/></inertial></link>
    <joint name="j"><limit lower="0" upper="1"/><limit lower="3" upper="2"/><axis/><limit/></joint></robot>"""
    root = ElementTree.fromstring(text)
    assert repair(root) == (
        "a <visual> has <geometry> twice; the first is taken",
        "a <inertial> has <mass> twice; the first is taken",
        "joint j has <limit> twice; the first is taken",
        "joint j has <limit> twice; the first is taken",
    )
    assert root.find("joint/limit").attrib == {"lower": "0", "upper": "1"}
    assert [len(root.findall(path)) for path in (".//limit", ".//mass", ".//geometry", ".//axis")] == [1, 1, 1, 1]
    assert root.find(".//mass").get("value") == "1"


@pytest.mark.parametrize(
    ("inertia", "sphere"),
    [
        ("-1 2 4", 3.0),
        ("0 0 0", 1e-5),
        ("inf 2 4", 3.0),
        ("nan 2 -4", 2.0),
        ("1 2", 1.5),
        ("1 1 1 1 0 0", 1.0),
        ("1 1 1 0 1 0", 1.0),
        ("1 1 1 0 0 -1", 1.0),
        ("1 1 1 0.9 0 0", None),
        ("1 1 1 0 0.9 0", None),
        ("1 1 1 0 0 0.9", None),
        ("1 1 1 nan 0 0", 1.0),
    ],
)
def test_inertia_matrix_that_is_not_positive_definite_becomes_that_of_a_sphere(inertia, sphere):
    body = f'<body name="b"><inertial mass="1" fullinertia="{inertia}"/></body>'
    root = ElementTree.fromstring(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    notes = repair(root)
    inertial = root.find(".//inertial")
    if sphere is None:
        assert (notes, inertial.get("fullinertia"), inertial.get("diaginertia")) == ((), inertia, None)
        return
    assert notes == ("the inertia of body b is replaced by that of a sphere: it is not positive definite",)
    assert inertial.get("fullinertia") is None
    assert [float(value) for value in inertial.get("diaginertia").split()] == [sphere] * 3


def test_replaced_inertia_of_a_link_has_no_products():
    root = ElementTree.fromstring(LINK.format("heavy", 'ixx="1" iyy="2" izz="3" ixy="5" ixz="1" iyz="1"', ""))
    assert len(repair(root)) == 2
    assert root.find(".//mass").get("value") == "0.001"
    inertia = root.find(".//inertia").attrib
    assert [float(inertia[key]) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")] == [2, 2, 2, 0, 0, 0]


def test_mass_element_of_a_link_without_a_value_gets_a_mass():
    root = ElementTree.fromstring('<robot><link name="a"><inertial><mass/></inertial></link></robot>')
    (note,) = repair(root)
    assert note.startswith("the mass of link a is replaced by 0.001 kg")
    assert root.find(".//mass").get("value") == "0.001"


def test_missing_product_of_inertia_counts_as_zero():
    root = ElementTree.fromstring(LINK.format(1, 'ixx="1" iyy="1" izz="1" iyz="2"', ""))
    assert len(repair(root)) == 1


@pytest.mark.parametrize(
    ("limit", "ends"),
    [
        ('<limit upper="-1"/>', ("-1", "0")),
        ('<limit lower="1"/>', ("0", "1")),
        ('<limit lower="1" upper="1"/>', None),
        ("<limit/>", None),
        ("<axis/>", None),
    ],
)
def test_missing_joint_limit_counts_as_zero_in_the_order_check(limit, ends):
    root = ElementTree.fromstring(f'<robot><joint name="j">{limit}</joint></robot>')
    notes = repair(root)
    assert len(notes) == (0 if ends is None else 1)
    if ends is not None:
        assert (root.find("joint/limit").get("lower"), root.find("joint/limit").get("upper")) == ends


def test_limits_of_an_mjcf_joint_are_not_exchanged():
    root = ElementTree.fromstring('<mujoco><joint name="j"><limit lower="1" upper="0"/></joint></mujoco>')
    assert repair(root) == ()


def test_link_and_body_without_inertial_or_mass_need_no_repair():
    assert repair(ElementTree.fromstring('<robot><link name="a"><inertial/></link><link name="b"/></robot>')) == ()
    body = ElementTree.fromstring('<mujoco><worldbody><body name="a"/></worldbody></mujoco>')
    assert repair(body) == ()
