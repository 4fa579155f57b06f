"""Measures BML as others expect it: scenarios, documents, the live server and its speech."""

from collections.abc import Iterator

from kinesic.bench.bml.conformance import play_suite
from kinesic.bench.bml.draft_names import judge_draft_names
from kinesic.bench.bml.expectations import (
    ExpectationVerdict,
    Parsing,
    ReferenceSuite,
    Scenarios,
    expected,
    verdict_figures,
)
from kinesic.bench.bml.parsing import judge_parsing, judge_references
from kinesic.bench.figure import Figure
from kinesic.controller.perform import set_up

SCENARIOS, DOCUMENTS, GRAMMAR = "realizertester", "openbmlparser", "syncref"  # suites, by the names of their files
NO_CORPUS = "no expectations of this suite; KINESIC_CORPUS names the folder that holds them"


def bench() -> list[Figure]:
    """Plays and reads every suite that is there."""
    return [*verdict_figures(list(verdicts())), *_missing()]


def verdicts() -> Iterator[ExpectationVerdict]:
    """Judges every expectation of all suites: of others, where they are, and our own."""
    yield from judge_draft_names(set_up())
    if (scenarios := expected(SCENARIOS, Scenarios)) is not None:
        yield from play_suite(SCENARIOS, *scenarios, set_up())
    if (documents := expected(DOCUMENTS, Parsing)) is not None:
        yield from judge_parsing(DOCUMENTS, *documents)
    if (grammar := expected(GRAMMAR, ReferenceSuite)) is not None:
        yield from judge_references(GRAMMAR, grammar[1])


def _missing() -> Iterator[Figure]:
    found = {
        SCENARIOS: expected(SCENARIOS, Scenarios),
        DOCUMENTS: expected(DOCUMENTS, Parsing),
        GRAMMAR: expected(GRAMMAR, ReferenceSuite),
    }
    for suite, there in found.items():
        if there is None:
            yield Figure(f"bml.{suite}.passed", None, "expectations", None, "higher", NO_CORPUS)
