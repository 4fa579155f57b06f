"""Messages about conflicts between strokes, with a time free of conflicts."""

from kinesic.body.robot import SIDE_NAMES, Side
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.expressivity.hands.strokes import HandStroke, Stroke
from kinesic.expressivity.keyframes import Outcome


def busy_with_stroke(stroke: Stroke, side: Side, work: HandStroke, delay: float) -> str:
    """Return a message about a hand that another stroke keeps busy.

    Args:
        stroke: stroke that needs the hand.
        side: side of the hand.
        work: stroke that the hand performs.
        delay: delay of the hand after that stroke [s]; 0 where the strokes overlap.
    """
    if delay > 0.0:
        previous = f"after the stroke of {work.id} at {work.at('stroke'):.2f} s"
        late = f"the {SIDE_NAMES[side]} hand is {delay:.2f} s late"
        return f"its stroke is at {stroke.times['stroke']:.2f} s; {previous}, {late}"
    use = f"the stroke of {work.id} until {work.at('strokeEnd'):.2f} s"
    return f"{_begins(stroke)}, the {SIDE_NAMES[side]} hand is busy with {use}"


def busy_with_block(stroke: Stroke, other: BusyHand, travel_time: float) -> str:
    """Return a message about a hand that another block keeps busy.

    The message includes the hand's travel time [s].
    """
    use = f"{other.by} until {other.end:.2f} s, and needs {travel_time:.2f} s to get there"
    return f"{_begins(stroke)}, the {SIDE_NAMES[other.side]} hand is busy with {use}"


def displaced_outcome(work: HandStroke, side: Side, stroke: Stroke, delay: float) -> Outcome:
    """Return the outcome of a stroke dropped for a more important stroke.

    Args:
        work: dropped stroke.
        side: side of the hand.
        stroke: more important stroke.
        delay: time by which the more important stroke comes too early [s].
    """
    use = f"the {SIDE_NAMES[side]} hand is needed for that of {stroke.id} at {stroke.times['stroke']:.2f} s"
    why = f"gives way to {stroke.id}, which is more important: its stroke ends at {work.at('strokeEnd'):.2f} s, {use}"
    return Outcome("dropped", f"{why}; {remedy(work.at('stroke') - delay)}")


def remedy(time: float) -> str:
    """Return a message that suggests a feasible stroke time [s]."""
    return f"with its stroke at {time:.2f} s there would be time"


def moved_outcome(option: frozenset[Side], hand_count: int, why: str) -> Outcome:
    """Return the outcome of a stroke performed by other or fewer hands.

    Args:
        option: hands that perform the stroke.
        hand_count: number of hands of the stroke's first option.
        why: conflict of the first option.
    """
    sides = sorted(option)
    if len(sides) < hand_count:
        return one_hand_outcome(sides[0], why)
    return Outcome("substituted", f"moved to the {' and '.join(SIDE_NAMES[side] for side in sides)} hand: {why}")


def brief_outcome(why: str) -> Outcome:
    """Return the outcome of a stroke shown as a pose without movement."""
    return Outcome("substituted", f"shown once, without its movement: {why}")


def one_hand_outcome(side: Side, why: str) -> Outcome:
    """Return the outcome of a two-handed stroke performed by one hand."""
    return Outcome("substituted", f"done by the {SIDE_NAMES[side]} hand alone: {why}")


def needed_elsewhere(side: Side, stroke: Stroke) -> str:
    """Return a message that a hand performs another stroke."""
    return f"the {SIDE_NAMES[side]} hand does {stroke.id} from {stroke.times['strokeStart']:.2f} s on"


def _begins(stroke: Stroke) -> str:
    return f"its stroke begins at {stroke.times['strokeStart']:.2f} s"
