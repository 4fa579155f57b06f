"""Plans a block: from BML to a motion that the servos can follow, without side effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from time import perf_counter

from kinesic.bml.block import Block, Notice, Timeline
from kinesic.bml.schedule import schedule
from kinesic.body.arrays import Floats
from kinesic.body.command import State
from kinesic.body.dynamics import Clearance
from kinesic.body.utterance import Utterance
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.durations import spans
from kinesic.expressivity.hands.engaged import Engaged
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.expressivity.realise import keyframes
from kinesic.motion.budget import Budget
from kinesic.motion.condition import Conditioned
from kinesic.motion.desired import DesiredMotion, join_keys
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.certify import certify
from kinesic.planning.clashes import ClashFinder
from kinesic.planning.clearance import REPAIRS, Conditioner, culprits, keep_clear
from kinesic.planning.finger_postures import with_finger_keys
from kinesic.planning.motion_files import replace_motion
from kinesic.planning.postures import Postures, postures
from kinesic.planning.secondary.add import add_secondary_motion
from kinesic.planning.setup import Setup
from kinesic.planning.speech import (
    SpeechPause,
    allowed_pauses,
    lengthen_pauses,
    mark_delays,
    pause_notices,
    remarks,
    required_pauses,
    synthesise_block,
)
from kinesic.planning.syncs import Syncs, SyncTime, find_bonds, path_notices, shift_notices, sync_times
from kinesic.planning.thinning import thin_out

STILL = 0.1  # [s] of rest, where nothing is asked
ROUNDS = 3  # of planning, in which pauses are made longer
ATTEMPTS = 3  # to say it with pauses that are as long as they must be
WORK = 300_000  # pieces of splines whose shortage is measured for one block, before it is planned by shorter ways
AGAIN, AGAIN_A_KEY = 100, 40  # of them, that a behaviour and a key frame are worth when they are planned once more
FEWER = 0.5  # of the behaviours that overlap, where there are far too many of them, or the work is done and their
# motion does not keep clear of the body


@dataclass(frozen=True, eq=False)
class Plan:
    """A planned block: all that is known before anything moves."""

    setup: Setup
    timeline: Timeline
    utterances: Mapping[str, Utterance]
    keyframes: KeyFrames
    postures: Postures
    motion: Conditioned
    clearance: Clearance  # of the reference, at 100 Hz
    clearance_times: Floats  # (m,) [s] performance time
    syncs: Syncs[SyncTime]
    notices: tuple[Notice, ...]
    seconds: float  # [s] that planning took
    asked: tuple[KeyPosture, ...]  # before detours

    @property
    def trajectory(self) -> Trajectory:
        """The motion that will be performed."""
        return self.motion.trajectory

    @cached_property
    def desired(self) -> DesiredMotion:
        """The motion as it was asked for, without limits and detours."""
        if len(self.asked) < 2:
            rest = self.setup.robot.skeleton.rest
            still = (KeyPosture.whole(0.0, rest), KeyPosture.whole(STILL, rest))
            keys = Keys.of(still, self.setup.limits, room=0.0)
        else:
            keys = Keys.of(self.asked, self.setup.limits)
        return join_keys(keys.asked, keys)

    @property
    def duration(self) -> float:
        """[s] of the performance, speech included."""
        return max(self.trajectory.duration, self.trajectory.zero + self.timeline.end)

    def at(self, when: float | str) -> State:
        """Angles, speeds and accelerations at a performance time [s], or at a sync point such as `nod:stroke`.

        Raises:
            KeyError: there is no such sync point.
        """
        return self.trajectory.at(self.trajectory.zero + self.syncs[when].planned if isinstance(when, str) else when)

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Writes the motion; the suffix names the format: .npz, .csv or .bap.

        Args:
            path: of the file; a motion that was saved there before is replaced.
            force: whether any other ordinary file may be replaced, too.

        Raises:
            ConfigError: the suffix is not known, or the path is a folder's, a link's or, unless forced, another file's.
        """
        return replace_motion(self.trajectory, self.setup.robot, Path(path), force=force)

    def __str__(self) -> str:
        """One line: what, on which robot, in which manner, how long, and what had to give."""
        block, outcomes = self.timeline.block, self.keyframes.outcomes
        what = f"block {block.id}" if block.source.startswith("<") else block.source
        dropped = sum(outcome.kind == "dropped" for outcome in outcomes.values())
        counts = ((len(block.behaviours), "behaviour"), (dropped, "dropped behaviour"), (len(self.notices), "notice"))
        notes = ", ".join(f"{count} {noun}{'s' if count > 1 else ''}" for count, noun in counts if count)
        where = f"{self.setup.robot.name} ({self.setup.style.name})"
        return f"plan of {what} on {where}: {self.duration:.2f} s{', ' if notes else ''}{notes}"

    def __repr__(self) -> str:
        return f"<{self}>"


def plan_block(
    block: Block,
    setup: Setup,
    *,
    conditioned: Conditioner = certify,
    utterances: Mapping[str, Utterance] | None = None,
    engaged: Sequence[Engaged] = (),
) -> Plan:
    """Plans a block as a whole.

    Where the body would be late for a word and the block allows it, a pause is made before the word, and all is
    planned again. Of two gestures that are too near for their hand one gives way. A behaviour whose motion cannot be
    kept clear of the body is dropped by name, and the rest is planned again. All this takes no more work than a budget
    of `WORK`: where it is spent, hinges rest at keys for which they are short of time, and wherever behaviours still
    hinder one another, the newest of those that overlap are dropped by name.

    Args:
        block: what was asked.
        setup: everything else.
        conditioned: makes a motion one that the servos can follow.
        utterances: each speech by its id, when that is decided; no further pause is made then.
        engaged: hands that other blocks need meanwhile: gestures that leave it open take the other one.

    Raises:
        BmlError: something `required` cannot be performed.
    """
    began = perf_counter()
    context = BlockContext(block, setup.context, engaged)
    said, waiting, budget = utterances or synthesise_block(block, setup), tuple[SpeechPause, ...](), Budget(WORK)
    if utterances is None and (most := allowed_pauses(block, setup.pause)):
        said, waiting = _add_pauses(said, most, context, setup, conditioned, budget)
    found = _plan_once(context, setup, said, conditioned, budget if budget.spent else Budget(WORK))
    notices = (*remarks(block, found.utterances), *pause_notices(block, waiting), *found.notices)
    return replace(found, notices=notices, seconds=perf_counter() - began)


def _add_pauses(
    utterances: Mapping[str, Utterance],
    most: Mapping[str, float],
    context: BlockContext,
    setup: Setup,
    conditioned: Conditioner,
    budget: Budget,
) -> tuple[Mapping[str, Utterance], tuple[SpeechPause, ...]]:
    """Speech with pauses before words that the body would miss, as long as they make it better, and the pauses.

    Gestures that are too near for their hand do not give way here: their words may wait.
    """
    block = context.block
    plan = _plan_once(context, setup, utterances, conditioned, budget, weighing=False)
    waiting: tuple[SpeechPause, ...] = ()
    for _ in range(ROUNDS):
        more, said = required_pauses(plan.timeline, plan.syncs, most, waiting), plan.utterances
        for _ in range(ATTEMPTS):
            more = lengthen_pauses(more, said)
            said = synthesise_block(block, setup, more)
        if more == waiting or budget.spent:
            break
        better = _plan_once(context, setup, said, conditioned, budget, weighing=False)
        if _worst(better) >= _worst(plan):
            break
        plan, waiting = better, more
    return plan.utterances, waiting


def _worst(planned: Plan) -> float:
    """[s] by which the body misses a word at worst."""
    return max((abs(late) for late, _ in mark_delays(planned.timeline, planned.syncs).values()), default=0.0)


def _plan_once(
    context: BlockContext,
    setup: Setup,
    utterances: Mapping[str, Utterance],
    conditioned: Conditioner,
    budget: Budget,
    *,
    weighing: bool = True,
) -> Plan:
    timeline = schedule(context.block, utterances, spans(context, utterances))
    without: dict[str, str] = {}
    finder = ClashFinder(setup)
    memory: PlaneMemory | None = None  # which begins with what shows whether gestures clash
    while True:
        frames = keyframes(timeline, context, without=without, clashes=finder.clashes)
        asked = postures(frames, setup.robot, setup.distances)
        if without or finder.clashes:
            budget.spend(AGAIN * len(timeline.timed) + AGAIN_A_KEY * len(frames.frames))
        if weighing and (clashing := finder.look(frames, asked.postures)):
            if budget.spent or finder.spent:
                without |= thin_out(frames, clashing, FEWER if finder.crowded else 1.0)
            continue
        asked = replace(asked, postures=with_finger_keys(asked.postures, frames.fingers, setup.robot))
        memory = memory or finder.memory.part(range(len(setup.limits.lower)))
        bounded, repairs = partial(conditioned, budget=budget, memory=memory), 0 if budget.spent else REPAIRS
        solved, motion, times, clearance = keep_clear(
            asked, setup, find_bonds(timeline), conditioned=bounded, repairs=repairs
        )
        dropped = culprits(frames, motion, times, clearance, setup.robot)
        if not dropped:
            break
        without |= (thin_out(frames, dropped, FEWER) if budget.spent else {}) | dropped
    motion, times, clearance = add_secondary_motion(motion, times, clearance, frames, utterances, setup)
    syncs = sync_times(frames, motion)
    return Plan(
        setup=setup,
        timeline=timeline,
        utterances=utterances,
        keyframes=frames,
        postures=solved,
        motion=motion,
        clearance=clearance,
        clearance_times=times,
        syncs=syncs,
        notices=(
            *frames.notices,
            *shift_notices(context.block, syncs, frames, motion, setup.robot),
            *path_notices(context.block, solved.postures, frames, motion, setup.robot),
        ),
        seconds=0.0,
        asked=asked.postures,
    )
