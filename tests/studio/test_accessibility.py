"""Accessibility of every view: rules of axe-core, keyboard, tour, colour scheme and reduced motion."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from .axe import severe_violations
from .conftest import Studio
from .test_recovery import reload

DRAWN = False  # WebGL pictures are tested in test_stage.py
TAB = 9
COLOUR_RULES = ("color-contrast", "link-in-text-block")  # rules whose result depends on the colour scheme
STEPS = 6  # number of steps of the tour


@contextmanager
def media(studio: Studio, **features: str) -> Iterator[None]:
    """Emulate media features of the user's system."""
    values = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
    studio.page.call("Emulation.setEmulatedMedia", features=values)
    try:
        yield
    finally:
        studio.page.call("Emulation.setEmulatedMedia", features=[])


def open_template(studio: Studio, name: str) -> None:
    planned, menu = studio.state("planned"), "document.querySelector('#examples')"
    studio.page.value(f"{menu}.value = 'template:{name}'; {menu}.dispatchEvent(new Event('change')); 0")
    studio.until(f"s.planned > {planned} && s.name === '{name}.bml'")


def show(studio: Studio, view: str) -> None:
    """Open one view of the page."""
    page = studio.page
    match view:
        case "words":
            open_template(studio, "story")
            page.click("#tab-words")
            page.value("document.querySelector('[data-spoken=\"5\"]').click()")
            page.until("document.querySelectorAll('#alternatives-list button').length > 3")
        case "source":
            page.click("#tab-source")
        case "manner":
            page.click("[data-block='big']")
            page.until("!document.querySelector('#inspector').hidden")
        case "gestures":
            page.value("document.querySelector('#lexicon').open = true")
            page.until("document.querySelectorAll('#found button').length > 10")
        case "robot":
            page.click("#mode-robot")
        case "error":
            studio.write(studio.state("text").replace("<gesture", "<gestur", 1) + "<")
        case "save":
            page.click("#save-as")
            page.until("document.querySelector('#saving').open")
        case "tour":
            page.value("document.querySelector('#saving').close()")
            page.click("#tour-start")
        case "gesture":
            page.value("document.querySelector('#tour-skip').click()")
            page.click("[aria-label^='Edit a copy of']")
            studio.until("s.name.endsWith('.toml') && s.draft?.keys?.length > 0")


def test_nine_studio_views_have_no_severe_axe_violations_in_light_and_dark(studio: Studio):
    faults = []
    for view in ("words", "source", "manner", "gestures", "robot", "error", "save", "tour", "gesture"):
        show(studio, view)
        for scheme, rules in (("light", ()), ("dark", COLOUR_RULES)):
            with media(studio, prefers_color_scheme=scheme):
                faults += [f"{view}, {scheme}: {each}" for each in severe_violations(studio.page, *rules)]
    assert faults == []


def test_axe_reports_a_button_without_an_accessible_name(studio: Studio):
    studio.page.value("document.querySelector('header').append(document.createElement('button')); 0")
    assert [each for each in severe_violations(studio.page) if each.startswith("button-name")]
    studio.page.value("document.querySelector('header > button:last-child').remove(); 0")


def test_main_controls_of_the_studio_are_reached_with_the_tab_key(studio: Studio):
    open_template(studio, "greeting")
    page = studio.page
    page.click("#tab-words")
    page.value("window.reached = new Set(), 0")
    page.value("document.addEventListener('focusin', event => reached.add(event.target.id)), 0")
    page.value("document.querySelector('#examples').focus()")
    for _ in range(140):
        page.press("Tab", TAB)
    reached = set(page.value("[...reached]"))
    named = {"examples", "save-as", "export", "tour-start", "perform", "stop", "tab-words", "plain", "plain-make"}
    assert named <= reached
    assert {"canvas", "mode-robot", "play", "time", "add", "line", "choose-block", "loop"} <= reached


def test_studio_tour_has_six_steps_driven_by_keys_and_is_remembered_after_a_reload(studio: Studio):
    open_template(studio, "greeting")
    page = studio.page
    page.value("localStorage.removeItem('tour-seen')")
    reload(studio)
    assert page.value("document.querySelector('#tour-start').textContent") == "Take the tour"
    page.value("document.querySelector('#tour-start').focus()")
    page.value("document.querySelector('#tour-start').click()")
    seen = []
    for step in range(1, STEPS + 1):
        assert page.value("document.querySelector('#tour-count').textContent") == f"Step {step} of {STEPS}"
        seen.append(page.value("document.querySelector('[data-tour]').id"))
        assert page.value("document.activeElement.id") == "tour-next"
        area = "document.querySelector('#tour').getBoundingClientRect()"
        assert page.value(
            f"(r => r.left >= 0 && r.top >= 0 && r.right <= innerWidth && r.bottom <= innerHeight)({area})"
        )
        page.press("ArrowRight", 39)
    assert seen == ["stage", "plain-form", "spoken", "timeline", "choose-block", "control"]
    assert page.value("document.querySelector('#tour').hidden")
    assert page.value("document.activeElement.id") == "tour-start"
    reload(studio)
    assert page.value("document.querySelector('#tour-start').textContent") == "Tour"


@pytest.mark.parametrize(("scheme", "is_dark"), [("light", False), ("dark", True)])
def test_studio_page_follows_the_colour_scheme_of_the_system(studio: Studio, scheme: str, is_dark: bool):
    with media(studio, prefers_color_scheme=scheme):
        colour = studio.page.value("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)")
    assert (max(colour) < 128) == is_dark


def test_reduced_motion_setting_disables_studio_previews_and_css_transitions(studio: Studio):
    with media(studio, prefers_reduced_motion="reduce"):
        reload(studio)
        assert not studio.page.value("document.querySelector('#play-changes').checked")
        assert studio.page.value("getComputedStyle(document.querySelector('#handles i')).transitionDuration") == "0s"
