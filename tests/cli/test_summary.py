"""What a performance comes to on the screen: failures first, passing checks in one line, every warning as text."""

import io

import pytest
from rich.console import Console

from kinesic.bml.block import Notice, NoticeType
from kinesic.cli.summary import print_checks, print_notices, rank_notices
from kinesic.controller.perform import plan
from kinesic.controller.performance import Performance
from kinesic.planning.setup import Setup
from kinesic.report.checks.check import Check

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
PASS = Check.of("tracking.rmse", 0.1, 1.0)
WARN = Check.of("tracking.max", 7.0, 5.0, "l_elbow_flexion at 1.20 s")
FAIL = Check.of("collision.plan", 0.004, 0.01, "head and l_hand at 0.50 s")


@pytest.fixture
def screen() -> Console:
    return Console(file=io.StringIO(), width=160)


def lines(screen: Console) -> list[str]:
    assert isinstance(screen.file, io.StringIO)
    return [line.rstrip() for line in screen.file.getvalue().splitlines()]


def test_a_failure_comes_before_a_warning_and_passing_checks_are_one_line(screen: Console):
    print_checks((PASS, WARN, PASS, FAIL, PASS), screen)
    heading, first, second, last = lines(screen)
    assert heading.split()[:2] == ["check", "status"]
    assert first.split()[:2] == ["collision.plan", "fail"]
    assert first.endswith("head and l_hand at 0.50 s")
    assert second.split()[:2] == ["tracking.max", "warn"]
    assert last == "3 of 5 checks pass"


def test_where_all_pass_there_is_one_line_alone(screen: Console):
    print_checks((PASS, PASS), screen)
    assert lines(screen) == ["all 2 checks pass"]


def test_every_warning_is_printed_and_what_is_dropped_comes_first(hurried: Performance, screen: Console):
    plan = hurried.plan
    print_notices(plan, screen)
    assert len(lines(screen)) == len(plan.notices) > 1
    assert lines(screen)[0].startswith("dropped     xyzzy (odd): ")
    assert all(line.startswith("warning     offer (rushed): ") for line in lines(screen)[1:])
    for notice in plan.notices:
        assert any(notice.text in line for line in lines(screen))


def test_of_too_many_the_first_are_printed_and_the_rest_counted(hurried: Performance, screen: Console):
    print_notices(hurried.plan, screen, most=1)
    first, rest = lines(screen)
    assert first.startswith("dropped")
    assert rest == f"and {len(hurried.plan.notices) - 1} more warnings: report.json lists all"


def test_words_of_strangers_are_no_markup(known: Setup, screen: Console):
    found = plan(BLOCK.format('<gesture id="[bold]g" lexeme="[red]xyzzy&#x9b;"/>'), known)
    print_notices(found, screen)
    assert any("[red]xyzzy\\x9b ([bold]g): " in line and "[red]xyzzy\\x9b" in line for line in lines(screen))


def test_a_gesture_that_takes_the_other_hand_is_substituted_and_not_called_impossible(known: Setup):
    """Two beats at once: the second is performed in its time, by the hand that is free."""
    found = plan(
        BLOCK.format('<gesture id="one" lexeme="beat" stroke="1"/><gesture id="two" lexeme="beat" stroke="1"/>'), known
    )
    (meaning, notice), *rest = rank_notices(found)
    assert (meaning, notice.id, notice.type) == ("substituted", "b:two", NoticeType.CANNOT_CREATE_BEHAVIOR)
    assert notice.text.startswith("moved to the left hand: ")
    assert rest == []


def test_a_warning_of_a_dropped_behaviour_that_is_not_the_reason_is_a_warning(known: Setup):
    found = plan(BLOCK.format('<gesture id="g" lexeme="xyzzy" sparkle="1"/><head id="h" lexeme="NOD"/>'), known)
    meanings = {notice.type: meaning for meaning, notice in rank_notices(found)}
    assert meanings == {
        NoticeType.CANNOT_CREATE_BEHAVIOR: "dropped",
        NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED: "warning",
    }
    assert isinstance(rank_notices(found)[0][1], Notice)
