"""Conformance benchmark: scenarios in virtual time, expectations about documents, metrics."""

import json
from collections import Counter
from functools import cache
from pathlib import Path

import pytest
from msgspec import structs

from kinesic.bench import bml
from kinesic.bench.blocks import find_corpus
from kinesic.bench.bml.conformance import CHECK_FUNCTIONS, place_targets, play_suite
from kinesic.bench.bml.draft_names import DRAFT_SCENARIOS, SUITE_NAME, DraftScenario, judge_scenario
from kinesic.bench.bml.expectations import (
    ExpectationVerdict,
    ParsingSuite,
    ReferenceSuite,
    ScenarioStep,
    ScenarioSuite,
    read_expectations,
    verdict_metrics,
)
from kinesic.bench.bml.parsing import judge_parsing, judge_references
from kinesic.bench.bml.virtual_realizer import FeedbackLog, Realizer, ReceivedMessage, read_message
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up

NOD_BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b1"><head id="h" lexeme="NOD" start="1" end="2"/></bml>'
)
LAMP_GAZE = '<bml id="b2" composition="append"><gaze id="g" target="lamp" start="0" end="2"/></bml>'


@cache
def shared_setup() -> Setup:
    """Return the setup of all scenarios, so that its limits are computed once."""
    return set_up()


def step(**fields: object) -> dict[str, object]:
    return fields


def suite(path: Path, name: str, *steps: dict[str, object]) -> ScenarioSuite:
    """Write and read a suite with one scenario over two documents."""
    documents = {"nod.xml": NOD_BLOCK, "look.xml": LAMP_GAZE}
    folder = path / "suite"
    folder.mkdir(exist_ok=True)
    for file, text in documents.items():
        (folder / file).write_text(text)
    (path / "expectations").mkdir(exist_ok=True)
    content = {
        "tolerance": 0.1,
        "timeout": 20,
        "documents": dict.fromkeys(documents, (name,)),
        "scenarios": {name: {"steps": steps}},
    }
    (path / "expectations" / "suite.json").write_text(json.dumps(content))
    read = read_expectations("suite", ScenarioSuite)
    assert read is not None
    assert read[0] == folder
    return read[1]


@pytest.fixture
def corpus(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("KINESIC_CORPUS", str(tmp_path))
    return tmp_path


SEND_NOD = step(do="send", document="nod.xml")
WAIT_FOR_END = step(do="wait_block_end", block="b1")


@pytest.mark.parametrize(
    ("steps", "why"),
    [
        (
            [
                SEND_NOD,
                WAIT_FOR_END,
                step(check="blocks", started=["b1"], ended=["b1"]),
                step(check="no_duplicate_feedback"),
            ],
            "",
        ),
        ([SEND_NOD, WAIT_FOR_END, step(check="sync_time", sync="b1:h:start", time=1.0, tolerance=0.1)], ""),
        (
            [SEND_NOD, WAIT_FOR_END, step(check="sync_time", sync="b1:h:start", time=1.5, tolerance=0.1)],
            "b1:h:start at 1.000 s",
        ),
        ([SEND_NOD, WAIT_FOR_END, step(check="sync_order", behaviour="b1:h", syncs=["start", "stroke", "end"])], ""),
        (
            [SEND_NOD, WAIT_FOR_END, step(check="sync_order", behaviour="b1:h", syncs=["end", "start"])],
            "start is missing",
        ),
        ([SEND_NOD, WAIT_FOR_END, step(check="warnings", count=1)], "0 warnings, not 1"),
        ([SEND_NOD, step(do="wait_sync", sync="b1:h:stroke"), step(check="blocks", started=["b1"], ended=[])], ""),
        ([SEND_NOD, step(do="wait_block_end", block="b9")], "block b9 does not end within 20 s"),
        ([step(do="send", inline_block={"id": "x"}), step(do="sleep", seconds=1), step(check="warnings", count=0)], ""),
        ([SEND_NOD, WAIT_FOR_END, step(do="clear_feedback"), step(check="blocks", started=[], ended=[])], ""),
        ([step(do="dance")], "'dance' is not a known action"),
        ([step(check="mood")], "'mood' is not a known check"),
        (
            [
                SEND_NOD,
                step(do="send", document="look.xml"),
                step(do="wait_block_end", block="b2"),
                step(check="block_starts_when_block_ends", start_of="b2", end_of="b1", tolerance=0.1),
                step(check="block_duration_positive", block="b2"),
                step(check="warnings", count=0),
            ],
            "",
        ),
    ],
)
def test_conformance_scenario_passes_or_gives_the_reason_of_its_failure(
    corpus: Path, steps: list[dict[str, object]], why: str
) -> None:
    scenarios = suite(corpus, "one/test", *steps)
    (verdict,) = play_suite("suite", corpus / "suite", scenarios, shared_setup())
    assert (verdict.suite, verdict.name) == ("suite", "one.test")
    assert why in verdict.why
    assert verdict.passed is (why == "")


def test_document_without_behaviours_is_an_error_in_draft_1_but_not_in_bml_1_scenarios(corpus: Path) -> None:
    steps = [step(do="send", inline_block={}), step(do="sleep", seconds=1), step(check="exceptions", count=1)]
    (verdict,) = play_suite("suite", corpus / "suite", suite(corpus, "draft1/test", *steps), shared_setup())
    assert verdict.passed
    (verdict,) = play_suite("suite", corpus / "suite", suite(corpus, "bml-1/test", *steps), shared_setup())
    assert verdict.why.startswith("0 exceptions")


def test_only_gaze_targets_missing_from_the_setup_are_placed_in_front_of_the_robot() -> None:
    setup = shared_setup()
    positions = place_targets([LAMP_GAZE.encode(), b"no bml", b'<bml><gaze target="user"/></bml>'], setup)
    assert set(positions) == {"lamp"}
    assert positions["lamp"][0] > 1.0


def feedback_of(*ids: str, kind: str = "syncPointProgress") -> FeedbackLog:
    return FeedbackLog(ReceivedMessage(kind, id, global_time=float(k), time=float(k)) for k, id in enumerate(ids))


@pytest.mark.parametrize(
    ("check", "feedback", "why"),
    [
        (
            ScenarioStep(check="no_duplicate_feedback"),
            feedback_of("b:h:start", "b:h:start"),
            "reported more than once: b:h:start",
        ),
        (
            ScenarioStep(check="sync_before_time", sync="b:h:end", time=1.0),
            feedback_of("b:h:start", "b:h:end"),
            "b:h:end at 1.000 s",
        ),
        (ScenarioStep(check="sync_after_time", sync="b:h:end", time=0.5), feedback_of("b:h:start", "b:h:end"), ""),
        (ScenarioStep(check="sync_time", sync="b:h:end"), feedback_of(), "b:h:end was not reported"),
        (
            ScenarioStep(check="syncs_coincide", a="b:h:start", b="b:g:end", a_offset=1.0),
            feedback_of("b:h:start", "b:g:end"),
            "",
        ),
        (
            ScenarioStep(check="syncs_coincide", a="b:h:start", b="b:g:end"),
            feedback_of("b:h:start", "b:g:end"),
            "1.000 s apart",
        ),
        (ScenarioStep(check="syncs_coincide", a="b:h:start", b="b:g:end"), feedback_of(), "b:h:start was not reported"),
        (
            ScenarioStep(check="blocks", started=("b",)),
            feedback_of("c:start", kind="blockProgress"),
            "start of blocks ['c']",
        ),
        (
            ScenarioStep(check="block_duration_positive", block="b"),
            feedback_of("b:start", kind="blockProgress"),
            "0.0 to None",
        ),
        (
            ScenarioStep(check="sync_times_not_negative"),
            FeedbackLog([ReceivedMessage("syncPointProgress", "b:h:x", time=-1.0)]),
            "b:h:x",
        ),
        (
            ScenarioStep(check="one_behaviour_named", among=("b:g",)),
            feedback_of("b:h", kind="warningFeedback"),
            "['b:h'] named",
        ),
    ],
)
def test_scenario_check_of_feedback_passes_or_gives_the_reason_of_its_failure(
    check: ScenarioStep, feedback: FeedbackLog, why: str
) -> None:
    reason = CHECK_FUNCTIONS[check.check](check, feedback)
    assert why in reason
    assert bool(reason) is bool(why)


def test_xml_feedback_message_is_parsed() -> None:
    xml = '<syncPointProgress id="b:h:start" time="1.5" globalTime="2.5"/>'
    assert read_message(xml) == ReceivedMessage("syncPointProgress", "b:h:start", 2.5, 1.5)


def test_realizer_answers_a_malformed_document_with_a_warning() -> None:
    realizer = Realizer(shared_setup())
    realizer.send("<bml", source="f")
    (message,) = realizer.feedback.messages
    assert (message.kind, message.id) == ("warningFeedback", "block")
    assert "f:1:" in message.text


def test_metrics_of_conformance_suites_count_passed_and_failed_expectations() -> None:
    metrics = list(
        verdict_metrics(
            [ExpectationVerdict("s", "a"), ExpectationVerdict("s", "b", "too late"), ExpectationVerdict("t", "c")]
        )
    )
    assert [(metric.name, metric.value, metric.ok) for metric in metrics] == [
        ("bml.s.passed", 1, False),
        ("bml.s.failed", 1, False),
        ("bml.s.b", 0.0, False),
        ("bml.t.passed", 1, True),
        ("bml.t.failed", 0, True),
    ]
    assert metrics[2].why == "too late"


def test_empty_corpus_gives_null_metrics_except_for_built_in_draft_scenarios(corpus: Path) -> None:
    metrics = bml.bench()
    own = [metric for metric in metrics if metric.name.startswith(f"bml.{SUITE_NAME}.")]
    others = [metric for metric in metrics if metric not in own]
    assert [metric.value for metric in others] == [None, None, None]
    assert all("KINESIC_CORPUS" in metric.why for metric in others)
    assert [metric.value for metric in own] == [len(DRAFT_SCENARIOS), 0]
    assert find_corpus() == corpus


def test_scenario_verdict_names_sync_points_at_wrong_times_and_missing_ones() -> None:
    content = '<gesture id="g" type="beat" stroke_start="2.0"/>'
    assert judge_scenario(DraftScenario(content, {"g:strokeStart": 2.0}), shared_setup()) == ""
    late = DraftScenario(content, {"g:strokeStart": 1.0, "h:stroke": 2.0})
    assert judge_scenario(late, shared_setup()) == "g:strokeStart at 2.000 s, not at 1 s; h:stroke never, not at 2 s"


def test_all_bml_conformance_expectations_of_the_corpus_pass() -> None:
    if read_expectations(bml.SCENARIO_SUITE, ScenarioSuite) is None:
        pytest.skip("no corpus; KINESIC_CORPUS names its folder")
    metrics = list(bml.verdicts())
    assert [(verdict.suite, verdict.name, verdict.why) for verdict in metrics if not verdict.passed] == []
    assert min(Counter(verdict.suite for verdict in metrics).values()) >= 19


def test_parsing_benchmark_fails_if_accepted_and_rejected_documents_are_swapped() -> None:
    documents, grammar = (
        read_expectations(bml.DOCUMENT_SUITE, ParsingSuite),
        read_expectations(bml.GRAMMAR_SUITE, ReferenceSuite),
    )
    if documents is None or grammar is None:
        pytest.skip("no corpus; KINESIC_CORPUS names its folder")
    folder, suite_data = documents
    flipped = {"ok": "error", "error": "ok"}
    wrong = replace_all(suite_data, flipped)
    assert not any(verdict.passed for verdict in judge_parsing("d", folder, wrong))
    swapped = ReferenceSuite(
        grammar[1].tolerance, (), grammar[1].accepted, grammar[1].not_equal, grammar[1].equal, grammar[1].written
    )
    assert sum(verdict.passed for verdict in judge_references("g", swapped)) == len(swapped.written)


def replace_all(suite_data: ParsingSuite, opposites: dict[str, str]) -> ParsingSuite:
    """Return the suite with accepted and refused documents exchanged."""
    documents = {
        name: structs.replace(document, parse=opposites[document.parse]) if document else None
        for name, document in suite_data.documents.items()
    }
    return ParsingSuite(
        documents, tuple(structs.replace(item, parse=opposites[item.parse]) for item in suite_data.inline)
    )
