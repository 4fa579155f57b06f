"""The gestures as a language model can afford to know them: the usual ones, all names, and a search."""

from dataclasses import dataclass

from kinesic.expressivity.lexicon.lexicon import Lexicon

# What people do most, by what it is for.
USUAL = (
    *("greet_wave", "welcome", "greet_bow_hand", "applause", "thumb_up", "ok_ring"),  # to somebody
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
    *("large", "small_pinch", "balance", "contrast_left_right", "circle_drawn", "link_rings"),  # pictures
    *("doubt_shrug", "think", "stop", "refuse_sweep", "hush", "come", "go_away"),  # what is meant
    *("heart", "joy_cheer", "sadness", "phone_call", "violin"),
)
MOST_FOUND = 25


@dataclass(frozen=True)
class FoundGesture:
    """A gesture that a search found."""

    name: str
    category: str
    says: str  # what is done, in one sentence


def usual_gestures(lexicon: Lexicon) -> str:
    """Lists the gestures that are used most, in less than a kilobyte."""
    return ", ".join(name for name in USUAL if name in lexicon.forms_by_id)


def all_names(lexicon: Lexicon) -> str:
    """Lists the names of all gestures, in less than four kilobytes."""
    return " ".join(form.id for form in lexicon.forms)


def search_gestures(lexicon: Lexicon, query: str, category: str = "") -> tuple[FoundGesture, ...]:
    """Finds gestures by name, meaning and category.

    Args:
        lexicon: that is searched.
        query: words that all occur; empty: every gesture.
        category: of the gestures; empty: any.

    Returns:
        `MOST_FOUND` at most, those first whose name has the words.
    """
    words = query.lower().split()
    found = []
    for form, sense in zip(lexicon.forms, lexicon.senses, strict=True):
        about = f"{form.id} {form.category} {sense.says} {' '.join(sense.words)}".lower()
        if category in ("", form.category) and all(word in about for word in words):
            found.append((not all(word in form.id for word in words), FoundGesture(form.id, form.category, sense.says)))
    return tuple(each for _, each in sorted(found, key=lambda pair: pair[0])[:MOST_FOUND])
