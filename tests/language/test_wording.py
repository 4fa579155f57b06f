"""Wording rules find what they forbid, and the project keeps them."""

from pathlib import Path

import pytest

from .code import read_findings
from .commit_rules import ImperativeSubject
from .docs import read_sentences
from .measure import find_shared_names, measure, read_allowed
from .rules import has_old_word, is_one_word, is_unclear

CLEAR_LINE = "Return the latest telemetry of all servos."


@pytest.mark.parametrize(
    "line",
    [
        "Returns what was asked since the last call.",
        "Return the telemetry; a stop ends it.",
        "Return the latest telemetry of all servos that answered during the last cycle of the bus.",
        "Sees new cycles, and returns whether it has looked ahead anew.",
    ],
)
def test_wording_check_reports_unclear_docstring_first_lines(line: str):
    assert is_unclear(line)
    assert not is_unclear(CLEAR_LINE)


def test_wording_check_finds_discouraged_words_only_as_whole_words():
    assert has_old_word("Return the share of the period.")
    assert not has_old_word("Return the shared period.")


def test_wording_check_reports_constant_names_of_one_word():
    assert is_one_word("_ROUNDS")
    assert not is_one_word("MAX_ROUNDS")


def test_wording_check_lists_constants_and_docstrings_of_a_file(tmp_path: Path):
    file = tmp_path / "example.py"
    file.write_text('"""Who knows."""\nNEAR, FAR = 1, 2\nMAX_ROUNDS: int = 3\nlower = 1\n', encoding="utf-8")
    findings = [(item.kind, item.place, item.text, item.is_offender) for item in read_findings(file, "example.py")]
    assert findings == [
        ("first lines", "example.py:1", "Who knows.", True),
        ("old words", "example.py:1", "Who knows.", False),
        ("constants", "example.py:2", "NEAR, FAR", True),
        ("constants", "example.py:3", "MAX_ROUNDS", False),
    ]


def test_wording_check_counts_functions_with_more_than_six_parameters(tmp_path: Path):
    file = tmp_path / "example.py"
    file.write_text(
        "class Arm:\n    def reach(self, a, b, *, c, d, e, f): ...\n\n\ndef plan(a, b, c, d, e, *rest, **other): ...\n"
    )
    found = {
        item.text: item.is_offender for item in read_findings(file, "example.py") if item.kind == "long signatures"
    }
    assert found == {"reach": False, "plan": True}


def test_wording_check_counts_public_names_that_several_modules_define(tmp_path: Path):
    findings = []
    for name, text in (("a.py", "def draw(): ...\nclass Arm: ...\ndef _own(): ...\n"), ("b.py", "def draw(): ...\n")):
        (tmp_path / name).write_text(text, encoding="utf-8")
        findings += [item for item in read_findings(tmp_path / name, name) if item.kind == "public names"]
    shared = {item.text: (item.place, item.is_offender) for item in find_shared_names(findings)}
    assert shared == {"draw": ("a.py:1, b.py:1", True), "Arm": ("a.py:2", False)}


def test_wording_check_of_a_page_skips_tables_code_and_headings(tmp_path: Path):
    long_sentence = " ".join(["word"] * 31) + "."
    page = tmp_path / "page.md"
    page.write_text(
        f"# Title\n\nShort one. {long_sentence.capitalize()}\n- item\n\n| a |\n\n```\nx\n```\n", encoding="utf-8"
    )
    assert [(item.text[:9], item.is_offender) for item in read_sentences(page, "page.md")] == [
        ("Short one", False),
        ("Word word", True),
        ("item", False),
    ]


@pytest.mark.parametrize(
    "subject", ["the plan is pure", "are all stops tested", "planned strokes", "fixing", "adds a test"]
)
def test_commit_check_rejects_subjects_that_are_not_imperative(subject: str):
    rule = ImperativeSubject()
    assert rule.validate(f"planning: {subject}", None)
    assert not rule.validate("planning: process the embedded pauses", None)


@pytest.mark.soak
def test_docstrings_constants_and_pages_of_the_project_pass_the_wording_check():
    offenders = {metric.kind: metric.offenders[:20] for metric in measure() if not metric.is_met}
    assert not offenders, [f"{item.place}: {item.text}" for items in offenders.values() for item in items]


def test_every_exception_to_the_wording_check_has_a_reason():
    assert all(len(reason.split()) >= 4 for reason in read_allowed().values())
