"""Tests of the ranked gestures that could be shown at a word."""

from pathlib import Path

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.search import find_gestures
from kinesic.intent.alternatives import BEAT_REASON, MAX_BEATS, OWN_REASON, Alternative, rank_alternatives
from kinesic.intent.behaviour_sets import builtin_sets

TEXT = "No, I did not say that! There were three big boxes."
LEXICON = Lexicon.load()


def ranked(word: str, text: str = TEXT, **options) -> tuple[Alternative, ...]:
    found, alternatives = rank_alternatives(text, text.index(word), LEXICON, builtin_sets(), **options)
    assert found == word
    return alternatives


def test_best_candidate_of_a_word_comes_first_with_its_reason_and_score():
    first = ranked("three")[0]
    assert (first.id, first.why) == ("count_three", "'three' is a number (0.68)")
    assert first.says == LEXICON.sense(LEXICON.find("count_three").form).says


def test_other_gestures_of_the_intent_in_the_query_follow_the_best_candidate():
    alternatives = ranked("No", intent="negation")
    assert alternatives[0].id == "no_low"
    same = [each.id for each in alternatives if each.why == "shows the same intent: negation"]
    assert {"no_wag", "refuse_push", "refuse_sweep"} <= set(same)
    assert [each.id for each in alternatives[1 : 1 + len(same)]] == same
    assert not [each for each in ranked("No") if "same intent" in each.why]


def test_word_without_candidates_is_offered_the_gestures_that_the_ranked_search_finds():
    hits = [hit.id for hit in find_gestures(LEXICON, "boxes", count=3)]
    assert [each.id for each in ranked("boxes") if each.why == "found for 'boxes'"][:3] == hits


def test_function_words_are_not_searched_for_alternative_gestures():
    assert find_gestures(LEXICON, "and"), "descriptions contain it"
    assert {each.why for each in ranked("and", text="They and I met.")} == {BEAT_REASON}


@pytest.mark.parametrize("word", ["that", "three"])
def test_alternatives_end_with_beats_and_list_no_gesture_twice(word: str):
    alternatives = ranked(word)
    assert [each.why for each in alternatives][-MAX_BEATS:] == MAX_BEATS * [BEAT_REASON]
    assert len({each.id for each in alternatives}) == len(alternatives)


def test_gesture_of_a_user_lexicon_is_offered_for_an_unrelated_word(tmp_path: Path):
    file = tmp_path / "mine.toml"
    file.write_text('category = "beat"\n[[gesture]]\nid = "mine"\nkeys = [{ right = { at = [0.5, 0.3, 0.5] } }]\n')
    _, alternatives = rank_alternatives(TEXT, TEXT.index("say"), Lexicon.load(file), builtin_sets())
    assert ("mine", OWN_REASON) in [(each.id, each.why) for each in alternatives]
    assert OWN_REASON not in [each.why for each in ranked("say")]


def test_number_of_alternative_gestures_of_a_word_is_limited(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("kinesic.intent.alternatives.MAX_ALTERNATIVES", 3)
    assert len(ranked("No")) == 3


def test_position_beyond_the_text_selects_its_last_word_and_a_blank_text_has_no_alternatives():
    assert rank_alternatives(TEXT, 10_000, LEXICON, builtin_sets())[0] == "boxes"
    assert rank_alternatives("  ", 0, LEXICON, builtin_sets()) == ("", ())


def test_alternatives_in_a_language_without_cues_end_with_a_beat():
    alternatives = ranked("sehr", "Das ist sehr gut.", language="de")
    assert alternatives[-1].why == BEAT_REASON
