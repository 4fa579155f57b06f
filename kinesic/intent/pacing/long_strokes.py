"""Gestures with a long stroke, which accompanies a word."""

from collections.abc import Collection, Iterable, Mapping

from kinesic.expressivity.style.style import Style

STROKE_LEAD = 0.6  # [s] from the start of a long stroke to its word
USUAL_STROKE = 0.55  # [s] stroke duration of most gestures that are not in `LONG_STROKES`, in the neutral style
SLOWNESS_BASE = 2.3  # duration of an air drawing at temporal -1 / duration at 0; 1.42 at -0.4, 1.64 at -0.6 on `human`
MAX_STROKE_DELAY = 1.6  # [s] longest delay of a gesture's stroke point after its word
LONG_STROKES: Mapping[str, float] = {
    "around_here": 1.6,
    "brush_teeth": 2.4,
    "circle_drawn": 1.3,
    "crazy": 1.8,
    "decline_curve": 1.2,
    "dream_off": 2.7,
    "everything_circle": 1.6,
    "fire": 2.3,
    "flow": 2.2,
    "growth_curve": 1.4,
    "hands_converge": 1.1,
    "handshake": 1.9,
    "joy_bounce": 1.5,
    "listen": 1.1,
    "money": 1.5,
    "one_after_another": 1.3,
    "overhead_sweep": 1.1,
    "pat_tummy": 1.7,
    "path_along": 1.7,
    "piano": 2.5,
    "pull_rope": 1.6,
    "rain": 2.4,
    "ride_horse": 3.2,
    "river": 3.2,
    "sea": 2.8,
    "shake_fist": 1.4,
    "slow_glide": 2.4,
    "spiral_stairs": 2.3,
    "square": 1.2,
    "stairs_up": 1.2,
    "steering_wheel": 1.2,
    "stir": 2.1,
    "sunrise": 1.4,
    "turn_key": 1.1,
    "vase": 1.2,
    "walk_fingers": 2.3,
    "wind": 1.9,
}  # [s] natural time from a gesture's start to its stroke point, in the neutral style


def slowness_of(style: Style) -> float:
    """Return duration / neutral duration of air-drawing strokes, at least 1."""
    return float(max(1.0, SLOWNESS_BASE**-style.gesture.temporal))


def stroke_delay(lexemes: Collection[str], slowness: float = 1.0) -> float:
    """Return the delay [s] of a gesture's stroke after its word.

    A stroke of usual length is delayed only in a slow style, so that no stroke begins much earlier than `STROKE_LEAD`
    before its word. The delay is at most `MAX_STROKE_DELAY`.

    Args:
        lexemes: gestures of which one is shown; their mean duration counts.
        slowness: factor on the duration of long strokes, from `slowness_of`.
    """
    if not lexemes:
        return 0.0
    durations = (slowness * LONG_STROKES.get(lexeme, USUAL_STROKE) for lexeme in lexemes)
    mean = sum(max(duration, STROKE_LEAD) for duration in durations) / len(lexemes)
    return min(mean - STROKE_LEAD, MAX_STROKE_DELAY)


def is_in_long_stroke(at: float, strokes: Iterable[tuple[str, float]]) -> bool:
    """Return whether a long stroke is under way at a time.

    Args:
        at: time of a beat [s].
        strokes: gestures with their stroke times [s].
    """
    return any(0.0 <= time - at < LONG_STROKES.get(lexeme, 0.0) for lexeme, time in strokes)
