import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import Link, Pivot, linkage_of
from kinesic.ik.scalar3 import IDENTITY_ROTATION, Rotation, Vector, across, after, dot, rotated, unit

from ...reference.ik import wrist
from ...reference.ik.wrist import TOLERANCE, HandDirection, direction_errors, orient
from ...reference.ik.wrist import _best as best

ARM_CHAIN = Robot.load().arms["l"]  # chain of the left arm
ARM_LINKAGE = linkage_of(ARM_CHAIN)  # linkage of the left arm
HAND_LINK = ARM_LINKAGE.links[-1]  # bone and hinges of the hand
PALM_NORMAL: Vector = (0.0, -1.0, 0.0)  # unit normal of the palm in the hand's frame
REST_ANGLES = (0.0, 0.0, 0.0)  # [rad] rest angles of three wrist hinges


def _agreement(frame: Rotation, wishes: list[HandDirection], angles: tuple[float, ...]) -> float:
    for pivot, angle in zip(HAND_LINK.pivots, angles, strict=True):
        frame = after(frame, pivot.axis, angle)
    return sum(dot(rotated(frame, wish.own), wish.wanted) for wish in wishes)


def test_wrist_solution_meets_feasible_hand_directions() -> None:
    random = default_rng(8)
    for _ in range(60):
        angles = random.uniform(ARM_CHAIN.lower, ARM_CHAIN.upper).tolist()
        before, behind = ARM_LINKAGE.walk(angles, 3)[0], ARM_LINKAGE.walk(angles, 4)[0]
        wishes = [
            HandDirection("pointing", HAND_LINK.along, rotated(behind, HAND_LINK.along)),
            HandDirection("palm", PALM_NORMAL, rotated(behind, PALM_NORMAL)),
        ]
        result = orient(HAND_LINK, before, wishes, REST_ANGLES)
        assert math.acos(min(1.0, _agreement(before, wishes, result) - 1.0)) < math.radians(0.1)


@pytest.mark.parametrize("named", [("pointing",), ("palm",), ("pointing", "palm")])
def test_wrist_solution_has_no_larger_error_than_postures_on_a_grid(named: tuple[str, ...]) -> None:
    random = default_rng(9)
    grid = list(itertools.product(*(np.linspace(p.lower, p.upper, 13).tolist() for p in HAND_LINK.pivots)))
    for _ in range(4):
        frame = ARM_LINKAGE.walk(random.uniform(ARM_CHAIN.lower, ARM_CHAIN.upper).tolist(), 3)[0]
        along, aside = (unit(tuple(random.normal(size=3).tolist())) for _ in range(2))
        all_wishes = [
            HandDirection("pointing", HAND_LINK.along, along),
            HandDirection("palm", PALM_NORMAL, unit(across(aside, along))),
        ]
        wishes = [wish for wish in all_wishes if wish.name in named]
        result = orient(HAND_LINK, frame, wishes, REST_ANGLES)
        assert all(p.lower <= a <= p.upper for p, a in zip(HAND_LINK.pivots, result, strict=True))
        assert _agreement(frame, wishes, result) >= max(_agreement(frame, wishes, a) for a in grid) - 1e-3


def test_wrist_solution_is_a_coordinatewise_optimum() -> None:
    random = default_rng(10)
    for _ in range(12):
        frame = ARM_LINKAGE.walk(random.uniform(ARM_CHAIN.lower, ARM_CHAIN.upper).tolist(), 3)[0]
        along, aside = (unit(tuple(random.normal(size=3).tolist())) for _ in range(2))
        wishes = [
            HandDirection("pointing", HAND_LINK.along, along),
            HandDirection("palm", PALM_NORMAL, unit(across(aside, along))),
        ]
        result = orient(HAND_LINK, frame, wishes, REST_ANGLES)
        height = _agreement(frame, wishes, result)
        for k, pivot in enumerate(HAND_LINK.pivots):
            for step in (-0.02, 0.02):
                aside_of = [angle + step * (j == k) for j, angle in enumerate(result)]
                if pivot.lower <= aside_of[k] <= pivot.upper:
                    assert _agreement(frame, wishes, tuple(aside_of)) < height


def test_wrist_stays_at_rest_without_requested_directions() -> None:
    frame = ARM_LINKAGE.walk(ARM_CHAIN.rest.tolist(), 3)[0]
    assert orient(HAND_LINK, frame, [], (0.1, 0.2, 0.0)) == (0.1, 0.2, 0.0)


def test_wrist_is_unchanged_if_directions_are_already_met() -> None:
    frame = ARM_LINKAGE.walk(ARM_CHAIN.rest.tolist(), 3)[0]
    wishes = [HandDirection("pointing", HAND_LINK.along, rotated(frame, HAND_LINK.along))]
    assert orient(HAND_LINK, frame, wishes, REST_ANGLES) == pytest.approx(REST_ANGLES, abs=1e-6)


def one_hinge(lower: float, upper: float) -> Link:
    """Make a hand with one hinge about z."""
    return Link((Pivot((0.0, 0.0, 1.0), lower, upper, 0.0),), (0.1, 0.0, 0.0), (1.0, 0.0, 0.0), 0.1, 0)


def level(angle: float) -> Vector:
    """Return the unit vector at an angle in the xy plane."""
    return math.cos(angle), math.sin(angle), 0.0


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        (0.7, 0.7),
        (-2.8, -2.8),
        (1.0, 1.0),
        (1.3, 1.0),
        (2.15, 1.0),  # 1.15 from the upper stop, and by the back 1.23 from the lower one ...
        (2.25, -2.9),  # ... and here 1.25 and 1.13
        (3.0, -2.9),
    ],
)
def test_one_axis_wrist_turns_to_the_direction_or_the_nearer_limit(wanted: float, found: float) -> None:
    wishes = [HandDirection("pointing", level(0.0), level(wanted))]
    assert orient(one_hinge(-2.9, 1.0), IDENTITY_ROTATION, wishes, (0.0,)) == pytest.approx((found,), abs=1e-3)


@pytest.mark.parametrize(("rest", "found"), [(-0.5, (-1.0, -1.0)), (0.5, (1.0, 1.0))])
def test_wrist_rest_posture_decides_between_equal_solutions(rest: float, found: tuple[float, float]) -> None:
    """Use two hinges about one axis, with limits equally near the target."""
    hinge = one_hinge(-1.0, 1.0)
    twice = replace(hinge, pivots=hinge.pivots * 2)
    wishes = [HandDirection("pointing", (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))]
    assert orient(twice, IDENTITY_ROTATION, wishes, (rest, 0.0)) == found


@pytest.mark.parametrize(("rest", "rounds"), [(0.0, 1), (-TOLERANCE, 1), (-2 * TOLERANCE, 2), (-0.5, 2)])
def test_wrist_search_ends_after_a_round_with_change_within_the_tolerance(
    rest: float, rounds: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Use a hinge limit that the first round reaches."""
    looked = []
    monkeypatch.setattr(wrist, "_best", lambda *asked: (looked.append(asked), best(*asked))[1])
    wishes = [HandDirection("pointing", level(0.0), level(1e-3))]
    assert orient(one_hinge(-2.0, 0.0), IDENTITY_ROTATION, wishes, (rest,)) == (0.0,)
    assert len(looked) == rounds


def test_wrist_divides_the_error_equally_between_conflicting_directions() -> None:
    wishes = [HandDirection("a", level(0.0), level(0.2)), HandDirection("b", level(1.5), level(1.5 + 0.6))]
    assert orient(one_hinge(-2.0, 2.0), IDENTITY_ROTATION, wishes, (0.0,)) == pytest.approx((0.4,), abs=1e-3)


def test_wrist_ignores_directions_along_its_axis() -> None:
    own, wanted = unit((1.0, 0.0, 3.0)), unit((math.cos(0.5), math.sin(0.5), 3.0))
    wishes = [HandDirection("a", own, wanted), HandDirection("b", (0.0, 0.0, 1.0), unit((1.0, 0.0, 1.0)))]
    assert orient(one_hinge(-2.0, 2.0), IDENTITY_ROTATION, wishes, (0.0,)) == pytest.approx((0.5,), abs=2e-3)


@pytest.mark.parametrize("rest", [(0.4, 0.0, 0.0), (-1.2, 0.0, 0.0)])
def test_wrist_hinges_without_effect_on_the_directions_stay_at_rest(rest: tuple[float, float, float]) -> None:
    """Use a hand along the axis of its first hinge."""
    wishes = [HandDirection("pointing", HAND_LINK.along, HAND_LINK.along)]
    assert orient(HAND_LINK, IDENTITY_ROTATION, wishes, rest) == pytest.approx(rest, abs=1e-6)


def test_requested_directions_override_the_wrist_rest_posture() -> None:
    wishes = [HandDirection("pointing", level(0.0), level(1.9))]
    (result,) = orient(one_hinge(-2.0, 2.0), IDENTITY_ROTATION, wishes, (-1.0,))
    assert result == pytest.approx(1.9 - math.atan(2e-4 * math.sin(2.9)), abs=1e-5)  # and no more than that back


@pytest.mark.parametrize("turn", [0.0, 1.0, -2.5])
def test_wrist_solution_accounts_for_the_orientation_of_the_forearm(turn: float) -> None:
    """Give directions in the base frame, which differs from the forearm's."""
    wishes = [HandDirection("pointing", level(0.0), level(turn + 0.3))]
    frame = after(IDENTITY_ROTATION, (0.0, 0.0, 1.0), turn)
    assert orient(one_hinge(-1.0, 1.0), frame, wishes, (0.0,)) == pytest.approx((0.3,), abs=1e-3)


def test_reported_wrist_direction_errors_are_angles_to_the_requested_directions() -> None:
    frame = after(IDENTITY_ROTATION, (0.0, 0.0, 1.0), 0.5)
    wishes = [
        HandDirection("met", level(0.0), level(0.5)),
        HandDirection("aside", level(0.0), level(-0.7)),
        HandDirection("opposite", level(0.0), level(0.5 + math.pi)),
        HandDirection("longer by rounding", (1.0 + 1e-12, 0.0, 0.0), level(0.5)),
        HandDirection("longer, and opposite", (-1.0 - 1e-12, 0.0, 0.0), level(0.5)),
    ]
    result = direction_errors(frame, wishes)
    assert list(result) == [wish.name for wish in wishes]
    assert list(result.values()) == pytest.approx([0.0, 1.2, math.pi, 0.0, math.pi], abs=1e-7)
