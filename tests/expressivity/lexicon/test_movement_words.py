"""Tests of head and trunk movement names: whole words, never single letters."""

import pytest

from kinesic.expressivity.lexicon.movement_words import (
    MAX_NAME_LENGTH,
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
def test_names_of_head_movements_are_classified_as_nod_shake_or_direction(name: str, kind: str):
    matches = read_head_name(name)
    assert matches is not None
    assert (matches.kind, matches.stands_for) == (kind, "")


def test_unused_word_of_a_head_movement_name_is_reported():
    for name, stands in (("nod_merrily", 'a nod stands for nod_merrily: "merrily" is left out'), ("sway", "a shake")):
        matches = read_head_name(name)
        assert matches is not None
        assert stands in matches.stands_for


@pytest.mark.parametrize(
    "name",
    [
        *("upset", "uproar", "downtown", "leftover", "bright", "noddy", "handshake", "shake_hands", "side_glance"),
        *("left_behind", "cheer_up", "no_problem", "not_nod", "dont_shake", "no_nod", "turn", "nod " * MAX_NAME_LENGTH),
    ],
)
def test_words_similar_to_head_movements_are_not_recognised(name: str):
    assert read_head_name(name) is None


def test_trunk_words_are_matched_as_whole_words():
    assert read_trunk_name("LEANING_Backwards") == ("lean", "back")
    assert read_trunk_name("back_pain") == read_trunk_name("upset") == ()


def test_size_words_of_a_head_movement_set_the_amplitude_factor():
    assert [amplitude_factor(movement_words(name)) for name in ("nod_slightly", "deep_nod", "nod")] == [0.5, 1.5, 1.0]
