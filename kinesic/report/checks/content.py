"""Checks what became of the document: how much of it is performed, and how far its strokes go."""

from math import inf

from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check
from kinesic.report.conditioning import story
from kinesic.report.labels import label_with_id

PATH_LOST = 0.05  # share of a stroke's path
VISIBLE = {"m": 0.02, "deg": 3.0}  # that a path must lose before anybody sees it


def content_checks(performance: Performance) -> list[Check]:
    """Checks the share of behaviours that are performed, and the stroke that lost most of its path."""
    plan = performance.plan
    block = plan.timeline.block
    dropped = [label_with_id(id, block) for id, outcome in plan.keyframes.outcomes.items() if outcome.kind == "dropped"]
    total, found = len(block.behaviours), list[Check]()
    if total:
        where = f"dropped: {', '.join(dropped)}" if dropped else ""
        found.append(Check.of("meaning.performed", 1.0 - len(dropped) / total, 1.0, where))
    losses = [
        (loss.share, f"{loss.part} in {label_with_id(changed.behaviour, block)}")
        for changed in story(performance)
        for loss in changed.losses
        if loss.asked - loss.planned > VISIBLE.get(loss.unit, inf)
    ]
    if any(sync.is_stroke for sync in plan.syncs):
        share, where = max(losses, default=(0.0, ""))
        found.append(Check.of("amplitude.path", share, PATH_LOST, where))
    return found
