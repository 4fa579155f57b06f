import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.expressivity.face.gaze import headings, looks

BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def test_gazes_are_directions_in_time_and_shifts_stay(context):
    inside = (
        '<gaze id="g" target="thing" start="1" ready="1.4" relax="3" end="3.5"/>'
        '<gazeShift id="h" target="other" start="4" end="4.5"/><gaze id="i" target="nowhere" start="6"/>'
    )
    timeline = schedule(parse(BML.format(inside)), {}, {})
    targets = {"thing": np.array([1.0, 1.0, 1.2]), "other": np.array([2.0, -1.0, 0.6])}
    here = context(timeline.block, targets=targets)
    found = [look for look in looks(timeline, here) if look.start < 5.0]
    assert [look.start for look in found] == [1.0, 4.0]
    assert found[0].left > 0.3
    assert found[0].end == 3.0
    assert found[1].left < -0.2
    assert found[1].up < 0.0
    assert found[1].end == np.inf


def test_headings_are_left_and_up():
    found = headings(np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]]))
    np.testing.assert_allclose(found, [[0.0, 0.0], [np.pi / 4, 0.0], [0.0, np.pi / 4]])
    assert found.shape == (3, 2)
    assert found[1, 0] == pytest.approx(np.pi / 4)
