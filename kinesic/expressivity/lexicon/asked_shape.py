"""Gives a gesture the hand shape that a document asks for, in place of its own."""

from dataclasses import replace

from kinesic.body.config import suggestion
from kinesic.expressivity.lexicon.form import GestureForm, StrokeKey
from kinesic.expressivity.lexicon.hand_shapes import find_shape, hand_shapes


def with_shape(form: GestureForm, shape: str) -> GestureForm:
    """Holds the hands of a gesture in a shape from the first key of its stroke to the last.

    Args:
        form: of the gesture.
        shape: in any system's words; one that nobody knows, or none, changes nothing.
    """
    known = find_shape(shape)
    if known is None:
        return form
    keys = (StrokeKey({side: replace(pose, shape=known.name) for side, pose in key.hands.items()}) for key in form.keys)
    return replace(form, keys=tuple(keys))


def unknown_shape(shape: str) -> str:
    """Says that a shape is unknown, and which are meant perhaps; empty of one that is known, or none."""
    if not shape or find_shape(shape) is not None:
        return ""
    return f"hand shape {shape!r} is unknown{suggestion(shape.lower(), list(hand_shapes()))}"
