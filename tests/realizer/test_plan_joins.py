"""Knots and behaviours with which a block changes to its new plan."""

import numpy as np
import pytest

from kinesic.motion.trajectory import Trajectory
from kinesic.realizer import replan as module
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import MergeFailure, Occupancy
from kinesic.realizer.replan import _join, _PlanSwitch, _split, replan

LIMITS = object()  # placeholder; only passed on to a replaced function
NO_HINGES = np.zeros(4, dtype=np.bool_)


def use(id: str, *roles: str) -> Occupancy:
    return Occupancy(id, frozenset(roles), NO_HINGES, 0.0, 0.1, 0.2, 0.3)


def test_behaviours_in_progress_keep_their_arms_and_give_the_trunk_to_the_new_plan():
    both, arm, nod, beat = (
        use("g", "l_hand", "r_hand", "trunk"),
        use("p", "r_hand"),
        use("n", "sign"),
        use("b", "l_hand", "trunk"),
    )
    performed, finishing = _split([both, arm, nod, beat], {"g", "p", "n"})
    assert [(entry.behaviour, set(entry.roles)) for entry in performed] == [
        ("g", {"trunk"}),
        ("n", {"sign"}),
        ("b", {"l_hand", "trunk"}),
    ]
    assert [(entry.behaviour, set(entry.roles)) for entry in finishing] == [
        ("g", {"l_hand", "r_hand"}),
        ("p", {"r_hand"}),
    ]


@pytest.fixture
def crossings(monkeypatch):
    """Record knots and passed keys of transitions, of which given ones fail."""
    calls, failing, beside = [], set(), {}

    def cross_over(_current, goal, knots, limits, hinge, *, passing):
        assert (limits, hinge) == (LIMITS, 7)
        calls.append((*knots, passing.tolist()))
        if len(calls) - 1 in failing:
            return None
        joined = np.array(goal)
        for row, deviation in beside.items():
            joined[row] += deviation
        return joined

    monkeypatch.setattr(module, "cross_over", cross_over)
    return calls, failing, beside


def join(keys: list[float]):
    current, goal = np.ones(300), np.zeros(300)
    return _join(current, goal, 20, np.array(keys), LIMITS, 7)


def test_hand_joins_the_new_motion_at_one_of_the_next_three_keys(crossings):
    calls, failing, _ = crossings
    failing |= {0, 1, 2}
    assert join([30.5, 40.7, 50.0, 60.0]) is None
    assert calls == [(20, 30, []), (20, 40, [30.5]), (20, 50, [30.5, 40.7])]


def test_trunk_joins_the_new_motion_in_the_shortest_feasible_of_four_durations(crossings):
    calls, failing, _ = crossings
    failing |= {0, 1, 2, 3}
    assert join([]) is None
    assert calls == [(20, 30, []), (20, 40, []), (20, 60, []), (20, 100, [])]


@pytest.mark.parametrize(
    ("failures", "row", "deviation", "joins"),
    [
        (0, 33, 0.099, True),
        (0, 33, 0.1, False),
        (0, 33, -0.2, False),
        (0, 32, 0.5, True),
        (1, 34, 0.2, False),
        (1, 33, 0.2, True),
        (1, 40, 0.2, False),
        (2, 34, 0.2, False),
    ],
)
def test_hand_transition_fails_if_it_deviates_by_0_1_rad_three_knots_after_its_first_key(
    crossings, failures, row, deviation, joins
):
    """Later attempts join the new motion at a first key at knot 30.5."""
    calls, failing, beside = crossings
    failing |= set(range(failures))
    beside[row] = deviation
    result = join([30.5, 40.0, 50.0])
    assert (result is not None) is joins
    assert len(calls) == failures + 1


def test_transition_to_a_new_plan_that_ends_at_the_last_knot_is_accepted(crossings):
    goal = np.ones(31)
    assert _join(np.zeros(31), goal, 20, np.array([30.0]), LIMITS, 7) is not None


@pytest.mark.parametrize(
    ("keeps", "failures", "attempts"),
    [
        (True, [], [set()]),
        (False, [], [{"h"}]),
        (True, ["g", "h"], [set(), {"g", "h"}]),
        (True, ["g", "f"], [set(), {"g", "h"}, {"f", "g", "h"}]),
        (False, ["h"], [{"h"}]),
        (False, ["g", "f", "g"], [{"h"}, {"g", "h"}, {"f", "g", "h"}]),
    ],
)
def test_hands_finish_old_behaviours_one_by_one_until_the_transition_succeeds(monkeypatch, keeps, failures, attempts):
    remaining, tried = list(failures), []

    def attempt(_self, ending):
        tried.append(set(ending))
        return MergeFailure(remaining.pop(0), "why") if remaining else "a merged motion"

    monkeypatch.setattr(_PlanSwitch, "hands_in_progress", {"h"})
    monkeypatch.setattr(_PlanSwitch, "keeps_strokes", keeps)
    monkeypatch.setattr(_PlanSwitch, "attempt", attempt)
    given = []
    monkeypatch.setattr(_PlanSwitch, "of", lambda *changes: given.append(changes) or _PlanSwitch(*[None] * 7))
    still = Trajectory(np.zeros((9, 4)), 0.0)
    playing, others = MergedMotion(still, 0.0, still, (), (), (), ()), (use("o", "sign"),)
    result = replan(still, 0.2, playing, "a plan", others=others)
    assert given == [(still, 0.2, playing, "a plan", others)]
    is_over = bool(failures) and len(failures) == len(attempts)
    assert result == (None if is_over else "a merged motion")
    assert tried == attempts
