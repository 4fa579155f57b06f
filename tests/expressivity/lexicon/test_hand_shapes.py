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
def test_hand_shape_names_of_other_systems_and_spelling_variants_are_recognised(name: str, shape: str):
    matches = find_shape(name)
    assert matches is not None
    assert matches is hand_shapes()[shape]


def test_unknown_hand_shape_name_is_not_found():
    assert find_shape("tentacle") is None


def test_finger_motions_have_an_amplitude_and_rate():
    for motion in finger_motions().values():
        assert any(motion.bend) or motion.apart
        assert 0.5 <= motion.rate <= 4.0
        assert all(0 <= later < 4 for later in motion.later)


def test_air_quotes_typing_piano_and_walking_gestures_have_their_finger_motions():
    moving = {form.id: form.fingers.name for form in Lexicon.load().forms if form.fingers is not None}
    expected = {"air_quotes": "quotes", "typing": "typing", "piano": "typing", "walk_fingers": "walk"}
    assert expected.items() <= moving.items()
    assert set(moving.values()) == set(finger_motions())
