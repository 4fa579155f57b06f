import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.tools.directions import positive_way

ROBOT = Robot.load()


@pytest.mark.parametrize(
    ("hinge", "words"),
    [
        ("vl5_torsion", "the front of vl5 turns to its left"),
        ("vl5_tilt", "vl5 goes forward"),
        ("vl5_roll", "vl5 goes to its right"),
        ("l_shoulder_flexion", "l_shoulder goes forward"),
        ("l_shoulder_abduct", "l_shoulder goes to its left"),
        ("r_shoulder_abduct", "r_shoulder goes to its right"),
        ("r_elbow_twisting", "the front of r_elbow turns to its right"),
        ("l_sternoclavicular_abduct", "l_sternoclavicular goes up"),
    ],
)
def test_the_positive_way_in_words(hinge: str, words: str):
    assert positive_way(ROBOT, ROBOT.skeleton.joint(hinge)) == words
