import pytest

from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import word_duration
from kinesic.intent.reading.segmenting import segment
from kinesic.intent.reading.words import read_text

from ...growth import LINEAR_GROWTH_LIMIT, growth


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
        "ロボットー 犬",
        "猫 ロボット",
        "ァヺ 犬",
        "犬 ABC",
        "ABC 犬",
        "人々",
        "かばんは ここ に あります",  # Unknown hiragana words have no visible end
    ],
)
def test_japanese_text_is_segmented_into_words(words: str) -> None:
    assert segment(words.replace(" ", ""), load_language("ja")) == words.split()


def test_text_of_languages_with_spaces_is_not_segmented() -> None:
    assert segment("Wasser", load_language("de")) == ["Wasser"]


def test_japanese_question_is_recognised_by_its_last_word_or_mark() -> None:
    japanese = load_language("ja")
    kinds = read_text("行きますか。行きます。行く\uff1f行く\uff01元気ですか", japanese).kinds
    assert kinds == ("question", "statement", "question", "exclamation", "question")


def test_japanese_commas_add_a_pause_and_word_durations_follow_morae() -> None:
    japanese = load_language("ja")
    pausing = read_text("犬、猫", japanese)
    assert pausing.starts[1] > word_duration(pausing.words[0]) + 0.1
    hello, cat = (read_text(text, japanese).words[0] for text in ("こんにちは", "きゃ"))
    assert word_duration(hello) > 3 * word_duration(cat)


@pytest.mark.parametrize("piece", ["漢", "あ", "は", "ロボットは", "ない"])
def test_segmentation_time_is_linear_in_text_length(piece: str) -> None:
    japanese = load_language("ja")
    assert growth(lambda text: segment(text, japanese), lambda size: size * piece) < LINEAR_GROWTH_LIMIT
