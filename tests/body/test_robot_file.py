from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.robot_file import servo_models

UPPER22_TEXT = Robot.load().path.read_text(encoding="utf-8")
ELBOW_TEXT = '[[hinge]]\nname = "l_elbow_flexion"'
ROLL_TEXT = '[[hinge]]\nname = "vl5_roll"                   # + leans right; belt 2.5:1'
ROLL_AXIS_TEXT = f'{ROLL_TEXT}\nbody = "vl5"\naxis = [1, 0, 0]'


@pytest.fixture
def changed(tmp_path: Path):
    """Return a loader of the default robot file with one text replaced."""

    def load(old: str, new: str) -> Robot:
        assert UPPER22_TEXT.count(old) == 1, old
        path = tmp_path / "robot.toml"
        path.write_text(UPPER22_TEXT.replace(old, new), encoding="utf-8")
        return Robot.load(path)

    return load


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("clearance = 0.010", "clearance = -5.0", r"\[collision\] clearance is -5 m.*must be 0 or more"),
        ("[collision]\nclearance", "[collision]\nclearence", r"`clearence`.*did you mean clearance\?"),
        ("range_deg = [0, 135]", "range = [0, 135]", r"`range`.*did you mean range_deg\?"),
        ("range_deg = [0, 135]", "range_deg = [135, 0]", r"l_elbow_flexion: range_deg is \[135\.0, 0\.0\]"),
        ("range_deg = [0, 135]", "range_deg = [0, nan]", r"hinge\[10\]\.range_deg\[1\] is nan, must be a finite"),
        ("range_deg = [0, 135]", "range_deg = [0]", "length 2, got 1"),
        ("l_elbow_flexion = 18", "l_elbow_flexion = 140", r"\[rest\] l_elbow_flexion is 140\.0 deg, outside \[0\.0"),
        ("l_elbow_flexion = 18", "l_elbo_flexion = 18", r"\[rest\]: no l_elbo_flexion; did you mean l_elbow_flexion"),
        (
            'servo = "xm540_w150"\nmount = { body = "humanoid_root"',
            'servo = "xm540"\nmount = { body = "humanoid_root"',
            r"servo of hinge vl5_torsion: no xm540; did you mean xm540_w",
        ),
        (ELBOW_TEXT, '[[hinge]]\nname = "l_shoulder_twisting"', "hinge l_shoulder_twisting is described twice"),
        ('[[body]]\nname = "skullbase"', '[[body]]\nname = "vt1"', "body vt1 is described twice"),
        ('parent = "humanoid_root"', 'parent = "root"', r"parent of body vl5: no root"),
        (
            ROLL_AXIS_TEXT,
            ROLL_AXIS_TEXT.replace("[1, 0, 0]", "[0, 0, 0]"),
            "vl5_roll: axis is zero, must be a direction",
        ),
        ("count = 2", "count = 0", "vl5_tilt: count must be at least 1"),
        ("reduction = 2.5", "reduction = -2.5", "vl5_roll: .*reduction above 0"),
        ('torso = ["vl5"]', 'torso = ["vl6"]', r"chain torso: no vl6; did you mean vl5\?"),
        ('l_arm = ["l_s', 'left_arm = ["l_s', r"\[chains\] has neither l_arm nor r_arm"),
        ("l_palm = {", "l_hand = {", r"\[sites\] needs: no l_palm"),
        ('eyes = { body = "skullbase"', 'eyes = { body = "skull"', r"site eyes: no skull; did you mean skullbase\?"),
        ('pair = ["vl5", "skullbase"]', 'pair = ["vl5", "head"]', r"\[collision\] exclude: no head"),
    ],
)
def test_invalid_robot_file_error_is_one_line_with_the_file_and_the_cause(changed, old: str, new: str, message: str):
    with pytest.raises(ConfigError, match=message) as caught:
        changed(old, new)
    assert "robot.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_robot_file_with_one_side_describes_a_robot_with_one_arm(changed):
    robot = changed('mirror = { from = "l_", to = "r_" }\n', "")
    assert robot.sides == ("l",)
    arm, absent = robot.arm("l"), robot.arm("r")
    assert (absent.joints, len(absent.segments)) == ((), len(arm.segments))
    places, origins = robot.skeleton.zero_frames.origins, [1.0, -1.0, 1.0]
    np.testing.assert_allclose(places[absent.wrist], places[arm.wrist] * origins)
    segments = [segment for segment in robot.skeleton.segments if segment.name in absent.segments]
    assert all(segment.mass == 0.0 and not segment.capsules for segment in segments)
    assert not absent.bodies & set(robot.bodies)


def test_hinges_are_sorted_by_body_order(tmp_path: Path):
    head, *hinges = UPPER22_TEXT.split("[[hinge]]")
    last, tail = hinges[-1].split("# Bodies from the root outward")
    path = tmp_path / "robot.toml"
    arms_first = [*hinges[6:-1], last, *hinges[:6]]
    path.write_text("[[hinge]]".join([head, *arms_first]) + "\n# Bodies from the root outward" + tail, encoding="utf-8")
    assert Robot.load(path).skeleton.names == Robot.load().skeleton.names


def test_hinge_axis_is_normalised(changed):
    robot = changed(ROLL_AXIS_TEXT, ROLL_AXIS_TEXT.replace("[1, 0, 0]", "[2, 0, 0]"))
    assert robot.skeleton.hinges[2].axis.tolist() == [1, 0, 0]


def test_servo_model_numbers_are_unique_except_of_both_sts3215_variants():
    models = servo_models()
    assert set(models) >= {"xm540_w270", "xm540_w150", "xm430_w210", "xc430_w240", "xc330_t288", "xc330_t181"}
    assert all(model.name == name for name, model in models.items())
    shared = {model.model for model in models.values() if model.name.startswith("sts3215")}
    assert len(shared) == 1, "one number for both voltages of the STS3215"
    assert len({model.model for model in models.values()}) == len(models) - 1


def test_robot_file_with_more_than_500_bodies_is_refused(tmp_path: Path):
    path = tmp_path / "centipede.toml"
    body = '[[body]]\nname = "b{}"\nparent = ""\npos = [0, 0, 0]\nmass = 1.0\ncapsules = []\n'
    rest = "[robot]\nname = 'c'\n[chains]\n[sites]\n[collision]\nclearance = 0.01\n"
    path.write_text("hinge = []\n" + rest + "".join(body.format(k) for k in range(501)), encoding="utf-8")
    with pytest.raises(ConfigError, match="501 bodies, at most 500 are allowed"):
        Robot.load(path)
