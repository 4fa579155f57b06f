"""Groups of random blocks that are planned, judged and merged."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from random import Random
from time import process_time

from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.motion.trajectory import Trajectory, stay
from kinesic.planning.plan import Plan
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.planning.standing_plan import plan_standing_block
from kinesic.realizer.merge import MergedMotion, merge, replace_motion
from kinesic.realizer.occupancy import remaining_occupancy
from tests.campaign.judge import CONTACT, QUANTITIES, judge
from tests.campaign.random_blocks import random_block, random_setup, vary_expressivity

PLANS_PER_GROUP = 20  # number of planned blocks with the same robot and standing posture
MERGES_PER_PLAN = (
    4  # number of merges after each plan; the first one merges this plan, later ones earlier plans of the group
)
MEAN_PAUSE = 0.8  # [s] mean time between two blocks of the running motion
MERGE_FRACTION = 0.85  # fraction of the plans that are merged; all other plans replace the running motion
KEPT_PAST = 0.1  # [s] duration of past motion kept in the running motion


@dataclass
class GroupResult:
    """Counts of one group of blocks.

    Each failure names its block, so that it can be repeated.
    """

    robot: str
    blocks: int = 0
    refused: int = 0  # blocks refused with a message
    merges: int = 0  # blocks merged into the running motion, or replacing it
    seconds: float = 0.0  # [s] CPU time
    motion: float = 0.0  # [s] duration of all judged motions
    largest: dict[str, float] = field(
        default_factory=lambda: dict.fromkeys((*QUANTITIES, CONTACT), 0.0)
    )  # largest ratios of value / limit
    violations: int = 0  # motions beyond a limit
    penetrations: int = 0  # motions with self-contact
    failures: list[str] = field(default_factory=list)


def run_group(task: tuple[int, int]) -> GroupResult:
    """Plan, judge and merge the blocks of one group.

    Args:
        task: seed of the campaign, and number of the group.
    """
    began, chance = process_time(), Random(f"{task[0]} {task[1]}")
    setup = random_setup(chance)
    lexemes = [form.id for form in setup.lexicon.forms]
    stream, result = _Stream(setup, chance), GroupResult(setup.robot.name)
    for number in range(PLANS_PER_GROUP):
        text = random_block(chance, lexemes)
        planner, varied = chance.choice((plan_standing_block, plan_quickly)), vary_expressivity(setup, chance)
        result.blocks += 1
        try:
            planned = planner(parse(text), varied)
        except BmlError:
            result.refused += 1
            continue
        _judge(result, planned.trajectory, planned.setup, f"block {number}: {text}")
        for merged in stream.perform(planned):
            result.merges += 1
            _judge(result, merged, setup, f"merge {result.merges}, after block {number}: {text}")
    result.seconds = process_time() - began
    return result


def prepare() -> Callable[[tuple[int, int]], GroupResult]:
    """Return the function with which workers run a group."""
    return run_group


def _judge(result: GroupResult, trajectory: Trajectory, setup: Setup, name: str) -> None:
    judgement = judge(trajectory.controls, setup)
    result.motion += trajectory.duration
    result.largest = {key: max(value, judgement.ratios.get(key, 0.0)) for key, value in result.largest.items()}
    result.violations += bool(judgement.violated)
    result.penetrations += judgement.penetration > 0.0
    if judgement.violated or judgement.penetration > 0.0:
        result.failures.append(f"{judgement} in {name}")


class _Stream:
    """Running motion of a live performance with random merges."""

    def __init__(self, setup: Setup, chance: Random) -> None:
        self._chance, self._rest = chance, setup.robot.skeleton.rest
        self._motion, self._now = stay(self._rest), 0.0
        self._playing: list[MergedMotion] = []
        self._pool: list[Plan] = []

    def perform(self, planned: Plan) -> Iterator[Trajectory]:
        """Yield the motion after each merge of this and earlier plans."""
        if (planned.setup.robot.skeleton.rest != self._rest).any():
            return  # planned in another stance, so that gestures fit; the server plans such a block anew
        self._pool.append(planned)
        for coming in (planned, *self._chance.choices(self._pool, k=MERGES_PER_PLAN - 1)):
            yield self._add(coming)

    def _add(self, planned: Plan) -> Trajectory:
        """Merge a plan into the motion, or replace the motion."""
        self._now += self._chance.expovariate(1.0 / MEAN_PAUSE)
        now, running = self._now, self._motion.since(self._now - KEPT_PAST)
        self._playing = [
            item
            for item in (merged.since(now - KEPT_PAST) for merged in self._playing)
            if any(need.end > now or need.is_held for need in item.occupancy)
        ]
        if self._chance.random() < MERGE_FRACTION:
            needs = remaining_occupancy((need for item in self._playing for need in item.occupancy), now)
            merged = merge(running, now, planned, begin=now, occupied=needs)
        else:
            self._playing, merged = [], replace_motion(running, now, planned)
        self._playing.append(merged)
        self._motion = merged.trajectory
        return self._motion
