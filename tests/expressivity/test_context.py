import numpy as np
import pytest

from kinesic.bml.block import Behaviour, Block, Gaze, Gesture, Head, Manner, Place, Torso
from kinesic.body.arrays import sealed
from kinesic.expressivity.style.style import Expressivity, Style, style_preset

TEST_STYLE = Style("mine", Expressivity(power=0.1), Expressivity(power=0.2), Expressivity(power=0.3))
LAMP_POSITION = sealed([0.5, -1.0, 1.0])


def block(action, manner=None, manners=None):
    behaviour = Behaviour("b", type(action).__name__, action, Place(1, 1), manner=manner or Manner())
    return Block("bml1", (behaviour,), manners=manners or {})


@pytest.mark.parametrize(("action", "power"), [(Gesture("beat"), 0.1), (Head("NOD"), 0.2), (Torso("BodyLean"), 0.3)])
def test_behaviour_has_expressivity_of_its_modality(context, action, power):
    here = context(block(action), TEST_STYLE)
    (behaviour,) = here.block.behaviours
    assert here.manner(behaviour).power == power
    assert here.manner(behaviour, "torso").power == 0.3


def test_expressivity_parameters_of_a_document_override_the_style(context):
    here = context(block(Head("NOD"), Manner(power=0.7), {"head": Manner(power=0.6, spatial=0.4)}), TEST_STYLE)
    assert here.manner(here.block.behaviours[0]) == Expressivity(power=0.7, spatial=0.4)


def test_style_of_a_block_sets_the_standing_posture_unless_the_posture_setting_was_changed(context):
    joyful = block(Gesture("beat"), manners={"gesture": Manner(style="joyful")})
    assert context(joyful, TEST_STYLE).bearing == style_preset("joyful")
    assert context(block(Gesture("beat")), TEST_STYLE).bearing is TEST_STYLE
    slumped = TEST_STYLE.changed(["posture=0.5"])
    assert context(joyful, slumped).bearing is slumped
    assert context(joyful, TEST_STYLE.changed(["power=0.5"])).bearing == style_preset("joyful")


def test_behaviour_styles_are_resolved_once_per_block(context):
    here = context(block(Gaze("left")), TEST_STYLE)
    assert here.styles is here.styles


def test_unknown_part_of_a_gaze_target_has_the_position_of_the_whole_target(context):
    known = context(Block("b", ()), targets={"Ann": LAMP_POSITION, "bob:hand": sealed([1.0, 0.0, 0.0])})
    assert known.find_target("ann:l_wrist") is LAMP_POSITION
    assert np.array_equal(known.find_target("Bob:Hand"), [1.0, 0.0, 0.0])
    assert known.find_target("bob:foot") is None


def test_gaze_targets_of_the_user_override_those_of_the_robot_file(context, robot):
    here = context(Block("b", ()), targets={"left": LAMP_POSITION})
    assert here.find_target("left") is LAMP_POSITION
    assert here.find_target("right") is robot.targets["right"]
    assert "did you mean right?" in here.unknown_target("rihgt")


def test_gesture_lookup_is_cached_per_hand_mode(context):
    here = context(block(Gesture("beat")), TEST_STYLE)
    (behaviour,) = here.block.behaviours
    gesture = here.find_gesture(behaviour, Gesture("beat"))
    assert gesture is not None
    assert gesture is here.find_gesture(behaviour, Gesture("beat"))
    both = here.find_gesture(behaviour, Gesture("beat", "both"))
    assert both is not None
    assert both.form.sides == {"l", "r"} != gesture.form.sides


def test_behaviours_with_equal_parameters_use_one_style_object(context):
    plain = [Behaviour(id, "head", Head("NOD"), Place(1, 1)) for id in ("a", "b")]
    wide = Behaviour("c", "head", Head("NOD"), Place(1, 1), manner=Manner(spatial=0.5))
    styles = context(Block("bml1", (*plain, wide)), TEST_STYLE).styles
    assert styles["a"] is styles["b"]
    assert (styles["a"].head.spatial, styles["c"].head.spatial) == (0.0, 0.5)
