"""A newcomer's first wish, click by click: a gesture that weighs two things, on a word, shy, on servos."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from ..chromium import Page, binary, opened
from .conftest import SOFTWARE

pytestmark = pytest.mark.realtime

MOST_ACTIONS = 25
STATE = "kinesicStudio.state()"
DOCUMENT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="talk">\n'
    '  <speech id="s"><text>It is tea versus coffee today.</text></speech>\n</bml>'
)


@dataclass
class Person:
    """Somebody with a mouse and a keyboard, whose actions are counted."""

    page: Page
    actions: list[str] = field(default_factory=list)

    def click(self, selector: str) -> None:
        self.actions.append(f"click {selector}")
        self.page.click(selector)

    def write(self, selector: str, text: str) -> None:
        """Writes into a field, and leaves it."""
        self.actions.append(f"write into {selector}")
        script = (
            f"(e => {{ e.value = {json.dumps(text)}; e.dispatchEvent(new Event('input'));"
            f" e.dispatchEvent(new Event('change')) }})(document.querySelector({json.dumps(selector)}))"
        )
        self.page.value(script)

    def drag(self, begin: tuple[float, float], *steps: tuple[float, float]) -> None:
        self.actions.append("drag")
        self.page.drag(begin, *steps)

    def sees(self, condition: str) -> None:
        """Waits until something is so; `s` is what the page knows."""
        self.page.until(f"(s => {condition})({STATE})")

    def middle(self, selector: str) -> tuple[float, float]:
        area = f"document.querySelector({json.dumps(selector)}).getBoundingClientRect()"
        x, y = self.page.value(f"(r => [r.x + r.width / 2, r.y + r.height / 2])({area})")
        return x, y


@pytest.fixture
def servos(tmp_path: Path) -> Iterator[Path]:
    """Simulated servos at a port of this machine."""
    command = [sys.executable, "-m", "kinesic", "servos", "simulate", "--folder", str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert "body" in process.stdout.readline()
            yield tmp_path / "body"
        finally:
            process.kill()


@pytest.fixture
def person(servos: Path, tmp_path: Path) -> Iterator[Person]:
    """Before the studio that moves them."""
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    moved = ("--on", "servos", "--port", str(servos))
    command = [sys.executable, "-m", "kinesic", "studio", "--listen", "127.0.0.1:0", "--no-browser", *moved]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        try:
            url = next(found[1] for line in process.stderr if (found := re.search(r"the studio: (\S+)", line)))
            with opened(url.replace("127.0.0.1", "localhost"), tmp_path / "profile", *SOFTWARE) as page:
                page.until(f"window.kinesicStudio !== undefined && {STATE}.planned > 0")
                yield Person(page)
        finally:
            process.terminate()
            process.wait(60.0)


def test_a_gesture_is_made_put_on_a_word_made_shy_saved_and_seen_on_servos(person: Person, tmp_path: Path):
    person.page.call("Runtime.evaluate", expression="names = ['weigh.toml', 'talk.bml']; prompt = () => names.shift()")
    person.click("#lexicon summary")
    person.write("#search", "weigh against")
    person.click("[aria-label='Edit a copy of balance']")
    person.sees("s.draft?.gesture === 'my_balance'")
    person.click("#keys .group button:nth-child(1)")
    person.sees("s.drawn > 0 && s.left !== null")
    hand = person.page.value(f"{STATE}.left")
    person.drag((hand["x"], hand["y"]), (hand["x"] + 5, hand["y"] - 10), (hand["x"] + 10, hand["y"] - 20))
    person.sees("s.past === 1")
    person.click("#save")
    person.page.until("document.querySelector('#file').textContent === 'weigh.toml'")
    person.write("#examples", "example:one_gesture")
    person.sees("s.draft?.block === 'one'")
    person.write("#text", DOCUMENT)
    person.sees("s.draft?.block === 'talk'")
    person.write("#search", "my_balance")
    person.click("[aria-label='Add my_balance to the document']")
    person.sees("s.draft?.syncs.some(sync => sync.behaviour === 'my_balance')")
    versus = "[...document.querySelectorAll('.word')].findIndex(word => word.textContent === 'versus')"
    onto = person.middle(f"[data-word='{person.page.value(versus)}']")
    person.drag(person.middle("[data-stroke='my_balance']"), (onto[0] - 9, onto[1] + 3), onto)
    person.sees("s.text.includes('stroke=\"s:')")
    person.click("[data-row='my_balance'] .name")
    person.write("#own-style", "shy")
    person.sees(
        "s.text.includes('kinesic:style=\"shy\"') && s.draft.behaviours.every(each => each.outcome === 'realised')"
    )
    person.click("#save")
    person.page.until("document.querySelector('#file').textContent === 'talk.bml'")
    assert person.page.value("document.querySelector('#perform').disabled"), "the servos have no torque yet"
    person.sees("document.querySelectorAll('#strips .strip:not(.head)').length === s.report.servos.celsius.length")
    person.click("#arm")
    person.page.until("document.querySelector('#arming').open")
    person.page.value("document.querySelector('#arm-yes').click()")  # a script is nobody
    assert person.page.value("document.querySelector('#arming').open")
    person.click("#arm-yes")
    person.sees("s.report.servos.state === 'armed'")
    person.click("#perform")
    person.sees(
        "s.mode === 'robot' && s.report.hottest !== null && s.report.angles.some((a, k) => Math.abs(a - "
        f"{json.dumps(person.page.value(f'{STATE}.report.angles'))}[k]) > 0.3)"
    )
    assert len(person.actions) <= MOST_ACTIONS, person.actions
    saved = (tmp_path / "talk.bml").read_text()
    assert re.search(r'tea <sync id="(\w+)"/>versus', saved)[1] == re.search(r'stroke="s:(\w+)"', saved)[1]
    assert 'id = "my_balance"' in (tmp_path / "weigh.toml").read_text()
    strips = "[...document.querySelectorAll('#strips .strip:not(.head)')].map(each => each.textContent)"
    assert all(re.fullmatch(r"\w+?\d\d\d\d\.\d", strip) for strip in person.page.value(strips))
    told = person.page.value(f"{STATE}.report.servos")
    assert all(told["torque"])
    assert {*told["volts"]} == {12.0}
    person.click("#arm")
    person.sees("s.report.servos.state === 'limp' && s.report.servos.torque.every(each => each === 0)")
