import pytest

from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.style import Expressivity, passage_of
from kinesic.expressivity.turns import UPRIGHT, Hold, exclusive, pass_layer

MANNER = Expressivity(power=1.0, tension=0.5)
LEFT = Turn(torsion=0.5)


@pytest.mark.parametrize(
    ("holds", "phases"),
    [
        ([Hold(0.0, 1.0, LEFT, 2.0, 3.0)], ("retraction", "stroke", "hold", "retraction")),
        ([Hold(0.0, 1.0, LEFT, 1.0, 3.0)], ("retraction", "stroke", "retraction")),
        ([Hold(0.0, 1.0, LEFT)], ("retraction", "stroke")),
        ([Hold(0.0, 1.0, LEFT, 2.0, 3.0), Hold(1.5, 1.8, UPRIGHT)], ("retraction", "stroke", "hold", "retraction")),
    ],
)
def test_a_hold_goes_there_as_a_stroke_stays_and_goes_back(holds, phases):
    layer = exclusive(holds)[0]
    keys = pass_layer(layer, MANNER)
    assert [key.passage for key in keys] == [passage_of(MANNER, phase) for phase in phases]
    assert [(key.time, key.turn) for key in keys] == [(key.time, key.turn) for key in layer]


def test_no_layer_has_no_keys():
    assert pass_layer((), MANNER) == ()
