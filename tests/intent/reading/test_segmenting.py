import pytest

from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import word_duration
from kinesic.intent.reading.segmenting import segment
from kinesic.intent.reading.words import read_text

from ...growth import STRAIGHT, growth


@pytest.mark.parametrize(
    "words",
    [
        "私 は あなた を 見 ます",
        "魚 を 食べ ません",
        "行か ない",
        "どこ に 行き ますか",
        "日本語 と ロボット",
        "大きな 手",
        "それ は 少ない",
        "かばんは ここ に あります",  # unknown in hiragana: nothing tells where it ends
    ],
)
def test_words_are_cut_at_particles_known_words_and_changes_of_script(words: str) -> None:
    assert segment(words.replace(" ", ""), load_language("ja")) == words.split()


def test_words_with_spaces_are_left_whole() -> None:
    assert segment("Wasser", load_language("de")) == ["Wasser"]


def test_a_question_is_told_by_its_last_word_or_its_wide_mark() -> None:
    japanese = load_language("ja")
    kinds = read_text("行きますか。行きます。行く\uff1f行く\uff01元気ですか", japanese).kinds
    assert kinds == ("question", "statement", "question", "exclamation", "question")


def test_commas_of_japanese_pause_and_its_words_take_time_by_their_morae() -> None:
    japanese = load_language("ja")
    pausing = read_text("犬、猫", japanese)
    assert pausing.starts[1] > word_duration(pausing.words[0]) + 0.1
    hello, cat = (read_text(text, japanese).words[0] for text in ("こんにちは", "きゃ"))
    assert word_duration(hello) > 3 * word_duration(cat)


@pytest.mark.parametrize("piece", ["漢", "あ", "は", "ロボットは", "ない"])
def test_twice_as_long_a_text_takes_at_most_twice_as_long(piece: str) -> None:
    japanese = load_language("ja")
    assert growth(lambda text: segment(text, japanese), lambda size: size * piece) < STRAIGHT
