import numpy as np
import pytest

from kinesic.body.config import CONFIGS, ConfigError
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_schema import RobotFile
from kinesic.studies.designs.variant import (
    Variable,
    apply_design,
    build,
    draw_designs,
    without_defaults,
    write_design,
)

ROBOT_PATH = CONFIGS / "robots" / "upper22.toml"
ROBOT_FILE = read_robot(ROBOT_PATH, RobotFile)
LONG_ARM_DESIGN = (("l_shoulder.length", "0.33"),)


def test_design_variable_is_parsed_and_its_errors_suggest_a_correction():
    assert Variable.parse("l_elbow.length=0.2, 0.3,0.2") == Variable("l_elbow.length", ("0.2", "0.3"))
    for text, message in (("l_elbow.lenght=1", "did you mean length"), ("l_elbow=1", "write WHAT.FEATURE")):
        with pytest.raises(ConfigError, match=message):
            Variable.parse(text)


def test_designs_are_all_combinations_if_few_and_a_distinct_seeded_sample_if_many():
    small = [Variable("a.length", ("1", "2")), Variable("b.length", ("3",))]
    assert draw_designs(small, 5) == [(("a.length", "1"), ("b.length", "3")), (("a.length", "2"), ("b.length", "3"))]
    large = [Variable(f"{name}.length", tuple("12345")) for name in "abcd"]
    drawn = draw_designs(large, 40, seed=1)
    assert len(set(drawn)) == len(drawn) == 40
    assert drawn == draw_designs(large, 40, seed=1) != draw_designs(large, 40, seed=2)


def test_lengthened_upper_arm_is_heavier_and_longer_on_both_sides():
    was, robot = Robot.load(ROBOT_PATH, calibrated=False), build(ROBOT_FILE, LONG_ARM_DESIGN, ROBOT_PATH)
    assert robot.arm_length == pytest.approx(was.arm_length + 0.11)
    for side in "lr":
        k = robot.skeleton.segment(f"{side}_shoulder")
        assert robot.skeleton.segments[k].mass == pytest.approx(1.5 * was.skeleton.segments[k].mass)
        far = min(capsule.end[2] for capsule in robot.skeleton.segments[k].capsules)
        assert far == pytest.approx(-0.30)
    elbow = robot.skeleton.names.index("r_elbow_flexion")
    assert np.allclose(robot.mounts[elbow].position, [0, 0, -0.312])


def test_name_patterns_select_joints_for_servos_and_reductions():
    robot = build(ROBOT_FILE, (("*_elbow_flexion.servo", "xc430_w240"), ("vl5_roll.reduction", "3")), ROBOT_PATH)
    drives = dict(zip(robot.skeleton.names, robot.drives, strict=True))
    assert drives["l_elbow_flexion"].servo.name == drives["r_elbow_flexion"].servo.name == "xc430_w240"
    assert drives["vl5_roll"].reduction == 3.0
    assert drives["l_shoulder_twisting"].servo.name == "xm430_w210"


def test_design_values_equal_to_the_base_robot_are_dropped():
    assert (
        without_defaults(ROBOT_FILE, (("l_shoulder.length", "0.22"), ("vl5_roll.reduction", "2.50")), ROBOT_PATH) == ()
    )
    assert (
        without_defaults(ROBOT_FILE, (*LONG_ARM_DESIGN, ("vl5_roll.reduction", "2.5")), ROBOT_PATH) == LONG_ARM_DESIGN
    )


@pytest.mark.parametrize(
    ("design", "message"),
    [
        (("l_shouder.length", "0.2"), "no body l_shouder; did you mean l_shoulder"),
        (("vt1.length", "0.2"), "carries 2 others and has no length; bodies with a length: humanoid_root, vl5"),
        (("l_elbow.length", "-1"), "-1 must be a number above 0"),
        (("l_elbow_flexion.servo", "xm430"), "no xm430; did you mean xm430_w"),
        (("l_knee*.servo", "xm430_w210"), "no hinge l_knee"),
        (("l_shoulder_flexion.reduction", "2"), "turns its servo by 440 degrees, more than one turn of 360"),
    ],
)
def test_invalid_design_changes_are_refused(design, message):
    with pytest.raises(ConfigError, match=message):
        build(ROBOT_FILE, (design,), ROBOT_PATH)


def test_written_robot_design_contains_only_changes_and_reads_back_equal(tmp_path):
    design = (*LONG_ARM_DESIGN, ("l_wrist.length", "0.07"), ("vl5_tilt.reduction", "1"))
    text = write_design(ROBOT_FILE, design, name="longer", extends="upper22", heading=["a longer one"])
    (tmp_path / "longer.toml").write_text(text)
    read, built = Robot.load(tmp_path / "longer.toml"), build(ROBOT_FILE, design, ROBOT_PATH)
    assert read.skeleton.zero_frames.origins == pytest.approx(built.skeleton.zero_frames.origins)
    assert read.sites["r_palm"].position == pytest.approx(built.sites["r_palm"].position)
    assert list(read.drives.stall) == list(built.drives.stall)
    assert read.drives[1].reduction == 1.0  # also a default value
    assert "skullbase" not in text
    assert apply_design(ROBOT_FILE, (), ROBOT_PATH) == ROBOT_FILE
