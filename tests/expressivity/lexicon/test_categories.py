"""Listed categories of gestures."""

from kinesic.expressivity.lexicon.categories import GESTURE_CATEGORIES
from kinesic.expressivity.lexicon.lexicon import Lexicon


def test_lexicon_categories_are_those_used_by_its_gestures():
    lexicon = Lexicon.load()
    assert lexicon.categories == GESTURE_CATEGORIES
    assert {form.category for form in lexicon.forms} == {*GESTURE_CATEGORIES}
