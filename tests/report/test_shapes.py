import pytest

from kinesic.controller.perform import dry_run, plan, set_up
from kinesic.report.report import report
from kinesic.report.shapes import shapes_made

BLOCK = '<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0"><gesture id="g" lexeme="count_two"/></bml>'


@pytest.mark.parametrize(("robot", "made"), [("upper22", []), ("upper36", ["two"])])
def test_the_report_says_which_shapes_were_asked_and_which_the_hand_can_make(robot: str, made: list[str]):
    (row,) = report(dry_run(plan(BLOCK, set_up(robot))), source="<test>")["behaviours"]
    assert "two" in row["shapes"]["asked"]
    assert [shape for shape in row["shapes"]["made"] if shape == "two"] == made


def test_shapes_are_told_in_words():
    assert shapes_made({"shapes": {"asked": ["open", "ring"], "made": ["open"]}}) == "open, ring (not made)"
    assert shapes_made({"shapes": None}) == ""
