import pytest

from kinesic.controller.dry_run import dry_run
from kinesic.report.report import report
from kinesic.report.shapes import shapes_made
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BLOCK = '<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0"><gesture id="g" lexeme="count_two"/></bml>'


@pytest.mark.parametrize(("robot", "made"), [("upper22", []), ("upper36", ["two"])])
def test_report_lists_requested_and_feasible_hand_shapes(robot: str, made: list[str]):
    (row,) = report(dry_run(plan(BLOCK, set_up(robot))), source="<test>")["behaviours"]
    assert "two" in row["shapes"]["asked"]
    assert [shape for shape in row["shapes"]["made"] if shape == "two"] == made


def test_hand_shapes_are_described_in_words():
    assert shapes_made({"shapes": {"asked": ["open", "ring"], "made": ["open"]}}) == "open, ring (not made)"
    assert shapes_made({"shapes": None}) == ""
