import pickle
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from kinesic.body.config import CONFIGS
from kinesic.expressivity.lexicon.entries import FormsById, ReadEntry, own_gestures
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.toml_file import read_gestures


def told(thing: object) -> object:
    """A thing as plain values, which are equal where it is the same."""
    if is_dataclass(thing):
        return [type(thing).__name__, *(told(getattr(thing, each.name)) for each in fields(thing))]
    if isinstance(thing, np.ndarray):
        return thing.tolist()
    if isinstance(thing, tuple):
        return [told(each) for each in thing]
    return {key: told(value) for key, value in thing.items()} if hasattr(thing, "items") else thing


@pytest.fixture
def unread(monkeypatch):
    """Our gestures as they are in a process that has not asked for any."""
    own_gestures.cache_clear()
    yield Lexicon.load()
    own_gestures.cache_clear()


def read(lexicon: Lexicon) -> set[str]:
    """Names of the gestures that have been read."""
    return {entry.id for entry in lexicon.entries if "_entry" in vars(entry)}


def test_each_gesture_by_itself_is_what_the_whole_files_say():
    whole = read_gestures(CONFIGS / "gestures")
    lexicon = Lexicon.load()
    assert len(lexicon.forms) == len(whole.entries) > 250
    for entry, (form, sense) in zip(lexicon.entries, whole.entries, strict=True):
        assert told((entry.form, entry.sense)) == told((form, sense))
        assert (entry.id, entry.category) == (form.id, form.category)
    assert lexicon.synonyms == whole.synonyms
    assert lexicon.classes == whole.classes
    assert set(lexicon.bodies) == set(whole.bodies)


def test_what_is_not_asked_for_is_not_read(unread):
    assert read(unread) == set()
    assert "offer" in unread.forms_by_id
    assert "no such" not in unread.forms_by_id
    assert read(unread) == set()
    assert unread.find("offer").form.id == "offer"
    assert unread.find("Show Floor").form.id == "down"
    assert read(unread) == {"offer", "down"}


def test_all_is_read_for_who_must_not_wait(unread):
    unread.read_all()
    assert read(unread) == set(unread.forms_by_id)
    assert "names" in vars(own_gestures())


def test_a_changed_lexicon_keeps_names_and_reads_as_little(unread):
    changed = unread.changed(lambda form: replace(form, tempo="sudden"))
    assert read(unread) == set()
    assert changed.find("shrug").form.tempo == "sudden"
    assert unread.find("shrug").form.tempo == "neutral"
    assert list(changed.forms_by_id) == list(unread.forms_by_id)
    assert changed.sense(changed.forms_by_id["offer"]) is unread.sense(unread.forms_by_id["offer"])


def test_of_two_with_one_name_the_first_counts():
    one, other = (ReadEntry(replace(Lexicon.load().forms[k], id="same"), Lexicon.load().senses[k]) for k in (0, 1))
    forms = FormsById([one, other])
    assert (len(forms), forms["same"]) == (1, one.form)
    with pytest.raises(KeyError):
        forms["other"]


def test_other_processes_get_what_is_not_read_yet(unread):
    there = pickle.loads(pickle.dumps(unread))
    assert told(there.find("offer").form) == told(unread.find("offer").form)
