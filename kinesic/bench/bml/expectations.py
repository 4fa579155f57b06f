"""Expectations of third-party tests as typed data, and the verdicts on them.

The schemas are documented in a page next to the files; `null` means that nothing is expected.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec

from kinesic.bench.blocks import find_corpus
from kinesic.bench.metric import Metric

EXPECTATIONS_FOLDER = "expectations"  # name of the folder in the corpus

Shape = TypeVar("Shape")
MIN_PASS_FRACTION = 0.97  # goal for the fraction of a suite's expectations that are met


class ScenarioStep(msgspec.Struct, frozen=True):
    """One action or check of a scenario."""

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
    cases: tuple["NamedCase", ...] = ()


class NamedCase(msgspec.Struct, frozen=True):
    """Checks to make only if a warning names a certain behaviour."""

    when_named: str
    then: tuple[ScenarioStep, ...]


class Scenario(msgspec.Struct, frozen=True):
    """Sequence of actions and checks that a BML realizer must pass."""

    steps: tuple[ScenarioStep, ...]


class ScenarioSuite(msgspec.Struct, frozen=True):
    """Conformance scenarios, and the BML documents that they send.

    Scenario names have the form `dialect/test`. A document's value names the scenarios that use it.
    """

    tolerance: float  # [s]
    timeout: float  # [s]
    documents: dict[str, tuple[str, ...] | None]
    scenarios: dict[str, Scenario]


class SyncOffset(msgspec.Struct, frozen=True):
    """A sync point `behaviour:sync` with an offset."""

    sync: str
    offset: float = 0.0  # [s]


class AfterExpectation(msgspec.Struct, frozen=True):
    """A sync point and the sync points that must not precede it."""

    ref: SyncOffset
    targets: tuple[SyncOffset | tuple[SyncOffset, ...], ...]


class DocumentExpectation(msgspec.Struct, frozen=True):
    """Expected parse result, constraints and behaviours of one BML document."""

    parse: str
    block: str | None = None
    constraints: tuple[tuple[SyncOffset, ...], ...] | None = None
    required_constraints: tuple[tuple[SyncOffset, ...], ...] | None = None
    after_constraints: tuple[AfterExpectation, ...] | None = None
    required_after_constraints: tuple[AfterExpectation, ...] | None = None
    behaviour_count: int | None = None
    required_behaviours: dict[str, bool] | None = None


class BehaviourFact(msgspec.Struct, frozen=True):
    """Expected value of one constraint query about behaviours of a block.

    `fact` names the query, such as `connected`; `behaviours` are its arguments.
    """

    fact: str
    value: bool | tuple[str | tuple[str, ...], ...]
    behaviours: tuple[str, ...] = ()


class InlineExpectation(msgspec.Struct, frozen=True):
    """A small BML block and the facts expected of it."""

    test: str
    bml: str
    strict: bool
    parse: str
    facts: tuple[BehaviourFact, ...] = ()


class ParsingSuite(msgspec.Struct, frozen=True):
    """Expected parse results and constraints of BML documents and inline blocks."""

    documents: dict[str, DocumentExpectation | None]
    inline: tuple[InlineExpectation, ...]


class ReferenceExpectation(msgspec.Struct, frozen=True):
    """A sync reference with its expected parts, or two references to compare."""

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
    """Expected results of parsing, comparing and writing sync references."""

    tolerance: float  # [s]
    accepted: tuple[ReferenceExpectation, ...]
    rejected: tuple[ReferenceExpectation, ...]
    equal: tuple[ReferenceExpectation, ...]
    not_equal: tuple[ReferenceExpectation, ...]
    written: tuple[ReferenceExpectation, ...]


def read_expectations(name: str, shape: type[Shape]) -> tuple[Path, Shape] | None:
    """Read a suite's expectations from the corpus, None if missing.

    Returns:
        The folder of the documents and the expectations about them.
    """
    folder = find_corpus()
    if folder is None or not (file := folder / EXPECTATIONS_FOLDER / f"{name}.json").is_file():
        return None
    return folder / name, msgspec.json.decode(file.read_bytes(), type=shape)


@dataclass(frozen=True)
class ExpectationVerdict:
    """Whether one expectation was met, with the reason of a failure."""

    suite: str
    name: str
    why: str = ""  # reason of the failure; empty if passed

    @property
    def passed(self) -> bool:
        """Whether the expectation is met."""
        return not self.why


def verdict_metrics(verdicts: Sequence[ExpectationVerdict]) -> Iterator[Metric]:
    """Yield each suite's numbers of passed and failed expectations, then each failure.

    Args:
        verdicts: verdicts of any suites.
    """
    for suite in dict.fromkeys(verdict.suite for verdict in verdicts):
        of_suite = [verdict for verdict in verdicts if verdict.suite == suite]
        failed = [verdict for verdict in of_suite if not verdict.passed]
        name = f"bml.{suite}"
        yield Metric(
            f"{name}.passed",
            len(of_suite) - len(failed),
            f"of {len(of_suite)}",
            MIN_PASS_FRACTION * len(of_suite),
            "higher",
        )
        yield Metric(
            f"{name}.failed", len(failed), f"of {len(of_suite)}", (1.0 - MIN_PASS_FRACTION) * len(of_suite), "lower"
        )
        for verdict in failed:
            yield Metric(f"{name}.{verdict.name}", 0.0, "passed", 1.0, "higher", verdict.why)
