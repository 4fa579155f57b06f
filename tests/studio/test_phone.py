"""Studio on a phone of 390 x 844 pixels: layout and touch."""

from collections.abc import Iterator

import pytest

from .axe import severe_violations
from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
WIDTH = 390  # [CSS pixels]
MIN_TARGET = 44  # [CSS pixels] smallest width and height of a control
SMALL_TARGETS = f"""
[...document.querySelectorAll('button, select, input, summary, textarea')]
  .filter(each => each.checkVisibility() && !each.closest('#rows'))
  .map(each => [each.id || each.ariaLabel || each.textContent, (each.type === 'checkbox' ? each.closest('label') : each)
    .getBoundingClientRect()])
  .filter(([, area]) => area.width < {MIN_TARGET} || area.height < {MIN_TARGET})
  .map(([name, area]) => `${{name}}: ${{area.width}} x ${{area.height}}`)
"""
WORDS = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">'
    '<speech id="s"><text>Say <sync id="m1"/>one and then <sync id="m2"/>another.</text></speech>'
    '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m1"/></bml>'
)


@pytest.fixture(scope="module")
def phone(studio: Studio) -> Iterator[Studio]:
    metrics = {"width": WIDTH, "height": 844, "deviceScaleFactor": 2, "mobile": True}
    studio.page.call("Emulation.setDeviceMetricsOverride", **metrics)
    studio.page.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=1)
    studio.write(WORDS)
    yield studio
    studio.page.call("Emulation.clearDeviceMetricsOverride")


def tap(studio: Studio, selector: str) -> None:
    """Tap with a finger in the middle of an element."""
    area = (
        f"(e => {{ e.scrollIntoView({{block: 'center'}}); const r = e.getBoundingClientRect();"
        f" return [r.x + r.width / 2, r.y + r.height / 2] }})(document.querySelector({selector!r}))"
    )
    x, y = studio.page.value(area)
    touch(studio, "touchStart", x, y)
    touch(studio, "touchEnd")


def touch(studio: Studio, kind: str, *place: float) -> None:
    points = [{"x": place[0], "y": place[1]}] if place else []
    studio.page.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)


def test_phone_views_have_no_horizontal_scrolling_no_small_targets_and_no_axe_violations(phone: Studio):
    page = phone.page
    for selector in ("#tab-source", "#tab-words", "#choose-block", "#tour-start", "#tour-skip"):
        tap(phone, selector)
        assert page.value("document.documentElement.scrollWidth") == WIDTH, selector
        assert page.value(SMALL_TARGETS) == [], selector
        assert severe_violations(page) == [], selector
    tap(phone, "#choose-block")


def test_stop_and_perform_buttons_stay_visible_while_the_studio_scrolls_on_a_phone(phone: Studio):
    visible = (
        "['#stop', '#perform'].every(name => { const r = document.querySelector(name).getBoundingClientRect();"
        " return r.top >= 0 && r.bottom <= innerHeight && document.elementFromPoint(r.x + 9, r.y + 9)"
        " === document.querySelector(name) })"
    )
    for place in ("0", "600", "document.documentElement.scrollHeight"):
        phone.page.value(f"window.scrollTo(0, {place})")
        assert phone.page.value(visible), place
    tap(phone, "#tour-start")
    for step in range(6):
        phone.page.value("window.scrollTo(0, 0); window.dispatchEvent(new Event('resize'))")  # places the note again
        assert phone.page.value(visible), f"step {step} of the tour"
        tap(phone, "#tour-next")


def test_studio_plays_a_document_and_stops_the_robot_by_touch_on_a_phone(phone: Studio):
    tap(phone, "#play")
    phone.until("s.time > 0.2")
    tap(phone, "#play")
    tap(phone, "#perform")
    phone.until("s.mode === 'robot'")
    tap(phone, "#stop")
    phone.until("s.stopped")
    tap(phone, "#resume")
    phone.until("!s.stopped")
    tap(phone, "#mode-plan")


def test_gesture_is_found_and_added_in_the_studio_by_touch_on_a_phone(phone: Studio):
    tap(phone, "#lexicon summary")
    tap(phone, "#search")
    assert phone.page.value("document.activeElement.id") == "search"
    phone.page.call("Input.insertText", text="weigh two things")
    phone.page.until("document.querySelector('#found b')?.textContent === 'balance'")
    planned = phone.state("planned")
    tap(phone, "[aria-label='Add balance to the document']")
    phone.until(f"s.planned > {planned} && s.text.includes('lexeme=\"balance\"')")


def test_spoken_line_is_added_in_the_studio_by_touch_and_gets_a_style(phone: Studio):
    tap(phone, "#line")
    phone.page.call("Input.insertText", text="Good morning")
    planned = phone.state("planned")
    tap(phone, "#say-line button")
    phone.until(f"s.planned > {planned} && s.text.includes('Good morning')")
    tap(phone, "#choose-block")
    planned, menu = phone.state("planned"), "document.querySelector('#own-style')"
    phone.page.value(f"{menu}.value = 'shy'; {menu}.dispatchEvent(new Event('change')); 0")
    phone.page.value("document.querySelector('#play-changes').checked = false")
    phone.until(f"s.planned > {planned} && s.text.includes('kinesic:style=\"shy\"')")


def test_hand_of_the_drawn_robot_is_dragged_with_a_finger_on_a_phone(phone: Studio):
    phone.page.until("!kinesicStudio.playback.player.playing")  # playback would end the drag
    phone.page.value("document.querySelector('#stage').scrollIntoView({block: 'center'})")
    phone.until("s.left !== null")
    hand = phone.state("left")
    touch(phone, "touchStart", hand["x"], hand["y"])
    for step in range(1, 6):
        touch(phone, "touchMove", hand["x"] + 3 * step, hand["y"] - 8 * step)
    phone.until("s.reach !== null && s.reach.angles.length > 0")
    touch(phone, "touchEnd")
