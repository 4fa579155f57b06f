"""What is said when."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from kinesic.bml.block import Speech
from kinesic.planning.plan import Plan


@dataclass(frozen=True)
class Said:
    """A piece of speech between two marks."""

    behaviour: str
    begin: float  # [s] performance time
    end: float  # [s] performance time
    text: str


def captions(plan: Plan) -> Iterator[Said]:
    """Every text between its marks, each piece when it is said."""
    for timed in plan.timeline.timed:
        name, action = timed.behaviour.id, timed.behaviour.action
        if not isinstance(action, Speech) or name not in plan.utterances:
            continue
        script, utterance = action.script, plan.utterances[name]
        begin = plan.trajectory.zero + timed.times["start"]
        marks = sorted((m.position, utterance.marks[m.name]) for m in script.marks if m.name in utterance.marks)
        cuts = [(0, 0.0), *marks, (len(script.text), utterance.duration)]
        for (first, start), (last, stop) in pairwise(cuts):
            yield Said(name, begin + start, begin + stop, " ".join(script.text[first:last].split()))
