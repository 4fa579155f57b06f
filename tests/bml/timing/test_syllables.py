import pytest

from kinesic.bml.block import Behaviour, Block, Head, Place, Speech, SyncRef
from kinesic.bml.timing.syllables import find_accented_vowels, find_syllable_end, find_syllables
from kinesic.body.utterance import Phoneme, Script, Utterance


def sounds(text):
    """Return phonemes of 0.1 s each.

    An apostrophe marks primary stress, a comma secondary stress.
    """
    symbols = text.replace("'", "\u02c8").replace(",", "\u02cc").split()
    return tuple(Phoneme(symbol, 0.1 * k, 0.1) for k, symbol in enumerate(symbols))


@pytest.mark.parametrize(
    ("text", "ends"),
    [
        ("b i g 'i n", 0.4),  # stressed vowel, not the first one
        ("f 'u l", 0.2),
        ("g ,u d", 0.2),
        ("h o u s e", 0.3),  # letters instead of phonemes, without stress
        ("p s t", None),
    ],
)
def test_syllable_ends_with_its_accented_vowel(text, ends):
    assert find_syllable_end(sounds(text), 0.0) == (None if ends is None else pytest.approx(ends))


def test_accented_syllable_is_searched_only_in_the_word_at_the_speech_mark():
    spoken = sounds("'a b ə d ə k l m n o 'a")
    assert find_syllable_end(spoken, 0.1) == pytest.approx(0.3)
    assert find_syllable_end(spoken, 2.0) is None


def nod(stroke, offset=0.0):
    """Return a block with a nod at a speech mark at 0.2 s."""
    at = SyncRef("b", "s", stroke, offset=offset)
    speech = Behaviour("s", "speech", Speech(Script("x")), Place(1, 1))
    block = Block("b", (speech, Behaviour("n", "head", Head("NOD"), Place(1, 1), syncs={"stroke": at})))
    return find_syllables(block, {"s": Utterance(0.6, {"m": 0.2}, sounds("p a t 'a k a"))})


def test_nod_delay_to_the_syllable_end_is_reduced_by_the_reference_offset():
    assert nod("m") == {("n", "stroke"): pytest.approx(0.2)}
    assert nod("m", 0.15) == {("n", "stroke"): pytest.approx(0.05)}
    assert nod("m", 0.3) == nod("end") == {}
    assert nod("start") == {("n", "stroke"): pytest.approx(0.4)}


def test_accents_are_in_the_middle_of_stressed_vowels_or_else_of_all_vowels():
    assert find_accented_vowels(sounds("b i g 'i n ,u 'a")) == pytest.approx([0.35, 0.65])
    assert find_accented_vowels(sounds("h o u s e")) == pytest.approx([0.15, 0.25, 0.45])
    assert find_accented_vowels(sounds("p s t")) == []
