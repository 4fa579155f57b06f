"""Benchmark of the rate, gaps and repeats of gesture strokes in stories.

Each story lasts about a minute.

The stories are planned, so that dropped and late strokes and the paths of the hands count. Speech is that of the best
voice of this machine.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from kinesic.bench.meaning.stories import STORY_TEXTS
from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.style.style import Style
from kinesic.intent.pacing.memory import REPEAT_WINDOW
from kinesic.intent.pacing.rhythm import is_beat
from kinesic.intent.pacing.tempo import RUN_SPACING
from kinesic.planning.plan import Plan
from kinesic.session.documents import write_text
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

STORY_STYLES: Mapping[str, str] = {
    "restrained": "shy",
    "neutral": "neutral",
    "lively": "joyful",
}  # level in metric names -> style
MIN_HUMAN_RATE = 7.7  # [1/min] 5th percentile of the gesture rate of people who retell a cartoon
MAX_HUMAN_RATE = 34.0  # [1/min] 95th percentile of the gesture rate of people who retell a cartoon
MAX_STROKE_DELAY = 0.1  # [s] deviation from the requested time above which a stroke counts as late
RETURN_RATIO = 0.3  # distance from rest / distance at the strokes, below which a hand has returned
SAMPLE_PERIOD = 0.02  # [s] interval between samples of the hands' paths
MAX_LOSSES = 2.0  # goal for the number of dropped gestures in three stories, and for that of late strokes
MAX_SILENCE = 14.0  # [s] goal for the longest time without strokes


@dataclass(frozen=True)
class PlannedStroke:
    """Stroke of a planned gesture."""

    time: float  # [s] block time
    delay: float  # [s] planned minus requested time
    lexeme: str
    hands: frozenset[Side]


@dataclass(frozen=True)
class StoryRhythm:
    """Strokes, dropped gestures and hand returns of one planned story."""

    seconds: float  # [s] duration of the speech
    strokes: tuple[PlannedStroke, ...]  # strokes in time order
    lost: int  # number of dropped gestures
    returns: tuple[bool, ...]  # whether a hand returned to rest, for successive strokes of one hand

    @property
    def rate(self) -> float:
        """Gesture strokes per minute of speech [1/min]."""
        return 60.0 * len(self.strokes) / self.seconds

    @property
    def beats(self) -> float:
        """Fraction of beat gestures among all gestures."""
        return sum(is_beat(stroke.lexeme) for stroke in self.strokes) / max(len(self.strokes), 1)

    @property
    def silence(self) -> float:
        """Longest time without a stroke during the speech [s]."""
        times = [0.0, *(stroke.time for stroke in self.strokes), self.seconds]
        return max(after - before for before, after in pairwise(times))

    @property
    def repeats(self) -> int:
        """Number of gestures already shown by the same hands within a minute."""
        last: dict[tuple[str, frozenset[Side]], float] = {}
        count = 0
        for stroke in self.strokes:
            form = (stroke.lexeme, stroke.hands)
            count += stroke.time - last.get(form, -np.inf) < REPEAT_WINDOW
            last[form] = stroke.time
        return count

    @property
    def late(self) -> int:
        """Number of strokes more than `MAX_STROKE_DELAY` from their requested time."""
        return sum(abs(stroke.delay) > MAX_STROKE_DELAY for stroke in self.strokes)


def bench(robot: str = "human") -> Iterator[Metric]:
    """Measure stroke rate, gaps, repeats and returns to rest in three stories.

    Each story is planned in three styles.

    Args:
        robot: name of the body.
    """
    for level, style in STORY_STYLES.items():
        stories = [measure_story_rhythm(text, style, robot) for text in STORY_TEXTS.values()]
        yield from rhythm_metrics(f"meaning.rhythm.{level}", stories)


def rhythm_metrics(part: str, stories: Sequence[StoryRhythm]) -> Iterator[Metric]:
    """Yield the gesture-stroke metrics of several stories in one style.

    Args:
        part: prefix of the names.
        stories: measured ones.
    """
    rates, beats = [story.rate for story in stories], [100.0 * story.beats for story in stories]
    returns = [each for story in stories for each in story.returns]
    yield Metric(f"{part}.rate_least", min(rates), "per minute", MIN_HUMAN_RATE, "higher")
    yield Metric(f"{part}.rate_most", max(rates), "per minute", MAX_HUMAN_RATE, "lower")
    yield Metric(f"{part}.beats_least", min(beats), "%", None, "higher")
    yield Metric(f"{part}.beats_most", max(beats), "%", None, "lower")
    yield Metric(f"{part}.silence", max(story.silence for story in stories), "s", MAX_SILENCE, "lower")
    yield Metric(f"{part}.repeats", sum(story.repeats for story in stories), "gestures", None, "lower")
    yield Metric(f"{part}.lost", sum(story.lost for story in stories), "gestures", MAX_LOSSES, "lower")
    yield Metric(f"{part}.late", sum(story.late for story in stories), "strokes", MAX_LOSSES, "lower")
    why = "" if returns else "no two strokes of one hand in a run"
    yield Metric(f"{part}.returns", 100.0 * float(np.mean(returns)) if returns else None, "%", 0.0, "lower", why=why)


def measure_story_rhythm(text: str, style: str, robot: str) -> StoryRhythm:
    """Plan a story in a style and measure its gesture strokes."""
    setup = replace(set_up(robot, voice="auto"), style=Style.load(style))
    return measure_rhythm(plan(write_text(text, setup).bml, setup))


def measure_rhythm(planned: Plan) -> StoryRhythm:
    """Measure a plan's gesture strokes, dropped gestures and hand returns to rest."""
    gestures = {
        behaviour.id: behaviour.action for behaviour in planned.timeline.block.behaviours if behaviour.type == "gesture"
    }
    strokes = [
        PlannedStroke(
            sync.planned,
            sync.planned - sync.requested,
            getattr(gestures[sync.behaviour], "lexeme", ""),
            frozenset(
                side for side in SIDES if f"{side}_hand" in planned.keyframes.uses.get(sync.behaviour, frozenset())
            ),
        )
        for sync in planned.syncs
        if sync.sync == "stroke" and sync.behaviour in gestures
    ]
    strokes.sort(key=lambda stroke: stroke.time)
    speech = [timed.times["end"] for timed in planned.timeline.timed if timed.behaviour.type == "speech"]
    outcomes = planned.keyframes.outcomes
    lost = sum(id in outcomes and outcomes[id].kind == "dropped" for id in gestures)
    return StoryRhythm(max(speech, default=planned.duration), tuple(strokes), lost, tuple(_returns(planned, strokes)))


def _returns(planned: Plan, strokes: Sequence[PlannedStroke]) -> Iterator[bool]:
    """Yield whether a hand returned to rest between its successive strokes.

    Only strokes at most `RUN_SPACING` apart are compared.
    """
    times = np.arange(0.0, planned.trajectory.duration, SAMPLE_PERIOD)
    angles = planned.trajectory.sample(times)[0]
    distances = {side: _distance_from_rest(planned.setup.robot, side, angles) for side in SIDES}
    for before, after in pairwise(strokes):
        span = slice(*np.searchsorted(times - planned.trajectory.zero, (before.time, after.time)))
        for side in before.hands & after.hands if after.time - before.time <= RUN_SPACING else ():
            path = distances[side][span]
            if len(path):
                yield bool(path.min() < RETURN_RATIO * min(path[0], path[-1]))


def _distance_from_rest(robot: Robot, side: Side, angles: Floats) -> Floats:
    """Return wrist distances (m,) [m] from rest, relative to the chest."""
    rows = np.vstack([robot.skeleton.rest, angles])
    origins = robot.skeleton.frames(rows).origins
    path = origins[:, robot.arm(side).wrist] - origins[:, robot.skeleton.segment(robot.arms[side].base)]
    distance: Floats = np.linalg.norm(path[1:] - path[0], axis=1)
    return distance
