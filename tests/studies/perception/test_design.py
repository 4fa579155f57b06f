"""Numbers of the thesis (4.4, Table 4.2)."""

from collections import Counter

from kinesic.body.action_units import face_keys
from kinesic.studies.perception.answers import LABELS
from kinesic.studies.perception.design import PER_CELL, stimuli


def test_128_stimuli_of_which_96_count():
    assert len(stimuli()) == 128
    assert sum(each.action.asked for each in stimuli()) == 96
    assert len({each.id for each in stimuli()}) == 128


def test_every_condition_is_shown_as_often():
    counted = [each for each in stimuli() if each.action.asked]
    cells = Counter((each.agent, each.action.name, each.strength, each.wrinkles, each.presentation) for each in counted)
    assert len(cells) == 2 * 6 * 2 * 2 * 2
    assert set(cells.values()) == {1}


def test_a_participant_can_see_a_quarter_of_every_cell():
    cells = Counter((each.action.region, each.presentation) for each in stimuli())
    assert set(cells.values()) == {4 * PER_CELL}
    assert len(cells) == 4


def test_units_are_known_and_faint_ones_are_weaker():
    for each in stimuli():
        assert all(face_keys(unit) for unit in each.units)
    frowns = {each.strength: each.units["4"] for each in stimuli() if each.action.name == "4"}
    assert frowns["low"] < frowns["high"] == 1.0


def test_three_labels_are_asked_for_each_half_of_the_face():
    regions = {each.action.name: each.action.region for each in stimuli() if each.action.asked}
    assert set(regions) == set(LABELS)
    assert Counter(regions.values()) == {"upper": 3, "lower": 3}
