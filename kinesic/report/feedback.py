"""The BML feedback of a performed block, in the order in which it is sent."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from kinesic.bml.feedback import prediction, warning
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime
from kinesic.realizer.feedback import Progress, agenda, span, times_of

UNSEEN: Mapping[SyncTime, float | None] = MappingProxyType({})  # nobody measured


def feedback(plan: Plan, lags: Mapping[SyncTime, float | None] = UNSEEN) -> Iterator[str]:
    """Prediction and warnings before anything moves, then the progress.

    Args:
        plan: of the block, whose time 0 is that of the messages.
        lags: how much later than planned the body was seen at sync points [s]; None: it never came.
    """
    block, times = plan.timeline.block, times_of(plan.syncs)
    start, _, end = span(times)
    types = {behaviour.id: behaviour.type for behaviour in block.behaviours}
    yield prediction(block.id, start, end, times, types=types, character=block.character)
    for notice in plan.notices:
        yield warning(notice, character=block.character)
    seen = {(s.behaviour, s.sync): s.planned + lag for s, lag in lags.items() if lag is not None}
    for due in agenda(block.id, times, 0.0, sender=0, character=block.character):
        point = due.told
        measured = seen.get((point.behaviour or "", point.point)) if isinstance(point, Progress) else None
        yield due.xml if measured is None else due.seen(measured).xml
