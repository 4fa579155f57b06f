"""Dropping of overlapping behaviours by priority if planning exceeds its budget."""

from collections import defaultdict
from collections.abc import Collection
from math import ceil

from kinesic.bml.block import NoticeType
from kinesic.expressivity.keyframes import KeyFrames

Span = tuple[float, float]  # [s] of block time


def drop_by_priority(frames: KeyFrames, conflicting: Collection[str], kept_fraction: float = 1.0) -> dict[str, str]:
    """Choose overlapping behaviours to drop, with reasons.

    Overlapping behaviours use the same body part at the same time as the given ones, directly or through others. The
    last of the document are dropped first, required ones after all others. Behaviours that had found no free hand
    during that time are dropped, too, unless they are kept: otherwise they would take a place that has just become
    free.

    Args:
        frames: of the block.
        conflicting: conflicting behaviours.
        kept_fraction: fraction to be kept, 0 to 1.

    Returns:
        Reason by behaviour id; empty if nothing needs to be dropped.
    """
    spans = {one.behaviour.id: (min(one.times.values()), max(one.times.values())) for one in frames.timeline.timed}
    overlapping = _find_overlapping(frames, spans, conflicting)
    if len(overlapping) < 2:
        return {}
    begin, end = min(spans[id][0] for id in overlapping), max(spans[id][1] for id in overlapping)
    displaced = {id for id in _displaced(frames) if spans[id][0] < end and spans[id][1] > begin}
    by_priority = sorted(
        (one for one in frames.timeline.block.behaviours if one.id in overlapping), key=lambda one: not one.required
    )
    kept_ids = {one.id for one in by_priority[: ceil(kept_fraction * len(overlapping))]}
    reason = (
        f"{len(overlapping | displaced)} behaviours overlap from {begin:.2f} to {end:.2f} s, more than the planning "
        f"budget allows; {len(kept_ids)} of them are kept, the others need other times"
    )
    return dict.fromkeys((overlapping | displaced) - kept_ids, reason)


def _find_overlapping(frames: KeyFrames, spans: dict[str, Span], conflicting: Collection[str]) -> set[str]:
    """Return conflicting behaviours and all that overlap them on a body part.

    The overlap may be direct or through other behaviours.
    """
    parts = defaultdict[str, list[str]](list)
    for id in sorted(spans, key=lambda id: spans[id]):
        for part in frames.uses.get(id, ()):
            parts[part].append(id)
    groups = [group for row in parts.values() for group in _groups(row, spans)]
    overlapping, before = set(conflicting), 0
    while len(overlapping) > before:
        before = len(overlapping)
        for group in groups:
            if not overlapping.isdisjoint(group):
                overlapping |= group
    return overlapping


def _groups(row: list[str], spans: dict[str, Span]) -> list[set[str]]:
    """Group one body part's behaviours that overlap in time.

    The behaviours in `row` are in the order of their starts.
    """
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
    """Return the behaviours that were dropped for lack of a free hand."""
    noticed = {notice.id for notice in frames.notices if notice.type == NoticeType.IMPOSSIBLE_TO_SCHEDULE}
    prefix = f"{frames.timeline.block.id}:"
    timed = (one.behaviour.id for one in frames.timeline.timed)
    return {id for id in timed if prefix + id in noticed and frames.outcomes[id].kind == "dropped"}
