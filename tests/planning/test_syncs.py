"""Which limit moved a sync point."""

from dataclasses import replace

import numpy as np

from kinesic.controller.performance import Performance
from kinesic.motion.key_times import Bottleneck
from kinesic.planning.syncs import SHIFT_TO_WARN, limit_met, shifts


def test_every_shift_is_warned_and_nothing_else(hurried: Performance, calm: Performance) -> None:
    for performance in (hurried, calm):
        plan = performance.plan
        robot = plan.facts.robot
        notices = shifts(plan.timeline.block, plan.syncs, plan.keyframes, plan.motion, robot)
        moved = [sync for sync in plan.syncs if abs(sync.planned - sync.asked) > SHIFT_TO_WARN]
        assert [notice.text.split()[0] for notice in notices] == [sync.sync for sync in moved]
        assert all(any(name in notice.text for name in robot.skeleton.names) for notice in notices)


def test_of_two_limits_as_near_that_of_the_own_hinge_counts(calm: Performance) -> None:
    plan = calm.plan
    robot = plan.facts.robot
    own, other = robot.joints("r_arm")[2], robot.joints("neck")[0]
    last = len(plan.motion.asked) - 1
    met = {(0, last): Bottleneck(other, "jerk", 2.0), (0, last - 1): Bottleneck(own, "duty", 1.5)}
    motion = replace(plan.motion, bottlenecks=met)
    sync = next(sync for sync in plan.syncs if sync.sync == "stroke")
    assert plan.motion.asked[0] <= sync.asked <= plan.motion.asked[last - 1]
    assert limit_met(sync, plan.keyframes, motion, robot) == met[0, last - 1]
    assert limit_met(sync, plan.keyframes, replace(motion, bottlenecks={}), robot) is None
    late = replace(sync, asked=float(np.max(plan.motion.asked)))
    assert limit_met(late, plan.keyframes, motion, robot) == met[0, last], "the nearer one comes first"
