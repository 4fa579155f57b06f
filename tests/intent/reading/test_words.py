import pytest

from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text

from ...growth import LINEAR_GROWTH_LIMIT, growth


@pytest.mark.parametrize(
    ("text", "pauses"),
    [
        ('one <break time="2s"/> two', [0.0, 2.0]),
        ("one <break strength='x' time = '.5ms'> two", [0.0, 0.0005]),
        ('one <break time="2min" time="1s"/> two', [0.0, 1.0]),
        ('one <break time="99s"/> two', [0.0, 10.0]),
        ('one </break time="2s"> two', [0.0, 0.0]),
        ('one <breaks time="2s"/> two', [0.0, 0.0]),
        ('one <b time="2s"/> two', [0.0, 0.0]),
    ],
)
def test_break_tag_adds_a_pause(text: str, pauses: list[float]) -> None:
    assert [word.pause for word in read_text(text, load_language()).words] == pytest.approx(pauses, abs=0.0006)


def test_emphasis_tag_stresses_words_and_other_tags_are_ignored() -> None:
    text = "one <Emphasis level='strong'>two</Emphasis> <s>three</s> <emphasis-less>four</emphasis-less>"
    words = read_text(text, load_language()).words
    assert [word.plain for word in words if word.emphatic] == ["two"]
    assert [word.plain for word in words] == ["one", "two", "three", "four"]


@pytest.mark.parametrize("piece", ["<break ", "<break time='1s' ", "<a-", "-a", "time=", "<break time='1"])
def test_reading_time_of_a_text_is_linear_in_its_number_of_tags(piece: str) -> None:
    language = load_language()
    assert growth(lambda text: read_text(text, language), lambda size: f"<break {size * piece}") < LINEAR_GROWTH_LIMIT


def test_name_of_capitals_and_digits_is_spelled_out() -> None:
    words = read_text("WW2, 3D, H2O, CO2, 5G, A4 and B2B.", load_language()).words
    assert " ".join(word.text for word in words) == "W W 2 3 D H 2 O C O 2 5 G A 4 and B 2 B"
