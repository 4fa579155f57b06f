"""Twice as much of a document takes about twice as long to be read, whoever wrote it."""

from collections.abc import Callable
from contextlib import suppress

import pytest

from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.realizer.request import block_id

from ...growth import STRAIGHT, growth

INSIDE: dict[str, Callable[[int], str]] = {
    "blanks in a reference": lambda n: f'<head id="h" lexeme="NOD" start="a{n * " "}-b"/>',
    "blanks behind a sign": lambda n: f'<head id="h" lexeme="NOD" start="a +{n * " "}b"/>',
    "digits of a time": lambda n: f'<head id="h" lexeme="NOD" start="{n * "1"}x"/>',
    "digits of an offset": lambda n: f'<head id="h" lexeme="NOD" start="h:end+{n * "1"}x"/>',
    "signs of an offset": lambda n: f'<head id="h" lexeme="NOD" start="{n * "+1"}x"/>',
    "digits of a break": lambda n: f'<speech id="s"><text>a <break time="{n * "1"}x"/></text></speech>',
    "letters of a lexeme": lambda n: f'<gesture id="g" lexeme="{n * "aB1_"}"/>',
}
MOST = 2**19  # letters: more are refused


def read(text: str) -> None:
    with suppress(BmlError):
        parse(text)


@pytest.mark.parametrize("name", INSIDE)
def test_what_a_block_says(name: str) -> None:
    assert growth(read, lambda size: f'<bml id="b">{INSIDE[name](size)}</bml>', most=MOST) < STRAIGHT


def test_breaks_among_marks() -> None:
    def document(count: int) -> str:
        words = "".join(f'word <sync id="m{k}"/><break time="1ms"/> ' for k in range(count))
        return f'<bml id="b"><speech id="s"><text>{words}</text></speech></bml>'

    assert growth(read, document, most=4000) < STRAIGHT


@pytest.mark.parametrize("inside", ["{}!", "a{}!", "a({}!"])
def test_how_a_block_meets_others(inside: str) -> None:
    def document(size: int) -> str:
        return f'<bml id="b" composition="{inside.format(size * " ")}"/>'

    assert growth(read, document, most=MOST) < STRAIGHT


@pytest.mark.parametrize("piece", ["<bml ", "<bml id", " id=", "<", "<a"])
def test_its_id(piece: str) -> None:
    assert growth(block_id, lambda size: f"<bml {size * piece}", most=MOST) < STRAIGHT
    assert growth(block_id, lambda size: size * piece, most=MOST) < STRAIGHT
