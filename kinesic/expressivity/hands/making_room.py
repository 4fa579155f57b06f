"""Room between two strokes of one hand: the earlier ends sooner, the later begins later, each as far as it may."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

from kinesic.bml.block import GESTURE_SYNCS
from kinesic.body.robot import Side
from kinesic.expressivity.hands.poses import REST, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import HandStroke, Stroke, do_stroke, least_stroke_times, overlaps
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.pace import Pace

Tied = Mapping[str, Collection[str]]  # behaviour id -> sync points that the document places


@dataclass(frozen=True)
class Room:
    """Moves and shortens strokes that are too near to one another, as far as document and servos let it."""

    pace: Pace
    tied: Tied

    def move_apart(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> tuple[Stroke, HandStroke]:
        """Begins a stroke later and ends the earlier one sooner, each by its part of the time that is missing."""
        ends, begins = work.at("strokeEnd"), stroke.times["strokeStart"]
        soonest, latest = self._soonest_end(work), self._latest_start(stroke, option)
        missing = ends + self.way_between(work, stroke, option, side) - begins
        if missing <= 0.0:
            return stroke, work
        spare = (ends - soonest) + (latest - begins)
        part = min(1.0, missing / spare) if spare > 0 else 0.0
        sooner = replace(work.stroke, times=_cut_short(work.stroke.times, ends - part * (ends - soonest)))
        later = dict(stroke.times) | {"strokeStart": begins + part * (latest - begins)}
        return replace(stroke, times=later), do_stroke(sooner, work.poses, self.pace)

    def lead_over(self, work: HandStroke, stroke: Stroke, option: Poses) -> HandStroke:
        """Lets hold and retraction become the preparation of the next stroke, where the document allows it.

        Both hands of the earlier one get time for their way, to the next stroke or to rest.
        """
        times, begins, rest = work.stroke.times, stroke.times["strokeStart"], resting_hands(self.pace.robot)
        effort = Effort(self.pace, option.nature, stroke.manner)
        ways = {
            side: effort.joining_time(pose_distance(row[-1], option.hands.get(side, (REST,))[0], rest[side]))
            for side, row in work.poses.hands.items()
        }
        relax = max(min(stroke.times["start"], begins - max(ways.values())), times["strokeEnd"])
        homeward = max((way for side, way in ways.items() if side not in option.hands), default=0.0)
        limits = {"relax": relax, "end": max(begins, relax + homeward)}
        given = {
            sync: latest
            for sync, latest in limits.items()
            if sync not in self.placed(work.id) and times["strokeEnd"] <= latest < times[sync]
        }
        return replace(work, stroke=replace(work.stroke, times={**times, **given})) if given else work

    def stop_repeating(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> HandStroke:
        """Does a stroke less often than its manner has it, where its hand would else come late to a rest pose."""
        latest = stroke.times["strokeStart"] - self.way_between(work, stroke, option, side)
        end = max(self._soonest_end(work), latest)
        if not work.poses.again or end >= work.at("strokeEnd"):
            return work
        sooner = replace(work.stroke, times=_cut_short(work.stroke.times, end))
        return self.lead_over(do_stroke(sooner, work.poses, self.pace), stroke, option)

    def way_between(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> float:
        """Natural time of a hand from one stroke to the next [s]."""
        way = pose_distance(work.poses.hands[side][-1], option.hands[side][0], resting_hands(self.pace.robot)[side])
        return Effort(self.pace, option.nature, stroke.manner).joining_time(way)

    def may_part(self, work: HandStroke, stroke: Stroke, option: Poses) -> bool:
        """Whether two strokes can be moved apart at all, each as far as it may."""
        sooner = replace(
            work, stroke=replace(work.stroke, times=_cut_short(work.stroke.times, self._soonest_end(work)))
        )
        later = {**stroke.times, "strokeStart": self._latest_start(stroke, option)}
        return not overlaps(sooner, replace(stroke, times=later))

    def _soonest_end(self, work: HandStroke) -> float:
        """When a stroke can be over: done once, or as often as the document says [s]."""
        tied, times = self.placed(work.id), work.stroke.times
        if "strokeEnd" in tied:
            return times["strokeEnd"]
        poses = _once(work.poses)
        least = times["stroke"] + sum(least_stroke_times(poses, self.pace)[poses.stroke :])
        numbered = [time for sync, time in times.items() if sync in tied and sync.startswith("stroke:")]
        return min(max([least, *numbered]), times["strokeEnd"])

    def _latest_start(self, stroke: Stroke, option: Poses) -> float:
        """When a stroke must begin at the latest [s]."""
        if "strokeStart" in self.placed(stroke.id):
            return stroke.times["strokeStart"]
        latest = stroke.times["stroke"] - sum(least_stroke_times(option, self.pace)[: option.stroke])
        return max(latest, stroke.times["strokeStart"])

    def placed(self, id: str) -> Collection[str]:
        """Lists the sync points of a behaviour that may not move."""
        return self.tied.get(id, GESTURE_SYNCS)


@lru_cache(maxsize=256)
def _once(poses: Poses) -> Poses:
    """The same poses each time, for which the lengths of the ways between them are remembered."""
    return _once(poses.fewer()) if poses.again else poses


def _cut_short(times: Mapping[str, float], end: float) -> dict[str, float]:
    return {
        sync: min(time, end) if sync == "strokeEnd" or sync.startswith("stroke:") else time
        for sync, time in times.items()
    }
