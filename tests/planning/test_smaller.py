"""A path that servos cannot follow becomes smaller, which is said."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.perform import facts, plan
from kinesic.planning.smaller import SMALLER_TO_WARN, smaller
from kinesic.planning.syncs import SHIFT_TO_WARN

FACTS = facts()
ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def planned(lexeme: str, seconds: float):
    gesture = f'<gesture id="g" lexeme="{lexeme}" strokeStart="1" stroke="{1 + seconds}"/>'
    return plan(ROOT.format(gesture), FACTS)


def said(made) -> list[str]:
    return [notice.text for notice in made.notices if " % smaller" in notice.text]


@pytest.mark.parametrize("lexeme", ["stir", "crazy"])
def test_a_hurried_circle_shrinks_before_its_stroke_is_late(lexeme):
    made = planned(lexeme, 0.15)
    assert all(abs(sync.planned - sync.asked) <= SHIFT_TO_WARN for sync in made.syncs)
    assert [notice.id for notice in made.notices if " % smaller" in notice.text] == ["b:g"]


def test_a_path_at_ease_is_followed():
    made = planned("stir", 2.0)
    assert not said(made)
    hand = FACTS.robot.skeleton.segment("r_wrist")
    asked, found = (
        FACTS.robot.skeleton.frames(angles).origins[:, hand]
        for angles in (
            np.array([posture.angles for posture in made.postures.postures]),
            made.trajectory.sample(made.motion.planned + made.trajectory.zero)[0],
        )
    )
    soft = [not posture.firm for posture in made.postures.postures]
    assert sum(soft) >= 8
    assert np.linalg.norm(asked - found, axis=1).max() <= 0.01


def test_how_much_smaller_is_the_share_of_the_length():
    made = planned("stir", 2.0)
    middle = np.mean([posture.angles for posture in made.postures.postures if not posture.firm], axis=0)

    def wider(share: float):
        postures = tuple(
            posture if posture.firm else replace(posture, angles=middle + (posture.angles - middle) * share)
            for posture in made.postures.postures
        )
        return smaller(made.timeline.block, postures, made.keyframes, made.motion, FACTS.robot)

    assert not wider(1.0 + SMALLER_TO_WARN / 2)
    assert wider(2.0)
