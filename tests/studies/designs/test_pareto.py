from dataclasses import replace

import pytest

from kinesic.studies.designs.pareto import beaten_by, rank, unbeaten
from kinesic.studies.designs.trial import BodyFigures, DocumentFigures, Trial

BODY = BodyFigures(price=6000.0, mass=4.0, arm_length=0.4, torque=0.25, hinge="vl5_roll", sectors=60)


def trial(name: str, *, late: float = 0.02, **body: float) -> Trial:
    performed = (DocumentFigures("a.bml", 2, late, late, ()),)
    return Trial((("name", name),), body=replace(BODY, **body), documents=performed)


BASE, CHEAP, SLOW, HEAVY = (
    trial("base"),
    trial("cheap", price=5000.0),
    trial("late", price=5000.0, late=0.2),
    trial("heavy", mass=5.0, sectors=70),
)


def test_robot_design_dominates_another_if_no_metric_is_worse_and_one_is_better():
    assert beaten_by([BASE, CHEAP, SLOW, HEAVY]) == [[1], [], [1], []]
    assert unbeaten([BASE, CHEAP, SLOW, HEAVY]) == [CHEAP, HEAVY]


def test_robot_designs_with_more_reach_or_a_longer_arm_dominate_an_otherwise_equal_one():
    assert unbeaten([BASE, trial("reach", sectors=61), trial("arm", arm_length=0.5)]) == [
        trial("reach", sectors=61),
        trial("arm", arm_length=0.5),
    ]


def test_fewest_changes_decide_between_nearly_equal_robot_designs():
    alike = trial("alike", torque=0.2501, mass=4.001, late=0.0201)
    more = replace(alike, design=(*alike.design, ("more", "1")))
    assert unbeaten([more, BASE, HEAVY]) == [BASE, HEAVY]


def test_ranking_starts_with_robot_designs_that_dominate_the_base_robot():
    assert rank([SLOW, BASE, HEAVY, CHEAP], BASE) == [CHEAP, HEAVY, BASE, SLOW]


def test_robot_design_without_a_price_is_dominated_by_an_equal_design_with_a_price():
    assert beaten_by([replace(BASE, body=replace(BODY, price=None)), BASE]) == [[1], []]


def test_lateness_of_a_robot_design_is_the_mean_delay_of_its_strokes():
    two = replace(BASE, documents=(*BASE.documents, DocumentFigures("b.bml", 2, 0.06, 0.05, ("x dropped",))))
    assert two.lateness == pytest.approx(0.02)
    assert (two.worst, two.violations) == (0.05, 1)
