"""Compact gesture vocabulary for language models: common gestures, names and ranked search."""

from typing import TYPE_CHECKING

from kinesic.mcp.document_schema import Json

if TYPE_CHECKING:
    from kinesic.expressivity.lexicon.lexicon import Lexicon

SCORE_DIGITS = 2  # decimal places of a gesture's relevance

# The most common gestures, by purpose.
COMMON_GESTURES = (
    *("greet_wave", "welcome", "greet_bow_hand", "applause", "thumb_up", "ok_ring"),  # greeting and feedback
    *("you", "me", "we", "left", "right", "up", "down", "that_far"),  # pointing
    *(
        "beat",
        "offer",
        "inform_spread",
        "beat_strong",
        "list_fingers",
        "count_one",
        "count_two",
        "count_three",
    ),  # speech
    *("large", "small_pinch", "balance", "contrast_left_right", "circle_drawn", "link_rings"),  # depictions
    *("doubt_shrug", "think", "stop", "refuse_sweep", "hush", "come", "go_away"),  # emblems
    *("heart", "joy_cheer", "sadness", "phone_call", "violin"),
)


def common_gestures(lexicon: "Lexicon") -> str:
    """Return the names of the most common gestures, less than 1 kB."""
    return ", ".join(name for name in COMMON_GESTURES if name in lexicon.forms_by_id)


def all_names(lexicon: "Lexicon") -> str:
    """Return the names of all gestures, less than 4 kB."""
    return " ".join(form.id for form in lexicon.forms)


def list_gesture_hits(lexicon: "Lexicon", query: str, category: str, count: int) -> list[dict[str, Json]]:
    """Return the gestures that match a query, best first, for JSON."""
    from kinesic.expressivity.lexicon.search import find_gestures  # noqa: PLC0415 - slow to import

    hits = find_gestures(lexicon, query, category=category, count=count)
    return [
        {"name": hit.id, "category": hit.category, "says": hit.says, "score": round(hit.score, SCORE_DIGITS)}
        for hit in hits
    ]
