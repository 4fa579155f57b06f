"""Shortening of successive strokes of one hand, to separate the strokes."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

from kinesic.bml.block import GESTURE_SYNCS
from kinesic.body.robot import Side
from kinesic.expressivity.hands.poses import REST_HAND, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import HandStroke, Stroke, least_stroke_times, overlaps, time_stroke
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.pace import Pace

FixedSyncs = Mapping[str, Collection[str]]  # behaviour id -> sync points that the document fixes


@dataclass(frozen=True)
class StrokeSpacing:
    """Solver that makes time between successive strokes of one hand."""

    pace: Pace
    fixed_syncs: FixedSyncs

    def move_apart(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> tuple[Stroke, HandStroke]:
        """Let a stroke begin later and the preceding stroke end earlier.

        The missing time is divided in proportion to the time that each can give.

        Returns:
            The later stroke and the shortened one.
        """
        ends, begins = work.at("strokeEnd"), stroke.times["strokeStart"]
        soonest, latest = self._earliest_end(work), self._latest_start(stroke, option)
        missing_time = ends + self.transition_time(work, stroke, option, side) - begins
        if missing_time <= 0.0:
            return stroke, work
        available_time = (ends - soonest) + (latest - begins)
        fraction = min(1.0, missing_time / available_time) if available_time > 0 else 0.0
        shortened = replace(work.stroke, times=_shorten(work.stroke.times, ends - fraction * (ends - soonest)))
        later = dict(stroke.times) | {"strokeStart": begins + fraction * (latest - begins)}
        return replace(stroke, times=later), time_stroke(shortened, work.poses, self.pace)

    def merge_transition(self, work: HandStroke, stroke: Stroke, option: Poses) -> HandStroke:
        """Shorten hold and retraction of a stroke for the next preparation.

        The document must not fix them. Both hands of the earlier stroke get time to move to the next stroke or to rest.
        """
        times, begins, rest = work.stroke.times, stroke.times["strokeStart"], resting_hands(self.pace.robot)
        effort = Effort(self.pace, option.traits, stroke.manner)
        durations = {
            side: effort.joining_time(pose_distance(row[-1], option.hands.get(side, (REST_HAND,))[0], rest[side]))
            for side, row in work.poses.hands.items()
        }
        relax = max(min(stroke.times["start"], begins - max(durations.values())), times["strokeEnd"])
        retraction_time = max(
            (distance for side, distance in durations.items() if side not in option.hands), default=0.0
        )
        limits = {"relax": relax, "end": max(begins, relax + retraction_time)}
        moved_syncs = {
            sync: latest
            for sync, latest in limits.items()
            if sync not in self.fixed_points(work.id) and times["strokeEnd"] <= latest < times[sync]
        }
        return replace(work, stroke=replace(work.stroke, times={**times, **moved_syncs})) if moved_syncs else work

    def stop_repeating(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> HandStroke:
        """Drop stroke repetitions that would delay the following rest pose."""
        latest = stroke.times["strokeStart"] - self.transition_time(work, stroke, option, side)
        end = max(self._earliest_end(work), latest)
        if not work.poses.again or end >= work.at("strokeEnd"):
            return work
        shortened = replace(work.stroke, times=_shorten(work.stroke.times, end))
        return self.merge_transition(time_stroke(shortened, work.poses, self.pace), stroke, option)

    def transition_time(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> float:
        """Return the natural transition time of a hand between two strokes [s]."""
        distance = pose_distance(
            work.poses.hands[side][-1], option.hands[side][0], resting_hands(self.pace.robot)[side]
        )
        return Effort(self.pace, option.traits, stroke.manner).joining_time(distance)

    def can_move_apart(self, work: HandStroke, stroke: Stroke, option: Poses) -> bool:
        """Return whether two strokes can be moved apart far enough."""
        shortened = replace(
            work, stroke=replace(work.stroke, times=_shorten(work.stroke.times, self._earliest_end(work)))
        )
        later = {**stroke.times, "strokeStart": self._latest_start(stroke, option)}
        return not overlaps(shortened, replace(stroke, times=later))

    def _earliest_end(self, work: HandStroke) -> float:
        """Return the earliest end of a stroke without optional repetitions [s]."""
        fixed_syncs, times = self.fixed_points(work.id), work.stroke.times
        if "strokeEnd" in fixed_syncs:
            return times["strokeEnd"]
        poses = _without_repetitions(work.poses)
        minimum = times["stroke"] + sum(least_stroke_times(poses, self.pace)[poses.stroke :])
        repeated_strokes = [time for sync, time in times.items() if sync in fixed_syncs and sync.startswith("stroke:")]
        return min(max([minimum, *repeated_strokes]), times["strokeEnd"])

    def _latest_start(self, stroke: Stroke, option: Poses) -> float:
        """Return the latest start of a stroke that servos can follow [s]."""
        if "strokeStart" in self.fixed_points(stroke.id):
            return stroke.times["strokeStart"]
        latest = stroke.times["stroke"] - sum(least_stroke_times(option, self.pace)[: option.stroke])
        return max(latest, stroke.times["strokeStart"])

    def fixed_points(self, id: str) -> Collection[str]:
        """Return the sync points of a behaviour that must not move."""
        return self.fixed_syncs.get(id, GESTURE_SYNCS)


@lru_cache(maxsize=16)  # reused within one document only, for one stroke after the other
def _without_repetitions(poses: Poses) -> Poses:
    """Remove all repetitions of a stroke.

    The distances between its keys are cached by that object.
    """
    return _without_repetitions(poses.fewer()) if poses.again else poses


def _shorten(times: Mapping[str, float], end: float) -> dict[str, float]:
    return {
        sync: min(time, end) if sync == "strokeEnd" or sync.startswith("stroke:") else time
        for sync, time in times.items()
    }
