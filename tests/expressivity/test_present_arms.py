"""Gestures, pointing and postures on a robot with one arm."""

from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import CONFIGS
from kinesic.body.robot import Robot
from kinesic.session.plan import plan_document
from kinesic.session.setup import Setup, set_up

UPPER22_TEXT = (CONFIGS / "robots" / "upper22.toml").read_text(encoding="utf-8")
BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


@pytest.fixture(scope="module")
def left_armed(tmp_path_factory: pytest.TempPathFactory) -> Setup:
    """Provide the setup of upper22 with only its left arm."""
    path: Path = tmp_path_factory.mktemp("robots") / "one.toml"
    path.write_text(UPPER22_TEXT.replace('mirror = { from = "l_", to = "r_" }\n', ""), encoding="utf-8")
    return set_up(Robot.load(path))


def planned(body: str, setup: Setup, folder: Path):
    path = folder / "b.bml"
    path.write_text(BML.format(body), encoding="utf-8")
    return plan_document(path, setup)


@pytest.mark.parametrize(
    ("body", "kind", "why"),
    [
        ('<gesture id="g" lexeme="welcome" mode="RIGHT_HAND" start="1"/>', "substituted", "no right arm; the left arm"),
        ('<gesture id="g" lexeme="large" start="1"/>', "partly", "no right arm; the left arm performs its part"),
        ('<gesture id="g" lexeme="beat" start="1"/>', "realised", ""),
        ('<gesture id="g" lexeme="applause" start="1"/>', "dropped", "no right arm, which applause touches"),
        ('<pointing id="g" target="right" mode="RIGHT_HAND" start="1"/>', "partly", "no right arm"),
        ('<pointing id="g" target="right" start="1"/>', "realised", ""),
    ],
)
def test_gesture_of_a_missing_arm_uses_the_present_arm_or_is_reported(body, kind, why, left_armed, tmp_path):
    plan = planned(body, left_armed, tmp_path)
    outcome = plan.keyframes.outcomes["g"]
    assert outcome.kind == kind
    assert why in outcome.why
    assert plan.keyframes.uses.get("g", frozenset()) <= {"l_hand", "torso", "head"}
    moves = np.ptp(plan.motion.trajectory.controls[:, list(left_armed.robot.arm("l").joints)], axis=0).max()
    assert (moves > 0.2) == (kind != "dropped")
