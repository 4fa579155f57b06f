"""A scene in virtual time, and all that it tells."""

import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from kinesic.bml.composition import BlockState
from kinesic.planning.setup import Setup
from kinesic.realizer.contention import with_engaged_hands
from kinesic.realizer.realizer import PreparedBlock, Scene, ScheduledFeedback, advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request

TICK = 0.01  # [s]
NAMESPACES = (
    'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:bmla="http://www.asap-project.org/bmla" '
    'xmlns:kinesic="urn:kinesic"'
)


class Play:
    """A scene, the time, and all that was told."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.now = 0.0
        self.told: list[ScheduledFeedback] = []

    def ready(self, id: str, inside: str = "", attributes: str = "", sender: int = 0) -> PreparedBlock:
        text = f'<bml {NAMESPACES} id="{id}" {attributes}>{inside}</bml>'
        known = read_request(Message(text, sender), self.scene.setup, context=self.scene.context(self.now))
        return prepare_block(with_engaged_hands(self.scene, known), self.scene.setup)

    def send(self, id: str, inside: str = "", attributes: str = "", sender: int = 0) -> "Play":
        return self.take(begin(self.scene, self.ready(id, inside, attributes, sender), self.now))

    def renamed(self, made: PreparedBlock, id: str) -> PreparedBlock:
        """A plan that costs nothing."""
        block = replace(made.plan.timeline.block, id=id)
        plan = replace(made.plan, timeline=replace(made.plan.timeline, block=block))
        return replace(made, plan=plan, request=replace(made.request, block=block))

    def take(self, after: Scene) -> "Play":
        self.scene = after
        self.told += after.said
        return self

    def until(self, time: float) -> "Play":
        while self.now < time - 1e-9:
            self.now = min(time, self.now + TICK)
            self.take(advance(self.scene, self.now))
        return self

    def state(self, id: str) -> BlockState | None:
        return self.scene.states.get(id) or next((past.state for past in self.scene.ended if past.id == id), None)

    def at(self, id: str) -> float:
        """When a point was told, as `block:behaviour:point` or `block:point`; exactly once."""
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
    found = re.search(r'globalTime="([^"]*)"', due.xml)
    assert found is not None
    return float(found[1])


@pytest.fixture
def play(known: Setup) -> Play:
    return Play(Scene.of(known))


@pytest.fixture
def played(known: Setup) -> Callable[..., Play]:
    """One whose scene has options."""
    return lambda **options: Play(Scene.of(known, **options))
