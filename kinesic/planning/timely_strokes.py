"""Smaller or weaker gestures near people, so that strokes are in time.

A policy of contacts slows a gesture. If its stroke becomes late, less amplitude or less power is tried first.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from kinesic.bml.block import Block, Manner, Notice, NoticeType, find_modality
from kinesic.planning.plan import Plan

MAX_LATENESS = 0.1  # [s] lateness of a stroke up to which its gesture is not changed
MIN_GAIN = 0.05  # [s] smallest reduction of the largest latenesses, summed over gestures, that justifies a change


@dataclass(frozen=True)
class Reduction:
    """Parameter of expressivity with which a gesture needs less velocity."""

    spatial: float | None = None  # size of the gesture; None: unchanged
    power: float | None = None  # acceleration of its stroke; None: unchanged

    def apply(self, manner: Manner) -> Manner:
        """Return the expressivity of a gesture with the reduced parameter."""
        spatial, power = (
            old if new is None else new for old, new in ((manner.spatial, self.spatial), (manner.power, self.power))
        )
        return replace(manner, spatial=spatial, power=power)

    def __str__(self) -> str:
        """Return the parameter with its value."""
        return " and ".join(f"{name} {value:g}" for name, value in vars(self).items() if value is not None)


TRIED_REDUCTIONS = (Reduction(spatial=-1.0), Reduction(power=-1.0))  # tried in this order


def keep_strokes_in_time(plan: Plan, replan: Callable[[Block], Plan]) -> Plan:
    """Replan a block with reduced gestures if their strokes are late.

    The plan with the least lateness is returned. A notice names each reduced gesture.

    Args:
        plan: first plan.
        replan: plans a changed block in the same way.
    """
    best, block, seconds = plan, plan.timeline.block, plan.seconds
    late = find_late_gestures(plan)
    if plan.setup.policy is None or not late:
        return plan
    reduced: dict[str, Reduction] = {}
    causes = dict(late)  # lateness [s] of each gesture before it was reduced
    for reduction in TRIED_REDUCTIONS:
        attempt = reduced | dict.fromkeys(late, reduction)
        other = replan(_reduce(block, attempt))
        seconds += other.seconds
        is_better = _total_lateness(other) < _total_lateness(best) - MIN_GAIN
        if is_better and _count_dropped(other) <= _count_dropped(best):
            best, reduced, late = other, attempt, find_late_gestures(other)
            causes = late | causes
        if not late:
            break
    notices = tuple(_notice(block, name, reduction, causes[name]) for name, reduction in reduced.items())
    return replace(best, notices=(*notices, *best.notices), seconds=seconds)


def find_late_gestures(plan: Plan) -> dict[str, float]:
    """Return the lateness [s] of gestures later than `MAX_LATENESS`."""
    return {name: lateness for name, lateness in _list_lateness(plan).items() if lateness > MAX_LATENESS}


def _list_lateness(plan: Plan) -> dict[str, float]:
    """Return the largest lateness [s] of the strokes of each gesture."""
    gestures = {b.id for b in plan.timeline.block.behaviours if find_modality(b.action) == "gesture"}
    lateness: dict[str, float] = {}
    for sync in plan.syncs:
        if sync.is_stroke and sync.behaviour in gestures:
            late = max(0.0, sync.planned - sync.requested)
            lateness[sync.behaviour] = max(late, lateness.get(sync.behaviour, 0.0))
    return lateness


def _total_lateness(plan: Plan) -> float:
    return sum(_list_lateness(plan).values())


def _count_dropped(plan: Plan) -> int:
    return sum(outcome.kind == "dropped" for outcome in plan.keyframes.outcomes.values())


def _reduce(block: Block, reduced: Mapping[str, Reduction]) -> Block:
    behaviours = (
        replace(behaviour, manner=reduced.get(behaviour.id, Reduction()).apply(behaviour.manner))
        for behaviour in block.behaviours
    )
    return replace(block, behaviours=tuple(behaviours))


def _notice(block: Block, name: str, reduction: Reduction, lateness: float) -> Notice:
    text = f"performed with {reduction}, because its stroke would be {lateness:.2f} s late near people"
    return Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{name}", text)
