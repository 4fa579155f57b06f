"""Co-articulation: assignment of strokes to hands, and conflicts between strokes.

Hands that other blocks need are busy for a block that begins next to those. Of two strokes that one hand cannot
perform, the less important is dropped, otherwise the later one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from kinesic.body.robot import OTHER_SIDE, SIDES, Side
from kinesic.expressivity.hands.busy_hands import BusyHand, Clashes
from kinesic.expressivity.hands.conflict_messages import (
    brief_outcome,
    busy_with_block,
    busy_with_stroke,
    displaced_outcome,
    moved_outcome,
    needed_elsewhere,
    one_hand_outcome,
    remedy,
)
from kinesic.expressivity.hands.poses import REST_HAND, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.stroke_spacing import FixedSyncs, StrokeSpacing
from kinesic.expressivity.hands.strokes import HandStroke, Stroke, is_brief, overlaps, shortened, show_once, time_stroke
from kinesic.expressivity.keyframes import Outcome
from kinesic.expressivity.style.pace import Pace

NO_CLASHES: Clashes = MappingProxyType({})  # default: no pair of strokes is too close in time, empty


@dataclass(frozen=True, eq=False)
class HandAllocation:
    """Time-ordered strokes of each hand, with dropped behaviours and moved sync points."""

    works: Mapping[Side, Sequence[HandStroke]]
    outcomes: Mapping[str, Outcome]  # outcomes of behaviours that are not performed as requested
    remarks: Mapping[str, tuple[str, ...]]  # notes on changes for lack of time, by performed behaviour
    times: Mapping[str, Mapping[str, float]]  # behaviour id -> moved sync points [s]


def allocate_hands(
    strokes: Sequence[Stroke],
    pace: Pace,
    fixed_syncs: FixedSyncs,
    busy_hands: Sequence[BusyHand] = (),
    clashes: Clashes = NO_CLASHES,
) -> HandAllocation:
    """Assign hands to every stroke.

    A stroke that would begin before an earlier one of its hand has ended uses the other hand if one of its options has
    it free. Otherwise both are moved apart: the earlier ends sooner and the later begins later, as far as the document
    lets their `strokeEnd` and `strokeStart` move and the servos can follow, but `stroke` never moves. Otherwise a
    two-handed stroke and another one use one hand each. Otherwise the conflicting strokes are dropped if all of them
    are less important. Otherwise the stroke itself is dropped. A rest pose never conflicts: it is taken when the hand
    is free.

    A stroke avoids hands that other blocks need if one of its options allows it, or if one of its two hands alone can
    perform it. Otherwise it ignores them, and the realizer resolves the conflict when it merges the blocks.

    Args:
        strokes: in the order of the document.
        pace: of the robot.
        fixed_syncs: sync points fixed by the document; all sync points of behaviours that are missing.
        busy_hands: hands that other blocks need.
        clashes: strokes that count as overlapping, as one hand cannot move from one to the other in time.
    """
    in_order = sorted(strokes, key=lambda other: other.times["stroke" if other.series else "strokeStart"])
    displaced: dict[str, Outcome] = {}
    while True:
        hands = _Hands(pace, StrokeSpacing(pace, fixed_syncs), busy_hands, clashes)
        for stroke in in_order:
            if stroke.id not in displaced:
                hands.assign(stroke)
        if not hands.displaced:
            break
        displaced |= hands.displaced  # allocate again, as other strokes were shortened for the dropped ones
    works = {id(work): work for row in hands.works.values() for work in row}.values()
    remarks = {work.id: work.remarks for work in works if work.remarks}
    return HandAllocation(hands.works, hands.outcomes | displaced, remarks, hands.times)


@dataclass
class _Hands:
    """State of the hands during the assignment of strokes."""

    pace: Pace
    spacing: StrokeSpacing
    busy_hands: Sequence[BusyHand]
    clashes: Clashes
    works: dict[Side, list[HandStroke]] = field(default_factory=lambda: {side: [] for side in SIDES})
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    times: dict[str, dict[str, float]] = field(default_factory=dict)
    displaced: dict[str, Outcome] = field(default_factory=dict)  # strokes dropped for more important strokes

    def assign(self, stroke: Stroke) -> None:
        """Assign hands to a stroke, or drop the stroke."""
        if stroke.rest:
            self._take(stroke, stroke.options[0])
            return
        stroke = self._keep_series_hands(stroke)
        whole_options, half_options = stroke.options, self._halves(stroke)
        free, free_halves = (
            tuple(option for option in options if not self._busy_conflicts(stroke, option))
            for options in (whole_options, half_options)
        )
        methods = (self._try_free, self._try_spacing)
        assigned = any(method(stroke, options) for options in (free, free_halves, whole_options) for method in methods)
        if not assigned and self._may_be_brief(stroke):
            brief, why = shortened(stroke), self._conflict_message(stroke)
            assigned = any(method(brief, brief.options) for method in (*methods, self._try_shortening_series))
            if assigned:
                self._note(stroke, brief)
                self.outcomes[stroke.id] = brief_outcome(why)
        if not (assigned or self._try_one_hand_each(stroke) or self._try_displacing(stroke)):
            self.outcomes[stroke.id] = Outcome(
                "dropped", f"{self._conflict_message(stroke)}; {self._remedy_message(stroke)}"
            )

    def _keep_series_hands(self, stroke: Stroke) -> Stroke:
        """Restrict a stroke to the hands of earlier strokes of its series."""
        before = [work for row in self.works.values() for work in row if work.stroke.series == stroke.series != ""]
        if not before:
            return stroke
        hands = max(before, key=lambda work: work.at("stroke")).poses.hands.keys()
        return replace(stroke, options=tuple(o for o in stroke.options if o.hands.keys() == hands) or stroke.options)

    def _halves(self, stroke: Stroke) -> tuple[Poses, ...]:
        """Return the right- and left-handed versions of a two-handed stroke.

        Empty for a stroke that one hand must not perform alone.
        """
        both = [option for option in stroke.options if stroke.may_split and len(option.hands) == len(SIDES)]
        return tuple(option.only(side) for option in both for side in sorted(option.hands, reverse=True))

    def _take(self, stroke: Stroke, option: Poses) -> None:
        """Assign a stroke to hands, and shorten their preceding strokes to fit."""
        for side in sorted(option.hands):
            before = max(self.works[side], key=lambda work: work.at("strokeEnd"), default=None)
            if before and stroke.rest:
                self._replace(before, self.spacing.stop_repeating(before, stroke, option, side))
            elif before and not before.stroke.rest:
                later, sooner = self.spacing.move_apart(before, stroke, option, side)
                self._replace(before, self.spacing.merge_transition(sooner, later, option))
                self._note(stroke, later)
                stroke = later
        work = time_stroke(stroke, option, self.pace)
        for side in option.hands:
            self.works[side].append(work)

    def _clashes(self, stroke: Stroke, option: Poses) -> dict[Side, list[HandStroke]]:
        """Return the conflicting strokes of each hand that a stroke needs."""
        conflicts = {
            side: [work for work in self.works[side] if self._conflict(work, stroke)] for side in sorted(option.hands)
        }
        return {side: works for side, works in conflicts.items() if works}

    def _conflict(self, work: HandStroke, stroke: Stroke) -> bool:
        """Return whether one hand lacks the time for two strokes."""
        return overlaps(work, stroke) or (not work.stroke.rest and self._delay(work, stroke) > 0.0)

    def _can_be_spaced(self, work: HandStroke, stroke: Stroke, option: Poses) -> bool:
        """Return whether one hand can perform two strokes if both are shortened.

        Never with a reported timing conflict, else always for two two-handed strokes: their hands are tried singly.
        """
        twice = len(work.poses.hands) == len(option.hands) == len(SIDES)
        return self._delay(work, stroke) == 0.0 and (twice or self.spacing.can_move_apart(work, stroke, option))

    def _delay(self, work: HandStroke, stroke: Stroke) -> float:
        """Return the delay from a reported timing conflict of two strokes [s].

        It is 0 for two strokes that were shortened to one key after their clash was found: the planner checks them
        again.
        """
        clash = self.clashes.get(frozenset((work.id, stroke.id)))
        if clash is None or (not clash.brief and is_brief(work.stroke) and is_brief(stroke)):
            return 0.0
        return clash.delay

    def _busy_conflicts(self, stroke: Stroke, option: Poses) -> list[BusyHand]:
        """Return conflicting uses of the hands by other blocks."""
        conflicting = [
            other
            for other in self.busy_hands
            if other.side in option.hands and other.meets(stroke.times, self._travel_time(option, other.side))
        ]
        return sorted(conflicting, key=lambda other: other.begin)

    def _travel_time(self, option: Poses, side: Side) -> float:
        """Return a hand's minimum time from rest to a stroke [s]."""
        return self.pace.least_hand_time(
            pose_distance(REST_HAND, option.hands[side][0], resting_hands(self.pace.robot)[side])
        )

    def _try_free(self, stroke: Stroke, options: Sequence[Poses]) -> bool:
        for option in options:
            if not self._clashes(stroke, option):
                if option is not stroke.options[0]:
                    self._note_moved(stroke, option)
                self._take(stroke, option)
                return True
        return False

    def _note_moved(self, stroke: Stroke, option: Poses) -> None:
        hands = frozenset(option.hands)
        self.outcomes[stroke.id] = moved_outcome(hands, len(stroke.options[0].hands), self._conflict_message(stroke))

    def _try_spacing(self, stroke: Stroke, options: Sequence[Poses]) -> bool:
        """Move overlapping strokes apart for the first feasible choice of hands."""
        for option in options:
            clashes = self._clashes(stroke, option)
            if not all(self._can_be_spaced(work, stroke, option) for works in clashes.values() for work in works):
                continue
            later, earlier = stroke, dict[int, tuple[HandStroke, HandStroke]]()
            for side, works in clashes.items():
                for work in works:
                    shorter = earlier.get(id(work), (work, work))[1]
                    later, shorter = self.spacing.move_apart(shorter, later, option, side)
                    earlier[id(work)] = work, shorter
            if not any(self._conflict(shorter, later) for _, shorter in earlier.values()):
                if option is not stroke.options[0] and self._busy_conflicts(stroke, stroke.options[0]):
                    self._note_moved(stroke, option)
                for work, shorter in earlier.values():
                    self._replace(work, shorter)
                self._note(stroke, later)
                self._take(later, option)
                return True
        return False

    def _may_be_brief(self, stroke: Stroke) -> bool:
        """Return whether a stroke of a series may become a single pose."""
        return bool(stroke.series) and not {"strokeStart", "strokeEnd"} & set(self.spacing.fixed_points(stroke.id))

    def _try_shortening_series(self, stroke: Stroke, options: Sequence[Poses]) -> bool:
        """Reduce conflicting strokes of a series to one key, if that suffices."""
        for option in options:
            works = {id(work): work for row in self._clashes(stroke, option).values() for work in row}.values()
            brief = [(work, show_once(work, self.pace)) for work in works]
            if all(self._may_be_brief(work.stroke) and not self._conflict(shown, stroke) for work, shown in brief):
                for work, shown in brief:
                    self.outcomes[work.id] = brief_outcome(needed_elsewhere(min(option.hands), stroke))
                    self._replace(work, shown)
                self._take(stroke, option)
                return True
        return False

    def _try_one_hand_each(self, stroke: Stroke) -> bool:
        """Divide the hands between a two-handed stroke and another stroke."""
        for option in stroke.options:
            clashes = self._clashes(stroke, option)
            free = [side for side in option.hands if side not in clashes]
            if free:
                self.outcomes[stroke.id] = one_hand_outcome(free[0], self._conflict_message(stroke))
                self._take(stroke, option.only(free[0]))
                return True
            works = [work for side_works in clashes.values() for work in side_works]
            halved = all(len(work.poses.hands) == 2 and work.id not in self.outcomes for work in works)
            if len(option.hands) == 1 and halved:
                (side,) = option.hands
                for work in works:
                    self.works[side].remove(work)
                    one = time_stroke(work.stroke, work.poses.only(OTHER_SIDE[side]), self.pace)
                    self._replace(work, one)
                    self.outcomes[work.id] = one_hand_outcome(OTHER_SIDE[side], needed_elsewhere(side, stroke))
                self._take(stroke, option)
                return True
        return False

    def _try_displacing(self, stroke: Stroke) -> bool:
        """Perform a stroke instead of conflicting strokes, if all are less important.

        They are dropped. Returns whether the stroke was placed.
        """
        for option in stroke.options:
            works = [(side, work) for side, row in self._clashes(stroke, option).items() for work in row]
            if all(work.stroke.importance < stroke.importance for _, work in works):
                for side, work in works:
                    delay = self._missing_delay(work, stroke, option, side)
                    self.displaced[work.id] = displaced_outcome(work, side, stroke, delay)
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

    def _conflict_message(self, stroke: Stroke) -> str:
        """Return a message that names the conflict of the first hand option."""
        first_option = stroke.options[0]
        clashes = self._clashes(stroke, first_option)
        if clashes:
            side, works = next(iter(clashes.items()))
            return busy_with_stroke(stroke, side, works[-1], self._delay(works[-1], stroke))
        other = self._busy_conflicts(stroke, first_option)[0]
        return busy_with_block(stroke, other, self._travel_time(first_option, other.side))

    def _remedy_message(self, stroke: Stroke) -> str:
        """Return a message with a stroke time free of conflicts."""
        first_option = stroke.options[0]
        clashes = self._clashes(stroke, first_option)
        later = max(
            self._missing_delay(work, stroke, first_option, side) for side, row in clashes.items() for work in row
        )
        return remedy(stroke.times["stroke"] + later)

    def _missing_delay(self, work: HandStroke, stroke: Stroke, option: Poses, side: Side) -> float:
        """Return the delay that a stroke needs to follow another one [s]."""
        between = stroke.times["strokeStart"] - work.at("strokeEnd")
        return self._delay(work, stroke) or self.spacing.transition_time(work, stroke, option, side) - between
