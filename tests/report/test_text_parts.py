"""Tests of the summary of a text that is performed part by part."""

import json
from pathlib import Path

import pytest

from kinesic.report.batch import DocumentVerdict
from kinesic.report.checks import Check, CheckStatus
from kinesic.report.text_parts import PARTS_FILE, PerformedPart, write_parts
from kinesic.session.setup import set_up

SETUP = set_up()


def part(number: int, status: CheckStatus = "pass", value: float = 0.5) -> PerformedPart:
    check = Check("limits.speed", status, value, 1.0, "ratio")
    verdict = DocumentVerdict(f"part-{number}", "performed", 0, (("gesture", "realised"),), (check,))
    return PerformedPart(100 * number, 10.0 * number, number, verdict)


def test_summary_of_parts_has_their_starts_grades_and_totals(tmp_path: Path) -> None:
    data = write_parts(tmp_path, [part(1), part(2, "poor", 0.9), part(3)], SETUP, source="a.txt", count=3)
    assert data == json.loads((tmp_path / PARTS_FILE).read_text())
    rows = data["parts"]
    assert isinstance(rows, list)
    assert [row["start_s"] for row in rows] == [0.0, 10.0, 30.0]
    assert [row["grade"] for row in rows] == ["ok", "poor", "ok"]
    assert rows[1] == {
        "folder": "part-2",
        "start_s": 10.0,
        "duration_s": 20.0,
        "words": 200,
        "grade": "poor",
        "warnings": 2,
    }
    assert (data["words"], data["duration_s"], data["ok"], data["complete"]) == (600, 60.0, True, True)
    totals = data["totals"]
    assert (totals["documents"], totals["realised"]) == (3, 3)
    assert (totals["checks"]["limits.speed"]["worst"], totals["checks"]["limits.speed"]["file"]) == (0.9, "part-2")


@pytest.mark.parametrize(("status", "is_ok"), [("fail", False), ("poor", True), ("warn", True)])
def test_text_with_a_failed_part_is_not_ok(tmp_path: Path, status: CheckStatus, is_ok: bool) -> None:
    data = write_parts(tmp_path, [part(1), part(2, status)], SETUP, source="a.txt", count=2)
    assert data["ok"] is is_ok


def test_summary_before_the_last_part_is_incomplete_and_is_replaced(tmp_path: Path) -> None:
    assert write_parts(tmp_path, [], SETUP, source="a.txt", count=2)["complete"] is False
    data = write_parts(tmp_path, [part(1)], SETUP, source="a.txt", count=2)
    assert (data["complete"], data["count"], data["input"]) == (False, 2, "a.txt")
    assert (data["robot"], data["style"], data["seed"]) == ("upper22", "neutral", SETUP.idling.seed)
