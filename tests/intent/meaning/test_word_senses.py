"""Tests of word senses: meanings with the syntax in which words have them."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours
from kinesic.intent.meaning.cue_table import load_cues, load_senses
from kinesic.intent.meaning.senses import read_senses

LEXICON, NEUTRAL = Lexicon.load(), Style.load("neutral")


def pictures(text: str, *, seed: int = 0) -> set[str]:
    """Return the illustrating gestures of a text."""
    _, selection = plan_behaviours(text, LEXICON, NEUTRAL, seed=seed)
    shown = {behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == "gesture"}
    return {lexeme for lexeme in shown if not lexeme.startswith("beat")}


@pytest.mark.parametrize(
    ("fitting", "other", "gesture"),
    [
        ("The flags are drooping.", "We saw the droop of the flags.", "fall"),
        ("The smoke was rising.", "The rising was in March.", "rise"),
        ("My suitcase is roomy.", "I keep a roomy.", "large"),
        ("I am terrified.", "My uncle is terrified.", "fear"),
        ("We drifted apart.", "The drift was slow.", "break_apart"),
        ("It gets louder and louder.", "It does not get louder and louder.", "rise"),
        ("Shush, the baby sleeps.", "I told them to shush the crowd.", "hush"),
        ("It costs us a packet.", "We bought a packet of tea.", "money"),
    ],
)
def test_word_has_its_gesture_only_in_the_syntax_of_its_sense(fitting: str, other: str, gesture: str):
    assert gesture in set.union(*(pictures(fitting, seed=seed) for seed in range(4)))
    assert not any(gesture in pictures(other, seed=seed) for seed in range(2))


def test_irregular_forms_of_a_verb_have_the_word_sense_of_the_verb():
    for text in ("We all shrank back and it sank.", "Then the ship sank.", "The old ship has sunk."):
        assert "fall" in pictures(text)
    assert pictures("They drove us apart and we grew apart.") & {"break_apart", "contrast_left_right"}


def test_word_sense_gives_no_gesture_in_a_sentence_with_a_cue():
    assert pictures("I have no idea, it is gigantic.") <= {"doubt_shrug", "shrug_small", "large"}
    assert pictures("No problem, I'm terrified.") == {"open_low"}


def test_idiom_listed_with_a_gesture_overrides_an_idiom_without_one():
    assert pictures("That really hit the spot!") & {"thumb_up_low", "ok_ring"}
    assert not pictures("We hit the road at six.")


def test_denied_fact_gets_a_denying_gesture_unless_it_is_asked_or_forbidden():
    denying = {"no_low", "refuse_sweep"}
    assert pictures("I don't eat meat on Fridays.") & denying
    assert pictures("We have not sold the boat.") & denying
    for text in (
        "If you don't eat meat, say so.", "Don't sell the boat.", "She doesn't eat meat on Fridays at the club.",
        "He said that we don't eat meat.", "I was not exactly pleased.", "We never had a better summer.",
    ):  # fmt: skip
        assert not pictures(text) & denying, text


def test_pattern_without_its_optional_content_words_does_not_match_function_words():
    assert pictures("We ate only a few crumbs!") & {"small_pinch", "tiny_low", "narrow_low"}
    assert not pictures("We waited a few hours.") & {"small_pinch", "tiny_low", "narrow_low"}
    assert "that_low" in pictures("And there he stood.")


def test_key_and_point_as_things_get_no_gesture_of_importance():
    importance = {"focus", "beat_ring"}
    assert pictures("The key to all this is patience.") & importance
    assert pictures("The main point is that we are late.") & importance
    assert pictures("That is the whole point.") & importance
    assert not pictures("You get the key at reception.") & importance
    assert not pictures("The point of the needle is blunt.") & importance


def test_sea_that_is_only_a_destination_or_place_is_not_drawn():
    assert "sea" in pictures("The ocean was rough.")
    assert "sea" not in pictures("You change at Crewe for the coast.")
    assert "sea" not in pictures("The house is by the sea.")


def test_short_echo_question_gets_an_asking_gesture():
    assert pictures("Like what?") == {"ask_open"}
    assert "ask_open" not in pictures("I know what.")


def test_time_at_the_end_of_a_plain_report_gets_no_gesture():
    assert pictures("Two years ago, the bridge fell down.") & {"past_over_shoulder", "before_that", "fall"}
    assert not pictures("The engineer looked at the boiler two years ago.")


def test_word_senses_name_only_lexicon_gestures_and_each_has_a_pattern():
    known = {entry.id for entry in LEXICON.entries}
    table = load_senses("en")
    assert {name for sense in table.cues for name in sense.shows} <= known
    assert all(sense.patterns and sense.shows for sense in table.cues)
    assert sum(len(sense.patterns) for sense in table.cues) > 2000
    assert not load_senses("de").cues
    assert not load_cues("de").cues


def test_word_sense_with_an_unknown_syntactic_frame_is_refused(tmp_path: Path):
    (tmp_path / "wrong.toml").write_text('[[sense]]\nsays = "x"\nwords = "y"\nframe = "adverb"\n')
    with pytest.raises(ConfigError, match="frame"):
        list(read_senses(tmp_path, {}))
