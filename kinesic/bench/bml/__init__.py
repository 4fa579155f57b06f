"""Benchmarks of BML: conformance, the live server and synthesised speech."""

from collections.abc import Iterator

from kinesic.bench.bml.conformance import play_suite
from kinesic.bench.bml.draft_names import judge_draft_names
from kinesic.bench.bml.expectations import (
    ExpectationVerdict,
    ParsingSuite,
    ReferenceSuite,
    ScenarioSuite,
    read_expectations,
    verdict_metrics,
)
from kinesic.bench.bml.parsing import judge_parsing, judge_references
from kinesic.bench.metric import Metric
from kinesic.session.setup import set_up

SCENARIO_SUITE = "realizertester"  # name of the suite of conformance scenarios, and of its files in the corpus
DOCUMENT_SUITE = "openbmlparser"  # name of the suite of parsed documents
GRAMMAR_SUITE = "syncref"  # name of the suite of sync references
MISSING_SUITE = "no expectations of this suite: KINESIC_CORPUS must name the folder that holds them"


def bench() -> list[Metric]:
    """Run every available BML suite and count met expectations."""
    return [*verdict_metrics(list(verdicts())), *_missing()]


def verdicts() -> Iterator[ExpectationVerdict]:
    """Yield the verdict on each expectation of all available suites."""
    yield from judge_draft_names(set_up())
    if (scenarios := read_expectations(SCENARIO_SUITE, ScenarioSuite)) is not None:
        yield from play_suite(SCENARIO_SUITE, *scenarios, set_up())
    if (documents := read_expectations(DOCUMENT_SUITE, ParsingSuite)) is not None:
        yield from judge_parsing(DOCUMENT_SUITE, *documents)
    if (grammar := read_expectations(GRAMMAR_SUITE, ReferenceSuite)) is not None:
        yield from judge_references(GRAMMAR_SUITE, grammar[1])


def _missing() -> Iterator[Metric]:
    suites = {
        SCENARIO_SUITE: read_expectations(SCENARIO_SUITE, ScenarioSuite),
        DOCUMENT_SUITE: read_expectations(DOCUMENT_SUITE, ParsingSuite),
        GRAMMAR_SUITE: read_expectations(GRAMMAR_SUITE, ReferenceSuite),
    }
    for suite, expectations in suites.items():
        if expectations is None:
            yield Metric(f"bml.{suite}.passed", None, "expectations", None, "higher", MISSING_SUITE)
