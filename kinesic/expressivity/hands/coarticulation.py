"""Co-articulation: which hands do which stroke, and how strokes of one hand that overlap make room for one another.

Hands that other blocks need are engaged for a block that begins beside those.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from kinesic.bml.block import GESTURE_SYNCS
from kinesic.body.robot import OTHER_SIDE, SIDE_NAMES, SIDES, Side
from kinesic.expressivity.hands.poses import REST, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import HandStroke, Stroke, do_stroke, least_stroke_times, overlaps, shortened
from kinesic.expressivity.keyframes import Outcome
from kinesic.expressivity.style.pace import Pace

Tied = Mapping[str, Collection[str]]  # behaviour id -> sync points that the document places


@dataclass(frozen=True)
class Engaged:
    """A hand that another block needs for a while."""

    side: Side
    begin: float  # [s] block time from which the hand must be there
    end: float  # [s] block time at which it gives way
    by: str  # the behaviour that needs it, as the sender may know it

    def meets(self, times: Mapping[str, float], way: float) -> bool:
        """Checks whether a gesture overlaps with this use of the hand, or leaves no time to move between both.

        Args:
            times: sync points of the gesture [s], which needs the hand from `ready` to `relax`.
            way: [s] that the hand is on its way.
        """
        return times["ready"] < self.end + way and self.begin < times["relax"] + way


@dataclass(frozen=True, eq=False)
class Allotted:
    """The strokes given to each hand, in time order, and the behaviours and sync points that had to change."""

    works: Mapping[Side, Sequence[HandStroke]]
    outcomes: Mapping[str, Outcome]  # of behaviours that are not performed as asked
    remarks: Mapping[str, tuple[str, ...]]  # of behaviours that are, as far as time allows
    times: Mapping[str, Mapping[str, float]]  # behaviour id -> sync points that moved [s]


def allot_hands(strokes: Sequence[Stroke], pace: Pace, tied: Tied, engaged: Sequence[Engaged] = ()) -> Allotted:
    """Gives every stroke its hands.

    A stroke that would begin before an earlier one of its hand has ended takes the other hand if one of its options
    has it free; else both make room, the earlier by ending sooner and the later by beginning later, as far as the
    document lets their `strokeEnd` and `strokeStart` move and servos can follow, never at the cost of `stroke`; else
    two hands are shared out between a two-handed stroke and another; else it is dropped. A rest pose never stands in
    the way: it is taken when the hand is free.

    A stroke keeps clear of hands that other blocks need where one of its options lets it, or one of its two hands alone
    can do it; else they count for nothing, and whoever lays the blocks over one another judges.

    Args:
        strokes: in the order of the document.
        pace: of the robot.
        tied: what the document places; all sync points of behaviours that are missing.
        engaged: hands that other blocks need.
    """
    hands = _Hands(pace, tied, engaged)
    for stroke in sorted(strokes, key=lambda each: each.times["stroke" if each.series else "strokeStart"]):
        hands.give(stroke)
    works = {id(work): work for row in hands.works.values() for work in row}.values()
    remarks = {work.id: work.remarks for work in works if work.remarks}
    return Allotted(hands.works, hands.outcomes, remarks, hands.times)


@dataclass
class _Hands:
    """The hands while strokes are given to them."""

    pace: Pace
    tied: Tied
    engaged: Sequence[Engaged]
    works: dict[Side, list[HandStroke]] = field(default_factory=lambda: {side: [] for side in SIDES})
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    times: dict[str, dict[str, float]] = field(default_factory=dict)

    def give(self, stroke: Stroke) -> None:
        """Finds hands for a stroke, or drops it."""
        if stroke.rest:
            self._take(stroke, stroke.options[0])
            return
        stroke = self._with_its_series(stroke)
        wholes, halves = stroke.options, self._halves(stroke)
        free, alone = (
            tuple(option for option in options if not self._engagements(stroke, option)) for options in (wholes, halves)
        )
        ways = (self._finds_free, self._makes_room)
        given = any(way(stroke, options) for options in (free, alone, wholes) for way in ways)
        if not given and stroke.series and not {"strokeStart", "strokeEnd"} & set(self._tied(stroke.id)):
            brief, why = shortened(stroke), self._why(stroke)
            given = any(way(brief, brief.options) for way in ways)
            if given:
                self._note(stroke, brief)
                self.outcomes[stroke.id] = Outcome("substituted", f"shown once, without its movement: {why}")
        if not given and not self._shares(stroke):
            self.outcomes[stroke.id] = Outcome("dropped", self._why(stroke))

    def _with_its_series(self, stroke: Stroke) -> Stroke:
        """Leaves a stroke of a series only the hands that do what came before in it."""
        before = [work for row in self.works.values() for work in row if work.stroke.series == stroke.series != ""]
        if not before:
            return stroke
        hands = max(before, key=lambda work: work.at("stroke")).poses.hands.keys()
        return replace(stroke, options=tuple(o for o in stroke.options if o.hands.keys() == hands) or stroke.options)

    def _halves(self, stroke: Stroke) -> tuple[Poses, ...]:
        """Splits a two-handed stroke into its hands, if it may be halved."""
        both = [option for option in stroke.options if stroke.halves and len(option.hands) == len(SIDES)]
        return tuple(option.only(side) for option in both for side in sorted(option.hands, reverse=True))

    def _take(self, stroke: Stroke, option: Poses) -> None:
        """Gives a stroke its hands, and time to come to it from the strokes before."""
        for side in sorted(option.hands):
            before = max(self.works[side], key=lambda work: work.at("strokeEnd"), default=None)
            if before and not (before.stroke.rest or stroke.rest):
                later, sooner = self._move_apart(before, stroke, option, side)
                self._replace(before, self._lead_over(sooner, later))
                self._note(stroke, later)
                stroke = later
        work = do_stroke(stroke, option, self.pace)
        for side in option.hands:
            self.works[side].append(work)

    def _clashes(self, stroke: Stroke, option: Poses) -> dict[Side, list[HandStroke]]:
        """Finds work whose stroke is not over when the hands are needed."""
        found = {side: [work for work in self.works[side] if overlaps(work, stroke)] for side in sorted(option.hands)}
        return {side: works for side, works in found.items() if works}

    def _engagements(self, stroke: Stroke, option: Poses) -> list[Engaged]:
        """Lists, in time order, what other blocks need the hands for so that they cannot come in time."""
        met = [
            each
            for each in self.engaged
            if each.side in option.hands and each.meets(stroke.times, self._way(option, each.side))
        ]
        return sorted(met, key=lambda each: each.begin)

    def _way(self, option: Poses, side: Side) -> float:
        """The shortest time in which a hand comes to a stroke from rest: from elsewhere it takes about as long [s]."""
        return self.pace.least_hand_time(
            pose_distance(REST, option.hands[side][0], resting_hands(self.pace.robot)[side])
        )

    def _finds_free(self, stroke: Stroke, options: Sequence[Poses]) -> bool:
        for option in options:
            if not self._clashes(stroke, option):
                if option is not stroke.options[0]:
                    self._note_moved(stroke, option)
                self._take(stroke, option)
                return True
        return False

    def _note_moved(self, stroke: Stroke, option: Poses) -> None:
        sides = sorted(option.hands)
        if len(sides) < len(stroke.options[0].hands):
            self.outcomes[stroke.id] = _one_hand_outcome(sides[0], self._why(stroke))
            return
        hand = " and ".join(SIDE_NAMES[side] for side in sides)
        self.outcomes[stroke.id] = Outcome("substituted", f"moved to the {hand} hand: {self._why(stroke)}")

    def _makes_room(self, stroke: Stroke, options: Sequence[Poses]) -> bool:
        """Moves strokes that overlap apart for the first option that allows it; False: none does."""
        for option in options:
            later, earlier = stroke, dict[int, tuple[HandStroke, HandStroke]]()
            for side, works in self._clashes(stroke, option).items():
                for work in works:
                    shorter = earlier.get(id(work), (work, work))[1]
                    later, shorter = self._move_apart(shorter, later, option, side)
                    earlier[id(work)] = work, shorter
            if not any(overlaps(shorter, later) for _, shorter in earlier.values()):
                if option is not stroke.options[0] and self._engagements(stroke, stroke.options[0]):
                    self._note_moved(stroke, option)
                for work, shorter in earlier.values():
                    self._replace(work, shorter)
                self._note(stroke, later)
                self._take(later, option)
                return True
        return False

    def _move_apart(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> tuple[Stroke, HandStroke]:
        """Begins a stroke later and ends the earlier one sooner, each by its part of the time that is missing."""
        ends, begins = work.at("strokeEnd"), stroke.times["strokeStart"]
        soonest, latest = self._soonest_end(work), self._latest_start(stroke, option)
        way = pose_distance(work.poses.hands[side][-1], option.hands[side][0], resting_hands(self.pace.robot)[side])
        missing = ends + self.pace.way_time(way, stroke.manner) - begins
        if missing <= 0.0:
            return stroke, work
        spare = (ends - soonest) + (latest - begins)
        part = min(1.0, missing / spare) if spare > 0 else 0.0
        sooner = replace(work.stroke, times=_cut_short(work.stroke.times, ends - part * (ends - soonest)))
        later = dict(stroke.times) | {"strokeStart": begins + part * (latest - begins)}
        return replace(stroke, times=later), do_stroke(sooner, work.poses, self.pace)

    def _lead_over(self, work: HandStroke, stroke: Stroke) -> HandStroke:
        """Lets hold and retraction become the preparation of the next stroke, where the document allows it."""
        times = work.stroke.times
        limits = {"relax": max(stroke.times["start"], times["strokeEnd"]), "end": stroke.times["strokeStart"]}
        given = {
            sync: latest
            for sync, latest in limits.items()
            if sync not in self._tied(work.id) and times["strokeEnd"] <= latest < times[sync]
        }
        return replace(work, stroke=replace(work.stroke, times={**times, **given})) if given else work

    def _soonest_end(self, work: HandStroke) -> float:
        """When a stroke can be over: done once, or as often as the document says [s]."""
        tied, times = self._tied(work.id), work.stroke.times
        if "strokeEnd" in tied:
            return times["strokeEnd"]
        poses = work.poses
        while poses.times > 1:
            poses = poses.fewer()
        least = times["stroke"] + sum(least_stroke_times(poses, self.pace)[poses.stroke :])
        numbered = [time for sync, time in times.items() if sync in tied and sync.startswith("stroke:")]
        return min(max([least, *numbered]), times["strokeEnd"])

    def _latest_start(self, stroke: Stroke, option: Poses) -> float:
        """When a stroke must begin at the latest [s]."""
        if "strokeStart" in self._tied(stroke.id):
            return stroke.times["strokeStart"]
        latest = stroke.times["stroke"] - sum(least_stroke_times(option, self.pace)[: option.stroke])
        return max(latest, stroke.times["strokeStart"])

    def _shares(self, stroke: Stroke) -> bool:
        """Leaves one hand of a two-handed stroke to another; False: no option can."""
        for option in stroke.options:
            clashes = self._clashes(stroke, option)
            free = [side for side in option.hands if side not in clashes]
            if free:
                self._take(stroke, option.only(free[0]))
                self.outcomes[stroke.id] = _one_hand_outcome(free[0], self._why(stroke))
                return True
            works = [work for found in clashes.values() for work in found]
            halved = all(len(work.poses.hands) == 2 and work.id not in self.outcomes for work in works)
            if len(option.hands) == 1 and halved:
                (side,) = option.hands
                for work in works:
                    self.works[side].remove(work)
                    one = do_stroke(work.stroke, work.poses.only(OTHER_SIDE[side]), self.pace)
                    self._replace(work, one)
                    why = f"the {SIDE_NAMES[side]} hand does {stroke.id} from {stroke.times['strokeStart']:.2f} s on"
                    self.outcomes[work.id] = _one_hand_outcome(OTHER_SIDE[side], why)
                self._take(stroke, option)
                return True
        return False

    def _replace(self, old: HandStroke, new: HandStroke) -> None:
        for side in SIDES:
            self.works[side] = [new if work is old else work for work in self.works[side]]
        self._note(old.stroke, new.stroke)

    def _note(self, old: Stroke, new: Stroke) -> None:
        moved = {sync: time for sync, time in new.times.items() if time != old.times[sync]}
        if moved:
            self.times[new.id] = self.times.get(new.id, {}) | moved

    def _tied(self, id: str) -> Collection[str]:
        return self.tied.get(id, GESTURE_SYNCS)

    def _why(self, stroke: Stroke) -> str:
        """Names what is in the way of the first option."""
        usual = stroke.options[0]
        clashes = self._clashes(stroke, usual)
        if clashes:
            side, works = next(iter(clashes.items()))
            need = f"the stroke of {works[-1].id} until {works[-1].at('strokeEnd'):.2f} s"
        else:
            other = self._engagements(stroke, usual)[0]
            side, way = other.side, self._way(usual, other.side)
            need = f"{other.by} until {other.end:.2f} s, and needs {way:.2f} s to come"
        start = stroke.times["strokeStart"]
        return f"its stroke begins at {start:.2f} s, the {SIDE_NAMES[side]} hand is busy with {need}"


def _cut_short(times: Mapping[str, float], end: float) -> dict[str, float]:
    return {
        sync: min(time, end) if sync == "strokeEnd" or sync.startswith("stroke:") else time
        for sync, time in times.items()
    }


def _one_hand_outcome(side: Side, why: str) -> Outcome:
    return Outcome("substituted", f"done by the {SIDE_NAMES[side]} hand alone: {why}")
