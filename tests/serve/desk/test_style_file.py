"""Styles of a client's folder: validation, list, and the list over the wire."""

import json
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError, names_of
from kinesic.client import Client
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, Style
from kinesic.planning.setup import Setup
from kinesic.serve.desk.gesture_file import find_fault
from kinesic.serve.desk.style_file import MAX_STYLE_SIZE, StyleEntry, find_style_fault, is_style, list_builtin_styles
from kinesic.serve.wire.quotas import Quotas

from ..conftest import running

STYLE = "".join(f"{name} = 0.25\n" for name in EXPRESSIVITY_RANGES)
GESTURE = '[[gesture]]\nid = "mine"\nkeys = [{ right = { at = [0.5, 0.3, 0.5] } }]\n'


def test_builtin_styles_are_listed_with_the_numbers_of_their_gestures():
    entries = list_builtin_styles()
    assert [entry.name for entry in entries] == list(names_of("style"))
    for entry in entries:
        data = entry.as_json()
        assert data["numbers"] == Style.load(entry.name).numbers()["gesture"]
        assert not data["own"]


def test_style_from_its_text_equals_the_style_of_its_file(tmp_path: Path):
    path = tmp_path / "mine.toml"
    path.write_text(STYLE + "[head]\npower = 0.5\n")
    assert Style.parse(path.read_text(), path) == Style.load(path)
    with pytest.raises(ConfigError, match="spatial is 2"):
        Style.parse(STYLE.replace("spatial = 0.25", "spatial = 2"), path)


@pytest.mark.parametrize("present", [None, STYLE, STYLE + "[head]\npower = 0.5\n"])
def test_style_file_may_be_saved_as_new_or_over_another_style(upper22_setup: Setup, present: str | None):
    assert find_fault(STYLE, present, upper22_setup) == ""


@pytest.mark.parametrize("present", ["", "not = toml =", "[robot]\n", GESTURE])
def test_saving_a_style_over_a_file_that_is_no_style_is_refused(upper22_setup: Setup, present: str):
    assert "is no style" in find_fault(STYLE, present, upper22_setup)


def test_saving_a_gesture_file_over_a_style_file_is_refused(upper22_setup: Setup):
    assert "other data than gestures" in find_fault('category = "beat"\n' + GESTURE, STYLE, upper22_setup)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (STYLE.replace("spatial = 0.25", "spatial = 2"), "spatial is 2, outside"),
        (STYLE.replace("power = 0.25\n", ""), "missing required field `power`"),
        (STYLE + "[robot]\n", "robot"),
        (STYLE + "#" * MAX_STYLE_SIZE, f"at most {MAX_STYLE_SIZE} are allowed"),
    ],
)
def test_invalid_style_file_is_refused_with_the_reason(text: str, fault: str):
    assert is_style(text)
    assert fault in find_style_fault(text, None)


def test_listing_an_incomplete_style_raises_a_config_error():
    with pytest.raises(ConfigError):
        StyleEntry("mine", "spatial = 0.5", is_own=True).as_json()


def test_saved_style_is_listed_after_the_builtin_ones(tmp_path: Path):
    (tmp_path / "mine.toml").write_text(GESTURE)
    (tmp_path / "broken.toml").write_text("spatial = 0.5\n")
    with running(Quotas(planning=60.0), folder=tmp_path) as server, Client(port=server.port) as client:
        client.do("save", name="brisk.toml", text=STYLE)
        assert answered(client)["told"] == "saved"
        client.do("styles", id=5)
        answer = answered(client)
    assert (answer["told"], answer["id"]) == ("styles", 5)
    assert [entry["name"] for entry in answer["styles"]] == [*names_of("style"), "brisk"]
    assert answer["styles"][-1] == {
        "name": "brisk",
        "own": True,
        "numbers": dict.fromkeys(EXPRESSIVITY_RANGES, 0.25),
        "text": STYLE,
    }


def answered(client: Client) -> dict:
    while (answer := json.loads(client.receive(60)))["told"] not in ("saved", "refused", "styles"):
        pass
    return answer
