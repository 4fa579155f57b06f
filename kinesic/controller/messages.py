"""The BML feedback of a performed block, in the order in which it is sent."""

from collections.abc import Iterator

from kinesic.bml.feedback import block_progress, prediction, sync_point_progress, warning
from kinesic.controller.plan import Plan


def feedback(plan: Plan) -> Iterator[str]:
    """Prediction and warnings before anything moves, then the progress."""
    block = plan.timeline.block
    times: dict[str, dict[str, float]] = {}
    for sync in plan.syncs:
        times.setdefault(sync.behaviour, {})[sync.sync] = sync.planned
    start, end = plan.timeline.start, plan.timeline.end
    types = {behaviour.id: behaviour.type for behaviour in block.behaviours}
    yield prediction(block.id, start, end, times, types=types)
    for notice in plan.notices:
        yield warning(notice)
    yield block_progress(block.id, "start", start)
    for sync in plan.syncs:
        yield sync_point_progress(block.id, sync.behaviour, sync.sync, sync.planned, sync.planned)
    yield block_progress(block.id, "end", end)
