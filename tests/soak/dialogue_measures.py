"""Measures of live dialogues from the recorded commands, the recorded sound and the messages of the server."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from kinesic.bench.conversation.dialogues import STANDING_PLACE
from kinesic.body.command import COMMAND_RATE
from kinesic.body.robot import Robot
from kinesic.conversation.settings import TURN_TIMES
from kinesic.expressivity.gaze import towards
from kinesic.planning.setup import Setup
from kinesic.realizer.occupancy import ARM_ROLES, arm_hinges
from tests.soak.live_dialogue import LiveDialogue

QUIET_LEVEL = 1e-4  # root mean square below which the loudspeaker is silent
SILENCE_DURATION = 0.4  # [s] shortest silence that is no pause between two words
REACTION_WINDOW = 1.2  # [s] time after the start of a voice in which a reaction counts
MUSIC_WINDOW = 3.5  # [s] the same for the start of music
STILL_VELOCITY = np.radians(2.0)  # [rad/s] velocity below which an arm is still
STILL_DURATION = 0.2  # [s] shortest standstill that counts as a stop
LOOK_ANGLE = 4.0  # [deg] largest error of the head in a look at a person; a look away turns it by 7 degrees at least
SAMPLE_PERIOD = 0.02  # [s] time between two samples of the gaze
MIN_STATE_DURATION = 2.0  # [s] shortest stay in a state whose gaze is measured
MAX_RATIO = 1.001  # largest accepted ratio of a value to its limit


@dataclass(eq=False)
class Recording:
    """Recorded commands and sound of a server."""

    setup: Setup
    times: np.ndarray  # (m,) [s] machine times of the commands
    angles: np.ndarray  # (m, n) [rad] commanded angles, one row for each 10 ms of the clock
    setpoints: np.ndarray  # (m, n) [rad] setpoints of the servos
    heard: np.ndarray  # (k, 2) machine time [s] and root mean square of each 10 ms of sound

    @property
    def robot(self) -> Robot:
        return self.setup.robot

    @classmethod
    def of(cls, setup: Setup, commands: np.ndarray, sound: np.ndarray) -> "Recording":
        """Keep the last command of each tick of the clock."""
        count = len(setup.robot.skeleton.rest)
        rows = commands[: len(commands) // (2 + 2 * count) * (2 + 2 * count)].reshape(-1, 2 + 2 * count)
        ticks = np.round(rows[:, 1] * COMMAND_RATE).astype(int)
        last = np.append(np.flatnonzero(np.diff(ticks)), len(ticks) - 1)
        kept = rows[last]
        assert (np.diff(ticks[last]) == 1).all(), "a command is missing"
        return cls(setup, kept[:, 0], kept[:, 2 : 2 + count], kept[:, 2 + count :], sound.reshape(-1, 2))

    def limit_ratios(self) -> dict[str, float]:
        """Return the largest ratio of each quantity to its limit, by finite differences of the commands.

        A finite difference is a mean of the derivative, so a motion within its limits never exceeds 1.
        """
        limits = self.setup.limits
        lower, upper = self.robot.skeleton.lower, self.robot.skeleton.upper
        outside = np.maximum(lower - self.setpoints, self.setpoints - upper).max()
        ratios = {"position": 1.0 + float(max(0.0, outside - 1e-9))}
        bounds = {"velocity": limits.speed, "acceleration": limits.acceleration, "jerk": limits.jerk}
        for order, (name, bound) in enumerate(bounds.items(), 1):
            derivative = np.diff(self.angles, order, axis=0) * COMMAND_RATE**order
            ratios[name] = float((np.abs(derivative) / bound).max())
        return ratios

    def silence_begin(self, begin: float) -> float | None:
        """Return the time [s] of the first longer silence of the loudspeaker, or None if it was silent already."""
        times, loud = self.heard[:, 0], self.heard[:, 1] > QUIET_LEVEL
        before = loud[(times > begin - 0.3) & (times <= begin)]
        if not before.any():
            return None
        sounding = times[loud & (times > begin)]
        gaps = np.diff(np.append(sounding, np.inf))
        return float(sounding[np.argmax(gaps > SILENCE_DURATION)]) if len(sounding) else begin

    def arm_stop(self, begin: float) -> float | None:
        """Return the time [s] at which moving arms come to a stop after a time [s], or None if they were still."""
        hinges = [hinge for role in ARM_ROLES for hinge in arm_hinges(role, self.robot)]
        first = int(np.searchsorted(self.times, begin))
        velocities = np.abs(np.diff(self.angles[first : first + 3 * COMMAND_RATE, hinges], axis=0)).max(axis=1)
        moves = velocities * COMMAND_RATE >= STILL_VELOCITY
        if not moves[: round(0.3 * COMMAND_RATE)].any():
            return None
        moving = np.flatnonzero(moves)
        gaps = np.diff(np.append(moving, len(moves) + COMMAND_RATE))
        return float(moving[np.argmax(gaps > STILL_DURATION * COMMAND_RATE)] + 1) / COMMAND_RATE

    def head(self, times: np.ndarray) -> np.ndarray:
        """Return the head's azimuth and elevation (m, 2) [deg] at machine times (m,) [s], positive left and up."""
        rows = np.clip(np.searchsorted(self.times, times), 0, len(self.times) - 1)
        joints = [*self.robot.joints("torso"), *self.robot.joints("neck")]
        names = self.robot.skeleton.names
        turns = [
            self.angles[:, [k for k in joints if names[k].endswith(axis)]].sum(axis=1) for axis in ("torsion", "tilt")
        ]
        return np.degrees(np.stack([turns[0], -turns[1]], axis=1))[rows]


@dataclass(eq=False)
class Totals:
    """Measures of all dialogues."""

    turn_ends: dict[bool, list[float]] = field(default_factory=lambda: {False: [], True: []})  # [s] by predictor
    turns: int = 0
    false_ends: int = 0
    sound_off: list[float] = field(default_factory=list)  # [s] from a voice to the silence of the robot
    arms_still: list[float] = field(default_factory=list)  # [s] from a voice to the standstill of the arms
    attempts: int = 0
    missed: int = 0
    others: int = 0  # agreements, coughs and music while the robot speaks
    false_yields: int = 0
    looks: dict[str, list[float]] = field(default_factory=dict)  # fractions of time
    longest_look: float = 0.0
    nods: int = 0
    listening: float = 0.0
    loads: list[float] = field(default_factory=list)

    def lines(self) -> Iterator[str]:
        """Yield one line for each measure."""
        for predicted, delays in self.turn_ends.items():
            yield f"turn ends, predicted={predicted}: {_percentiles(delays)} s"
        yield f"false turn ends: {self.false_ends} of {self.turns}"
        yield f"sound off: {_percentiles(self.sound_off)} s; arms still: {_percentiles(self.arms_still)} s"
        yield f"missed: {self.missed} of {self.attempts}; false: {self.false_yields} of {self.others}"
        yield from (f"looks, {name}: {100.0 * np.mean(parts):.0f} %" for name, parts in self.looks.items())
        yield f"nods: {60.0 * self.nods / self.listening:.1f} per minute; CPU: {100.0 * np.mean(self.loads):.1f} %"


def _percentiles(values: list[float]) -> str:
    """Return the count, median and 95th percentile of values."""
    return f"{len(values)}, {np.median(values):.3f}, {np.percentile(values, 95):.3f}" if values else "0"


def measure(done: LiveDialogue, recording: Recording, totals: Totals) -> None:
    """Add the measures of one dialogue."""
    totals.loads.append(done.load)
    totals.nods += sum(message.get("told") == "backchannel" for _, message in done.told)
    _measure_turns(done, totals)
    _measure_interruptions(done, recording, totals)
    _measure_gaze(done, recording, totals)


def _measure_turns(done: LiveDialogue, totals: Totals) -> None:
    ends = [time for time, state in done.states() if state == "thinking"]
    for (begin, end), said in zip(done.dialogue.turns, done.speeches, strict=True):
        totals.turns += 1
        totals.false_ends += any(begin < time < end for time in ends)
        after = [time for time in ends if end <= time <= said + 0.5]
        totals.turn_ends[done.dialogue.has_predictor] += [time - end - TURN_TIMES.end_to_thinking for time in after[:1]]


def _measure_interruptions(done: LiveDialogue, recording: Recording, totals: Totals) -> None:
    interrupted = [time for time, state in done.states() if state == "interrupted"]
    events = [(item.begin, item.takes_turn) for item in done.dialogue.interjections]
    events += [] if done.music is None else [(done.music[0], False)]
    for begin, takes_turn in events:
        off = recording.silence_begin(done.begin + begin)
        if off is None:
            continue
        window = REACTION_WINDOW if done.music is None or begin != done.music[0] else MUSIC_WINDOW
        stops = [time for time in interrupted if begin <= time <= begin + window]
        if not takes_turn:
            totals.others += 1
            totals.false_yields += bool(stops)
            continue
        totals.attempts += 1
        totals.missed += not stops
        totals.sound_off.append(off - done.begin - begin)
        still = recording.arm_stop(done.begin + begin)
        totals.arms_still += [] if still is None else [still]


def _measure_gaze(done: LiveDialogue, recording: Recording, totals: Totals) -> None:
    """Measure the looks at the standing person, by the direction of the head alone."""
    states = [*done.states(), (done.dialogue.end, "off")]
    for (time, state), (stop, following) in pairwise(states):
        totals.listening += stop - time if state == "listening" else 0.0
        if state not in ("listening", "speaking") or stop - time < MIN_STATE_DURATION:
            continue
        spans = {state: (time, stop)}
        if state == "speaking" and following != "interrupted":
            spans |= {"first": (time, time + 1.0), "last": (stop - 1.0, stop)}
        for name, span in spans.items():
            totals.looks.setdefault(name, []).append(float(np.mean(_looks(done, recording, *span))))
    gaps = np.flatnonzero(~_looks(done, recording, 0.0, done.dialogue.end))
    totals.longest_look = max(totals.longest_look, SAMPLE_PERIOD * float(np.diff(gaps, prepend=0).max()))


def _looks(done: LiveDialogue, recording: Recording, begin: float, end: float) -> np.ndarray:
    """Return whether the head points at the standing person, for each sample of a time span [s]."""
    goal = towards(np.array(STANDING_PLACE), recording.robot)
    head = recording.head(done.begin + np.arange(begin, end, SAMPLE_PERIOD))
    errors = np.abs(head - np.degrees([goal.torsion, -goal.tilt]))
    return np.asarray((errors < LOOK_ANGLE).all(axis=1))
