"""Reads what the tests of others state about documents, as typed data, and says what became of each expectation.

The schemas of the files stand in a page beside them; `null` means that nothing is stated.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec

from kinesic.bench.blocks import corpus_folder
from kinesic.bench.figure import Figure

EXPECTATIONS = "expectations"

Shape = TypeVar("Shape")
GOAL = 0.97  # share of a suite that must pass


class Step(msgspec.Struct, frozen=True):
    """One thing to do, or to check, in a scenario."""

    do: str = ""
    check: str = ""
    document: str = ""
    inline_block: dict[str, str] | None = None
    block: str = ""
    behaviour: str = ""
    sync: str = ""
    syncs: tuple[str, ...] = ()
    seconds: float = 0.0  # [s]
    time: float = 0.0  # [s]
    tolerance: float | None = None  # [s]
    count: int = 0
    started: tuple[str, ...] = ()
    ended: tuple[str, ...] = ()
    a: str = ""
    b: str = ""
    a_offset: float = 0.0  # [s]
    b_offset: float = 0.0  # [s]
    start_of: str = ""
    end_of: str = ""
    among: tuple[str, ...] = ()
    within: str = msgspec.field(default="", name="in")
    cases: tuple["Case", ...] = ()


class Case(msgspec.Struct, frozen=True):
    """Steps for when one behaviour was named."""

    when_named: str
    then: tuple[Step, ...]


class Scenario(msgspec.Struct, frozen=True):
    """Steps in order."""

    steps: tuple[Step, ...]


class Scenarios(msgspec.Struct, frozen=True):
    """A suite of scenarios over documents; names are `suite/test`."""

    tolerance: float  # [s]
    timeout: float  # [s]
    documents: dict[str, tuple[str, ...] | None]
    scenarios: dict[str, Scenario]


class Time(msgspec.Struct, frozen=True):
    """A sync point `behaviour:sync` and an offset."""

    sync: str
    offset: float = 0.0  # [s]


class Later(msgspec.Struct, frozen=True):
    """Points that are not before another."""

    ref: Time
    targets: tuple[Time | tuple[Time, ...], ...]


class Stated(msgspec.Struct, frozen=True):
    """What is stated about one document."""

    parse: str
    block: str | None = None
    constraints: tuple[tuple[Time, ...], ...] | None = None
    required_constraints: tuple[tuple[Time, ...], ...] | None = None
    after_constraints: tuple[Later, ...] | None = None
    required_after_constraints: tuple[Later, ...] | None = None
    behaviour_count: int | None = None
    required_behaviours: dict[str, bool] | None = None


class Fact(msgspec.Struct, frozen=True):
    """What is stated about behaviours of a block."""

    fact: str
    value: bool | tuple[str | tuple[str, ...], ...]
    behaviours: tuple[str, ...] = ()


class Inline(msgspec.Struct, frozen=True):
    """A small block with what is stated about it."""

    test: str
    bml: str
    strict: bool
    parse: str
    facts: tuple[Fact, ...] = ()


class Parsing(msgspec.Struct, frozen=True):
    """A suite about what documents mean before any time is known."""

    documents: dict[str, Stated | None]
    inline: tuple[Inline, ...]


class ReferenceExpectation(msgspec.Struct, frozen=True):
    """One sync reference, or two to be compared, with what it is."""

    test: str
    default_block: str
    input: str = ""
    a: str = ""
    b: str = ""
    block: str = ""
    behaviour: str = ""
    sync: str = ""
    iteration: int | None = None
    offset: float = 0.0  # [s]
    text: str = ""
    relative_to: str | None = None


class ReferenceSuite(msgspec.Struct, frozen=True):
    """A suite about the grammar of sync references."""

    tolerance: float  # [s]
    accepted: tuple[ReferenceExpectation, ...]
    rejected: tuple[ReferenceExpectation, ...]
    equal: tuple[ReferenceExpectation, ...]
    not_equal: tuple[ReferenceExpectation, ...]
    written: tuple[ReferenceExpectation, ...]


def expected(name: str, shape: type[Shape]) -> tuple[Path, Shape] | None:
    """Reads a file of expectations by its name; None where there is no corpus, or no such file in it.

    Returns:
        The folder of the documents that the file is about, and what it states.
    """
    where = corpus_folder()
    if where is None or not (file := where / EXPECTATIONS / f"{name}.json").is_file():
        return None
    return where / name, msgspec.json.decode(file.read_bytes(), type=shape)


@dataclass(frozen=True)
class ExpectationVerdict:
    """One expectation."""

    suite: str
    name: str
    why: str = ""  # it failed; empty: passed

    @property
    def passed(self) -> bool:
        """Whether it holds."""
        return not self.why


def verdict_figures(verdicts: Sequence[ExpectationVerdict]) -> Iterator[Figure]:
    """Counts for each suite how many pass and how many fail, and says for each that fails why.

    Args:
        verdicts: of any suites.
    """
    for suite in dict.fromkeys(verdict.suite for verdict in verdicts):
        own = [verdict for verdict in verdicts if verdict.suite == suite]
        failed = [verdict for verdict in own if not verdict.passed]
        name = f"bml.{suite}"
        yield Figure(f"{name}.passed", len(own) - len(failed), f"of {len(own)}", GOAL * len(own), "higher")
        yield Figure(f"{name}.failed", len(failed), f"of {len(own)}", (1.0 - GOAL) * len(own), "lower")
        for verdict in failed:
            yield Figure(f"{name}.{verdict.name}", 0.0, "passed", 1.0, "higher", verdict.why)
