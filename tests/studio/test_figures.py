"""Stick figures of all gestures: complete, small, and moving in the browser."""

import json
from base64 import b64decode

import numpy as np
import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.studio.page import PAGE_FOLDER

from .conftest import Studio
from .test_page import middle
from .test_tracks import PARTS, show

DRAWN = False  # WebGL pictures are tested in test_stage.py
FIGURES = PAGE_FOLDER / "figures.json"
MAX_SIZE = 3_000_000  # [bytes] largest size of the file of all figures
RIGHT_ARM = 3 + 3 + 5  # index of the right shoulder: after head, neck, trunk and the left arm with five fingers


def frames_of(gesture: str) -> tuple[np.ndarray, int]:
    """Return the points of a figure (frames, points, 2), and the index of its stroke."""
    file = json.loads(FIGURES.read_text(encoding="utf-8"))
    figure = file["figures"][gesture]
    points = np.frombuffer(b64decode(figure["frames"]), np.uint8).reshape(file["frames"], -1, 2)
    return points.astype(float), figure["still"]


def test_studio_figure_file_has_a_figure_for_every_gesture_and_a_limited_size():
    figures = json.loads(FIGURES.read_text(encoding="utf-8"))["figures"]
    missing = {form.id for form in Lexicon.load().forms} - set(figures)
    assert missing == set(), "run docs/make/gesture_figures.py"
    assert FIGURES.stat().st_size < MAX_SIZE


def test_studio_figure_of_a_wave_raises_the_right_hand_to_the_shoulder_and_lowers_it():
    points, still = frames_of("greet_wave")
    shoulder, _, wrist = points[:, RIGHT_ARM : RIGHT_ARM + 3].swapaxes(0, 1)
    assert wrist[still, 1] < shoulder[still, 1] + 25, "the waving hand is about as high as the shoulder"
    assert wrist[0, 1] > shoulder[0, 1] + 60, "the arm hangs at first"
    assert np.abs(points[0] - points[-1]).max() < 40, "it returns"
    assert np.ptp(points[:, 5], axis=0).max() < 40, "the left wrist stays"


@pytest.mark.realtime
def test_gesture_in_the_studio_list_has_a_figure_that_moves_under_the_pointer(studio: Studio):
    studio.page.value("document.querySelector('#lexicon').open = true")
    search = "document.querySelector('#search')"
    studio.page.value(f"{search}.value = 'greet_wave', {search}.dispatchEvent(new Event('input'))")
    row = "[data-gesture='greet_wave']"
    studio.page.until(f'document.querySelector("{row} .figure-body") !== null')
    studio.page.value(f'document.querySelector("{row}").scrollIntoView({{block: "center"}})')
    x, y = middle(studio, f"{row} .figure")
    studio.page.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    moving = "document.querySelector('#figure-preview .figure-body')"
    studio.page.until(f"{moving} !== null && {moving}.checkVisibility()")
    first = studio.page.value(f"{moving}.getAttribute('d')")
    studio.page.until(f"{moving}.getAttribute('d') !== {first!r}")
    studio.page.call("Input.dispatchMouseEvent", type="mouseMoved", x=5, y=5)
    studio.page.until("document.querySelector('#figure-preview').hidden")
    studio.page.value("document.querySelector('#lexicon').open = false")


@pytest.mark.realtime
def test_gesture_on_the_studio_timeline_has_a_figure_and_a_nod_has_none(studio: Studio):
    show(studio, PARTS)
    studio.page.until("document.querySelector('[data-block=give] .figure') !== null")
    assert studio.page.value("document.querySelector('[data-block=nod] .figure') === null")
