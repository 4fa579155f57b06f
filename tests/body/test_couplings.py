"""Tests of couplings: reading, mirroring and rotation with the driver hinge."""

from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import SIDES, Robot
from kinesic.body.rotation import rotation_about

TIP_COUPLING = """
[[coupling]]
name = "l_tip"
body = "l_wrist"
axis = [0, 0, 2]
range_deg = [-20, 130]
driver = "l_elbow_flexion"
ratio = 0.5
offset_deg = 10
"""


@pytest.fixture
def coupled(tmp_path: Path):
    """Return a loader of the default robot with additional TOML tables."""

    def load(lines: str = TIP_COUPLING) -> Robot:
        path = tmp_path / "robot.toml"
        path.write_text(f'[robot]\nname = "mine"\nextends = "upper22"\n{lines}', encoding="utf-8")
        return Robot.load(path)

    return load


def test_coupled_angles_are_linear_in_their_driver_and_appended_after_the_free_joints(coupled):
    plain, robot = Robot.load("upper22"), coupled()
    assert robot.skeleton.names == plain.skeleton.names
    assert [c.name for c in robot.skeleton.couplings] == ["l_tip", "r_tip"]
    angles = np.random.default_rng(1).uniform(plain.skeleton.lower, plain.skeleton.upper, (5, 22))
    turned = robot.skeleton.with_couplings(angles)
    np.testing.assert_array_equal(turned[:, :22], angles)
    for column, side in enumerate(SIDES, 22):
        elbow = angles[:, robot.skeleton.joint(f"{side}_elbow_flexion")]
        np.testing.assert_allclose(turned[:, column], np.radians(10) + 0.5 * elbow)


def test_coupled_rotation_is_applied_before_the_joints_of_the_segment(coupled):
    plain, robot = Robot.load("upper22"), coupled()
    angles = plain.skeleton.rest
    free, led = plain.skeleton.frames(angles), robot.skeleton.frames(angles)
    wrist, elbow = plain.skeleton.segment("l_wrist"), plain.skeleton.segment("l_elbow")
    turn = rotation_about(np.array([0.0, 0.0, 1.0]), robot.skeleton.with_couplings(angles)[22])
    hinges = free.rotations[elbow].T @ free.rotations[wrist]
    np.testing.assert_allclose(led.rotations[wrist], free.rotations[elbow] @ turn @ hinges, atol=1e-12)
    np.testing.assert_array_equal(led.origins, free.origins)


def test_skeleton_without_couplings_returns_joint_angles_uncopied():
    skeleton = Robot.load("upper22").skeleton
    assert skeleton.with_couplings(skeleton.rest) is skeleton.rest


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('driver = "l_elbow_flexion"', 'driver = "l_elbow_flexon"', "l_elbow_flexon; did you mean l_elbow_flexion"),
        ('driver = "l_elbow_flexion"', 'driver = "l_tip"', "coupling l_tip: it follows itself; name the hinge"),
        ('body = "l_wrist"', 'body = "l_writs"', r"body of coupling l_tip: no l_writs; did you mean l_wrist\?"),
        ("ratio = 0.5", "ratio = 1.0", r"l_elbow_flexion leads it to 10\.\.145 deg, beyond its range_deg \[-20, 130\]"),
        ("ratio = 0.5", "ratio = -0.5", r"leads it to -57\.5\.\.10 deg, beyond"),
        ("axis = [0, 0, 2]", "axis = [0, 0, 0]", "coupling l_tip: axis is zero"),
        ('name = "l_tip"', 'name = "l_wrist_pivot"', "hinge l_wrist_pivot is described twice"),
        ("ratio = 0.5", "ration = 0.5", r"`ration`.*did you mean ratio\?"),
    ],
)
def test_invalid_coupling_is_refused_with_its_cause(coupled, old: str, new: str, message: str):
    with pytest.raises(ConfigError, match=message):
        coupled(TIP_COUPLING.replace(old, new))


def test_coupling_driven_by_another_coupling_is_refused(coupled):
    chain = TIP_COUPLING.replace("l_tip", "l_end").replace("l_elbow_flexion", "l_tip")
    with pytest.raises(
        ConfigError, match="coupling l_end: it follows l_tip, which follows another one; name the hinge"
    ):
        coupled(TIP_COUPLING + chain)
