import itertools
import math

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.wrist import HandDirection, orient
from kinesic.ik.scalar3 import Rotation, Vector, across, after, dot, rotated, unit

CHAIN = Robot.load().arms["l"]
ARM = linkage_of(CHAIN)
LINK = ARM.links[-1]
PALM: Vector = (0.0, -1.0, 0.0)
REST = (0.0, 0.0, 0.0)


def _agreement(frame: Rotation, wishes: list[HandDirection], angles: tuple[float, ...]) -> float:
    for pivot, angle in zip(LINK.pivots, angles, strict=True):
        frame = after(frame, pivot.axis, angle)
    return sum(dot(rotated(frame, wish.own), wish.wanted) for wish in wishes)


def test_directions_of_a_posture_inside_the_ranges_are_met() -> None:
    random = default_rng(8)
    for _ in range(60):
        angles = random.uniform(CHAIN.lower, CHAIN.upper).tolist()
        before, behind = ARM.walk(angles, 3)[0], ARM.walk(angles, 4)[0]
        wishes = [
            HandDirection("pointing", LINK.along, rotated(behind, LINK.along)),
            HandDirection("palm", PALM, rotated(behind, PALM)),
        ]
        found = orient(LINK, before, wishes, REST)
        assert math.acos(min(1.0, _agreement(before, wishes, found) - 1.0)) < math.radians(0.1)


@pytest.mark.parametrize("named", [("pointing",), ("palm",), ("pointing", "palm")])
def test_no_posture_of_a_fine_grid_agrees_better(named: tuple[str, ...]) -> None:
    random = default_rng(9)
    grid = list(itertools.product(*(np.linspace(p.lower, p.upper, 13).tolist() for p in LINK.pivots)))
    for _ in range(4):
        frame = ARM.walk(random.uniform(CHAIN.lower, CHAIN.upper).tolist(), 3)[0]
        along, aside = (unit(tuple(random.normal(size=3).tolist())) for _ in range(2))
        all_wishes = [
            HandDirection("pointing", LINK.along, along),
            HandDirection("palm", PALM, unit(across(aside, along))),
        ]
        wishes = [wish for wish in all_wishes if wish.name in named]
        found = orient(LINK, frame, wishes, REST)
        assert all(p.lower <= a <= p.upper for p, a in zip(LINK.pivots, found, strict=True))
        assert _agreement(frame, wishes, found) >= max(_agreement(frame, wishes, a) for a in grid) - 1e-3


def test_without_a_wish_the_hand_rests() -> None:
    frame = ARM.walk(CHAIN.rest.tolist(), 3)[0]
    assert orient(LINK, frame, [], (0.1, 0.2, 0.0)) == (0.1, 0.2, 0.0)


def test_a_wish_that_is_already_met_moves_nothing() -> None:
    frame = ARM.walk(CHAIN.rest.tolist(), 3)[0]
    wishes = [HandDirection("pointing", LINK.along, rotated(frame, LINK.along))]
    assert orient(LINK, frame, wishes, REST) == pytest.approx(REST, abs=1e-6)
