import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.sim.factors import NOMINAL, PESSIMISTIC, Factors

ROBOT = Robot.load()


def test_the_factors_of_both_twins_are_pinned():
    assert Factors(stall=1.0, no_load=1.0, friction=1.0, armature=1.0, mass=1.0) == NOMINAL
    assert Factors(stall=0.8, no_load=0.9, friction=1.5, armature=1.3, mass=1.1) == PESSIMISTIC


def test_each_factor_scales_its_own_figure():
    weak = PESSIMISTIC.applied(ROBOT)
    for changed, drive in zip(weak.drives, ROBOT.drives, strict=True):
        assert changed.stall == pytest.approx(0.8 * drive.stall)
        assert changed.no_load == pytest.approx(0.9 * drive.no_load)
        assert changed.frictionloss == pytest.approx(1.5 * drive.frictionloss)
        assert changed.damping == pytest.approx(1.5 * drive.damping)
        assert changed.armature == pytest.approx(1.3 * drive.armature)
        assert changed.servo.mass == pytest.approx(1.1 * drive.servo.mass)
        assert changed.gain == drive.gain
        assert changed.tick == drive.tick
    for changed_segment, segment in zip(weak.skeleton.segments, ROBOT.skeleton.segments, strict=True):
        assert changed_segment.mass == pytest.approx(1.1 * segment.mass)


def test_nominal_changes_nothing():
    same = NOMINAL.applied(ROBOT)
    assert same.drives == ROBOT.drives
    assert np.array_equal(same.skeleton.lower, ROBOT.skeleton.lower)


def test_factors_are_read_from_a_file(tmp_path):
    path = tmp_path / "tired.toml"
    path.write_text("stall = 0.7\nmass = 1.2\n")
    assert Factors.read(path) == Factors(stall=0.7, mass=1.2)


@pytest.mark.parametrize("text", ["stal = 0.7", "stall = 0.0", "mass = -1.0", "mass = 'heavy'", "mass = nan"])
def test_wrong_factors_are_refused(tmp_path, text):
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"wrong\.toml"):
        Factors.read(path)


def test_a_factor_of_zero_is_named():
    with pytest.raises(ValueError, match="factor armature is 0"):
        Factors(armature=0.0)
