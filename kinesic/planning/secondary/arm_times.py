"""Times of strokes and rests of each arm in a planned motion."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np

from kinesic.body.robot import Robot, Side
from kinesic.expressivity.idle import Span
from kinesic.expressivity.keyframes import NO_SUCCESSION, KeyFrames, Succession
from kinesic.motion.condition import Conditioned
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.offset_bumps import CONTROL_LEAD
from kinesic.planning.syncs import list_keyed_syncs

MIN_REST_TIME = 0.03  # [s] shorter standstills of an arm do not count as rests
STILL_THRESHOLD = 5e-5  # [rad] angle change per knot interval below which an arm stands still


@dataclass(frozen=True)
class ArmStroke:
    """Time span of an arm's stroke, with its follow-through delays."""

    id: str  # behaviour id
    begin: float  # [s] performance time
    end: float  # [s] performance time
    behind: float = 0.0  # [s] delay of the whole hand after the other hand
    loose: float = 0.0  # [s] delay of the wrist after the shoulder


@dataclass(frozen=True, eq=False)
class Gap:
    """Time span outside an arm's strokes, with its rests [s]."""

    begin: float
    end: float
    rests: tuple[Span, ...]

    @property
    def return_span(self) -> Span | None:
        """Time span [s] of the return to rest, None without a return."""
        if not self.rests or (len(self.rests) == 1 and self.end < inf):
            return None
        return (self.rests[0][1] if len(self.rests) > 1 else self.begin), self.rests[-1][0]


@dataclass(frozen=True, eq=False)
class ArmCourse:
    """Alternating strokes and gaps of one arm in a block."""

    side: Side
    strokes: Sequence[ArmStroke]  # in time order
    gaps: Sequence[Gap]  # before, between and after the strokes


def find_arm_courses(frames: KeyFrames, motion: Conditioned, robot: Robot) -> Iterator[ArmCourse]:
    """Yield the strokes and gaps of each arm that has a stroke.

    Args:
        frames: of the block.
        motion: through its keys.
        robot: with the arms.
    """
    spans = _find_stroke_spans(frames, motion)
    for side in robot.sides:
        if strokes := _list_strokes(side, spans, frames):
            yield ArmCourse(side, strokes, _find_gaps(motion.trajectory, list(robot.arm(side).joints), strokes))


def _find_stroke_spans(frames: KeyFrames, motion: Conditioned) -> Mapping[str, Span]:
    """Return each behaviour's first and last stroke sync time [s]."""
    strokes_of_side: dict[str, list[float]] = {}
    for behaviour, sync, _, planned in list_keyed_syncs(frames, motion):
        if sync.startswith("stroke"):
            strokes_of_side.setdefault(behaviour, []).append(motion.trajectory.zero + planned)
    return {behaviour: (min(times), max(times)) for behaviour, times in strokes_of_side.items()}


def _list_strokes(side: Side, spans: Mapping[str, Span], frames: KeyFrames) -> list[ArmStroke]:
    """Return the strokes of one arm in time order.

    Overlapping strokes are joined to one without delay.
    """
    strokes_of_side: list[ArmStroke] = []
    for id, (begin, end) in sorted(spans.items(), key=lambda spans: spans[1]):
        if f"{side}_hand" not in frames.uses.get(id, ()):
            continue
        succession: Succession = frames.successions.get(id, NO_SUCCESSION)
        if strokes_of_side and begin <= strokes_of_side[-1].end:
            strokes_of_side[-1] = ArmStroke(id, strokes_of_side[-1].begin, max(end, strokes_of_side[-1].end))
        else:
            strokes_of_side.append(
                ArmStroke(
                    id, begin, end, KNOT_INTERVAL * round(succession.behind_of(side) / KNOT_INTERVAL), succession.loose
                )
            )
    return strokes_of_side


def _find_gaps(motion: Trajectory, joints: list[int], strokes: Sequence[ArmStroke]) -> list[Gap]:
    """Return the gaps before, between and after the strokes of an arm.

    The arm rests before and after the motion, so that an arm without movement has one unlimited rest.
    """
    is_moving = np.abs(np.diff(motion.controls[:, joints], axis=0)).max(axis=1) >= STILL_THRESHOLD
    edges = np.flatnonzero(np.diff(np.concatenate([[False], is_moving, [False]]).astype(np.int8)))
    times = (motion.start + (edges.astype(np.float64) - CONTROL_LEAD) * KNOT_INTERVAL).tolist()
    still = list(zip([-inf, *times[1::2]], [*times[::2], inf], strict=True))
    ends = [(-inf, strokes[0].begin), *((a.end, b.begin) for a, b in pairwise(strokes)), (strokes[-1].end, inf)]
    rests = [tuple((max(a, begin), min(b, end)) for a, b in still) for begin, end in ends]
    return [
        Gap(begin, end, tuple((a, b) for a, b in spans if b - a >= MIN_REST_TIME))
        for (begin, end), spans in zip(ends, rests, strict=True)
    ]
