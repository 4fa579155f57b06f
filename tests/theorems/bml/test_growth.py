"""The time to read a document grows linearly with its length."""

from collections.abc import Callable
from contextlib import suppress

import pytest

from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.realizer.request import block_id

from ...growth import LINEAR_GROWTH_LIMIT, growth

BLOCK_CONTENTS: dict[str, Callable[[int], str]] = {
    "blanks in a reference": lambda n: f'<head id="h" lexeme="NOD" start="a{n * " "}-b"/>',
    "blanks behind a sign": lambda n: f'<head id="h" lexeme="NOD" start="a +{n * " "}b"/>',
    "digits of a time": lambda n: f'<head id="h" lexeme="NOD" start="{n * "1"}x"/>',
    "digits of an offset": lambda n: f'<head id="h" lexeme="NOD" start="h:end+{n * "1"}x"/>',
    "signs of an offset": lambda n: f'<head id="h" lexeme="NOD" start="{n * "+1"}x"/>',
    "digits of a break": lambda n: f'<speech id="s"><text>a <break time="{n * "1"}x"/></text></speech>',
    "letters of a lexeme": lambda n: f'<gesture id="g" lexeme="{n * "aB1_"}"/>',
}
MAX_LENGTH = 2**19  # [characters] length of the longest accepted document


def read(text: str) -> None:
    with suppress(BmlError):
        parse(text)


@pytest.mark.parametrize("name", BLOCK_CONTENTS)
def test_parsing_time_grows_at_most_linearly_with_block_length(name: str) -> None:
    assert (
        growth(read, lambda size: f'<bml id="b">{BLOCK_CONTENTS[name](size)}</bml>', most=MAX_LENGTH)
        < LINEAR_GROWTH_LIMIT
    )


def test_parsing_time_grows_at_most_linearly_with_the_number_of_breaks_and_marks() -> None:
    def document(count: int) -> str:
        words = "".join(f'word <sync id="m{k}"/><break time="1ms"/> ' for k in range(count))
        return f'<bml id="b"><speech id="s"><text>{words}</text></speech></bml>'

    assert growth(read, document, most=4000) < LINEAR_GROWTH_LIMIT


@pytest.mark.parametrize("inside", ["{}!", "a{}!", "a({}!"])
def test_parsing_time_grows_at_most_linearly_with_composition_length(inside: str) -> None:
    def document(size: int) -> str:
        return f'<bml id="b" composition="{inside.format(size * " ")}"/>'

    assert growth(read, document, most=MAX_LENGTH) < LINEAR_GROWTH_LIMIT


@pytest.mark.parametrize("piece", ["<bml ", "<bml id", " id=", "<", "<a"])
def test_time_to_find_the_block_id_grows_at_most_linearly_with_text_length(piece: str) -> None:
    assert growth(block_id, lambda size: f"<bml {size * piece}", most=MAX_LENGTH) < LINEAR_GROWTH_LIMIT
    assert growth(block_id, lambda size: size * piece, most=MAX_LENGTH) < LINEAR_GROWTH_LIMIT
