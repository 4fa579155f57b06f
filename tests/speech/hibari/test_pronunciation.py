import pytest

from kinesic.body.utterance import STRESS_MARKS
from kinesic.speech.engines.engine_voice import EngineVoice
from kinesic.speech.hibari.model import load_model
from kinesic.speech.hibari.pronunciation import pronounce


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Hello, my friend.", {"Hello,": "həlO", "my": "mI", "friend.": "fɹɛnd"}),
        ("It is 3 km away", {"3": "θɹi", "away": "əwA"}),
        ("at 3:30 now", {"at": "æt", "3:30": "θɹiθɜɹTi", "now": "nW"}),
        ('He said "well-known".', {'"well-known".': "wɛlnOn"}),
    ],
)
def test_each_word_of_a_text_is_mapped_to_its_phoneme_letters(text: str, words: dict[str, str], neural: EngineVoice):
    reading = pronounce(text, load_model().letter_ids)
    spoken = {text[begin:end]: reading.letters[first:last] for (begin, end), (first, last) in reading.words}
    assert spoken.keys() == set(text.split())
    for word, letters in words.items():
        assert "".join(letter for letter in spoken[word] if letter.isalpha() and letter not in STRESS_MARKS) == letters


def test_full_stop_is_added_to_a_phrase_without_final_punctuation(neural: EngineVoice):
    letters = load_model().letter_ids
    assert pronounce("see you", letters).letters.endswith("u.")
    assert pronounce("see you,", letters).letters.endswith("u,")


def test_text_without_letters_has_no_words_to_pronounce(neural: EngineVoice):
    assert pronounce("...", load_model().letter_ids).words == ()


def test_inline_pronunciation_markup_of_hibari_is_ignored(neural: EngineVoice):
    assert "x" not in pronounce("[one](/xxx/) two", load_model().letter_ids).letters.split()[0]
