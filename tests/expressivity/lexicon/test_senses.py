import pytest

from kinesic.expressivity.lexicon.senses import LexemeReading, Sense, nearest_sense, read_lexeme


@pytest.mark.parametrize(
    ("lexeme", "reading"),
    [
        ("past_Ges_L", LexemeReading(("past",), "left")),
        ("HandsTogetherR_Pos_B", LexemeReading(("hands", "together"), "both")),
        ("INFORM_GES_B_UP", LexemeReading(("inform", "up"), "both")),
        ("wave_right", LexemeReading(("wave",), "right")),
        ("right", LexemeReading(("right",), "unspecified")),
        ("beat4", LexemeReading(("beat",), "unspecified")),
        ("", LexemeReading((), "unspecified")),
        ("smile " * 100, LexemeReading((), "unspecified")),
    ],
)
def test_gesture_lexeme_is_split_into_words_and_hand(lexeme, reading):
    assert read_lexeme(lexeme) == reading


def test_nearest_gesture_sense_prefers_exact_words_to_inflections():
    senses = [Sense(("manipulate", "larger"), "iconic"), Sense(("other", "large"), "beat"), Sense(("x",), "iconic")]
    assert nearest_sense(["large"], senses) == (1, ("large",))
    assert nearest_sense(["larges"], senses) == (1, ("larges",))
    assert nearest_sense(["manip"], senses) is None
    assert nearest_sense(["iconic"], senses) == (0, ("iconic",))
    assert nearest_sense(["zzz"], senses) is None
    assert nearest_sense([], senses) is None
