"""Hinges, couplings, motors, masses and shapes read from small models."""

from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer import load
from kinesic.sim.importer.couplings import UrdfJoint, find_gears, read_equalities, to_absolute, urdf_joints
from kinesic.sim.importer.load import (
    _actuators,
    _approximate_by_capsules,
    _find_effort,
    _find_gain,
    _joint,
    _part,
    _positive,
    _tree,
    _without_meshes,
)
from kinesic.sim.importer.looks import Looks
from kinesic.sim.importer.model_tree import BASE_INDEX, Follow

X, Y, Z = np.eye(3)


def spec_of(text):
    return mujoco.MjSpec.from_string(f'<mujoco><compiler angle="radian"/>{text}</mujoco>')


def compiled(text):
    model = spec_of(text).compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def hinges(*names, motors="", attributes=""):
    """Return a chain of hinges on bodies one above the other."""
    bodies = "".join(
        f'<body name="{name}" pos="0 0 1"><joint name="{name}" {attributes}/><geom size="0.1" mass="1"/>'
        for name in names
    )
    closed = "</body>" * len(names)
    return f"<worldbody>{bodies}{closed}</worldbody><actuator>{motors}</actuator>"


def test_velocity_and_coupling_of_urdf_joints_are_read():
    text = """<robot><joint name="a"><limit velocity="2.5"/></joint><joint name="b"/><joint name="c"><limit/></joint>
    <joint name="d"><limit velocity="-1"/><mimic joint="a"/></joint>
    <joint><limit velocity="0.5"/><mimic multiplier="-2" offset="0.25"/></joint></robot>"""
    assert urdf_joints(ElementTree.fromstring(text)) == {
        "a": UrdfJoint(2.5, None),
        "b": UrdfJoint(None, None),
        "c": UrdfJoint(None, None),
        "d": UrdfJoint(None, Follow("a", 1.0, 0.0)),
        "": UrdfJoint(0.5, Follow("", -2.0, 0.25)),
    }
    assert urdf_joints(ElementTree.fromstring('<mujoco><joint name="a"/></mujoco>')) == {}


def test_couplings_of_an_imported_robot_become_linear_and_other_constraints_are_listed_as_omitted():
    equalities = """<equality>
    <joint joint1="a" joint2="b" polycoef="0.1 2 0 0 0"/>
    <joint joint1="c" joint2="b" polycoef="0.2 3 0 0 -0.5"/>
    <joint joint1="d"/><connect name="loop" body1="a" body2="c" anchor="0 0 0"/></equality>
    <tendon><fixed><joint joint="a" coef="1"/></fixed><fixed><joint joint="b" coef="1"/></fixed></tendon>"""
    found = read_equalities(spec_of(hinges("a", "b", "c", "d") + equalities))
    assert found.follows == {"a": Follow("b", 2.0, 0.1), "c": Follow("b", 3.0, 0.2)}
    assert found.left_out == (
        "c follows b linearly, but non-linearly in the file",
        "the equality d is left out: only joint couplings are supported",
        "the equality loop is left out: only joint couplings are supported",
        "2 tendons are left out: hinges that they drive move independently",
    )
    assert read_equalities(spec_of(hinges("a"))).left_out == ()


@pytest.mark.parametrize(("curve", "notes"), [("0.9e-9", 0), ("1.1e-9", 1), ("-1.1e-9", 1)])
def test_coupling_with_a_negligible_nonlinear_coefficient_counts_as_linear(curve, notes):
    coupling = f'<equality><joint joint1="a" joint2="b" polycoef="0 1 {curve} 0 0"/></equality>'
    assert len(read_equalities(spec_of(hinges("a", "b") + coupling)).left_out) == notes


def test_couplings_of_a_robot_file_are_converted_to_absolute_angles():
    text = """<worldbody><body><freejoint/><geom size="0.1"/><body><joint name="a" ref="0.5"/><geom size="0.1"/>
    <body><joint name="b" ref="0.25"/><geom size="0.1"/></body></body></body></worldbody>"""
    model, _ = compiled(text)
    assert to_absolute({"a": Follow("b", 3.0, 0.1)}, model) == {"a": Follow("b", 3.0, pytest.approx(-0.15))}


@pytest.mark.parametrize(("bodies", "geoms"), [(3, 3), (4, 2)])
def test_model_with_too_many_bodies_or_shapes_is_rejected(monkeypatch, bodies, geoms):
    monkeypatch.setattr(load, "MAX_BODIES", bodies)
    monkeypatch.setattr(load, "MAX_GEOMS", geoms)
    with pytest.raises(ConfigError, match=f"r.xml: 4 bodies and 3 shapes; at most {bodies} and {geoms}"):
        _without_meshes(spec_of(hinges("a", "b", "c")), Path("r.xml"))
    monkeypatch.setattr(load, "MAX_BODIES", 4)
    monkeypatch.setattr(load, "MAX_GEOMS", 3)
    assert _without_meshes(spec_of(hinges("a", "b", "c")), Path("r.xml")).nbody == 4


def test_import_limits_are_2000_bodies_and_20_000_shapes():
    assert (load.MAX_BODIES, load.MAX_GEOMS) == (2000, 20_000)


def test_massless_bodies_get_a_small_mass_and_meshes_textures_and_sensors_are_removed():
    text = """<asset><texture name="t" type="2d" builtin="flat" width="4" height="4"/><material name="m" texture="t"/>
    <mesh name="s" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
    <worldbody><light/><camera/><body name="empty"><joint name="a"/>
    <body name="ball"><geom size="0.1" mass="2" material="m"/><geom type="mesh" mesh="s"/></body>
    <body name="flat"><joint name="b"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 3"/></body>
    <body name="dust"><joint name="c"/><inertial pos="0 0 0" mass="1e-9" diaginertia="1e-9 1e-9 1e-9"/></body>
    </body></worldbody><keyframe><key qpos="0 0 0"/></keyframe>
    <custom><numeric name="n" data="1"/><text name="x" data="x"/></custom>
    <sensor><jointpos joint="a"/></sensor><contact><exclude body1="ball" body2="flat"/></contact>"""
    model = _without_meshes(spec_of(text), Path("r.xml"))
    assert model.body("empty").mass[0] == pytest.approx(1e-3)
    assert model.body("empty").inertia == pytest.approx([1e-6] * 3)
    assert model.body("ball").mass[0] == 2.0
    assert model.body("dust").mass[0] == pytest.approx(1e-3)
    assert model.body("dust").inertia == pytest.approx([1e-6] * 3)
    assert model.body("flat").inertia == pytest.approx([5 / 3] * 3)
    assert (model.ngeom, model.nmesh, model.nmat, model.ntex, model.ncam, model.nlight) == (1, 0, 0, 0, 0, 0)
    assert (model.nkey, model.nnumeric, model.ntext, model.nsensor, model.nexclude) == (0, 0, 0, 0, 0)


@pytest.mark.parametrize(
    ("attributes", "motors", "effort"),
    [
        ("", "", None),
        ('actuatorfrcrange="-9 7"', "", 7.0),
        ('actuatorfrcrange="-9 7"', '<motor joint="a" gear="-2" forcerange="-5 3"/>', 6.0),
        ('actuatorfrcrange="-9 5"', '<motor joint="a" gear="2" forcerange="-5 3"/>', 5.0),
        ("", '<motor joint="a" gear="3" ctrlrange="-1 2"/>', 6.0),
        ("", '<motor joint="a" gear="-3" ctrlrange="-4 2"/>', 6.0),
        ("", '<general joint="a" gainprm="-5" ctrlrange="-1 2"/>', 10.0),
        ("", '<motor joint="a" gear="3" ctrlrange="-1 2" forcerange="-5 4"/>', 12.0),
        ("", '<position joint="a" kp="5" ctrlrange="-1 2"/>', None),
        ("", '<motor joint="a"/>', None),
        ("", '<motor joint="b" forcerange="-5 3"/>', None),
        ("", '<motor joint="a" forcerange="-5 3"/><motor joint="a" forcerange="-5 2"/>', 2.0),
    ],
)
def test_torque_limit_is_the_least_of_joint_and_actuators(attributes, motors, effort):
    model, _ = compiled(hinges("a", "b", motors=motors, attributes=attributes))
    assert _find_effort(model, 0) == effort


@pytest.mark.parametrize(
    ("motors", "gain"),
    [
        ("", None),
        ('<position joint="a" kp="5"/>', 5.0),
        ('<motor joint="a"/><position joint="a" kp="5"/>', 5.0),
        ('<velocity joint="a" kv="5"/>', None),
        ('<general joint="a" gainprm="5" biastype="affine" biasprm="0 -4 0"/>', None),
        ('<general joint="a" gainprm="5" biastype="none" biasprm="0 -5 0"/>', None),
        ('<general joint="a" gainprm="-5" biastype="affine" biasprm="0 5 0"/>', None),
        ('<position joint="b" kp="5"/>', None),
    ],
)
def test_servo_gain_of_an_imported_hinge_is_that_of_its_position_actuator(motors, gain):
    model, _ = compiled(hinges("a", "b", motors=motors))
    assert _find_gain(model, 0) == gain


def test_actuators_of_tendons_do_not_belong_to_a_joint():
    tendon = '<tendon><fixed name="t"><joint joint="a" coef="1"/></fixed></tendon>'
    motors = '<motor joint="b"/><motor tendon="t"/><motor joint="a"/><motor joint="a"/>'
    model, _ = compiled(tendon + hinges("a", "b", motors=motors))
    assert [_actuators(model, k) for k in (0, 1)] == [[2, 3], [0]]


def test_zero_and_negative_values_of_a_model_count_as_missing():
    assert (_positive(0.0), _positive(-1.0), _positive(0.5)) == (None, None, 0.5)


def test_imported_hinge_has_the_axis_and_range_and_losses_of_its_joint():
    text = """<worldbody><body><freejoint/><geom size="0.1"/><body pos="1 0 0" euler="0 0 1.5707963267948966">
    <joint name="a" ref="0.5" range="-1 2" pos="0 0 3" axis="1 0 0" armature="0.1" frictionloss="0.2" damping="0.3"/>
    <joint name="b" axis="0 1 0"/><geom size="0.1"/></body></body></worldbody>
    <actuator><position joint="a" kp="5" forcerange="-4 4"/></actuator>"""
    model, data = compiled(text)
    a = _joint(model, data, 1, 7, UrdfJoint(2.5, None))
    assert (a.name, a.parent, a.zero, a.lower, a.upper) == ("a", 7, 0.5, -1.0, 2.0)
    np.testing.assert_allclose((a.anchor, a.axis), (X + 3 * Z, Y), atol=1e-12)
    assert (a.effort, a.speed, a.gain, a.armature, a.friction, a.damping) == (4.0, 2.5, 5.0, 0.1, 0.2, 0.3)
    b = _joint(model, data, 2, BASE_INDEX, None)
    assert (b.name, b.parent, b.zero, b.lower, b.upper) == ("b", BASE_INDEX, 0.0, None, None)
    assert (b.effort, b.speed, b.gain, b.armature, b.friction, b.damping) == (None,) * 6


@pytest.mark.parametrize(
    ("mimics", "fixed"),
    [
        (set(), set()),
        ({"a"}, {"a"}),
        ({"c"}, set()),
        ({"a", "b"}, {"a", "b"}),
        ({"b", "c"}, set()),
        ({"a", "c"}, {"a"}),
    ],
)
def test_coupled_hinges_that_carry_independent_ones_are_fixed(mimics, fixed):
    model, _ = compiled(hinges("a", "b", "c"))
    gears = find_gears(model, {name: Follow("missing", 1.0, 0.0) for name in mimics})
    assert (gears.fixed, gears.motors, len(gears.notes)) == (fixed, {}, len(fixed))


@pytest.mark.parametrize(("ratio", "name", "sign"), [(-1.0, "wheel", -1.0), (0.5, "driven", 1.0)])
def test_limb_behind_a_gear_has_the_motor_of_the_gear(ratio, name, sign):
    text = """<worldbody><body><geom size="0.1"/>
      <body><joint name="wheel" range="-1 2" actuatorfrcrange="-4 4" armature="0.1"/><geom size="0.1"/></body>
      <body pos="0 0 1"><joint name="driven" range="-9 1.5" axis="0 1 0"/><geom size="0.1"/>
        <body><joint name="after"/><geom size="0.1"/></body></body></body></worldbody>"""
    model, data = compiled(text)
    follow = Follow("wheel", ratio, 0.25)
    gears = find_gears(model, {"driven": follow})
    assert (gears.fixed, gears.motors) == ({"wheel"}, {"driven": follow})
    tree = _tree("name", model, data, {}, {"driven": follow}, Looks())
    limb, after = tree.joints
    assert (limb.name, after.name, after.parent) == (name, "after", 0)
    assert (limb.axis.tolist(), limb.anchor.tolist()) == ([0.0, sign, 0.0], [0.0, 0.0, 1.0])
    ends = (-1.0, 2.0) if ratio < 0 else (-0.25, 1.25)
    assert (limb.lower, limb.upper) == pytest.approx(ends)
    assert limb.zero == pytest.approx(0.25 if ratio < 0 else 0.0)
    assert (limb.effort, limb.armature, limb.follows) == pytest.approx((4 / abs(ratio), 0.1 / ratio**2, None))


def test_joint_that_drives_its_own_limb_or_a_second_gear_is_no_gear_motor():
    model, _ = compiled(hinges("a", "b", "c"))
    assert find_gears(model, {"b": Follow("a", 1.0, 0.0)}).fixed == {"b"}
    assert find_gears(model, {"a": Follow("b", 1.0, 0.0)}).fixed == {"a"}
    cyclic = {"a": Follow("b", 1.0, 0.0), "b": Follow("a", 1.0, 0.0)}
    assert find_gears(model, cyclic).fixed == {"a", "b"}


def test_merged_bodies_have_their_total_mass_and_common_centre_of_mass():
    text = """<worldbody><body pos="1 0 0"><geom size="0.1" mass="1"/></body>
    <body pos="0 2 0"><geom size="0.2" mass="3"/><geom size="0.001" mass="0"/></body>
    <body pos="0 0 5"><geom size="0.3" mass="9"/></body></worldbody>"""
    model, data = compiled(text)
    part = _part(model, data, [1, 2], 7 * X)
    assert part.mass == 4.0
    np.testing.assert_allclose(part.centre, (0.25, 1.5, 0.0))
    assert [shape.radius for shape in part.shapes] == [0.1, 0.2]


@pytest.mark.parametrize(("anchor", "centre"), [(None, 0 * X), (7 * X, 7 * X)])
def test_centre_of_mass_of_a_massless_part_is_at_its_hinge(anchor, centre):
    model, data = compiled('<worldbody><body pos="1 0 0"><geom size="0.1" mass="1"/></body></worldbody>')
    part = _part(model, data, [0], anchor)
    assert (part.mass, part.centre.tolist(), part.shapes) == (0.0, centre.tolist(), ())


@pytest.mark.parametrize(
    ("shape", "capsule"),
    [
        ('type="sphere" size="0.1"', (0.0, 0, 0, 0.1)),
        ('type="sphere" size="0.005"', (0.0, 0, 0, 0.005)),
        ('type="sphere" size="0.0049"', None),
        ('type="capsule" size="0.1 0.3"', (0, 0, 0.3, 0.1)),
        ('type="cylinder" size="0.1 0.3"', (0, 0, 0.2, 0.1)),
        ('type="cylinder" size="0.3 0.1"', (0.1, 0, 0, 0.2)),
        ('type="box" size="0.1 0.5 0.125"', (0, 0.3875, 0, 0.1125)),
        ('type="ellipsoid" size="0.5 0.1 0.3"', (0.3, 0, 0, 0.2)),
        ('type="box" size="0.1 0.1 0.1"', (0, 0, 0, 0.1)),
        ('type="plane" size="1 1 1"', None),
    ],
)
def test_shape_becomes_a_capsule_along_its_longest_side(shape, capsule):
    turned = f'<worldbody><geom {shape} pos="1 2 3" euler="0 0 1.5707963267948966"/></worldbody>'
    shapes = _approximate_by_capsules(*compiled(turned), 0)
    if capsule is None:
        assert shapes == ()
        return
    (found,) = shapes
    x, y, z, radius = capsule
    half = np.array([-y, x, z])
    ends = np.array([found.start, found.end]) - (1, 2, 3)
    np.testing.assert_allclose(ends, (-half, half), atol=1e-12)
    assert found.radius == pytest.approx(radius)


@pytest.mark.parametrize(("thickness", "radius", "count"), [(0.16, 0.16, 2), (0.1, 0.1, 3), (0.05, 0.1, 3)])
def test_wide_box_becomes_parallel_capsules_that_together_have_its_width(thickness, radius, count):
    text = f'<worldbody><geom type="box" size="{thickness} 0.3 0.5" pos="1 2 3"/></worldbody>'
    capsules = _approximate_by_capsules(*compiled(text), 0)
    centres = np.array([1, 2, 3]) + np.outer(np.linspace(radius - 0.3, 0.3 - radius, count), (0, 1, 0))
    for capsule, centre in zip(capsules, centres, strict=True):
        assert (*(capsule.end - centre), capsule.radius) == pytest.approx((0, 0, 0.5 - radius, radius))


def test_bodies_belong_to_the_last_hinge_on_their_path_from_the_base():
    text = """<worldbody><geom size="0.9"/>
    <body name="root"><freejoint/><geom size="0.1" mass="1"/>
      <body name="a" pos="1 0 0"><joint name="slide" type="slide"/><joint name="a1"/>
        <joint name="a2" axis="0 1 0"/><geom size="0.2" mass="2"/>
        <body name="b"><geom size="0.3" mass="4"/>
          <body name="c"><joint name="c1"/><geom size="0.4" mass="8"/></body></body></body>
      <body name="d"><joint name="mimic"/><geom size="0.5" mass="16"/>
        <body name="e"><joint name="e1"/><geom size="0.6" mass="32"/></body></body>
    </body></worldbody>"""
    model, data = compiled(text)
    urdf = {"mimic": UrdfJoint(None, Follow("a1", 1, 0)), "c1": UrdfJoint(3.5, None)}
    couplings = {"c1": Follow("a1", 2.0, 0.0)}
    looks = Looks({body: (f"surface {body}",) for body in (0, 1, 3)}, ("a note",))
    tree = _tree("name", model, data, urdf, couplings, looks)
    assert [(joint.name, joint.parent) for joint in tree.joints] == [("a1", -1), ("a2", 0), ("c1", 1), ("e1", -1)]
    assert [joint.speed for joint in tree.joints] == [None, None, 3.5, None]
    assert [joint.follows for joint in tree.joints] == [None, None, couplings["c1"], None]
    assert [part.mass for part in (*tree.parts, tree.base)] == [0.0, 6.0, 8.0, 32.0, 17.0]
    assert tree.parts[0].centre.tolist() == [1, 0, 0]
    surfaces = [part.surfaces for part in (*tree.parts, tree.base)]
    assert surfaces == [(), ("surface 3",), (), (), ("surface 0", "surface 1")]
    assert (tree.name, len(tree.left_out), tree.left_out[-1]) == ("name", 2, "a note")
