"""Tests of the preferences of a style among alternative gestures."""

from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author_text
from kinesic.intent.behaviour_sets import Choice
from kinesic.intent.pacing.accents import RHYTHM_INTENT
from kinesic.intent.pacing.variety import prefer
from kinesic.session.setup import set_up

LEXICON = set_up().lexicon
STORY = (
    "The new plan has three parts. We meet on Monday morning in the other room and look at every page of it. "
    "After that the paper goes to the office, and everybody writes an answer until the end of the week."
)


def beats(style):
    texts = [author_text(STORY, LEXICON, Style.load(style), seed=seed).bml for seed in range(6)]
    return [part.split('"')[0] for text in texts for part in text.split('lexeme="')[1:] if part.startswith("beat")]


def test_angry_beats_are_often_hard_and_sad_beats_often_small_and_never_hard():
    hard, small = (
        {"beat_strong", "beat_edge", "beat_finger", "beat_fist_palm"},
        {"beat_low", "beat_small", "beat_wrist"},
    )
    angry, sad = beats("angry"), beats("sad")
    assert sum(name in hard for name in angry) > 0.4 * len(angry)
    assert not any(name in hard for name in sad)
    assert sum(name in small for name in sad) > 0.4 * len(sad)


def test_style_preferences_weight_alternatives_and_add_beats_only_to_rhythmic_gestures():
    choices = (Choice("beat", 0.5), Choice("beat_low", 0.5))
    preferences = {"beat_low": 0.5, "beat_edge": 3.0, "akimbo": 9.0}
    assert prefer(choices, preferences, RHYTHM_INTENT) == (
        Choice("beat", 0.5),
        Choice("beat_low", 0.25),
        Choice("beat_edge", 1.5),
    )
    assert prefer(choices, preferences, "greeting") == (Choice("beat", 0.5), Choice("beat_low", 0.25))
    assert prefer((), preferences, RHYTHM_INTENT) == ()
