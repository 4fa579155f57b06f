"""Simulated first use of the studio with mouse and keyboard, on simulated servos."""

import json
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import sleep

from ..chromium import Page, opened

PATIENT = "planning=600"  # quota of the planning time [s], sufficient on a busy machine
STATE = "kinesicStudio.state()"
TEXT = "It is tea versus coffee today."
MUSEUM_TEXT = (
    "Good morning, and welcome to the museum of machines! My name is Milo. On this floor you will find three hundred "
    "clocks. Some are tiny, and some are taller than a house. The oldest of them is over there, on the left. Please do "
    "not touch them, but ask me anything you like. Enjoy your visit!"
)  # greeting of about 20 s


@dataclass
class Person:
    """User whose actions are counted and reported to `films`."""

    page: Page
    films: Callable[[str, tuple[float, float] | None], None] = lambda _what, _where: None
    actions: list[str] = field(default_factory=list)
    typing_interval: float = 0.0  # [s] between two typed words; 0: a text comes at once

    def click(self, selector: str, what: str = "") -> None:
        """Click on an element; `what` describes the action."""
        self.page.value(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{block: 'center'}})")
        self._does(what or f"click {selector}", self.middle(selector))
        self.page.click(selector)

    def write(self, selector: str, text: str, what: str = "") -> None:
        """Write into a field and leave it."""
        self._does(what or f"write into {selector}", self.middle(selector))
        words = text.split(" ")
        for count in range(1 if self.typing_interval else len(words), len(words)):
            self._enter(selector, " ".join(words[:count]), "input")
            sleep(self.typing_interval)
        self._enter(selector, text, "input", "change")

    def _enter(self, selector: str, text: str, *events: str) -> None:
        """Set the value of a field, and dispatch events to it."""
        dispatched = "".join(f" e.dispatchEvent(new Event('{name}'));" for name in events)
        field = f"document.querySelector({json.dumps(selector)})"
        self.page.value(f"(e => {{ e.value = {json.dumps(text)};{dispatched} }})({field})")

    def save_as(self, name: str, what: str) -> None:
        """Save a new document under a name."""
        self.click("#save", what)
        self.page.until("document.querySelector('#saving').open")
        self.write("#save-name", name, f"write its name: {name}")
        self.click("#save-ok", "confirm the name")

    def drag(self, begin: tuple[float, float], *steps: tuple[float, float], what: str = "drag") -> None:
        self._does(what, begin)
        self.page.drag(begin, *steps)

    def sees(self, condition: str) -> None:
        """Wait for a condition; `s` is the state of the page."""
        self.page.until(f"(s => {condition})({STATE})")

    def middle(self, selector: str) -> tuple[float, float]:
        area = f"document.querySelector({json.dumps(selector)}).getBoundingClientRect()"
        x, y = self.page.value(f"(r => [r.x + r.width / 2, r.y + r.height / 2])({area})")
        return x, y

    def _does(self, what: str, where: tuple[float, float]) -> None:
        self.actions.append(what)
        self.films(what, where)


@contextmanager
def before_the_studio(folder: Path, *flags: str, drawn: bool = True, robot: str | Path = "upper22") -> Iterator[Person]:
    """Open the studio of a folder and of simulated servos in a browser with additional flags."""
    command = [sys.executable, "-m", "kinesic", "servos", "simulate", "--robot", str(robot), "--folder", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as servos:
        try:
            assert "body" in servos.stdout.readline()
            moved = ("--robot", str(robot), "--on", "servos", "--port", str(folder / "body"))
            with opened_studio(folder, *moved, flags=flags, drawn=drawn) as person:
                yield person
        finally:
            servos.kill()


@contextmanager
def opened_studio(folder: Path, *options: str, flags: tuple[str, ...] = (), drawn: bool = True) -> Iterator[Person]:
    """Open the studio of a folder with options in a browser with additional flags."""
    command = [sys.executable, "-m", "kinesic", "studio", "--listen", "127.0.0.1:0", "--no-browser"]
    with subprocess.Popen(
        [*command, "--rule", PATIENT, *options], stderr=subprocess.PIPE, text=True, cwd=folder
    ) as studio:
        try:
            url = next(result[1] for line in studio.stderr if (result := re.search(r"the studio: (\S+)", line)))
            with opened(url.replace("127.0.0.1", "localhost"), *flags, drawn=drawn) as page:
                page.until(f"window.kinesicStudio !== undefined && {STATE}.planned > 0")
                yield Person(page)
        finally:
            studio.terminate()
            studio.wait(60.0)


def make_and_perform(person: Person) -> None:
    """Perform a word with a new gesture in shy style."""
    person.click("#lexicon summary", "Gestures are found by what they mean")
    person.write("#search", "weigh against", "search: weigh against")
    person.click("[aria-label='Edit a copy of balance']", "Edit opens a copy of its file")
    person.sees("s.draft?.gesture === 'my_balance'")
    person.click("#keys .group button:nth-child(1)", "select a key of the gesture")
    person.sees("s.drawn > 0 && s.left !== null")
    hand = person.page.value(f"{STATE}.left")
    up = [(hand["x"] + 5 * k, hand["y"] - 10 * k) for k in range(3)]
    person.drag(*up, what="drag the hand to its new position")
    person.sees("s.past === 1")
    person.save_as("weigh", "Save the gesture for immediate use by the robot")
    person.page.until("document.querySelector('#file').textContent === 'weigh.toml'")
    person.write("#examples", "template:empty", "open a new document")
    person.sees("s.draft?.block === 'new'")
    person.write("#plain", TEXT, f"write: {TEXT}")
    person.click("#plain-make", "let the studio choose gestures")
    person.sees("s.draft?.block === 'said'")
    choose_gesture(person, "versus", "my balance")
    person.sees("s.draft?.syncs.some(sync => sync.behaviour === 'g1') && s.text.includes('lexeme=\"my_balance\"')")
    person.write("#own-style", "shy", "make it shy")
    realised = "s.draft.behaviours.every(each => each.type !== 'gesture' || each.outcome === 'realised')"
    person.sees(f"s.text.includes('kinesic:style=\"shy\"') && {realised}")
    person.save_as("talk", "Save the document")
    person.page.until("document.querySelector('#file').textContent === 'talk.bml'")
    switch_on_and_perform(person)


def write_greeting(person: Person) -> None:
    """Make and save a greeting of 20 s for a museum: a text, one changed gesture, joyful style."""
    person.write("#examples", "template:empty", "open a new document")
    person.sees("s.draft?.block === 'new'")
    person.write("#plain", MUSEUM_TEXT, "type what the robot should say")
    person.click("#plain-make", "let the studio choose gestures")
    person.sees("s.draft?.block === 'said' && s.text === s.plannedText")
    choose_gesture(person, "left.", "left")
    person.sees("s.text.includes('lexeme=\"left\"') && s.text === s.plannedText")
    person.click("#whole-style", "return to the whole performance")
    person.write("#own-style", "joyful", "make it joyful")
    person.sees("s.text.includes('kinesic:style=\"joyful\"') && s.text === s.plannedText")
    person.save_as("museum", "Save the document")
    person.page.until("document.querySelector('#file').textContent === 'museum.bml'")


def choose_gesture(person: Person, word: str, gesture: str) -> None:
    """Choose a gesture for a spoken word from the list."""
    index = f"[...document.querySelectorAll('#spoken button')].findIndex(e => e.textContent.startsWith({word!r}))"
    person.page.until(f"{index} >= 0")
    person.click(f"[data-spoken='{person.page.value(index)}']", f"click the word: {word.strip('.')}")
    row = f"[...document.querySelectorAll('#alternatives-list b')].find(e => e.textContent === {gesture!r})"
    person.page.until(f"{row} !== undefined")
    person.page.value(f"{row}.closest('button').id = 'mine'")
    person.click("#mine", f"choose {gesture} from the list")


def switch_on_and_perform(person: Person) -> None:
    """Switch the servos on, and perform the document."""
    person.sees("document.querySelectorAll('#strips .strip:not(.head)').length === s.report.servos.celsius.length")
    assert person.page.value("document.querySelector('#perform').disabled"), "the servos have no torque yet"
    person.click("#arm", "Motors on gives servos their torque")
    person.page.until("document.querySelector('#arming').open")
    person.page.value("document.querySelector('#arm-yes').click()")  # a script's click does not count
    assert person.page.value("document.querySelector('#arming').open")
    person.click("#arm-yes", "confirm that the space is free")
    person.sees("s.report.servos.state === 'armed'")
    person.click("#perform", "Perform")
