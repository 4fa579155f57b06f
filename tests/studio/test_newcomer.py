"""First use of the studio, from editing a gesture to performing it on servos."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import kinesic
from kinesic.studio.page import EXAMPLE_FOLDER

from ..chromium import binary
from ..reduced_robots import write_robot
from .newcomer import (
    STATE,
    Person,
    before_the_studio,
    make_and_perform,
    opened_studio,
    switch_on_and_perform,
    write_greeting,
)

pytestmark = pytest.mark.soak

MAX_ACTIONS = 20
EXAMPLES = ("welcome", *sorted(path.stem.partition("_")[2] for path in EXAMPLE_FOLDER.glob("*.bml")))


@pytest.fixture
def person(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Person]:
    """Open the studio of an arms-only robot, which needs fewer servos."""
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    robot = write_robot(tmp_path_factory.mktemp("robot"), "neck", "torso", "clavicles")
    with before_the_studio(tmp_path, drawn=False, robot=robot) as result:
        yield result


@pytest.mark.realtime
def test_new_gesture_on_a_word_in_the_studio_is_performed_by_servos_within_few_actions(person: Person, tmp_path: Path):
    make_and_perform(person)
    person.sees(
        "s.mode === 'robot' && s.report.hottest !== null && s.report.angles.some((a, k) => Math.abs(a - "
        f"{json.dumps(person.page.value(f'{STATE}.report.angles'))}[k]) > 0.3)"
    )
    assert len(person.actions) <= MAX_ACTIONS, person.actions
    saved = (tmp_path / "talk.bml").read_text()
    assert re.search(r'tea <sync id="(\w+)"/>versus', saved)[1] == re.search(r'"my_balance" stroke="s:(\w+)', saved)[1]
    assert 'id = "my_balance"' in (tmp_path / "weigh.toml").read_text()
    strips = "[...document.querySelectorAll('#strips .strip:not(.head)')].map(each => each.textContent)"
    assert all(re.fullmatch(r"\w+?\d\d\d\d\.\d", strip) for strip in person.page.value(strips))
    person.sees("s.report.servos.torque.every(each => each === 1)")  # servos are read in turn
    assert {*person.page.value(f"{STATE}.report.servos.volts")} == {12.0}
    person.click("#arm")
    person.sees("s.report.servos.state === 'limp' && s.report.servos.torque.every(each => each === 0)")


@pytest.mark.realtime
@pytest.mark.parametrize("example", EXAMPLES)
def test_newcomer_needs_at_most_20_studio_actions_for_a_new_gesture_from_every_example(person: Person, example: str):
    person.page.value("document.querySelector('#examples').focus(), 0")
    person.write("#examples", f"example:{example}", f"open {example}")
    person.sees(f"s.name === '{example}.bml' && s.text === s.plannedText")
    person.actions.clear()  # the page shows the example before the task begins
    make_and_perform(person)
    person.sees("s.performs")
    assert len(person.actions) <= MAX_ACTIONS, person.actions


def test_greeting_of_20_seconds_is_written_and_saved_in_the_studio_in_few_actions_on_a_slow_machine(tmp_path: Path):
    """Perform the saved greeting in simulation, in virtual time."""
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    with opened_studio(tmp_path, "--no-sound", drawn=False) as person:
        write_greeting(person)
    assert len(person.actions) < MAX_ACTIONS, person.actions
    performer = kinesic.Performer("upper22", voice="auto")
    run = performer.perform(performer.plan(tmp_path / "museum.bml"))
    assert run.ok
    assert 18.0 < run.plan.duration < 23.0


@pytest.mark.realtime
def test_greeting_of_20_seconds_is_written_and_performed_in_the_studio_in_few_actions(person: Person, tmp_path: Path):
    write_greeting(person)
    switch_on_and_perform(person)
    person.sees("s.performs")
    person.page.until("document.querySelector('#performing').textContent.startsWith('Finished')")
    assert 18.0 < person.page.value(f"{STATE}.draft.duration") < 23.0
    assert len(person.actions) <= MAX_ACTIONS, person.actions
    assert 'lexeme="left"' in (tmp_path / "museum.bml").read_text()
