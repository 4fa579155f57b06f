"""Posture and facial expression of each conversational state."""

from kinesic.conversation.settings import MODE_BEARINGS, RELAXED_BEARING
from kinesic.conversation.state import ConversationState
from kinesic.conversation.wants import ActionUnits, BodyLean, BriefExpression, HeldExpression, Mode, Want

GREETING_SMILE = (("6", 0.6), ("12", 0.9))  # action units of a greeting smile, with intensities 0..1
RAISED_BROWS = (("1", 0.5), ("2", 0.5))  # action units of surprise, with intensities 0..1
SMILE_DURATION = 1.5  # [s] duration of a greeting smile
BROWS_DURATION = 0.8  # [s] duration of raised brows


def mode_bearing(state: ConversationState, before: Mode) -> list[Want]:
    """Return the posture and expressions requested when a mode starts.

    Args:
        state: state with the new mode.
        before: previous mode.
    """
    bearing, earlier = (MODE_BEARINGS.get(mode, RELAXED_BEARING) for mode in (state.mode, before))
    wants: list[Want] = []
    if (bearing.lean, bearing.tilt) != (earlier.lean, earlier.tilt):
        side = 1.0 if state.draws % 2 else -1.0
        wants.append(BodyLean(state.amount * bearing.lean, state.amount * side * bearing.tilt, state.mode))
    if bearing.face != earlier.face:
        wants.append(HeldExpression(_scaled(bearing.face, state.amount), state.mode))
    if state.mode == "attending" and before in ("off", "idle"):
        wants.append(BriefExpression(_scaled(GREETING_SMILE, state.amount), SMILE_DURATION, state.mode))
    if state.mode == "interrupted":
        wants.append(BriefExpression(_scaled(RAISED_BROWS, state.amount), BROWS_DURATION, state.mode))
    return wants


def _scaled(units: ActionUnits, amount: float) -> ActionUnits:
    return tuple((unit, amount * value) for unit, value in units)
