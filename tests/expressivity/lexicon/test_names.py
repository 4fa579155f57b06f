import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.names import GestureName, read_name, split_words


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("GreetWave-RH2", ("greet", "wave", "rh", "2")),
        ("INFORM_GES_B_UP", ("inform", "ges", "b", "up")),
        ("LHandOnHip_Motex", ("l", "hand", "on", "hip", "motex")),
        ("cup-flip_2H_2", ("cup", "flip", "2h", "2")),
        ("don't", ("dont",)),
        ("déjà vu", ("déjà", "vu")),
        ("", ()),
    ],
)
def test_gesture_name_is_split_at_marks_capitals_and_numbers(name, words):
    assert split_words(name) == words


@pytest.mark.parametrize(
    ("name", "words", "hand"),
    [
        ("past_Ges_L", ("past",), "left"),
        ("HandsTogetherR_Pos_B", ("hands", "together"), "both"),
        ("Point_Left_RH", ("point", "left"), "right"),
        ("beat_chop_mid_LH", ("beat", "chop", "mid"), "left"),
        ("walls_2H", ("walls",), "both"),
        ("ChopBt01", ("chop", "1"), "both"),
        ("The Point of a Pen", ("point", "of", "pen"), "unspecified"),
        ("animations/Stand/Emotions/Negative/Angry_1", ("angry", "1"), "unspecified"),
        ("yes/no", ("yes", "no"), "unspecified"),
        ("RH", (), "right"),
    ],
)
def test_gesture_name_gives_words_and_hand(name, words, hand):
    assert read_name(name) == GestureName(words, hand)


def shorter(name):
    return [(item.words, item.hand, item.left_out) for item in read_name(name).shortened()]


def test_gesture_name_is_shortened_by_number_then_category_then_qualifier_or_hand():
    assert shorter("you_iconic_left_low_1") == [
        (("you", "iconic", "left", "low", "1"), "unspecified", ()),
        (("you", "iconic", "left", "low"), "unspecified", ()),
        (("you", "left", "low"), "unspecified", ()),
        (("you", "left"), "unspecified", ("low",)),
        (("you", "low"), "left", ()),
        (("you",), "left", ("low",)),
    ]


def test_word_arm_after_the_hand_letter_of_a_gesture_name_is_removed_last():
    assert shorter("RArm_Offer_low")[-1] == (("offer",), "right", ("low",))
    assert (("arm", "offer", "low"), "right", ()) in shorter("RArm_Offer_low")
    assert shorter("OfferArm_R")[-1] == (("offer", "arm"), "right", ())


def test_side_word_of_a_gesture_name_that_contradicts_the_suffix_is_reported():
    assert shorter("StopLeftRt")[-1] == (("stop",), "right", ("left",))
    assert shorter("StopRightRt")[-1] == (("stop",), "right", ())
    assert shorter("Stop_left_right")[-1] == (("stop",), "unspecified", ("left", "right"))


@pytest.mark.parametrize("name", ["left", "3", "iconic", "low", "very", "left right"])
def test_gesture_name_of_only_removable_words_keeps_them(name):
    assert shorter(name)[-1] == (tuple(name.split()), "unspecified", ())


def test_qualifier_words_are_removed_only_at_the_ends_of_a_gesture_name():
    assert shorter("very_slow_wave_big")[-1] == (("wave",), "unspecified", ("very", "slow", "big"))
    assert shorter("count_big_boxes")[-1][0] == ("count", "big", "boxes")


@given(st.text(max_size=60))
def test_any_gesture_name_text_is_shortened_without_error(text):
    for item in read_name(text).shortened():
        assert bool(item.words) == bool(read_name(text).words)
        assert set(item.words) <= set(read_name(text).words)


@pytest.mark.parametrize(
    ("name", "gesture", "side"),
    [
        *(("RArm_Offer", "offer", "r"), ("LArm_Offer", "offer", "l"), ("RHand_Offer", "offer", "r")),
        *(("RArm_Stop", "stop", "r"), ("RHandStop", "stop", "r"), ("RHandThumbUp", "thumb_up", "r")),
        *(("LArm_Greet", "greet_wave", "l"), ("RArm_Shrug", "doubt_shrug", "r")),
        *(("RArmUp", "raise_hand", "r"), ("LHandOnHip", "hand_on_hip", "l"), ("RHandShake", "handshake", "r")),
    ],
)
def test_body_part_word_with_a_side_letter_in_a_gesture_name_selects_the_hand(name, gesture, side):
    match = Lexicon.load().find(name)
    assert match is not None
    assert (match.form.id, match.form.sides, match.substitute) == (gesture, {side}, "")
