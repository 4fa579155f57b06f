"""Replacement of a gesture's hand shape by the requested one."""

from dataclasses import replace

from kinesic.body.config import suggestion
from kinesic.expressivity.lexicon.form import GestureForm, StrokeKey
from kinesic.expressivity.lexicon.hand_shapes import find_shape, hand_shapes


def with_shape(form: GestureForm, shape: str) -> GestureForm:
    """Set the hand shape of all stroke keys of a gesture.

    Args:
        form: of the gesture.
        shape: name in any supported system; an unknown or empty name changes nothing.
    """
    hand_shape = find_shape(shape)
    if hand_shape is None:
        return form
    keys = (
        StrokeKey({side: replace(pose, shape=hand_shape.name) for side, pose in key.hands.items()}) for key in form.keys
    )
    return replace(form, keys=tuple(keys))


def unknown_shape(shape: str) -> str:
    """Return a message about an unknown hand shape, with similar names.

    It is empty for known shapes and for an empty name.
    """
    if not shape or find_shape(shape) is not None:
        return ""
    return f"hand shape {shape!r} is unknown{suggestion(shape.lower(), list(hand_shapes()))}"
