"""Tests of the ranked gestures that could be shown at a word."""

from pathlib import Path

import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.search import find_gestures
from kinesic.intent.alternatives import BEAT_REASON, MAX_BEATS, OWN_REASON, Alternative, QueriedWord, rank_alternatives
from kinesic.intent.behaviour_sets import builtin_sets

TEXT = "No, I did not say that! There were three big boxes."
LEXICON = Lexicon.load()


UPPER22, UPPER36 = Robot.load("upper22"), Robot.load("upper36")


def ranked(word: str, text: str = TEXT, robot: Robot = UPPER36, **options) -> tuple[Alternative, ...]:
    queried = QueriedWord(text, text.index(word), **options)
    found, alternatives = rank_alternatives(queried, LEXICON, builtin_sets(), robot)
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
    queried = QueriedWord(TEXT, TEXT.index("say"))
    _, alternatives = rank_alternatives(queried, Lexicon.load(file), builtin_sets(), UPPER36)
    assert ("mine", OWN_REASON) in [(each.id, each.why) for each in alternatives]
    assert OWN_REASON not in [each.why for each in ranked("say")]


def test_number_of_alternative_gestures_of_a_word_is_limited(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("kinesic.intent.alternatives.MAX_ALTERNATIVES", 3)
    assert len(ranked("No")) == 3


def test_position_beyond_the_text_selects_its_last_word_and_a_blank_text_has_no_alternatives():
    assert rank_alternatives(QueriedWord(TEXT, 10_000), LEXICON, builtin_sets(), UPPER36)[0] == "boxes"
    assert rank_alternatives(QueriedWord("  ", 0), LEXICON, builtin_sets(), UPPER36) == ("", ())


def test_alternatives_that_need_fingers_come_last_among_those_with_the_same_reason_on_a_robot_without_fingers():
    alternatives, with_fingers = (ranked("No", robot=robot, intent="negation") for robot in (UPPER22, UPPER36))
    for why in {each.why for each in alternatives}:
        lacking = [bool(each.lacks) for each in alternatives if each.why == why]
        assert lacking == sorted(lacking)
    assert any(each.lacks.endswith(" fingers") for each in alternatives)
    assert not any(each.lacks for each in with_fingers)
    assert [each.id for each in alternatives] != [each.id for each in with_fingers]


def test_alternative_that_the_robot_would_replace_for_lack_of_fingers_is_offered_as_its_replacement():
    text = "It was very small."
    names = [[each.id for each in ranked("small", text, robot)] for robot in (UPPER22, UPPER36)]
    assert "tiny_low" in names[1]
    assert "tiny_low" not in names[0]
    assert names[0][0] == LEXICON.find("tiny_low").form.fallback


def test_alternatives_in_a_language_without_cues_end_with_a_beat():
    alternatives = ranked("sehr", "Das ist sehr gut.", language="de")
    assert alternatives[-1].why == BEAT_REASON
