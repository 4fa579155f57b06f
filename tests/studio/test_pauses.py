"""Pauses that the menu Add inserts into or after a speech."""

from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
SPEECH = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">
  <speech id="s"><text>Good morning to all of you</text></speech>
</bml>"""


def add_pause(studio: Studio, label: str, time: float) -> None:
    """Add a pause at a time by slider and menu Add."""
    planned = studio.state("planned")
    slider, menu = "document.querySelector('#time')", "document.querySelector('#add')"
    studio.page.value(f"{slider}.value = {time}; {slider}.dispatchEvent(new Event('input')); 0")
    studio.page.value(f"{menu}.value = 'Pause/{label}'; {menu}.dispatchEvent(new Event('change')); 0")
    studio.until(f"s.planned > {planned}")


def test_pause_added_within_a_speech_in_the_studio_lengthens_the_speech(studio: Studio):
    studio.write(SPEECH)
    before = studio.state("draft")["duration"]
    (words,) = studio.state("draft")["words"]
    add_pause(studio, "2 seconds", (words["start"] + words["end"]) / 2)
    assert studio.state("text").count('<break time="2s"/>') == 1
    assert "<wait" not in studio.state("text")
    assert 1.8 < studio.state("draft")["duration"] - before < 2.6


def test_pause_added_after_the_speech_in_the_studio_becomes_a_wait_and_the_log_explains_it(studio: Studio):
    studio.write(SPEECH)
    add_pause(studio, "1 second", studio.state("draft")["duration"])
    assert "<wait" in studio.state("text")
    assert "<break" not in studio.state("text")
    log = studio.page.value("document.querySelector('#log li').textContent")
    assert log == "the pause is a wait: it delays only what refers to its end"
