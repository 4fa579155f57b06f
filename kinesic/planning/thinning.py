"""Thins out a crowd of behaviours that overlap, where to plan them all takes more work than the budget of planning."""

from collections import defaultdict
from collections.abc import Collection
from math import ceil

from kinesic.bml.block import NoticeType
from kinesic.expressivity.keyframes import KeyFrames

Span = tuple[float, float]  # [s] of block time


def thin_out(frames: KeyFrames, about: Collection[str], share: float = 1.0) -> dict[str, str]:
    """Chooses the behaviours of a crowd that are left out.

    A crowd is all that overlaps the given behaviours on a part of the body, directly or by others in between. Of it the
    last of the document go, required ones only after all others. What had found no free hand during that time goes,
    too, unless it is kept as one of the crowd: else it would take the place that has just become free.

    Args:
        frames: of the block.
        about: behaviours that hinder one another.
        share: of the crowd, which is kept, from 0 to 1.

    Returns:
        Why each is left out, by behaviour; empty where none needs to go.
    """
    spans = {one.behaviour.id: (min(one.times.values()), max(one.times.values())) for one in frames.timeline.timed}
    crowd = _crowd(frames, spans, about)
    if len(crowd) < 2:
        return {}
    begin, end = min(spans[id][0] for id in crowd), max(spans[id][1] for id in crowd)
    displaced = {id for id in _displaced(frames) if spans[id][0] < end and spans[id][1] > begin}
    by_priority = sorted(
        (one for one in frames.timeline.block.behaviours if one.id in crowd), key=lambda one: not one.required
    )
    kept = {one.id for one in by_priority[: ceil(share * len(crowd))]}
    why = (
        f"{len(crowd | displaced)} behaviours overlap from {begin:.2f} to {end:.2f} s, more than can be planned "
        f"together with the work that planning may do; {len(kept)} of them are kept, the others need times of their own"
    )
    return dict.fromkeys((crowd | displaced) - kept, why)


def _crowd(frames: KeyFrames, spans: dict[str, Span], about: Collection[str]) -> set[str]:
    """Some behaviours, with all that overlaps them on a part of the body, directly or by others in between."""
    parts = defaultdict[str, list[str]](list)
    for id in sorted(spans, key=lambda id: spans[id]):
        for part in frames.uses.get(id, ()):
            parts[part].append(id)
    groups = [group for row in parts.values() for group in _groups(row, spans)]
    crowd, before = set(about), 0
    while len(crowd) > before:
        before = len(crowd)
        for group in groups:
            if not crowd.isdisjoint(group):
                crowd |= group
    return crowd


def _groups(row: list[str], spans: dict[str, Span]) -> list[set[str]]:
    """Splits the behaviours of one part, in the order of their starts, wherever the part is free."""
    groups: list[set[str]] = []
    until = float("-inf")
    for id in row:
        begin, end = spans[id]
        if begin >= until:
            groups.append(set())
        groups[-1].add(id)
        until = max(until, end)
    return groups


def _displaced(frames: KeyFrames) -> set[str]:
    """Finds the behaviours that were dropped because others have their hands."""
    said = {notice.id for notice in frames.notices if notice.type == NoticeType.IMPOSSIBLE_TO_SCHEDULE}
    own = f"{frames.timeline.block.id}:"
    timed = (one.behaviour.id for one in frames.timeline.timed)
    return {id for id in timed if own + id in said and frames.outcomes[id].kind == "dropped"}
