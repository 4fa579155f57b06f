"""The time to choose behaviours grows linearly with the input."""

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author
from kinesic.intent.fml.author import author_fml

from ...growth import LINEAR_GROWTH_LIMIT, growth

INITIAL_SIZE = 40  # number of text pieces or intents in the first measurement
TEXT_PIECES = (
    "no ",
    "no, ",
    "you I ",
    "so happy! ",
    pytest.param("NO so ", marks=pytest.mark.soak),
    "a, b and c, ",
    ":) a ",
    "!",
    "ly",
    "<break ",
    pytest.param("<break time='1s' ", marks=pytest.mark.soak),
    "<a-",
)


@pytest.fixture(scope="module")
def lexicon() -> Lexicon:
    return Lexicon.load()


@pytest.mark.parametrize("piece", TEXT_PIECES)
def test_authoring_time_grows_at_most_linearly_with_text_length(piece: str, lexicon: Lexicon) -> None:
    style = Style.load("neutral")
    assert (
        growth(lambda text: author(text, lexicon, style), lambda size: size * piece, size=INITIAL_SIZE)
        < LINEAR_GROWTH_LIMIT
    )


@pytest.mark.parametrize(
    ("kind", "time"),
    [
        ('emotion type="joy"', "s:m{k}"),
        ('performative type="agree"', "{k}"),
        ('certainty type="x"', "s:start"),
        ('emotion type="joy"', "nowhere"),
        ('performative type="agree"', "s:m{k}"),
    ],
)
def test_authoring_time_grows_at_most_linearly_with_the_number_of_intents(kind: str, time: str) -> None:
    def document(count: int) -> str:
        inside = "".join(f'word <tm id="m{k}"/><pitchaccent start="s:m{k}" end="s:m{k}+0.2"/>' for k in range(count))
        intentions = "".join(f'<{kind} start="{time.format(k=k)}" end="s:end"/>' for k in range(count))
        return f'<fml-apml><bml id="b"><speech id="s">{inside}</speech></bml><fml>{intentions}</fml></fml-apml>'

    assert growth(author_fml, document, size=INITIAL_SIZE) < LINEAR_GROWTH_LIMIT


def test_authoring_time_grows_at_most_linearly_with_intent_name_length() -> None:
    def document(size: int) -> str:
        return f'<fml-apml><bml id="b"/><fml><emotion type="{size * "a-"}" start="0"/></fml></fml-apml>'

    assert growth(author_fml, document, most=2**17) < LINEAR_GROWTH_LIMIT
