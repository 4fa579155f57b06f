"""When each arm does its strokes in a planned motion, and when it stands still between them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np

from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.idle import Span
from kinesic.expressivity.keyframes import NO_SUCCESSION, KeyFrames, Succession
from kinesic.motion.condition import Conditioned
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.secondary.swells import CONTROL_LEAD
from kinesic.planning.syncs import on_keys

LEAST_REST = 0.03  # [s]
STILL_ARM = 5e-5  # [rad] from knot to knot


@dataclass(frozen=True)
class ArmStroke:
    """The span in which an arm has to be where its behaviour asks, and by how much its hand and wrist lag."""

    id: str  # of the behaviour
    begin: float  # [s]
    end: float  # [s]
    behind: float = 0.0  # [s]
    loose: float = 0.0  # [s]


@dataclass(frozen=True, eq=False)
class Gap:
    """The time of an arm before, between or after strokes, and when it stands still in it [s]."""

    begin: float
    end: float
    rests: tuple[Span, ...]

    @property
    def way_home(self) -> Span | None:
        """From the hold after a stroke, or its end, to where the arm stands still next; None: it goes on at once."""
        if not self.rests or (len(self.rests) == 1 and self.end < inf):
            return None
        return (self.rests[0][1] if len(self.rests) > 1 else self.begin), self.rests[-1][0]


@dataclass(frozen=True, eq=False)
class ArmCourse:
    """The strokes of one arm through a block, and the gaps between them."""

    side: Side
    strokes: Sequence[ArmStroke]  # in time order
    gaps: Sequence[Gap]  # before, between and after them


def arm_courses(frames: KeyFrames, motion: Conditioned, robot: Robot) -> Iterator[ArmCourse]:
    """Finds what arms do through a block; those without a stroke do nothing.

    Args:
        frames: of the block.
        motion: through its keys.
        robot: whose arms they are.
    """
    spans = _stroke_spans(frames, motion)
    for side in SIDES:
        if strokes := _strokes(side, spans, frames):
            yield ArmCourse(side, strokes, _gaps(motion.trajectory, list(robot.arm(side).joints), strokes))


def _stroke_spans(frames: KeyFrames, motion: Conditioned) -> Mapping[str, Span]:
    """Finds the span from the first to the last stroke point of each behaviour [s]."""
    found: dict[str, list[float]] = {}
    for behaviour, sync, _, planned in on_keys(frames, motion):
        if sync.startswith("stroke"):
            found.setdefault(behaviour, []).append(motion.trajectory.zero + planned)
    return {behaviour: (min(times), max(times)) for behaviour, times in found.items()}


def _strokes(side: Side, spans: Mapping[str, Span], frames: KeyFrames) -> list[ArmStroke]:
    """Lists the strokes of one arm in time order; strokes that overlap are joined to one that does not lag."""
    found: list[ArmStroke] = []
    for id, (begin, end) in sorted(spans.items(), key=lambda row: row[1]):
        if f"{side}_hand" not in frames.uses.get(id, ()):
            continue
        asked: Succession = frames.successions.get(id, NO_SUCCESSION)
        if found and begin <= found[-1].end:
            found[-1] = ArmStroke(id, found[-1].begin, max(end, found[-1].end))
        else:
            found.append(ArmStroke(id, begin, end, STEP * round(asked.behind_of(side) / STEP), asked.loose))
    return found


def _gaps(motion: Trajectory, joints: list[int], strokes: Sequence[ArmStroke]) -> list[Gap]:
    """The times before, between and after the strokes of an arm."""
    turned = np.abs(np.diff(motion.controls[:, joints], axis=0)).max(axis=1) >= STILL_ARM
    edges = np.flatnonzero(np.diff(np.concatenate([[True], turned, [True]]).astype(np.int8)))
    times = motion.start + (edges.astype(np.float64) - CONTROL_LEAD) * STEP
    still = list(zip(times[::2].tolist(), times[1::2].tolist(), strict=True))
    still[0], still[-1] = (-inf, still[0][1]), (still[-1][0], inf)
    ends = [(-inf, strokes[0].begin), *((a.end, b.begin) for a, b in pairwise(strokes)), (strokes[-1].end, inf)]
    rests = [tuple((max(a, begin), min(b, end)) for a, b in still) for begin, end in ends]
    return [
        Gap(begin, end, tuple((a, b) for a, b in row if b - a >= LEAST_REST))
        for (begin, end), row in zip(ends, rests, strict=True)
    ]
