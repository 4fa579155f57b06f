"""The conformance bench: scenarios in virtual time, expectations about documents, and what a figure says."""

import json
from collections import Counter
from pathlib import Path

import pytest
from msgspec import structs

from kinesic.bench import bml
from kinesic.bench.blocks import corpus_folder
from kinesic.bench.bml.conformance import CHECKS, place_targets, play_suite
from kinesic.bench.bml.draft_names import SCENARIOS, SUITE, DraftScenario, judge_scenario
from kinesic.bench.bml.expectations import (
    ExpectationVerdict,
    Parsing,
    ReferenceSuite,
    Scenarios,
    Step,
    expected,
    verdict_figures,
)
from kinesic.bench.bml.parsing import judge_parsing, judge_references
from kinesic.bench.bml.virtual_realizer import Feedback, Realizer, ReceivedMessage, read_message
from kinesic.controller.perform import set_up

NOD = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b1"><head id="h" lexeme="NOD" start="1" end="2"/></bml>'
)
LOOK = '<bml id="b2" composition="append"><gaze id="g" target="lamp" start="0" end="2"/></bml>'


def step(**told: object) -> dict[str, object]:
    return told


def suite(path: Path, name: str, *steps: dict[str, object]) -> Scenarios:
    """A suite of one scenario over documents of our own."""
    documents = {"nod.xml": NOD, "look.xml": LOOK}
    where = path / "suite"
    where.mkdir(exist_ok=True)
    for file, text in documents.items():
        (where / file).write_text(text)
    (path / "expectations").mkdir(exist_ok=True)
    told = {
        "tolerance": 0.1,
        "timeout": 20,
        "documents": dict.fromkeys(documents, (name,)),
        "scenarios": {name: {"steps": steps}},
    }
    (path / "expectations" / "suite.json").write_text(json.dumps(told))
    found = expected("suite", Scenarios)
    assert found is not None
    assert found[0] == where
    return found[1]


@pytest.fixture
def corpus(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("KINESIC_CORPUS", str(tmp_path))
    return tmp_path


SEND = step(do="send", document="nod.xml")
END = step(do="wait_block_end", block="b1")


@pytest.mark.parametrize(
    ("steps", "why"),
    [
        ([SEND, END, step(check="blocks", started=["b1"], ended=["b1"]), step(check="no_duplicate_feedback")], ""),
        ([SEND, END, step(check="sync_time", sync="b1:h:start", time=1.0, tolerance=0.1)], ""),
        ([SEND, END, step(check="sync_time", sync="b1:h:start", time=1.5, tolerance=0.1)], "b1:h:start at 1.000 s"),
        ([SEND, END, step(check="sync_order", behaviour="b1:h", syncs=["start", "stroke", "end"])], ""),
        ([SEND, END, step(check="sync_order", behaviour="b1:h", syncs=["end", "start"])], "start is missing"),
        ([SEND, END, step(check="warnings", count=1)], "0 warnings, not 1"),
        ([SEND, step(do="wait_sync", sync="b1:h:stroke"), step(check="blocks", started=["b1"], ended=[])], ""),
        ([SEND, step(do="wait_block_end", block="b9")], "block b9 does not end within 20 s"),
        ([step(do="send", inline_block={"id": "x"}), step(do="sleep", seconds=1), step(check="warnings", count=0)], ""),
        ([SEND, END, step(do="clear_feedback"), step(check="blocks", started=[], ended=[])], ""),
        ([step(do="dance")], "'dance' is nothing that can be done"),
        ([step(check="mood")], "'mood' is no check"),
        (
            [
                SEND,
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
def test_a_scenario_passes_or_says_why(corpus: Path, steps: list[dict[str, object]], why: str) -> None:
    scenarios = suite(corpus, "one/test", *steps)
    (verdict,) = play_suite("suite", corpus / "suite", scenarios, set_up())
    assert (verdict.suite, verdict.name) == ("suite", "one.test")
    assert why in verdict.why
    assert verdict.passed is (why == "")


def test_a_draft_is_read_strictly(corpus: Path) -> None:
    steps = [step(do="send", inline_block={}), step(do="sleep", seconds=1), step(check="exceptions", count=1)]
    (verdict,) = play_suite("suite", corpus / "suite", suite(corpus, "draft1/test", *steps), set_up())
    assert verdict.passed
    (verdict,) = play_suite("suite", corpus / "suite", suite(corpus, "bml-1/test", *steps), set_up())
    assert verdict.why.startswith("0 exceptions")


def test_unknown_targets_get_a_place() -> None:
    known = set_up()
    places = place_targets([LOOK.encode(), b"no bml", b'<bml><gaze target="user"/></bml>'], known)
    assert set(places) == {"lamp"}
    assert places["lamp"][0] > 1.0


def told(*ids: str, kind: str = "syncPointProgress") -> Feedback:
    return Feedback(ReceivedMessage(kind, id, global_time=float(k), time=float(k)) for k, id in enumerate(ids))


@pytest.mark.parametrize(
    ("check", "feedback", "why"),
    [
        (Step(check="no_duplicate_feedback"), told("b:h:start", "b:h:start"), "reported more than once: b:h:start"),
        (Step(check="sync_before_time", sync="b:h:end", time=1.0), told("b:h:start", "b:h:end"), "b:h:end at 1.000 s"),
        (Step(check="sync_after_time", sync="b:h:end", time=0.5), told("b:h:start", "b:h:end"), ""),
        (Step(check="sync_time", sync="b:h:end"), told(), "b:h:end was not reported"),
        (Step(check="syncs_coincide", a="b:h:start", b="b:g:end", a_offset=1.0), told("b:h:start", "b:g:end"), ""),
        (Step(check="syncs_coincide", a="b:h:start", b="b:g:end"), told("b:h:start", "b:g:end"), "1.000 s apart"),
        (Step(check="syncs_coincide", a="b:h:start", b="b:g:end"), told(), "b:h:start was not reported"),
        (Step(check="blocks", started=("b",)), told("c:start", kind="blockProgress"), "start of blocks ['c']"),
        (Step(check="block_duration_positive", block="b"), told("b:start", kind="blockProgress"), "0.0 to None"),
        (
            Step(check="sync_times_not_negative"),
            Feedback([ReceivedMessage("syncPointProgress", "b:h:x", time=-1.0)]),
            "b:h:x",
        ),
        (Step(check="one_behaviour_named", among=("b:g",)), told("b:h", kind="warningFeedback"), "['b:h'] named"),
    ],
)
def test_checks_of_feedback(check: Step, feedback: Feedback, why: str) -> None:
    found = CHECKS[check.check](check, feedback)
    assert why in found
    assert bool(found) is bool(why)


def test_a_message_is_heard() -> None:
    xml = '<syncPointProgress id="b:h:start" time="1.5" globalTime="2.5"/>'
    assert read_message(xml) == ReceivedMessage("syncPointProgress", "b:h:start", 2.5, 1.5)


def test_a_refused_document_is_warned_of() -> None:
    realizer = Realizer(set_up())
    realizer.send("<bml", source="f")
    (message,) = realizer.feedback.messages
    assert (message.kind, message.id) == ("warningFeedback", "block")
    assert "f:1:" in message.text


def test_figures_count_and_explain() -> None:
    found = list(
        verdict_figures(
            [ExpectationVerdict("s", "a"), ExpectationVerdict("s", "b", "too late"), ExpectationVerdict("t", "c")]
        )
    )
    assert [(figure.name, figure.value, figure.ok) for figure in found] == [
        ("bml.s.passed", 1, False),
        ("bml.s.failed", 1, False),
        ("bml.s.b", 0.0, False),
        ("bml.t.passed", 1, True),
        ("bml.t.failed", 0, True),
    ]
    assert found[2].why == "too late"


def test_without_a_corpus_figures_have_a_reason(corpus: Path) -> None:
    found = bml.bench()
    own = [figure for figure in found if figure.name.startswith(f"bml.{SUITE}.")]
    others = [figure for figure in found if figure not in own]
    assert [figure.value for figure in others] == [None, None, None]
    assert all("KINESIC_CORPUS" in figure.why for figure in others)
    assert [figure.value for figure in own] == [len(SCENARIOS), 0]
    assert corpus_folder() == corpus


def test_a_sync_point_that_comes_at_another_time_or_never_fails() -> None:
    inside = '<gesture id="g" type="beat" stroke_start="2.0"/>'
    assert judge_scenario(DraftScenario(inside, {"g:strokeStart": 2.0}), set_up()) == ""
    late = DraftScenario(inside, {"g:strokeStart": 1.0, "h:stroke": 2.0})
    assert judge_scenario(late, set_up()) == "g:strokeStart at 2.000 s, not at 1 s; h:stroke never, not at 2 s"


def test_every_shown_expectation_passes() -> None:
    if expected(bml.SCENARIOS, Scenarios) is None:
        pytest.skip("no corpus; KINESIC_CORPUS names its folder")
    found = list(bml.verdicts())
    assert [(verdict.suite, verdict.name, verdict.why) for verdict in found if not verdict.passed] == []
    assert min(Counter(verdict.suite for verdict in found).values()) >= 19


def test_a_wrong_expectation_is_found_out() -> None:
    documents, grammar = expected(bml.DOCUMENTS, Parsing), expected(bml.GRAMMAR, ReferenceSuite)
    if documents is None or grammar is None:
        pytest.skip("no corpus; KINESIC_CORPUS names its folder")
    where, stated = documents
    flipped = {"ok": "error", "error": "ok"}
    wrong = replace_all(stated, flipped)
    assert not any(verdict.passed for verdict in judge_parsing("d", where, wrong))
    swapped = ReferenceSuite(
        grammar[1].tolerance, (), grammar[1].accepted, grammar[1].not_equal, grammar[1].equal, grammar[1].written
    )
    assert sum(verdict.passed for verdict in judge_references("g", swapped)) == len(swapped.written)


def replace_all(stated: Parsing, flipped: dict[str, str]) -> Parsing:
    """The same with every document refused that is read, and read that is refused."""
    documents = {
        name: structs.replace(each, parse=flipped[each.parse]) if each else None
        for name, each in stated.documents.items()
    }
    return Parsing(documents, tuple(structs.replace(each, parse=flipped[each.parse]) for each in stated.inline))
