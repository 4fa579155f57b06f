from math import radians

import numpy as np
import pytest

from kinesic.bench.naturalness.legibility import different_pairs, legibility_figures, shoulder_figure
from kinesic.expressivity.lexicon.legibility_table import AlikeTable, LegibilityTable, PlaceTable, legibility_table
from kinesic.expressivity.lexicon.lexicon import Lexicon

ROWS = {name: np.full((2, 1, 3), [0.0, at, 0.0]) for name, at in (("hush", 0.0), ("nose", 0.03), ("come", 0.2))}
NEAR = LegibilityTable({"hush": PlaceTable("tips", "mouth", 0.05)}, {}, ())


def figures(table, places):
    found = legibility_figures("naturalness", ROWS, places, table)
    return {figure.name.removeprefix("naturalness."): figure for figure in found}


def test_gestures_that_are_taken_for_others_are_counted_and_named():
    found = figures(NEAR, {})
    assert (found["alike"].value, found["alike"].ok, found["alike"].why) == (1.0, False, "hush and nose 30")
    assert (found["nearest_pair"].value, found["nearest_pair"].ok) == (pytest.approx(30), False)


def test_gestures_of_one_meaning_may_look_alike():
    table = LegibilityTable({}, {}, (AlikeTable(("hush", "nose"), "the face"), AlikeTable(("nose", "come"), "none")))
    assert different_pairs(ROWS, table) == []
    assert figures(table, {})["alike"].ok
    assert not table.may_be_alike("hush", "come")


def test_hands_that_are_not_in_their_place_are_counted_and_named():
    assert figures(NEAR, {"hush": 0.04})["misplaced"].ok
    far = figures(NEAR, {"hush": 0.06})
    assert (far["misplaced"].value, far["misplaced"].why, far["farthest_place"].value) == (
        1.0,
        "hush",
        pytest.approx(60),
    )


def test_gestures_at_the_head_are_told_apart_more_strictly():
    assert figures(NEAR, {})["alike_at_head"].value == 0.0, "nose has no place here"
    both = {name: PlaceTable("tips", "mouth", 0.05) for name in ("hush", "nose")}
    found = figures(LegibilityTable(both, {}, ()), {})["alike_at_head"]
    assert (found.value, found.why) == (1.0, "hush and nose 30")


def test_shoulders_that_do_not_rise_are_named():
    table = LegibilityTable({}, {"shrug": 12.0, "lift": 12.0}, ())
    found = shoulder_figure("naturalness", {"shrug": radians(13), "lift": radians(11), "other": 0.0}, table)
    assert (found.value, found.ok, found.why) == (1.0, False, "lift")


def test_the_table_speaks_of_gestures_that_there_are():
    table, known = legibility_table(), Lexicon.load().forms_by_id
    named = {*table.places, *table.shoulders, *(gesture for group in table.alike for gesture in group.gestures)}
    assert named <= known.keys()
    assert all(len(group.gestures) > 1 and group.why for group in table.alike)
