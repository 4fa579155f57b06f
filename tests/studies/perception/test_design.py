"""Design of the face study as in the thesis (4.4, Table 4.2)."""

from collections import Counter

from kinesic.body.action_units import face_keys
from kinesic.studies.perception.answers import ACTION_NAMES
from kinesic.studies.perception.design import STIMULI_PER_CELL, list_stimuli


def test_answers_about_96_of_128_stimuli_are_evaluated():
    assert len(list_stimuli()) == 128
    assert sum(each.action.label != "" for each in list_stimuli()) == 96
    assert len({each.id for each in list_stimuli()}) == 128


def test_conditions_of_the_face_study_are_balanced():
    counted = [each for each in list_stimuli() if each.action.label]
    cells = Counter((each.agent, each.action.name, each.strength, each.wrinkles, each.presentation) for each in counted)
    assert len(cells) == 2 * 6 * 2 * 2 * 2
    assert set(cells.values()) == {1}


def test_participant_sees_a_quarter_of_the_stimuli_of_each_condition():
    cells = Counter((each.action.region, each.presentation) for each in list_stimuli())
    assert set(cells.values()) == {4 * STIMULI_PER_CELL}
    assert len(cells) == 4


def test_action_units_of_stimuli_exist_and_weak_ones_have_lower_intensity():
    for each in list_stimuli():
        assert all(face_keys(unit) for unit in each.units)
    frowns = {each.strength: each.units["4"] for each in list_stimuli() if each.action.name == "4"}
    assert frowns["low"] < frowns["high"] == 1.0


def test_face_study_asks_for_three_labels_in_each_facial_region():
    regions = {each.action.name: each.action.region for each in list_stimuli() if each.action.label}
    assert set(regions) == set(ACTION_NAMES)
    assert Counter(regions.values()) == {"upper": 3, "lower": 3}
