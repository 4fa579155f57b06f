"""Mutations of valid inputs, guided by new outcomes instead of code coverage."""

import re
from collections.abc import Callable
from random import Random

TOKENS = (  # bytes that readers treat specially
    *(b"\0", b"\n", b"\r\n", b" ", b"\t", b"\xff", b"\xef\xbb\xbf", b"\xed\xa0\x80", b"\xf0\x9f\x98\x80"),
    *(b"0", b"-1", b"1e308", b"-1e999", b"nan", b"inf", b"1" * 400, b"0x10", b"1_000", b"true", b"null", b"''"),
    *(b"<", b">", b"</", b"/>", b"<!--", b"<![CDATA[", b"&amp;", b"&#0;", b"&x;", b"<!DOCTYPE a [<!ENTITY b 'c'>]>"),
    *(b"{", b"}", b"[", b"]", b"[[", b"[" * 2000, b'"', b"=", b",", b":", b"id", b"\\u0000", b"\\ud800", b"xmlns"),
    *(b"\xff\xff\xfd\x00", b"\x00\x00\x00\x80", b"\xff\xff\xff\xff", b"PK\x03\x04", b"RIFF", b"data"),
)
SPECIAL_NUMBERS = (b"0", b"-1", b"1e308", b"nan", b"1e-320", b"99999999999")
MAX_SIZE = 200_000  # [bytes] largest mutated input
MAX_POOL = 400  # number of inputs that mutations start from
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")


def mutate(data: bytes, chance: Random, others: list[bytes]) -> bytes:
    """Return an input with one to four random changes.

    Args:
        data: input to be changed.
        chance: source of random numbers.
        others: inputs from which pieces may be copied.
    """
    for _ in range(chance.randint(1, 4)):
        begin = chance.randrange(len(data) + 1)
        end = min(len(data), begin + chance.choice((0, 1, 1, 2, 4, 16, 64, 400)))
        match chance.randrange(8):
            case 0:
                data = data[:begin] + chance.choice(TOKENS) + data[end:]
            case 1:
                data = data[:begin] + data[end:]
            case 2:
                data = data[:end] + data[begin:end] * chance.choice((1, 2, 30)) + data[end:]
            case 3:
                data = data[:begin] + bytes(chance.randrange(256) for _ in range(end - begin)) + data[end:]
            case 4:
                data = data[:begin] if chance.random() < 0.3 else data
            case 5:
                data = _with_number(data, chance)
            case 6:
                other = chance.choice(others)
                place = chance.randrange(len(other) + 1)
                data = data[:begin] + other[place : place + chance.choice((4, 40, 400))] + data[end:]
            case _:
                changed = bytearray(data)
                for _ in range(chance.randint(1, 4) if changed else 0):
                    changed[chance.randrange(len(changed))] ^= 1 << chance.randrange(8)
                data = bytes(changed)
    return data[:MAX_SIZE]


def _with_number(data: bytes, chance: Random) -> bytes:
    """Replace one of the first numbers by a special one."""
    found = [match for _, match in zip(range(200), NUMBER.finditer(data), strict=False)]
    if not found:
        return data
    one = chance.choice(found)
    return (
        data[: one.start()]
        + chance.choice((b"0", b"-1", b"1e308", b"nan", b"1e-320", b"99999999999"))
        + data[one.end() :]
    )


class Pool:
    """Inputs that led to different outcomes, from which mutations start."""

    def __init__(self, seeds: tuple[bytes, ...], chance: Random) -> None:
        self._seeds, self._inputs, self._chance = list(seeds), list(seeds), chance
        self._outcomes = set[str]()

    def draw(self) -> bytes:
        """Return a new input by mutation.

        In half of the cases it comes from a valid input.
        """
        start = self._chance.choice(self._seeds if self._chance.random() < 0.5 else self._inputs)
        return mutate(start, self._chance, self._inputs)

    def keep(self, data: bytes, outcome: str) -> None:
        """Keep an input with a new outcome.

        Numbers and quoted words of the message are ignored in the comparison.
        """
        kind = re.sub(r"'[^']*'|\d+", "", outcome)[:200]
        if kind not in self._outcomes and len(self._inputs) < MAX_POOL:
            self._outcomes.add(kind)
            self._inputs.append(data)


def outcome_of(read: Callable[[bytes], object], data: bytes, refusals: tuple[type[Exception], ...]) -> str:
    """Read an input and return the message of a refusal.

    The message is empty for an accepted input. Other errors pass through.
    """
    try:
        read(data)
    except refusals as error:
        return str(error) or type(error).__name__
    return ""
