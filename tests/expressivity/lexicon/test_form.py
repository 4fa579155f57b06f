from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon

BUILTIN_LEXICON = Lexicon.load()
HAND_SHAPES = hand_shapes()


def test_hand_shapes_have_distinct_finger_values_and_descriptions():
    assert len(HAND_SHAPES) == 24
    assert len({(shape.straight, shape.apart, shape.across) for shape in HAND_SHAPES.values()}) == len(HAND_SHAPES)
    assert len({shape.says for shape in HAND_SHAPES.values()}) == len(HAND_SHAPES)


def test_hand_shape_values_are_within_their_ranges():
    for shape in HAND_SHAPES.values():
        assert all(0.0 <= straight <= 1.0 for straight in shape.straight)
        assert -1.0 <= shape.apart <= 1.0


def test_every_hand_shape_is_used_by_a_gesture():
    used = {pose.shape for form in BUILTIN_LEXICON.forms for key in form.keys for pose in key.hands.values()}
    assert set(HAND_SHAPES) - used == set(), "remove these shapes from kinesic/configs/hands.toml, or use them"


def test_every_hand_pose_of_a_gesture_has_a_hand_shape():
    shapeless = [
        f"kinesic/configs/gestures/{form.category}.toml: {form.id}"
        for form in BUILTIN_LEXICON.forms
        if not all(pose.shape for key in form.keys for pose in key.hands.values())
    ]
    assert shapeless == [], "give every key of these gestures a shape"


def test_summary_of_a_gesture_names_its_category_hands_keys_and_shapes():
    both, one = BUILTIN_LEXICON.forms_by_id["hands_folded_low"], BUILTIN_LEXICON.forms_by_id["heart"]
    for form, hands in ((both, "both hands"), (one, "right hand")):
        count = f"{len(form.keys)} key{'s' * (len(form.keys) != 1)}"
        expected = ", ".join((f"gesture {form.id} ({form.category}): {hands}, {count}", *form.shapes))
        assert (str(form), repr(form)) == (expected, f"<{expected}>")
    assert both.shapes
