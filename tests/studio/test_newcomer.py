"""A newcomer's first wish, click by click: a gesture that weighs two things, on a word, shy, on servos."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from ..chromium import binary
from .newcomer import STATE, Person, before_the_studio, make_and_perform

pytestmark = pytest.mark.realtime

MOST_ACTIONS = 25


@pytest.fixture
def person(tmp_path: Path) -> Iterator[Person]:
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    with before_the_studio(tmp_path, drawn=False) as found:
        yield found


def test_a_gesture_is_made_put_on_a_word_made_shy_saved_and_seen_on_servos(person: Person, tmp_path: Path):
    make_and_perform(person)
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
    person.sees("s.report.servos.torque.every(each => each === 1)")  # each servo is asked in its turn
    assert {*person.page.value(f"{STATE}.report.servos.volts")} == {12.0}
    person.click("#arm")
    person.sees("s.report.servos.state === 'limp' && s.report.servos.torque.every(each => each === 0)")
