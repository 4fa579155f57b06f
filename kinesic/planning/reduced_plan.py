"""Plans of blocks without some of their behaviours.

Hinges add up the movements of several behaviours, and limits change the sum. The motion
without one of them is therefore planned again, not subtracted.
"""

from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache

from kinesic.planning.plan import Plan, plan_block

CACHE_SIZE = 8  # number of cached reduced plans; rejected changes are often requested again


def plan_without(plan: Plan, behaviours: Collection[str]) -> Plan:
    """Plan a block again without some of its behaviours.

    Speech, times and hands of other blocks stay. Behaviours that the plan has dropped remain dropped.

    Args:
        plan: plan of the block.
        behaviours: ids of the behaviours to leave out, required ones included.

    Returns:
        The plan itself without behaviours to leave out.
    """
    return _plan_again(plan, frozenset(behaviours)) if behaviours else plan


@lru_cache(maxsize=CACHE_SIZE)
def _plan_again(plan: Plan, behaviours: frozenset[str]) -> Plan:
    block, timed = plan.timeline.block, {entry.behaviour.id for entry in plan.timeline.timed}
    optional = tuple(replace(behaviour, required=False) for behaviour in block.behaviours)
    dropped = {id: outcome.why for id, outcome in plan.keyframes.outcomes.items() if outcome.kind == "dropped"}
    dropped |= dict.fromkeys(sorted(behaviours), "another block needs its body parts")
    return plan_block(
        replace(block, behaviours=optional),
        plan.setup,
        conditioned=plan.conditioned,
        utterances=plan.utterances,
        busy_hands=plan.busy_hands,
        without={id: why for id, why in dropped.items() if id in timed},
    )
