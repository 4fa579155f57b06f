"""Replay of the report's page with face film and voice."""

import json
import wave
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from kinesic.face.show.files import save_film
from kinesic.metrics.dry_run import DryRun
from kinesic.report.page import Recordings, write_page
from kinesic.report.report import report
from kinesic.sim.filming.drawn_face import paint_face

from ..chromium import Page, binary, opened

FILM_RATE = 20.0  # [Hz] frame rate of the film
FRAME_COUNT = 40
SOUND_DURATION = 1.0  # [s] duration of the sound
WINDOW_SIZE = (480, 400)  # [pixels] size of the window, small because drawing in software is slow

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(binary() is None, reason="no Chromium: apt-get install chromium"),
]


def grey(frame: int) -> int:
    return 20 + 5 * frame


@pytest.fixture(scope="module")
def url(hurried: DryRun, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the URL of a page whose face film slowly brightens."""
    folder = tmp_path_factory.mktemp("player")
    frames = []
    for k in range(FRAME_COUNT):
        frames.append(np.full((64, 64, 3), 30, dtype=np.uint8))
        frames[-1][32:, 32:] = grey(k)  # most of the picture stays, so that the file holds parts of it
    save_film(frames, folder / "face.webp", rate=FILM_RATE)
    with wave.open(str(folder / "speech.wav"), "wb") as sound:
        sound.setparams((1, 2, 8000, 0, "NONE", ""))
        sound.writeframes(bytes(round(2 * 8000 * SOUND_DURATION)))
    data, path = report(hurried, source="x.bml"), folder / "report.html"
    write_page(
        hurried, data, Recordings(face=folder / "face.webp", voice=folder / "speech.wav", face_on_head=True), path=path
    )
    return path.as_uri()


def resize(page: Page, width: int, height: int) -> None:
    page.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)


@contextmanager
def ready(url: str) -> Iterator[Page]:
    """Return a page in a small window, after its robot is drawn."""
    with opened(url) as page:
        resize(page, *WINDOW_SIZE)
        page.until("document.querySelector('#stage')?.hidden === false")
        yield page


@pytest.fixture(scope="module")
def page(url: str) -> Iterator[Page]:
    """Return a paused page for tests that set the time themselves."""
    with ready(url) as result:
        yield result


@pytest.fixture(scope="module")
def plain(hurried: DryRun, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """Return a page whose twin deviates by 3 degrees after 0.5 s."""
    measured, robot = hurried.measured, hurried.plan.setup.robot
    astray = hurried.plan.trajectory.sample(measured.times)[0]
    elbow = robot.skeleton.names.index("r_elbow_flexion")
    astray[:, elbow] += np.radians(np.where(measured.times < 0.5, 0.8, 3.0))
    path, changed = tmp_path_factory.mktemp("plain") / "plain.html", replace(measured, angles=astray)
    write_page(replace(hurried, measured=changed), report(hurried, source="x.bml"), path=path)
    with ready(path.as_uri()) as result:
        yield result


def seek(page: Page, time: float) -> None:
    slider = "document.querySelector('[data-part=time]')"
    page.value(f"{slider}.value = {time}; {slider}.dispatchEvent(new Event('input'))")


def shade(page: Page) -> str:
    """Return a script expression for the brightness of the face film's corner."""
    return "document.querySelector('[data-part=face]').getContext('2d').getImageData(50, 50, 1, 1).data[0]"


def test_face_film_of_the_report_page_follows_the_replay_forwards_and_backwards(page: Page):
    rest = "document.querySelector('[data-part=face]').getContext('2d').getImageData(10, 10, 1, 1).data[0]"
    with page.undrawn():
        for frame in (3, 20, 31, 30, 5, 0, 39):
            seek(page, (frame + 0.5) / FILM_RATE)
            page.until(f"Math.abs({shade(page)} - {grey(frame)}) < 3")
            assert abs(int(str(page.value(rest))) - 30) < 4


def test_replay_of_the_report_page_follows_the_clock_of_the_sound_and_stops_the_sound(page: Page):
    page.call("Runtime.evaluate", expression="window.voice = document.querySelector('audio')")
    clock = "Number(document.querySelector('[data-part=clock]').textContent.split(' ')[0])"
    with page.undrawn():
        seek(page, 0.0)
        look(
            page,
            "together",
            f"!voice.paused && voice.currentTime > 0.2 && Math.abs({clock} - voice.currentTime) < 0.15 + gap",
        )
        page.click("[data-part=play]")
        assert page.value("together")
        page.click("[data-part=play]")
        page.until("voice.paused")
        seek(page, 0.1)
        look(page, "again", "voice.currentTime < 0.6 && !voice.paused")
        page.click("[data-part=play]")
        assert page.value("again")
        page.until(f"voice.paused && {clock} > {SOUND_DURATION + 0.2}")  # it goes on after the last word
        page.click("[data-part=play]")


def look(page: Page, name: str, condition: str) -> None:
    """Define a promise `name` that is fulfilled once a condition holds.

    A condition may speak of the `gap` [s] since the frame before: what is drawn is as old as that.
    """
    measure = "const now = performance.now(), gap = (now - last) / 1000; last = now"
    frame = f"() => {{ {measure}; ({condition}) ? done(true) : requestAnimationFrame(once) }}"
    watch = f"done => {{ let last = performance.now(); const once = {frame}; requestAnimationFrame(once) }}"
    page.call("Runtime.evaluate", expression=f"window.{name} = new Promise({watch}), 0")


def test_space_key_plays_the_replay_without_a_click_on_it(plain: Page):
    is_playing = "document.querySelector('#stage').classList.contains('playing')"
    assert plain.value("document.activeElement === document.body")
    with plain.undrawn():
        for key_ends in (is_playing, f"!{is_playing}"):
            for kind in ("keyDown", "keyUp"):
                plain.call("Input.dispatchKeyEvent", type=kind, key=" ", code="Space", text=" " * (kind == "keyDown"))
            plain.until(key_ends)


def test_report_page_without_recordings_has_no_face_film_and_no_sound(plain: Page):
    assert plain.value("document.querySelector('[data-part=face]').hidden")
    assert plain.value("document.querySelector('audio') === null")
    with plain.undrawn():
        seek(plain, 0.0)
        plain.click("[data-part=play]")
        plain.until("Number(document.querySelector('[data-part=clock]').textContent.split(' ')[0]) > 0.2")
        plain.click("[data-part=play]")


def picture(page: Page, ghost: str, time: float) -> object:
    """Return the picture at a time with the chosen overlays."""
    choice = f"document.querySelector('[data-part=ghost]').value = '{ghost}'"
    slider = f"const s = document.querySelector('[data-part=time]'); s.value = {time}"
    drawn = "requestAnimationFrame(() => done(document.querySelector('#stage canvas').toDataURL()))"
    return page.value(f"new Promise(done => {{ {choice}; {slider}; s.dispatchEvent(new Event('input')); {drawn} }})")


def test_plan_overlay_for_deviations_appears_only_after_the_twin_leaves_the_plan_by_3_degrees(plain: Page):
    for time, seen in ((0.3, False), (0.7, True)):
        without = picture(plain, "", time)
        assert (picture(plain, "plan over astray", time) != without) == seen
        assert picture(plain, "plan over", time) != without


def edges(selector: str) -> str:
    """Return a script expression for an element's left and top edge [px]."""
    return f"(() => {{ const r = document.querySelector('{selector}').getBoundingClientRect(); return [r.x, r.y]; }})()"


def test_time_slider_aligns_with_the_plot_playhead_and_the_player_is_first_on_telephones(page: Page):
    with page.undrawn():
        for width, style in ((360, "narrow"), (390, "narrow"), (560, "narrow"), (700, "broad"), (1180, "broad")):
            resize(page, width, 900)
            for time in (0.0, 1.0):
                seek(page, time)
                mark = f"document.querySelector('.line').getBoundingClientRect().x + 8 + {time} / Number(max) * track"
                share = "const max = document.querySelector('[data-part=time]').max;"
                track = "const track = document.querySelector('.line').getBoundingClientRect().width - 16;"
                thumb = float(str(page.value(f"(() => {{ {share} {track} return {mark}; }})()")))
                assert thumb == pytest.approx(page.value(edges(f".{style} .playhead"))[0], abs=2.0)
            above = page.value(edges("#stage"))[1] < page.value(edges(".tiles"))[1]
            assert above == (style == "narrow")
            hidden = "broad" if style == "narrow" else "narrow"
            assert page.value(f"document.querySelector('.{hidden}').getBoundingClientRect().width") == 0
            assert page.value("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    resize(page, *WINDOW_SIZE)


def test_face_film_on_the_robot_head_follows_the_replay_time(page: Page):
    """Compare the head's brightness while the face film brightens."""
    lights = []
    for frame in (2, 20, 38):
        seek(page, (frame + 0.5) / FILM_RATE)
        page.until(f"Math.abs({shade(page)} - {grey(frame)}) < 3")
        lights.append(brightest_change(page))
    assert page.value("document.querySelector('[data-part=face]').getBoundingClientRect().width") == 0
    assert lights[0] < lights[1] < lights[2]


def brightest_change(page: Page) -> float:
    """Return the mean brightness of the canvas around the head."""
    pen = "const p = document.createElement('canvas').getContext('2d', { willReadFrequently: true });"
    source = "const c = document.querySelector('#stage canvas');"
    copied = f"{pen} {source} p.canvas.width = c.width; p.canvas.height = c.height; p.drawImage(c, 0, 0);"
    area = "p.getImageData(c.width * 0.47, c.height * 0.22, c.width * 0.06, c.height * 0.2).data"
    mean = f"done({area}.reduce((sum, value) => sum + value, 0))"
    seek = "const s = document.querySelector('[data-part=time]'); s.dispatchEvent(new Event('input'));"
    drawn = f"requestAnimationFrame(() => {{ {copied} {mean} }})"
    return float(str(page.value(f"new Promise(done => {{ {seek} {drawn} }})")))


def test_report_page_paints_the_same_face_as_the_robot_film(plain: Page):
    faces = (
        {},
        {"26": 0.8, "18": 0.6},
        {"12": 1.0, "6": 0.5, "61": 0.7},
        {"L45": 1.0, "4": 1.0, "15": 0.6, "63": 0.5},
        {"1": 1.0, "5": 1.0, "7": 0.5, "R14": 1.0, "10": 0.7, "16": 0.6},
        {"2": 1.0, "9": 0.6, "17": 0.8, "22": 0.4, "23": 0.7, "66": 0.5},
    )
    for units in faces:
        painted = f"const {{ paper, pen }} = plainFace(); paintFace(pen, {json.dumps(units)});"
        pixels = plain.value(f"(() => {{ {painted} return [...pen.getImageData(0, 0, 320, 240).data]; }})()")
        seen = np.array(pixels).reshape(240, 320, 4)[..., :3]
        assert np.abs(seen - paint_face(units).astype(int)).mean() < 1.5
