"""Co-articulation: which hands do which stroke, and how strokes of one hand that overlap make room for one another.

Hands that other blocks need are engaged for a block that begins beside those. Of two strokes that one hand cannot do
the one that counts for less gives way, or else the later one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from kinesic.body.robot import OTHER_SIDE, SIDES, Side
from kinesic.expressivity.hands.conflict_words import (
    brief_outcome,
    busy_with_block,
    busy_with_stroke,
    displaced_outcome,
    moved_outcome,
    needed_elsewhere,
    one_hand_outcome,
    remedy,
)
from kinesic.expressivity.hands.engaged import Clashes, Engaged
from kinesic.expressivity.hands.making_room import Room, Tied
from kinesic.expressivity.hands.poses import REST, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import HandStroke, Stroke, do_stroke, is_brief, overlaps, shortened, show_once
from kinesic.expressivity.keyframes import Outcome
from kinesic.expressivity.style.pace import Pace

NO_CLASHES: Clashes = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class Allotted:
    """The strokes given to each hand, in time order, and the behaviours and sync points that had to change."""

    works: Mapping[Side, Sequence[HandStroke]]
    outcomes: Mapping[str, Outcome]  # of behaviours that are not performed as asked
    remarks: Mapping[str, tuple[str, ...]]  # of behaviours that are, as far as time allows
    times: Mapping[str, Mapping[str, float]]  # behaviour id -> sync points that moved [s]


def allot_hands(
    strokes: Sequence[Stroke],
    pace: Pace,
    tied: Tied,
    engaged: Sequence[Engaged] = (),
    clashes: Clashes = NO_CLASHES,
) -> Allotted:
    """Gives every stroke its hands.

    A stroke that would begin before an earlier one of its hand has ended takes the other hand if one of its options
    has it free; else both make room, the earlier by ending sooner and the later by beginning later, as far as the
    document lets their `strokeEnd` and `strokeStart` move and servos can follow, never at the cost of `stroke`; else
    two hands are shared out between a two-handed stroke and another; else those in its way are dropped, if all of them
    count for less; else it is. A rest pose never stands in the way: it is taken when the hand is free.

    A stroke keeps clear of hands that other blocks need where one of its options lets it, or one of its two hands alone
    can do it; else they count for nothing, and whoever lays the blocks over one another judges.

    Args:
        strokes: in the order of the document.
        pace: of the robot.
        tied: what the document places; all sync points of behaviours that are missing.
        engaged: hands that other blocks need.
        clashes: strokes that count as overlapping, as one hand cannot come from one to the other in time.
    """
    in_turn = sorted(strokes, key=lambda each: each.times["stroke" if each.series else "strokeStart"])
    displaced: dict[str, Outcome] = {}
    while True:
        hands = _Hands(pace, Room(pace, tied), engaged, clashes)
        for stroke in in_turn:
            if stroke.id not in displaced:
                hands.give(stroke)
        if not hands.displaced:
            break
        displaced |= hands.displaced  # and all over again, for others have made room for these
    works = {id(work): work for row in hands.works.values() for work in row}.values()
    remarks = {work.id: work.remarks for work in works if work.remarks}
    return Allotted(hands.works, hands.outcomes | displaced, remarks, hands.times)


@dataclass
class _Hands:
    """The hands while strokes are given to them."""

    pace: Pace
    room: Room
    engaged: Sequence[Engaged]
    clashes: Clashes
    works: dict[Side, list[HandStroke]] = field(default_factory=lambda: {side: [] for side in SIDES})
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    times: dict[str, dict[str, float]] = field(default_factory=dict)
    displaced: dict[str, Outcome] = field(default_factory=dict)  # of strokes that had hands, and had to give way

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
        if not given and self._may_be_brief(stroke):
            brief, why = shortened(stroke), self._why(stroke)
            given = any(way(brief, brief.options) for way in (*ways, self._shortens_its_series))
            if given:
                self._note(stroke, brief)
                self.outcomes[stroke.id] = brief_outcome(why)
        if not (given or self._shares(stroke) or self._displaces(stroke)):
            self.outcomes[stroke.id] = Outcome("dropped", f"{self._why(stroke)}; {self._remedy(stroke)}")

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
            if before and stroke.rest:
                self._replace(before, self.room.stop_repeating(before, stroke, option, side))
            elif before and not before.stroke.rest:
                later, sooner = self.room.move_apart(before, stroke, option, side)
                self._replace(before, self.room.lead_over(sooner, later, option))
                self._note(stroke, later)
                stroke = later
        work = do_stroke(stroke, option, self.pace)
        for side in option.hands:
            self.works[side].append(work)

    def _clashes(self, stroke: Stroke, option: Poses) -> dict[Side, list[HandStroke]]:
        """Finds work whose stroke is not over when the hands are needed."""
        found = {side: [work for work in self.works[side] if self._meet(work, stroke)] for side in sorted(option.hands)}
        return {side: works for side, works in found.items() if works}

    def _meet(self, work: HandStroke, stroke: Stroke) -> bool:
        """Whether one hand cannot do both: their strokes overlap, or it cannot come in time."""
        return overlaps(work, stroke) or (not work.stroke.rest and self._late_by(work, stroke) > 0.0)

    def _may_part(self, work: HandStroke, stroke: Stroke, option: Poses) -> bool:
        """Whether one hand can do both when their strokes make room; twice where they share both hands."""
        twice = len(work.poses.hands) == len(option.hands) == len(SIDES)
        return self._late_by(work, stroke) == 0.0 and (twice or self.room.may_part(work, stroke, option))

    def _late_by(self, work: HandStroke, stroke: Stroke) -> float:
        """Returns how late a hand comes from one stroke to another that does not overlap it [s].

        Nothing is known of two that have become brief since they were found to clash: whoever plans them looks again.
        """
        clash = self.clashes.get(frozenset((work.id, stroke.id)))
        if clash is None or (not clash.brief and is_brief(work.stroke) and is_brief(stroke)):
            return 0.0
        return clash.late

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
        hands = frozenset(option.hands)
        self.outcomes[stroke.id] = moved_outcome(hands, len(stroke.options[0].hands), self._why(stroke))

    def _makes_room(self, stroke: Stroke, options: Sequence[Poses]) -> bool:
        """Moves strokes that overlap apart for the first option that allows it; False: none does."""
        for option in options:
            clashes = self._clashes(stroke, option)
            if not all(self._may_part(work, stroke, option) for works in clashes.values() for work in works):
                continue
            later, earlier = stroke, dict[int, tuple[HandStroke, HandStroke]]()
            for side, works in clashes.items():
                for work in works:
                    shorter = earlier.get(id(work), (work, work))[1]
                    later, shorter = self.room.move_apart(shorter, later, option, side)
                    earlier[id(work)] = work, shorter
            if not any(self._meet(shorter, later) for _, shorter in earlier.values()):
                if option is not stroke.options[0] and self._engagements(stroke, stroke.options[0]):
                    self._note_moved(stroke, option)
                for work, shorter in earlier.values():
                    self._replace(work, shorter)
                self._note(stroke, later)
                self._take(later, option)
                return True
        return False

    def _may_be_brief(self, stroke: Stroke) -> bool:
        """Whether it may be shown once, without its movement: of a series that is better than not at all."""
        return bool(stroke.series) and not {"strokeStart", "strokeEnd"} & set(self.room.placed(stroke.id))

    def _shortens_its_series(self, stroke: Stroke, options: Sequence[Poses]) -> bool:
        """Shows once, too, what of its series is in the way; False: something else is, or that does not suffice."""
        for option in options:
            works = {id(work): work for row in self._clashes(stroke, option).values() for work in row}.values()
            brief = [(work, show_once(work, self.pace)) for work in works]
            if all(self._may_be_brief(work.stroke) and not self._meet(shown, stroke) for work, shown in brief):
                for work, shown in brief:
                    self.outcomes[work.id] = brief_outcome(needed_elsewhere(min(option.hands), stroke))
                    self._replace(work, shown)
                self._take(stroke, option)
                return True
        return False

    def _shares(self, stroke: Stroke) -> bool:
        """Leaves one hand of a two-handed stroke to another; False: no option can."""
        for option in stroke.options:
            clashes = self._clashes(stroke, option)
            free = [side for side in option.hands if side not in clashes]
            if free:
                self.outcomes[stroke.id] = one_hand_outcome(free[0], self._why(stroke))
                self._take(stroke, option.only(free[0]))
                return True
            works = [work for found in clashes.values() for work in found]
            halved = all(len(work.poses.hands) == 2 and work.id not in self.outcomes for work in works)
            if len(option.hands) == 1 and halved:
                (side,) = option.hands
                for work in works:
                    self.works[side].remove(work)
                    one = do_stroke(work.stroke, work.poses.only(OTHER_SIDE[side]), self.pace)
                    self._replace(work, one)
                    self.outcomes[work.id] = one_hand_outcome(OTHER_SIDE[side], needed_elsewhere(side, stroke))
                self._take(stroke, option)
                return True
        return False

    def _displaces(self, stroke: Stroke) -> bool:
        """Takes the hands of strokes that count for less, which are dropped; False: no option has only such."""
        for option in stroke.options:
            works = [(side, work) for side, row in self._clashes(stroke, option).items() for work in row]
            if all(work.stroke.importance < stroke.importance for _, work in works):
                for side, work in works:
                    lacking = self._lacking(work, stroke, option, side)
                    self.displaced[work.id] = displaced_outcome(work, side, stroke, lacking)
                self.works = {
                    side: [work for work in row if work.id not in self.displaced] for side, row in self.works.items()
                }
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

    def _why(self, stroke: Stroke) -> str:
        """Names what is in the way of the first option."""
        usual = stroke.options[0]
        clashes = self._clashes(stroke, usual)
        if clashes:
            side, works = next(iter(clashes.items()))
            return busy_with_stroke(stroke, side, works[-1], self._late_by(works[-1], stroke))
        other = self._engagements(stroke, usual)[0]
        return busy_with_block(stroke, other, self._way(usual, other.side))

    def _remedy(self, stroke: Stroke) -> str:
        """Says when a stroke would have the hands of its first option."""
        usual = stroke.options[0]
        clashes = self._clashes(stroke, usual)
        later = max(self._lacking(work, stroke, usual, side) for side, row in clashes.items() for work in row)
        return remedy(stroke.times["stroke"] + later)

    def _lacking(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> float:
        """Computes how much later a stroke must be for its hand to come from another stroke [s]."""
        between = stroke.times["strokeStart"] - work.at("strokeEnd")
        return self._late_by(work, stroke) or self.room.way_between(work, stroke, option, side) - between
