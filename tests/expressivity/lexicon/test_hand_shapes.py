import pytest

from kinesic.expressivity.lexicon.hand_shapes import find_shape, finger_motions, hand_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("FORM_OPEN", "open"),
        ("FORM_OPENAPART", "open"),
        ("form_fist", "fist"),
        ("FORM_POINT1", "index"),
        ("BEND_CURVED", "curved"),
        ("SYMBOL_2_CLOSED", "together"),
        ("SYMBOL_1_OPEN", "thumb"),
        ("RELAX", "relaxed"),
        ("Index Finger", "index"),
        ("finger-ring", "ring"),
        ("thumbs_up", "thumb"),
        ("purse", "purse"),
    ],
)
def test_shapes_of_other_systems_are_known_by_their_names(name: str, shape: str):
    found = find_shape(name)
    assert found is not None
    assert found is hand_shapes()[shape]


def test_a_shape_that_nobody_knows_is_none():
    assert find_shape("tentacle") is None


def test_motions_leave_the_shape_by_something():
    for motion in finger_motions().values():
        assert any(motion.bend) or motion.apart
        assert 0.5 <= motion.rate <= 4.0
        assert all(0 <= later < 4 for later in motion.later)


def test_gestures_that_live_by_their_fingers_move_them():
    moving = {form.id: form.fingers.name for form in Lexicon.load().forms if form.fingers is not None}
    expected = {"air_quotes": "quotes", "typing": "typing", "piano": "typing", "walk_fingers": "walk"}
    assert expected.items() <= moving.items()
    assert set(moving.values()) == set(finger_motions())
