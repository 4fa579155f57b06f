import numpy as np

from kinesic.motion.transition import largest_limit_ratios, widen_limits
from kinesic.realizer.occupancy import MergeFailure, Overlay
from kinesic.realizer.overlay import MAX_LIMIT_RATIO, add_motions


def test_sum_of_motions_is_projected_onto_limits_where_only_one_control_point_changes(known):
    rest, limits = known.robot.skeleton.rest, widen_limits(known.limits)
    base = np.tile(rest, (40, 1))
    block = base.copy()
    block[20, known.robot.joints("neck")[0]] += 0.05
    assert largest_limit_ratios(block, limits).max() > 1.0
    total = add_motions(Overlay(base, block, rest, 0, (), ()), np.zeros(len(rest), dtype=np.bool_), known, limits)
    assert not isinstance(total, MergeFailure)
    assert largest_limit_ratios(total, limits).max() <= MAX_LIMIT_RATIO
