"""Chains of coupled joints, and hinges with the motor of their gear."""

import mujoco
import numpy as np
import pytest

from kinesic.sim.importer.couplings import _narrower, _resolve, _sum, find_gears, join_gear
from kinesic.sim.importer.model_tree import Follow, Joint


def test_coupling_chain_is_resolved_to_its_independent_driver():
    follows = {"a": Follow("b", 2.0, 0.1), "b": Follow("c", -0.5, 0.2), "c": Follow("motor", 3.0, 0.0)}
    result = _resolve("a", follows)
    assert result.driver == "motor"
    assert (result.ratio, result.offset) == (pytest.approx(-3.0), pytest.approx(0.5))
    assert _resolve("c", follows) == follows["c"]


@pytest.mark.parametrize(
    "follows",
    [
        {"a": Follow("a", 1.0, 0.0)},
        {"a": Follow("b", 1.0, 0.0), "b": Follow("a", 1.0, 0.0)},
        {"a": Follow("b", 1.0, 0.0), "b": Follow("c", 1.0, 0.0), "c": Follow("b", 1.0, 0.0)},
    ],
)
def test_couplings_in_a_circle_have_no_driver(follows):
    assert _resolve("a", follows) is None


def test_gear_has_the_narrower_range_and_the_summed_friction_of_its_two_joints():
    assert [_narrower(*ends, max) for ends in ((None, None), (None, 1.0), (2.0, None), (1.0, 2.0))] == [None, 1, 2, 2]
    assert _narrower(1.0, 2.0, min) == 1.0
    assert [_sum(*pair) for pair in ((None, None), (None, 1.0), (2.0, None), (1.0, 2.0))] == [None, 1, 2, 3]


def make_joint(name, axis, zero, *values):
    return Joint(name, -1, np.zeros(3), np.array(axis, float), zero, *values, follows=Follow("wheel", 1, 0))


MOTOR = make_joint("wheel", (1, 0, 0), 0.0, -1.0, 2.0, 4.0, 6.0, 8.0, 0.4, 0.2, 0.8)
BARE_MOTOR = make_joint("wheel", (1, 0, 0), 0.0, *[None] * 8)


def values_of(joint):
    names = ("lower", "upper", "effort", "speed", "gain", "armature", "friction", "damping")
    return tuple(getattr(joint, name) for name in names)


def test_values_of_a_gear_motor_are_converted_to_the_limb_by_the_ratio():
    driven = make_joint("limb", (0, 1, 0), 0.5, -9.0, 1.75, None, None, None, 0.01, 0.02, 0.03)
    joint = join_gear(driven, MOTOR, Follow("wheel", -2.0, 0.25))
    assert (joint.name, joint.axis.tolist(), joint.zero, joint.follows) == ("limb", [0, 1, 0], 0.5, None)
    assert values_of(joint) == pytest.approx((-3.75, 1.75, 2.0, 12.0, 2.0, 0.11, 0.12, 0.23))


def test_gear_motor_without_values_leaves_those_of_the_limb():
    driven = make_joint("limb", (0, 1, 0), 0.5, -9.0, 1.75, None, None, None, 0.01, None, 0.03)
    joint = join_gear(driven, BARE_MOTOR, Follow("wheel", 2.0, 0.25))
    assert values_of(joint) == (-9.0, 1.75, None, None, None, 0.01, None, 0.03)


@pytest.mark.parametrize(
    ("ratio", "axis", "zero", "ends"),
    [(1.0, [0, 1, 0], 0.25, (-1.0, 1.5)), (-1.0, [0, -1, 0], -0.25, (-1.0, 2.0)), (1.0 + 9e-7, [0, 1, 0], 0.25, None)],
)
def test_limb_with_a_unit_gear_has_the_name_and_angle_of_its_motor(ratio, axis, zero, ends):
    driven = make_joint("limb", (0, 1, 0), 0.5, -9.0, 1.75, *[None] * 6)
    joint = join_gear(driven, MOTOR, Follow("wheel", ratio, 0.25))
    assert (joint.name, joint.axis.tolist(), joint.zero) == ("wheel", axis, pytest.approx(zero))
    assert ends is None or (joint.lower, joint.upper) == pytest.approx(ends)
    unlimited = join_gear(make_joint("limb", (0, 1, 0), 0.5, *[None] * 8), BARE_MOTOR, Follow("wheel", ratio, 0.25))
    assert (unlimited.lower, unlimited.upper) == (None, None)


def test_limb_with_a_gear_of_slightly_more_than_one_keeps_its_name():
    driven = make_joint("limb", (0, 1, 0), 0.5, *[None] * 8)
    assert join_gear(driven, MOTOR, Follow("wheel", 1.0 + 2e-6, 0.0)).name == "limb"


def geared(wheel='<joint name="wheel"/>', inside="", second=""):
    """Return a model with a gear wheel beside a limb that its joint drives."""
    text = f"""<mujoco><worldbody><body><geom size="0.1"/>
      <body>{wheel}<geom size="0.1"/>{inside}</body>
      <body><joint name="limb"/><geom size="0.1"/><body><joint name="after"/><geom size="0.1"/></body></body>
      {second}</body></worldbody></mujoco>"""
    return mujoco.MjModel.from_xml_string(text)


CARRIED = '<body><joint name="carried"/><geom size="0.1"/></body>'
SECOND = """<body><joint name="second"/><geom size="0.1"/><body><joint name="far"/><geom size="0.1"/></body></body>"""


@pytest.mark.parametrize(
    ("model", "ratio", "fixed"),
    [
        (geared(), 1.0, "wheel"),
        (geared(), 0.0011, "wheel"),
        (geared(), 0.0009, "limb"),
        (geared(), -0.0011, "wheel"),
        (geared(inside=CARRIED), 1.0, "limb"),
        (geared('<joint name="wheel"/><joint name="other" axis="1 0 0"/>'), 1.0, "limb"),
        (geared('<joint name="other" axis="1 0 0"/><joint name="wheel"/>'), 1.0, "limb"),
    ],
)
def test_gear_wheel_that_moves_nothing_else_drives_a_limb(model, ratio, fixed):
    found = find_gears(model, {"limb": Follow("wheel", ratio, 0.0)})
    assert found.fixed == {fixed}
    assert set(found.motors) == ({"limb"} if fixed == "wheel" else set())
    (note,) = found.notes
    driven = f"limb is driven by wheel through a gear, with ratio {ratio:g}"
    held = "limb follows another joint and is held, because a limb continues after it"
    assert note == (driven if fixed == "wheel" else held)


def test_second_limb_on_the_same_gear_wheel_is_held():
    found = find_gears(geared(second=SECOND), {name: Follow("wheel", 1.0, 0.0) for name in ("limb", "second")})
    assert (found.fixed, set(found.motors)) == ({"wheel", "second"}, {"limb"})


def test_coupled_joint_that_carries_only_coupled_joints_needs_no_gear():
    found = find_gears(geared(), {name: Follow("wheel", 1.0, 0.0) for name in ("limb", "after")})
    assert (found.fixed, found.motors, found.notes) == (frozenset(), {}, ())


def test_joint_on_the_same_body_as_its_driver_is_held():
    two = f'<body><joint name="limb"/><joint name="wheel" axis="1 0 0"/><geom size="0.1"/>{CARRIED}</body>'
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{two}</worldbody></mujoco>")
    assert find_gears(model, {"limb": Follow("wheel", 1.0, 0.0)}).fixed == {"limb"}
