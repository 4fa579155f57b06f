"""One attempt to change a running block's plan, with stubbed steps."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer import replan as module
from kinesic.realizer.occupancy import MergeFailure, Overlay
from kinesic.realizer.replan import _PlanSwitch

from .plan_switches import HINGE_COUNT, NECK, switched, use

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="c">{}</bml>'


@pytest.fixture(scope="module")
def nod(known):
    return plan_quickly(parse(ROOT.format('<head id="n" lexeme="NOD" stroke="0"/>')), known)


@pytest.fixture
def switch(nod):
    return partial(switched, nod)


@pytest.fixture
def attempts(monkeypatch):
    """Changeable results of each stubbed step of an attempt, with its arguments."""
    results = {
        "_without_block": np.zeros((150, HINGE_COUNT)),
        "overlay_motions": np.ones((160, HINGE_COUNT)),
        "_catch_up": "caught up",
        "find_conflict": None,
        "_result": "a merged motion",
    }
    given = {}

    def step(name, is_method):
        def take(*arguments):
            given[name] = arguments[is_method:]
            return results[name]

        return take

    for name in results:
        owner, is_method = (_PlanSwitch, 1) if name.startswith("_") else (module, 0)
        monkeypatch.setattr(owner, name, step(name, is_method))
    return results, given


def test_behaviours_in_progress_stay_in_the_running_motion_until_they_relax(switch, attempts, nod, known):
    old = [use("g", "r_hand", relax=0.5), use("h", "l_hand", relax=0.2), use("k", "l_hand", relax=0.5)]
    others = [use("o", "sign", relax=0.3), use("p", "look", relax=0.1)]
    late = 0.15
    moved = switch(playing_occupancy=old, others=others, playing_zero=nod.trajectory.zero + late)
    vars(moved)["new_occupancy"] = (use("g", "r_hand", "trunk"), use("n", "sign"))
    assert moved.attempt({"g", "h"}) == "a merged motion"
    _, given = attempts
    (count,) = given["_without_block"]
    (work, setup, limits) = given["overlay_motions"]
    assert isinstance(work, Overlay)
    assert count == len(work.coming) == moved._count
    np.testing.assert_array_equal(work.coming[15 : len(nod.trajectory.controls)], nod.trajectory.controls[:-15])
    np.testing.assert_array_equal(work.start, nod.trajectory.controls[0])
    assert work.base is attempts[0]["_without_block"]
    assert (work.cut, setup) == (20, known)
    assert limits.jerk[0] > known.limits.jerk[0]
    assert [entry.behaviour for entry in work.holding] == ["o", "g"]
    assert [(entry.behaviour, set(entry.roles)) for entry in work.performed] == [("g", {"trunk"}), ("n", {"sign"})]
    assert [(entry.behaviour, set(entry.roles)) for entry in work.finishing] == [("g", {"r_hand"})]
    assert given["find_conflict"] == (work, "caught up", known)
    controls, ending, occupancy = given["_result"]
    assert (controls, ending) == ("caught up", {"g", "h"})
    assert [entry.behaviour for entry in occupancy] == ["g", "g", "n"]
    assert set(occupancy[0].roles) == {"r_hand"}


@pytest.mark.parametrize(("knot", "count"), [(20, 160), (77, 160), (78, 161)])
def test_target_motion_of_a_plan_change_extends_at_least_83_knots_beyond_the_change(switch, attempts, knot, count):
    assert switch(knot=knot).attempt(set()) == "a merged motion"
    (goal,) = attempts[1]["_catch_up"]
    assert len(goal) == count
    np.testing.assert_array_equal(goal, 1.0)


@pytest.mark.parametrize(
    ("step", "result", "failure"),
    [
        ("_without_block", None, MergeFailure("", "the trunk cannot follow other blocks within its limits")),
        ("overlay_motions", MergeFailure("g", "no time"), MergeFailure("g", "no time")),
        ("_catch_up", None, MergeFailure("", "a hinge cannot catch up")),
        ("find_conflict", MergeFailure("n", "collides"), MergeFailure("n", "collides")),
    ],
)
def test_plan_change_fails_with_the_reason_of_the_failed_step(switch, attempts, step, result, failure):
    attempts[0][step] = result
    assert switch().attempt(set()) == failure


def test_new_gaze_also_occupies_the_hinges_of_the_gaze_that_it_supersedes(switch, attempts, known):
    neck = np.arange(HINGE_COUNT) == NECK
    held = replace(use("a", "look", offset=np.zeros(HINGE_COUNT)), hinges=neck)
    moved = switch(others=[held])
    vars(moved)["new_occupancy"] = (use("b", "look"),)
    moved.attempt(set())
    (entry,) = attempts[1]["_result"][2]
    np.testing.assert_array_equal(entry.hinges, neck)
