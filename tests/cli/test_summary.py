"""Printed summary of a performance: checks and warnings."""

import io

import pytest

from kinesic.bml.block import Notice, NoticeType
from kinesic.cli.screen.console import Console
from kinesic.cli.summary import print_checks, print_notices, rank_notices
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.report.checks.check import Check
from kinesic.session.plan import plan

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
PASSED_CHECK = Check.of("tracking.rmse", 0.1, 1.0)
WARNING_CHECK = Check.of("tracking.max", 7.0, 5.0, "l_elbow_flexion at 1.20 s")
FAILED_CHECK = Check.of("collision.plan", 0.004, 0.01, "head and l_hand at 0.50 s")


@pytest.fixture
def screen() -> Console:
    return Console(io.StringIO(), 160)


def lines(screen: Console) -> list[str]:
    assert isinstance(screen.file, io.StringIO)
    return [line.rstrip() for line in screen.file.getvalue().splitlines()]


def test_summary_prints_failed_checks_first_and_only_counts_passing_ones(screen: Console):
    print_checks((PASSED_CHECK, WARNING_CHECK, PASSED_CHECK, FAILED_CHECK, PASSED_CHECK), screen)
    heading, first, second, last = lines(screen)
    assert heading.split()[:2] == ["check", "status"]
    assert first.split()[:2] == ["collision.plan", "fail"]
    assert first.endswith("head and l_hand at 0.50 s")
    assert second.split()[:2] == ["tracking.max", "warn"]
    assert last == "3 of 5 checks pass"


def test_summary_prints_only_the_number_of_checks_if_all_pass(screen: Console):
    print_checks((PASSED_CHECK, PASSED_CHECK), screen)
    assert lines(screen) == ["all 2 checks pass"]


def test_summary_prints_all_warnings_with_dropped_behaviours_first(hurried: DryRun, screen: Console):
    plan = hurried.plan
    print_notices(plan, screen)
    assert len(lines(screen)) == len(plan.notices) > 1
    assert lines(screen)[0].startswith("dropped     xyzzy (odd): ")
    assert all(line.startswith("warning     offer (rushed): ") for line in lines(screen)[1:])
    for notice in plan.notices:
        assert any(notice.text in line for line in lines(screen))


def test_summary_only_counts_warnings_beyond_its_line_limit(hurried: DryRun, screen: Console):
    print_notices(hurried.plan, screen, max_lines=1)
    first, rest = lines(screen)
    assert first.startswith("dropped")
    assert rest == f"and {len(hurried.plan.notices) - 1} more warnings: report.json lists all"


def test_markup_in_texts_of_a_document_is_printed_literally(known: Setup, screen: Console):
    document_plan = plan(BLOCK.format('<gesture id="[bold]g" lexeme="[red]xyzzy&#x9b;"/>'), known)
    print_notices(document_plan, screen)
    assert any("[red]xyzzy\\x9b ([bold]g): " in line and "[red]xyzzy\\x9b" in line for line in lines(screen))


def test_summary_reports_a_gesture_moved_to_the_other_hand_as_substituted(known: Setup):
    """Plan two simultaneous beats, of which the free hand performs one."""
    document_plan = plan(
        BLOCK.format('<gesture id="one" lexeme="beat" stroke="1"/><gesture id="two" lexeme="beat" stroke="1"/>'), known
    )
    (category, notice), *rest = rank_notices(document_plan)
    assert (category, notice.id, notice.type) == ("substituted", "b:two", NoticeType.CANNOT_CREATE_BEHAVIOR)
    assert notice.text.startswith("moved to the left hand: ")
    assert rest == []


def test_only_the_warning_that_explains_a_drop_has_category_dropped(known: Setup):
    document_plan = plan(BLOCK.format('<gesture id="g" lexeme="xyzzy" sparkle="1"/><head id="h" lexeme="NOD"/>'), known)
    categories = {notice.type: category for category, notice in rank_notices(document_plan)}
    assert categories == {
        NoticeType.CANNOT_CREATE_BEHAVIOR: "dropped",
        NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED: "warning",
    }
    assert isinstance(rank_notices(document_plan)[0][1], Notice)
