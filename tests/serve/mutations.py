"""Deterministic mutations of documents that produce hostile documents."""

import random
import re
from collections.abc import Callable

HOSTILE_NUMBERS = (
    b"1e308",
    b"-1e9",
    b"nan",
    b"inf",
    b"0",
    b"-0.000001",
    b"99999999999999999999",
    b"1e-320",
    b"",
    b"abc",
    b"1,5",
)
NESTING_DEPTH = 3000  # number of nested elements
INSERTED_SIZE = 20_000  # [bytes] size of an inserted sequence of equal bytes

_ATTRIBUTE_PATTERN = re.compile(
    rb'\b(\w++)="([^"]*)"'
)  # starts at a word boundary, so that long words are scanned once
_ELEMENT_PATTERN = re.compile(rb"<\w[^<>]*/>")


def mutate(document: bytes, seed: int) -> bytes:
    """Apply one to three mutations to a document.

    Args:
        document: any document.
        seed: seed of all random choices.
    """
    chance = random.Random(seed)
    for _ in range(chance.randint(1, 3)):
        document = chance.choice(ALL_MUTATIONS)(document, chance)
    return document


def _truncated(document: bytes, chance: random.Random) -> bytes:
    return document[: chance.randrange(len(document) + 1)]


def _flipped(document: bytes, chance: random.Random) -> bytes:
    """Return the bytes with one bit flipped."""
    data = bytearray(document)
    for _ in range(chance.randint(1, 8) if data else 0):
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    return bytes(data)


def _swapped(document: bytes, chance: random.Random) -> bytes:
    """Exchange the values of two attributes."""
    results = list(_ATTRIBUTE_PATTERN.finditer(document))
    if len(results) < 2:
        return document
    one, two = sorted(chance.sample(results, 2), key=lambda match: match.start())
    parts = (document[: one.start(2)], two[2], document[one.end(2) : two.start(2)], one[2], document[two.end(2) :])
    return b"".join(parts)


def _with_number(document: bytes, chance: random.Random) -> bytes:
    """Set an attribute to a nonsensical number."""
    results = list(_ATTRIBUTE_PATTERN.finditer(document))
    if not results:
        return document
    one = chance.choice(results)
    return document[: one.start(2)] + chance.choice(HOSTILE_NUMBERS) + document[one.end(2) :]


def _deepened(document: bytes, chance: random.Random) -> bytes:
    place = chance.randrange(len(document) + 1)
    depth = chance.choice((10, 60, 70, NESTING_DEPTH))
    return document[:place] + b"<a>" * depth + b"</a>" * depth + document[place:]


def _repeated(document: bytes, chance: random.Random) -> bytes:
    """Repeat an element many times."""
    results = list(_ELEMENT_PATTERN.finditer(document))
    if not results:
        return document
    one = chance.choice(results)
    return document[: one.end()] + one[0] * chance.choice((1, 3, 40)) + document[one.end() :]


def _lengthened(document: bytes, chance: random.Random) -> bytes:
    place = chance.randrange(len(document) + 1)
    return document[:place] + bytes([chance.randrange(256)]) * INSERTED_SIZE + document[place:]


def _spliced(document: bytes, chance: random.Random) -> bytes:
    """Copy a piece of the document to another position."""
    begin, end = sorted(chance.randrange(len(document) + 1) for _ in range(2))
    place = chance.randrange(len(document) + 1)
    return document[:place] + document[begin:end] + document[place:]


ALL_MUTATIONS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    _truncated,
    _flipped,
    _swapped,
    _with_number,
    _deepened,
    _repeated,
    _lengthened,
    _spliced,
)
