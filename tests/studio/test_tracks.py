"""Tracks of the timeline by body part: phases, drags with snapping, selection and commands."""

import re
from collections.abc import Iterator
from typing import Literal

import pytest

from .conftest import Studio
from .test_page import WORDS, middle

pytestmark = pytest.mark.realtime

DRAWN = False  # WebGL pictures are tested in test_stage.py
BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="parts">'
PARTS = (
    f'{BML}<gesture id="open" lexeme="welcome" mode="BOTH_HANDS" start="0.2"/>'
    '<gesture id="give" lexeme="offer" mode="RIGHT_HAND" start="3"/><head id="nod" lexeme="NOD" start="1"/>'
    '<gaze id="look" target="left" start="1" end="3"/><faceLexeme id="glad" lexeme="smile" start="1" end="3"/>'
    '<posture id="lean" start="0.5" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture></bml>'
)
THREE = (
    f'{BML}\n  <head id="one" lexeme="NOD" start="1"/>\n  <head id="two" lexeme="NOD" start="3"/>\n'
    '  <gesture id="three" lexeme="beat" mode="RIGHT_HAND" start="5"/>\n</bml>'
)
CONTROL, SHIFT = 2, 8  # modifiers of the browser's protocol
CODES = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Delete": 46, "Enter": 13}


@pytest.fixture(autouse=True)
def nothing_selected(studio: Studio) -> Iterator[None]:
    """Deselect everything after each test."""
    yield
    studio.page.value("kinesicStudio.tracks.selection.set([])")


def press(studio: Studio, key: str, modifiers: int = 0) -> None:
    """Press a key together with modifier keys."""
    code = CODES.get(key, ord(key[0].upper()))
    for kind in ("rawKeyDown", "keyUp"):
        studio.page.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code, modifiers=modifiers)


def click(
    studio: Studio, place: tuple[float, float], *, modifiers: int = 0, button: Literal["left", "right"] = "left"
) -> None:
    """Click at a position with modifier keys."""
    for kind in ("mousePressed", "mouseReleased"):
        studio.page.call(
            "Input.dispatchMouseEvent",
            type=kind,
            x=place[0],
            y=place[1],
            button=button,
            clickCount=1,
            modifiers=modifiers,
        )


def show(studio: Studio, text: str) -> None:
    """Write a document and wait for its plan."""
    studio.write(text)
    block = re.search(r'id="(\w+)"', text)[1]
    studio.until(f"s.draft.block === '{block}' && document.querySelector('#fault').hidden")


def changed(studio: Studio, text: str) -> str:
    """Wait for another text and its plan, and return the text."""
    studio.until(f"s.text !== {text!r} && s.plannedText === s.text")
    return str(studio.state("text"))


def onto(studio: Studio, selector: str, by: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the mouse positions [pixels] of a drag along the time axis.

    The drag moves by a time [s]. It begins in an element, beside the handles of a block.
    """
    item = f"document.querySelector({selector!r})"
    studio.page.value(f"{item}.scrollIntoView({{block: 'nearest'}})")
    x, y = middle(studio, selector)
    if "block" in selector:
        left, top, width, height = studio.page.value(
            f"(r => [r.x, r.y, r.width, r.height])({item}.getBoundingClientRect())"
        )
        x, y = left + 0.15 * width, top + 0.75 * height
    return (x, y), (x + by / studio.page.value("kinesicStudio.timeline.pixel"), y)


def test_studio_shows_a_track_with_lexemes_and_phases_for_each_body_part(studio: Studio):
    show(studio, PARTS)
    tracks = "[...document.querySelectorAll('[data-track]')].map(row => [row.dataset.track, row.textContent])"
    assert dict(studio.page.value(tracks)) == {
        "voice": "voice",
        "face": "facesmile",
        "gaze": "gazeleft",
        "head": "headnod",
        "torso": "trunkleaning forward",
        "r_hand": "right handwelcomeoffer",
        "l_hand": "left handwelcome",
    }
    phases = "[...document.querySelectorAll('[data-block=give] .phase')].map(each => each.className.split(' ')[1])"
    found = studio.page.value(phases)
    assert found[0] == "preparation-phase"
    assert found[-1] == "retraction-phase"
    assert "stroke-phase" in found
    left = "document.querySelector('[data-block=give] .stroke-phase').getBoundingClientRect().left"
    drawn = studio.page.value(f"kinesicStudio.timeline.timeAt({left})")
    sync = next(s for s in studio.state("draft")["syncs"] if (s["behaviour"], s["sync"]) == ("give", "strokeStart"))
    assert drawn == pytest.approx(sync["planned"], abs=0.02)
    show(studio, WORDS)
    assert studio.page.value("document.querySelectorAll('[data-block=s] .phase').length") == 0, "speech has none"
    show(studio, PARTS)
    label = studio.page.value("document.querySelector('[data-block=give]').getAttribute('aria-label')")
    assert re.fullmatch(r"gesture offer, give, \d+\.\d\d to \d+\.\d\d s", label)


def test_overlapping_behaviours_in_a_studio_track_do_not_cover_each_other(studio: Studio):
    show(
        studio,
        PARTS.replace("smile", "joy").replace("</bml>", '<faceLexeme id="b" lexeme="smile" start="2" end="4"/></bml>'),
    )
    boxes = "['glad', 'b'].map(id => document.querySelector(`[data-block=${id}]`).getBoundingClientRect().top)"
    first, second = studio.page.value(boxes)
    assert second - first > 20


def test_playhead_of_the_studio_follows_the_performance_of_the_robot(studio: Studio):
    """Compare the playhead with each stroke's planned time at the stroke's feedback."""
    early = '<gesture id="early" lexeme="welcome" mode="LEFT_HAND" stroke="0"/>'
    show(studio, f'{BML.replace("parts", "shown")}{early}<head id="late" lexeme="NOD" stroke="3"/></bml>')
    draft = studio.state("draft")
    assert draft["zero"] > 0.5, "the hand begins to rise before the block time 0"
    studio.page.value(
        "heard = {}, (p => { const hear = p.hear.bind(p);"
        " p.hear = feedback => { hear(feedback); heard[feedback.about] = kinesicStudio.state().time; }; "
        "})(kinesicStudio.performing), 0"
    )
    studio.page.value("kinesicStudio.playback.player.seek(0)")
    studio.page.click("#perform")
    studio.until("s.performs && s.time > 0")
    studio.until("!s.performs")
    heard = studio.page.value("heard")
    for sync in draft["syncs"]:
        if sync["sync"] == "stroke":
            assert heard[f"shown:{sync['behaviour']}:stroke"] == pytest.approx(sync["planned"], abs=0.35)
    share = float(studio.page.value("document.querySelector('.playhead').style.left").split("* ")[1].rstrip(")"))
    assert share == pytest.approx(studio.state("time") / draft["duration"], abs=0.02)


def test_behaviour_dragged_in_the_studio_moves_and_snaps_to_the_stroke_of_another_behaviour(studio: Studio):
    show(studio, THREE)
    begin, end = onto(studio, "[data-block=two]", 0.5)
    studio.page.drag(begin, ((begin[0] + end[0]) / 2, end[1]), end)
    assert changed(studio, THREE) == THREE.replace('start="3"', 'start="3.5"')
    text = str(studio.state("text"))
    syncs = {(s["behaviour"], s["sync"]): s["planned"] for s in studio.state("draft")["syncs"]}
    begin, end = onto(studio, "[data-block=three]", syncs["two", "stroke"] - syncs["three", "stroke"] + 0.03)
    studio.page.drag(begin, ((begin[0] + end[0]) / 2, end[1]), end)
    assert changed(studio, text) == text.replace('start="5"', 'stroke="two:stroke"')


def test_stroke_dragged_to_an_accent_in_the_studio_is_written_as_an_offset_from_its_word(studio: Studio):
    show(studio, WORDS)
    accents = studio.state("draft")["accents"]
    if not accents:
        pytest.skip("no voice is heard here: espeak is not installed")
    words = studio.state("draft")["words"]
    piece = words[-1]
    time = next(accent for accent in accents if piece["start"] + 0.1 < accent < piece["end"])
    stroke = next(s for s in studio.state("draft")["syncs"] if (s["behaviour"], s["sync"]) == ("g", "stroke"))
    begin, end = onto(studio, "[data-stroke=g]", time - stroke["planned"])
    studio.page.drag(begin, ((begin[0] + end[0]) / 2, end[1]), end)
    text = changed(studio, WORDS)
    offset = float(re.search(rf'stroke="s:{piece["mark"]}\+([\d.]+)"', text)[1])
    assert offset == pytest.approx(time - piece["start"], abs=2e-3)


def test_behaviour_dragged_in_the_studio_with_the_alt_key_does_not_snap_to_strokes(studio: Studio):
    show(studio, THREE)
    syncs = {(s["behaviour"], s["sync"]): s["planned"] for s in studio.state("draft")["syncs"]}
    begin, end = onto(studio, "[data-block=three]", syncs["two", "stroke"] - syncs["three", "stroke"] + 0.03)
    mouse = {"button": "left", "buttons": 1, "clickCount": 1, "modifiers": 1}
    for kind, (x, y) in (("mousePressed", begin), ("mouseMoved", end), ("mouseReleased", end)):
        studio.page.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **mouse)
    assert "two:stroke" not in changed(studio, THREE)


def test_shift_click_and_rectangle_select_several_studio_behaviours_which_move_together(studio: Studio):
    show(studio, THREE)
    studio.page.click("[data-block=one]")
    click(studio, middle(studio, "[data-block=two]"), modifiers=SHIFT)
    assert studio.state("selected") == ["one", "two"]
    begin, end = onto(studio, "[data-block=one]", 0.4)
    studio.page.drag(begin, ((begin[0] + end[0]) / 2, end[1]), end)
    text = changed(studio, THREE)
    moved = {name: float(re.search(rf'id="{name}"[^>]*start="([\d.]+)"', text)[1]) for name in ("one", "two", "three")}
    assert moved["one"] == pytest.approx(1.4, abs=0.1)
    assert moved["two"] - moved["one"] == pytest.approx(2.0)
    assert moved["three"] == 5.0
    area = studio.page.value(
        "(r => [r.left, r.top, r.right, r.bottom])(document.querySelector('[data-lane=head]').getBoundingClientRect())"
    )
    studio.page.drag((area[2] - 2, area[1] + 2), (area[0] + 40, area[3] - 4), (area[0] + 3, area[3] - 2))
    assert set(studio.state("selected")) == {"one", "two"}
    click(studio, (area[2] - 2, area[1] + 2))
    assert studio.state("time") > 5.0, "a click seeks"


def test_keyboard_moves_copies_pastes_duplicates_and_deletes_studio_behaviours_with_undo(studio: Studio):
    show(studio, THREE)
    studio.page.click("[data-block=one]")
    studio.page.value("document.querySelector('[data-block=one]').focus()")
    press(studio, "ArrowRight", SHIFT)
    assert studio.state("selected") == ["one", "two"]
    press(studio, "ArrowRight")
    moved = changed(studio, THREE)
    assert moved == THREE.replace('"1"', '"1.05"').replace('"3"', '"3.05"')
    assert studio.page.value("document.querySelector('#track-status').textContent") == "2 behaviours moved by 0.05 s"
    press(studio, "c", CONTROL)
    studio.page.value("kinesicStudio.playback.player.duration = 99; kinesicStudio.playback.player.seek(10.5); 0")
    zero = studio.state("draft")["zero"]
    press(studio, "v", CONTROL)
    pasted = changed(studio, moved)
    first = f"{10.5 - zero:.3f}".rstrip("0").rstrip(".")
    second = f"{12.5 - zero:.3f}".rstrip("0").rstrip(".")
    lines = f'  <head id="one2" lexeme="NOD" start="{first}"/>\n  <head id="two2" lexeme="NOD" start="{second}"/>\n'
    assert pasted == moved.replace("</bml>", f"{lines}</bml>")
    studio.until("s.selected.join() === 'one2,two2' && s.draft.behaviours.length === 5")
    press(studio, "d", CONTROL)
    assert changed(studio, pasted).count("<head") == 6
    studio.until("s.draft.behaviours.length === 7 && s.selected.length === 2")
    press(studio, "Delete")
    assert studio.state("text") == pasted
    for _ in range(4):
        studio.page.click("#undo")
    assert studio.state("text") == THREE


def test_right_click_in_the_studio_opens_a_track_menu_that_arrow_keys_navigate(studio: Studio):
    show(studio, THREE)
    click(studio, onto(studio, "[data-block=three]", 0.0)[0], button="right")
    studio.page.until("document.querySelector('#track-menu') !== null")
    assert studio.state("selected") == ["three"]
    items = "[...document.querySelectorAll('#track-menu button:not(:disabled)')].map(each => each.firstChild.data)"
    names = studio.page.value(items)
    assert names[:4] == ["Copy", "Cut", "Duplicate", "Delete"] or "Paste here" in names
    steps = names.index("Delete")
    for _ in range(steps):
        press(studio, "ArrowDown")
    assert studio.page.value("document.activeElement.firstChild.data") == "Delete"
    studio.page.value("document.activeElement.click()")
    assert 'id="three"' not in studio.state("text")
    assert studio.page.value("document.querySelector('#track-menu') === null")


def test_dragged_edge_of_a_gesture_phase_in_the_studio_changes_the_phase_and_keeps_the_stroke(studio: Studio):
    show(studio, THREE)
    studio.page.click("[data-block=three]")
    before = {s["sync"]: s["planned"] for s in studio.state("draft")["syncs"] if s["behaviour"] == "three"}
    selector = "[data-behaviour=three][data-edge=relax]"
    begin, end = onto(studio, selector, 0.1)
    studio.page.drag(begin, ((begin[0] + end[0]) / 2, end[1]), end)
    text = changed(studio, THREE)
    assert 'start="5" relax="' in text
    studio.until(
        "s.draft.syncs.some(s => s.behaviour === 'three' && s.sync === 'relax' && "
        f"Math.abs(s.planned - {before['relax']} - 0.1) < 0.06)"
    )
    after = {s["sync"]: s["planned"] for s in studio.state("draft")["syncs"] if s["behaviour"] == "three"}
    assert after["stroke"] == pytest.approx(before["stroke"], abs=0.03)


def drop(studio: Studio, source: str, place: tuple[float, float]) -> None:
    """Drag a palette chip or gesture row onto the timeline."""
    x, y = middle(studio, source)
    studio.page.drag((x, y), (x + 8, y + 8), ((x + place[0]) / 2, (y + place[1]) / 2), place)


def test_palette_entry_of_the_studio_may_be_dropped_onto_a_word_or_onto_a_time(studio: Studio):
    show(studio, WORDS)
    studio.page.click("#show-palette")
    word = studio.page.value("[...document.querySelectorAll('.word')].findIndex(word => word.textContent === 'then')")
    drop(studio, "[data-add='palette:Head/nod']", middle(studio, f"[data-word='{word}']"))
    text = changed(studio, WORDS)
    mark = re.search(r'<sync id="(\w+)"/>then', text)[1]
    assert f'<head id="nod" stroke="s:{mark}" lexeme="NOD"/>' in text
    studio.until("s.selected.join() === 'nod'")
    right, bottom = studio.page.value(
        "(r => [r.right, r.bottom])(document.querySelector('#rows').getBoundingClientRect())"
    )
    drop(studio, "[data-add='palette:Gaze/to the left']", (right - 30, bottom - 12))
    late = changed(studio, text)
    start, end = (
        float(value) for value in re.search(r'<gaze id="look" start="([\d.]+)" end="([\d.]+)"', late).groups()
    )
    assert start > 1.0
    assert end == pytest.approx(start + 2)
    studio.page.click("#show-palette")
    assert studio.page.value("document.querySelector('#palette').hidden")


def test_listed_gesture_dropped_onto_a_word_in_the_studio_gets_its_stroke_there(studio: Studio):
    show(studio, WORDS)
    studio.page.value("document.querySelector('#lexicon').open = true")
    search = "document.querySelector('#search')"
    studio.page.value(f"{search}.value = 'idea bowl', {search}.dispatchEvent(new Event('input'))")
    row = "[data-add='gesture:conduit']"
    studio.page.value(f'document.querySelector("{row}").scrollIntoView({{block: "center"}})')
    drop(studio, f"{row} b", middle(studio, "[data-word='0']"))
    assert '<gesture id="conduit" lexeme="conduit" stroke="s:start"/>' in changed(studio, WORDS)
    studio.page.value("document.querySelector('#lexicon').open = false")
