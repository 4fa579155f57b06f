from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon

LEXICON = Lexicon.load()
SHAPES = hand_shapes()


def test_every_shape_is_described_and_no_other():
    assert len(SHAPES) == 22
    assert len({(shape.straight, shape.apart, shape.across) for shape in SHAPES.values()}) == len(SHAPES)
    assert len({shape.says for shape in SHAPES.values()}) == len(SHAPES)


def test_fingers_are_between_closed_and_straight():
    for shape in SHAPES.values():
        assert all(0.0 <= straight <= 1.0 for straight in shape.straight)
        assert -1.0 <= shape.apart <= 1.0


def test_every_shape_is_used_and_every_pose_has_one():
    used = {pose.shape for form in LEXICON.forms for key in form.keys for pose in key.hands.values()}
    assert used == set(SHAPES)
