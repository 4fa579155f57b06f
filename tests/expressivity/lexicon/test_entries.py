import pickle
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from kinesic.body.config import CONFIGS
from kinesic.expressivity.lexicon.entries import FormsById, ParsedEntry, builtin_gestures
from kinesic.expressivity.lexicon.lexicon import Lexicon, builtin_lexicon
from kinesic.expressivity.lexicon.toml_file import read_gestures


def plain_values(thing: object) -> object:
    """Convert an object to plain values that can be compared."""
    if is_dataclass(thing):
        return [type(thing).__name__, *(plain_values(getattr(thing, field.name)) for field in fields(thing))]
    if isinstance(thing, np.ndarray):
        return thing.tolist()
    if isinstance(thing, tuple):
        return [plain_values(item) for item in thing]
    return {key: plain_values(value) for key, value in thing.items()} if hasattr(thing, "items") else thing


@pytest.fixture
def fresh_lexicon(monkeypatch):
    """Return a lexicon without parsed entries."""
    for cached in (builtin_gestures, builtin_lexicon):
        cached.cache_clear()
    yield Lexicon.load()
    for cached in (builtin_gestures, builtin_lexicon):
        cached.cache_clear()


def test_lexicon_without_user_gestures_is_loaded_once():
    assert Lexicon.load(None) is Lexicon.load()


def parsed_names(lexicon: Lexicon) -> set[str]:
    """Return the names of parsed entries."""
    return {entry.id for entry in lexicon.entries if "_entry" in vars(entry)}


def test_gestures_parsed_alone_equal_those_of_whole_files():
    whole = read_gestures(CONFIGS / "gestures")
    lexicon = Lexicon.load()
    assert len(lexicon.forms) == len(whole.entries) > 250
    for entry, (form, sense) in zip(lexicon.entries, whole.entries, strict=True):
        assert plain_values((entry.form, entry.sense)) == plain_values((form, sense))
        assert (entry.id, entry.category) == (form.id, form.category)
    assert lexicon.synonyms == whole.synonyms
    assert lexicon.classes == whole.classes
    assert set(lexicon.bodies) == set(whole.bodies)


def test_unused_gestures_of_a_lexicon_are_not_parsed(fresh_lexicon):
    assert parsed_names(fresh_lexicon) == set()
    assert "offer" in fresh_lexicon.forms_by_id
    assert "no such" not in fresh_lexicon.forms_by_id
    assert parsed_names(fresh_lexicon) == set()
    assert fresh_lexicon.find("offer").form.id == "offer"
    assert fresh_lexicon.find("Show Floor").form.id == "down"
    assert parsed_names(fresh_lexicon) == {"offer", "down"}


def test_reading_a_whole_lexicon_parses_every_gesture(fresh_lexicon):
    fresh_lexicon.read_all()
    assert parsed_names(fresh_lexicon) == set(fresh_lexicon.forms_by_id)
    assert "names" in vars(builtin_gestures())


def test_lexicon_with_modified_gestures_keeps_names_and_lazy_parsing(fresh_lexicon):
    changed = fresh_lexicon.changed(lambda form: replace(form, tempo="sudden"))
    assert parsed_names(fresh_lexicon) == set()
    assert changed.find("shrug").form.tempo == "sudden"
    assert fresh_lexicon.find("shrug").form.tempo == "neutral"
    assert list(changed.forms_by_id) == list(fresh_lexicon.forms_by_id)
    assert changed.sense(changed.forms_by_id["offer"]) is fresh_lexicon.sense(fresh_lexicon.forms_by_id["offer"])


def test_first_of_two_gestures_with_equal_names_is_used():
    one, other = (ParsedEntry(replace(Lexicon.load().forms[k], id="same"), Lexicon.load().senses[k]) for k in (0, 1))
    forms = FormsById([one, other])
    assert (len(forms), forms["same"]) == (1, one.form)
    with pytest.raises(KeyError):
        forms["other"]


def test_pickled_lexicon_parses_gestures_at_their_first_use(fresh_lexicon):
    there = pickle.loads(pickle.dumps(fresh_lexicon))
    assert plain_values(there.find("offer").form) == plain_values(fresh_lexicon.find("offer").form)
