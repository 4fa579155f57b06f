from dataclasses import replace

import pytest

from kinesic.studies.designs.pareto import beaten_by, rank, unbeaten
from kinesic.studies.designs.trial import BodyFigures, DocumentFigures, Trial

BODY = BodyFigures(price=6000.0, mass=4.0, arm_length=0.4, torque=0.25, hinge="vl5_roll", sectors=60)


def trial(name: str, *, late: float = 0.02, **body: float) -> Trial:
    performed = (DocumentFigures("a.bml", 2, late, late, ()),)
    return Trial((("name", name),), body=replace(BODY, **body), documents=performed)


BASE, CHEAP, LATE, HEAVY = (
    trial("base"),
    trial("cheap", price=5000.0),
    trial("late", price=5000.0, late=0.2),
    trial("heavy", mass=5.0, sectors=70),
)


def test_who_is_no_worse_in_anything_and_better_in_something_beats():
    assert beaten_by([BASE, CHEAP, LATE, HEAVY]) == [[1], [], [1], []]
    assert unbeaten([BASE, CHEAP, LATE, HEAVY]) == [CHEAP, HEAVY]


def test_more_reach_and_a_longer_arm_are_better():
    assert unbeaten([BASE, trial("reach", sectors=61), trial("arm", arm_length=0.5)]) == [
        trial("reach", sectors=61),
        trial("arm", arm_length=0.5),
    ]


def test_of_what_is_less_apart_than_a_step_the_one_that_changes_least_is_picked():
    alike = trial("alike", torque=0.2501, mass=4.001, late=0.0201)
    more = replace(alike, design=(*alike.design, ("more", "1")))
    assert unbeaten([more, BASE, HEAVY]) == [BASE, HEAVY]


def test_who_beats_the_base_comes_first_then_who_is_beaten_by_few():
    assert rank([LATE, BASE, HEAVY, CHEAP], BASE) == [CHEAP, HEAVY, BASE, LATE]


def test_an_unknown_price_is_the_highest():
    assert beaten_by([replace(BASE, body=replace(BODY, price=None)), BASE]) == [[1], []]


def test_lateness_is_that_of_a_stroke_in_the_mean():
    two = replace(BASE, documents=(*BASE.documents, DocumentFigures("b.bml", 2, 0.06, 0.05, ("x dropped",))))
    assert two.lateness == pytest.approx(0.02)
    assert (two.worst, two.violations) == (0.05, 1)
