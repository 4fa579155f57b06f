"""Says in words why a stroke does not have the hands that it asked for, and when it would have had them."""

from kinesic.body.robot import SIDE_NAMES, Side
from kinesic.expressivity.hands.engaged import Engaged
from kinesic.expressivity.hands.strokes import HandStroke, Stroke
from kinesic.expressivity.keyframes import Outcome


def busy_with_stroke(stroke: Stroke, side: Side, work: HandStroke, late: float) -> str:
    """Says what a hand does when a stroke needs it.

    Args:
        stroke: that needs it.
        side: of the hand.
        work: that the hand does.
        late: [s] by which the hand comes from there too late; 0 where the strokes overlap.
    """
    if late > 0.0:
        times = (
            f"from that of {work.id} at {work.at('stroke'):.2f} s the {SIDE_NAMES[side]} hand comes {late:.2f} s late"
        )
        return f"its stroke is at {stroke.times['stroke']:.2f} s, {times}"
    need = f"the stroke of {work.id} until {work.at('strokeEnd'):.2f} s"
    return f"{_begins(stroke)}, the {SIDE_NAMES[side]} hand is busy with {need}"


def busy_with_block(stroke: Stroke, other: Engaged, way: float) -> str:
    """Says which other block needs a hand, and how long the hand takes to come [s]."""
    need = f"{other.by} until {other.end:.2f} s, and needs {way:.2f} s to come"
    return f"{_begins(stroke)}, the {SIDE_NAMES[other.side]} hand is busy with {need}"


def displaced_outcome(work: HandStroke, side: Side, stroke: Stroke, lacking: float) -> Outcome:
    """Drops what a hand did for a stroke that counts for more, and that comes too early by some time [s]."""
    need = f"the {SIDE_NAMES[side]} hand is needed for that of {stroke.id} at {stroke.times['stroke']:.2f} s"
    why = f"gives way to {stroke.id}, which counts for more: its stroke ends at {work.at('strokeEnd'):.2f} s, {need}"
    return Outcome("dropped", f"{why}; {remedy(work.at('stroke') - lacking)}")


def remedy(time: float) -> str:
    """Says at what time [s] a stroke would have its hands."""
    return f"with its stroke at {time:.2f} s there would be time"


def moved_outcome(option: frozenset[Side], whole: int, why: str) -> Outcome:
    """Says by which hands a stroke is done that asked for others, or for `whole` hands."""
    sides = sorted(option)
    if len(sides) < whole:
        return one_hand_outcome(sides[0], why)
    return Outcome("substituted", f"moved to the {' and '.join(SIDE_NAMES[side] for side in sides)} hand: {why}")


def brief_outcome(why: str) -> Outcome:
    """Says that of a stroke only its key is shown."""
    return Outcome("substituted", f"shown once, without its movement: {why}")


def one_hand_outcome(side: Side, why: str) -> Outcome:
    """Says that one hand does alone what both were asked for."""
    return Outcome("substituted", f"done by the {SIDE_NAMES[side]} hand alone: {why}")


def needed_elsewhere(side: Side, stroke: Stroke) -> str:
    """Says what a hand does that a stroke of two hands has lost."""
    return f"the {SIDE_NAMES[side]} hand does {stroke.id} from {stroke.times['strokeStart']:.2f} s on"


def _begins(stroke: Stroke) -> str:
    return f"its stroke begins at {stroke.times['strokeStart']:.2f} s"
