from dataclasses import replace

import numpy as np
import pytest

from kinesic.motion.transition import largest_limit_ratios, widen_limits
from kinesic.realizer.occupancy import MergeFailure, Occupancy, Overlay
from kinesic.realizer.overlay import MAX_LIMIT_RATIO, _cross_over_to, _return_to_rest, add_motions


def test_sum_of_motions_is_projected_onto_limits_where_only_one_control_point_changes(known):
    rest, limits = known.robot.skeleton.rest, widen_limits(known.limits)
    base = np.tile(rest, (40, 1))
    block = base.copy()
    block[20, known.robot.joints("neck")[0]] += 0.05
    assert largest_limit_ratios(block, limits).max() > 1.0
    total = add_motions(Overlay(base, block, rest, 0, (), ()), np.zeros(len(rest), dtype=np.bool_), known, limits)
    assert not isinstance(total, MergeFailure)
    assert largest_limit_ratios(total, limits).max() <= MAX_LIMIT_RATIO


@pytest.mark.parametrize("ready", [0.6, 0.605])
def test_hand_follows_the_next_behaviour_from_the_last_knot_before_it_is_ready(known, ready):
    limits, hinge = widen_limits(known.limits), known.robot.joints("r_arm")[0]
    current, after = np.zeros(100), np.linspace(0.1, 0.2, 100)
    stop = Occupancy("g", frozenset({"r_hand"}), np.ones(22, dtype=np.bool_), 0.0, ready, 0.8, 0.9)
    column = _cross_over_to(current, after, 0.0, stop, limits, hinge)
    np.testing.assert_array_equal(column[60:], after[60:])
    assert np.abs(column[:60] - after[:60]).min() > 0.0


def test_sum_of_motions_is_projected_onto_limits_where_every_control_point_changes(known):
    rest, limits = known.robot.skeleton.rest, widen_limits(known.limits)
    base = np.tile(rest, (40, 1))
    block = base.copy()
    hinge = known.robot.joints("neck")[0]
    block[:, hinge] += 0.02
    block[20, hinge] += 0.05
    assert largest_limit_ratios(block, limits).max() > 1.0
    total = add_motions(Overlay(base, block, rest, 0, (), ()), np.zeros(len(rest), dtype=np.bool_), known, limits)
    assert not isinstance(total, MergeFailure)
    assert largest_limit_ratios(total, limits).max() <= MAX_LIMIT_RATIO


def test_failure_to_return_a_hand_to_rest_names_its_behaviour(known):
    hinge = known.robot.joints("r_arm")[0]
    limits = replace(known.limits, speed=np.full(len(known.limits.speed), 1e-6))
    start = known.robot.skeleton.rest
    coming = np.tile(start, (60, 1))
    base = coming.copy()
    base[:, hinge] += 0.5
    done = Occupancy("g", frozenset({"r_hand"}), np.ones(len(start), dtype=np.bool_), 0.0, 0.1, 0.2, 0.4)
    work = Overlay(base, coming, start, 0, (), ())
    failure = _return_to_rest(base[:, hinge] + 0.3, done, work, "r_hand", limits, hinge)
    assert isinstance(failure, MergeFailure)
    assert (failure.behaviour, failure.why) == ("g", "its hand cannot return to rest within its limits")
