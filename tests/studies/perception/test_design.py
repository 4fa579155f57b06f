"""Design of the face study as in the thesis (4.4, Table 4.2)."""

import re
from collections import Counter
from itertools import pairwise

from kinesic.body.action_units import face_keys
from kinesic.studies.perception.answers import ACTION_NAMES
from kinesic.studies.perception.design import STIMULI_PER_CELL, list_stimuli
from kinesic.studies.perception.page import file_of


def test_answers_about_96_of_128_stimuli_are_evaluated():
    assert len(list_stimuli()) == 128
    assert sum(stimulus.action.label != "" for stimulus in list_stimuli()) == 96
    assert len({stimulus.id for stimulus in list_stimuli()}) == 128


def test_stimulus_names_for_participants_do_not_reveal_the_condition():
    stimuli = list_stimuli()
    assert len({stimulus.code for stimulus in stimuli}) == 128
    assert all(re.fullmatch("face-[0-9a-f]{8}", stimulus.code) for stimulus in stimuli)
    assert all(file_of(stimulus).startswith(f"{stimulus.code}.") for stimulus in stimuli)
    in_order = sorted(stimuli, key=lambda stimulus: stimulus.code)
    runs = sum(a.strength == b.strength for a, b in pairwise(in_order))
    assert 40 < runs < 90, "neighbours by name share conditions by chance"


def test_conditions_of_the_face_study_are_balanced():
    counted = [stimulus for stimulus in list_stimuli() if stimulus.action.label]
    cells = Counter((item.agent, item.action.name, item.strength, item.wrinkles, item.presentation) for item in counted)
    assert len(cells) == 2 * 6 * 2 * 2 * 2
    assert set(cells.values()) == {1}


def test_participant_sees_a_quarter_of_the_stimuli_of_each_condition():
    cells = Counter((stimulus.action.region, stimulus.presentation) for stimulus in list_stimuli())
    assert set(cells.values()) == {4 * STIMULI_PER_CELL}
    assert len(cells) == 4


def test_action_units_of_stimuli_exist_and_weak_ones_have_lower_intensity():
    for each in list_stimuli():
        assert all(face_keys(unit) for unit in each.units)
    frowns = {stimulus.strength: stimulus.units["4"] for stimulus in list_stimuli() if stimulus.action.name == "4"}
    assert frowns["low"] < frowns["high"] == 1.0


def test_face_study_asks_for_three_labels_in_each_facial_region():
    regions = {stimulus.action.name: stimulus.action.region for stimulus in list_stimuli() if stimulus.action.label}
    assert set(regions) == set(ACTION_NAMES)
    assert Counter(regions.values()) == {"upper": 3, "lower": 3}
