"""Names of movements of head and trunk: whole words, never letters."""

import pytest

from kinesic.expressivity.lexicon.movement_words import (
    LONGEST_NAME,
    amplitude_factor,
    movement_words,
    read_head_name,
    read_trunk_name,
)


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        *[(name, "nod") for name in ("NOD", "HeadNod01", "Nod_Middle", "yes", "agreement", "up_and_down", "yeah_nod")],
        *[(name, "shake") for name in ("SHAKE", "no", "denial", "left_right", "side_to_side", "ShakeLeft")],
        *[(name, "direction") for name in ("DOWN_ASIDE_LEFT", "look_up", "Rightward", "Neutral", "tilted", "bow")],
    ],
)
def test_exact_names_and_synonyms(name: str, kind: str):
    found = read_head_name(name)
    assert found is not None
    assert (found.kind, found.stands_for) == (kind, "")


def test_a_word_more_is_said():
    for name, stands in (("nod_merrily", 'a nod stands for nod_merrily: "merrily" is left out'), ("sway", "a shake")):
        found = read_head_name(name)
        assert found is not None
        assert stands in found.stands_for


@pytest.mark.parametrize(
    "name",
    [
        *("upset", "uproar", "downtown", "leftover", "bright", "noddy", "handshake", "shake_hands", "side_glance"),
        *("left_behind", "cheer_up", "no_problem", "not_nod", "dont_shake", "no_nod", "turn", "nod " * LONGEST_NAME),
    ],
)
def test_what_only_looks_like_one_is_none(name: str):
    assert read_head_name(name) is None


def test_words_of_the_trunk_are_read_whole():
    assert read_trunk_name("LEANING_Backwards") == ("lean", "back")
    assert read_trunk_name("back_pain") == read_trunk_name("upset") == ()


def test_sizes_have_many_words():
    assert [amplitude_factor(movement_words(name)) for name in ("nod_slightly", "deep_nod", "nod")] == [0.5, 1.5, 1.0]
