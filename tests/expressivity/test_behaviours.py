from dataclasses import replace

import pytest

from kinesic.bml.block import Head, Manner, Posture, Torso
from kinesic.expressivity.behaviours import head_move, torso_move
from kinesic.expressivity.posture import posture_moves
from kinesic.expressivity.style.passage import passage_of
from kinesic.expressivity.style.style import Expressivity, Style

TEST_STYLE = Style("mine", Expressivity(power=0.1), Expressivity(power=0.2), Expressivity(power=0.3))


@pytest.fixture
def scene(timeline, context):
    """Return a block context and its only behaviour."""

    def of(action, times, manner=None, manners=None):
        built = timeline(("b", action, times))
        timed = replace(built.timed[0], behaviour=replace(built.timed[0].behaviour, manner=manner or Manner()))
        return context(replace(built.block, behaviours=(timed.behaviour,), manners=manners or {}), TEST_STYLE), timed

    return of


def test_head_torso_and_posture_keys_use_the_expressivity_of_their_modality(scene, phases):
    times = phases(0, 1, 1, 2, 2.5, 3, 4)
    here, timed = scene(Head("NOD"), times)
    assert passage_of(TEST_STYLE.head, "stroke") in {
        key.passage for key in head_move(timed, timed.behaviour.action, here).head[0]
    }
    here, timed = scene(Torso("BodyLean"), times)
    assert torso_move(timed, timed.behaviour.action, here).torso[0][1].passage == passage_of(TEST_STYLE.torso, "stroke")
    here, timed = scene(Posture(poses=(("WHOLEBODY", "LEANING_FORWARD"),)), times)
    assert posture_moves([timed], here)["b"].torso[0][1].passage == passage_of(TEST_STYLE.torso, "stroke")
