"""Captions: the spoken text with its times."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from kinesic.bml.block import Speech
from kinesic.planning.plan import Plan


@dataclass(frozen=True)
class Caption:
    """Text between two marks of a speech."""

    behaviour: str
    mark: str  # preceding mark, or "start"
    begin: float  # [s] performance time
    end: float  # [s] performance time
    text: str


def make_captions(plan: Plan) -> Iterator[Caption]:
    """Yield the text between marks of every speech with its times."""
    for timed in plan.timeline.timed:
        name, action = timed.behaviour.id, timed.behaviour.action
        if not isinstance(action, Speech) or name not in plan.utterances:
            continue
        script, utterance = action.script, plan.utterances[name]
        begin = plan.trajectory.zero + timed.times["start"]
        marks = sorted((m.position, utterance.marks[m.name], m.name) for m in script.marks if m.name in utterance.marks)
        cuts = [(0, 0.0, "start"), *marks, (len(script.text), utterance.duration, "end")]
        for (first, start, mark), (last, stop, _) in pairwise(cuts):
            yield Caption(name, mark, begin + start, begin + stop, " ".join(script.text[first:last].split()))
