from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.query_words import content_words, form_words, related_words, search_stem


def test_content_words_of_a_search_query_exclude_function_words_and_repetitions():
    assert content_words("Put the hand on your hand") == ("hand",)
    assert content_words("to the") == ("to", "the")
    assert content_words("") == ()


def test_related_search_words_are_found_for_inflected_words_and_compounds():
    assert "part" in related_words("apart")
    assert set(related_words("fingers")) == {"forefinger", "index"}
    assert related_words("violin") == ()


def test_inflected_forms_such_as_finger_and_fingers_have_the_same_search_stem():
    assert search_stem("fingers") == search_stem("finger")
    assert search_stem("waving") == search_stem("waves")


def test_search_words_of_a_gesture_include_two_handedness_and_touched_body_parts():
    forms = Lexicon.load().forms_by_id
    assert {"both", "two", "arm", "touch"} <= set(form_words(forms["adjust_cuff"]))
    assert {"head", "touch"} <= set(form_words(forms["think"]))
    assert "both" not in set(form_words(forms["think"]))
    assert list(form_words(forms["beat"])) == []
