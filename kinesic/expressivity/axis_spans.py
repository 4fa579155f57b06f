"""Time spans in which head or trunk rotate about each axis."""

from collections.abc import Iterable, Sequence
from itertools import pairwise

from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import Layer, turn_angles

Span = tuple[float, float]  # [s] begin and end
Spans = tuple[Sequence[Span], Sequence[Span], Sequence[Span]]  # torsion, tilt, roll
NO_SPANS: Spans = ((), (), ())  # time spans without rotation about any axis


def axes_used(layers: Iterable[Layer]) -> Spans:
    """Return the time spans [s] of rotation from upright by axis.

    A layer that stays away from upright does not use its axis after the last key.
    """
    spans: tuple[list[Span], list[Span], list[Span]] = ([], [], [])
    for layer in layers:
        for a, b in pairwise(layer):
            for axis, turns in enumerate(zip(turn_angles(a.turn), turn_angles(b.turn), strict=True)):
                if any(turns):
                    spans[axis].append((a.time, b.time))
    return spans


def unused_axes(turn: Turn, used_axes: Spans, span: Span) -> Turn:
    """Zero a rotation's angles about axes used during a time span."""
    return Turn(
        *(0.0 if overlap(spans, span) else angle for angle, spans in zip(turn_angles(turn), used_axes, strict=True))
    )


def overlap(spans: Sequence[Span], span: Span) -> bool:
    """Return whether a time span overlaps any of several other spans."""
    return any(start < span[1] and span[0] < end for start, end in spans)
