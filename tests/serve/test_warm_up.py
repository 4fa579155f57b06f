"""Tests of the warm-up of a planner."""

import pytest

from kinesic.body.config import ConfigError
from kinesic.intent.meaning.lexicon_names import index_names
from kinesic.intent.reading.language import load_language
from kinesic.serve.tracks import NO_ACCOMPANIMENT
from kinesic.serve.warm_up import warm_up
from kinesic.session.setup import set_up


def test_warm_up_loads_the_language_data_of_the_setup():
    load_language.cache_clear()
    warm_up(set_up(language="nl"), NO_ACCOMPANIMENT)
    before = load_language.cache_info()
    load_language("nl")
    assert load_language.cache_info().hits == before.hits + 1


def test_warm_up_indexes_the_gesture_names_of_the_lexicon_in_use():
    setup = set_up()
    warm_up(setup, NO_ACCOMPANIMENT)
    before = index_names.cache_info()
    index_names(setup.lexicon)
    assert index_names.cache_info().hits == before.hits + 1


def test_setup_with_an_invalid_language_tag_is_refused():
    with pytest.raises(ConfigError, match=r"'\.\./nl' is not a language tag"):
        set_up(language="../nl")
