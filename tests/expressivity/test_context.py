import numpy as np
import pytest

from kinesic.bml.block import Behaviour, Block, Gaze, Gesture, Head, Manner, Place, Torso
from kinesic.body.arrays import sealed
from kinesic.expressivity.style.style import Expressivity, Style

STYLE = Style("mine", Expressivity(power=0.1), Expressivity(power=0.2), Expressivity(power=0.3))
LAMP = sealed([0.5, -1.0, 1.0])


def block(action, manner=None, manners=None):
    behaviour = Behaviour("b", type(action).__name__, action, Place(1, 1), manner=manner or Manner())
    return Block("bml1", (behaviour,), manners=manners or {})


@pytest.mark.parametrize(("action", "power"), [(Gesture("beat"), 0.1), (Head("NOD"), 0.2), (Torso("BodyLean"), 0.3)])
def test_a_behaviour_has_the_manner_of_its_modality(context, action, power):
    here = context(block(action), STYLE)
    (behaviour,) = here.block.behaviours
    assert here.manner(behaviour).power == power
    assert here.manner(behaviour, "torso").power == 0.3


def test_the_document_goes_over_the_style(context):
    here = context(block(Head("NOD"), Manner(power=0.7), {"head": Manner(power=0.6, spatial=0.4)}), STYLE)
    assert here.manner(here.block.behaviours[0]) == Expressivity(power=0.7, spatial=0.4)


def test_styles_are_resolved_once(context):
    here = context(block(Gaze("left")), STYLE)
    assert here.styles is here.styles


def test_a_part_of_somebody_is_where_the_whole_is(context):
    known = context(Block("b", ()), targets={"Ann": LAMP, "bob:hand": sealed([1.0, 0.0, 0.0])})
    assert known.find_target("ann:l_wrist") is LAMP
    assert np.array_equal(known.find_target("Bob:Hand"), [1.0, 0.0, 0.0])
    assert known.find_target("bob:foot") is None


def test_targets_of_the_user_go_over_those_of_the_robot(context, robot):
    here = context(Block("b", ()), targets={"left": LAMP})
    assert here.find_target("left") is LAMP
    assert here.find_target("right") is robot.targets["right"]
    assert "did you mean right?" in here.unknown_target("rihgt")


def test_a_gesture_is_looked_up_once_and_each_mode_of_its_own(context):
    here = context(block(Gesture("beat")), STYLE)
    (behaviour,) = here.block.behaviours
    found = here.find_gesture(behaviour, Gesture("beat"))
    assert found is not None
    assert found is here.find_gesture(behaviour, Gesture("beat"))
    both = here.find_gesture(behaviour, Gesture("beat", "both"))
    assert both is not None
    assert both.form.sides == {"l", "r"} != found.form.sides


def test_behaviours_that_say_the_same_of_their_manner_share_a_style_and_others_do_not(context):
    plain = [Behaviour(id, "head", Head("NOD"), Place(1, 1)) for id in ("a", "b")]
    wide = Behaviour("c", "head", Head("NOD"), Place(1, 1), manner=Manner(spatial=0.5))
    styles = context(Block("bml1", (*plain, wide)), STYLE).styles
    assert styles["a"] is styles["b"]
    assert (styles["a"].head.spatial, styles["c"].head.spatial) == (0.0, 0.5)
