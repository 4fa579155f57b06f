"""Checks of content: performed behaviours and shortened stroke paths."""

from math import inf

from kinesic.metrics.dry_run import DryRun
from kinesic.report.checks.check import Check
from kinesic.report.labels import label_with_id

MAX_PATH_LOSS = 0.05  # largest accepted shortening of a stroke's path / requested path length
MIN_VISIBLE_LOSSES = {"m": 0.02, "deg": 3.0}  # smallest visible shortening of a stroke's path, by unit


def content_checks(performance: DryRun) -> list[Check]:
    """Check the performed fraction of behaviours and the shortening of stroke paths."""
    plan = performance.plan
    block = plan.timeline.block
    dropped = [label_with_id(id, block) for id, outcome in plan.keyframes.outcomes.items() if outcome.kind == "dropped"]
    total, results = len(block.behaviours), list[Check]()
    if total:
        where = f"dropped: {', '.join(dropped)}" if dropped else ""
        results.append(Check.of("meaning.performed", 1.0 - len(dropped) / total, 1.0, where))
    losses = [
        (loss.fraction, f"{loss.part} in {label_with_id(changed.behaviour, block)}, smaller for lack of time")
        for changed in performance.reference.changes
        for loss in changed.losses
        if loss.asked - loss.planned > MIN_VISIBLE_LOSSES.get(loss.unit, inf)
    ]
    if any(sync.is_stroke for sync in plan.syncs):
        fraction, where = max(losses, default=(0.0, ""))
        results.append(Check.of("amplitude.path", fraction, MAX_PATH_LOSS, where))
    return results
