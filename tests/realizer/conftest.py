"""Scene in simulated time with a record of its feedback."""

import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from kinesic.bml.composition import BlockState
from kinesic.planning.setup import Setup
from kinesic.realizer.contention import with_busy_hands
from kinesic.realizer.realizer import PreparedBlock, Scene, ScheduledFeedback, advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request

TICK_PERIOD = 0.01  # [s] time between two updates of the scene
BML_NAMESPACES = (
    'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:bmla="http://www.asap-project.org/bmla" '
    'xmlns:kinesic="urn:kinesic"'
)


class Play:
    """Scene with its time and all sent feedback."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.now = 0.0
        self.told: list[ScheduledFeedback] = []

    def ready(self, id: str, inside: str = "", attributes: str = "", sender: int = 0) -> PreparedBlock:
        text = f'<bml {BML_NAMESPACES} id="{id}" {attributes}>{inside}</bml>'
        known = read_request(Message(text, sender), self.scene.setup, context=self.scene.context(self.now))
        return prepare_block(with_busy_hands(self.scene, known), self.scene.setup)

    def send(self, id: str, inside: str = "", attributes: str = "", sender: int = 0) -> "Play":
        return self.take(begin(self.scene, self.ready(id, inside, attributes, sender), self.now))

    def renamed(self, made: PreparedBlock, id: str) -> PreparedBlock:
        """Return a prepared block with another id, without planning."""
        block = replace(made.plan.timeline.block, id=id)
        plan = replace(made.plan, timeline=replace(made.plan.timeline, block=block))
        return replace(made, plan=plan, request=replace(made.request, block=block))

    def take(self, after: Scene) -> "Play":
        self.scene = after
        self.told += after.outgoing_feedback
        return self

    def until(self, time: float) -> "Play":
        while self.now < time - 1e-9:
            self.now = min(time, self.now + TICK_PERIOD)
            self.take(advance(self.scene, self.now))
        return self

    def state(self, id: str) -> BlockState | None:
        return self.scene.states.get(id) or next((past.state for past in self.scene.ended if past.id == id), None)

    def at(self, id: str) -> float:
        """Return the time of the only feedback for `block:behaviour:point` or `block:point`."""
        times = [time(due) for due in self.told if is_progress(due, id)]
        assert len(times) == 1, f"{id} was told {len(times)} times"
        return times[0]

    def was_told(self, id: str) -> bool:
        return any(is_progress(due, id) for due in self.told)

    def warnings(self, id: str = "") -> list[str]:
        return [due.xml for due in self.told if "<warningFeedback" in due.xml and f'id="{id}' in due.xml]

    def predictions(self, id: str) -> list[str]:
        return [due.xml for due in self.told if "<predictionFeedback" in due.xml and f'<bml id="{id}"' in due.xml]


def is_progress(due: ScheduledFeedback, id: str) -> bool:
    return "Progress " in due.xml and f' id="{id}"' in due.xml


def time(due: ScheduledFeedback) -> float:
    result = re.search(r'globalTime="([^"]*)"', due.xml)
    assert result is not None
    return float(result[1])


@pytest.fixture
def play(known: Setup) -> Play:
    return Play(Scene.of(known))


@pytest.fixture
def played(known: Setup) -> Callable[..., Play]:
    """Function that makes scenes with the given options."""
    return lambda **options: Play(Scene.of(known, **options))
