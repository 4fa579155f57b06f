"""Keeps every step of the physics, in MuJoCo's order and cheaply: there are 300 a second."""

from array import array
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from kinesic.body.arrays import Floats, Indices

Rows: TypeAlias = "array[float]"  # one after another


@dataclass(frozen=True, eq=False)
class StepRecord:
    """The m commands that a compiled loop sent since its last record, or in all, and the s steps that it made."""

    times: Floats  # (m,) [s] of the commands
    sent: Floats  # (m, n) [rad] goals of each command
    counts: Indices  # (m,) steps of this record so far at each command
    aims: Floats  # (g, n) [rad] goals that came into force
    aimed: Indices  # (g,) steps of this record before they did
    angles: Floats  # (s, q) [rad] after each step
    speeds: Floats  # (s, q) [rad/s] likewise
    spans: Floats  # (s,) [s] how long each step was


@dataclass(frozen=True, eq=False)
class KeptSteps:
    """The s steps and m commands that a log holds."""

    angles: Floats  # (s, q) [rad] of the joints after each step, as MuJoCo has them
    speeds: Floats  # (s, q) [rad/s] likewise
    spans: Floats  # (s,) [s] how long each step was
    supplied: Floats  # (s,) share of its voltage that the supply had during each step; (1,) of one that holds it
    aims: Floats  # (g, n) [rad] goals, each in force for a while
    begins: Indices  # (g,) steps from which on they were
    ends: Indices  # (m,) steps so far at each command


class StepLog:
    """Postures, speeds and goals of all steps, and the steps at which commands came."""

    def __init__(self, angles: Floats, speeds: Floats, goals: Floats) -> None:
        """Begins with a posture that no step led to.

        Args:
            angles: (n,) [rad] of the physics, read anew at each step.
            speeds: (n,) [rad/s] of the physics, read anew at each step.
            goals: (n,) [rad] in force, in joint order.
        """
        self._live = angles, speeds
        self._keep_in(array("d", angles), array("d", speeds), array("d", [0.0]), array("d", [1.0]))
        self._begins, self._aims = [0], [goals[None]]  # from which steps on which rows of goals are in force
        self.times: list[float] = []  # [s] of the commands
        self.counts: list[int] = []  # steps so far at each command
        self._sent: list[Floats] = []  # (k, n) [rad] goals of k commands each

    def _keep_in(self, angles: Rows, speeds: Rows, spans: Rows, supplied: Rows) -> None:
        """Keeps steps from now on in arrays that hold at least one."""
        live_angles, live_speeds = self._live
        self._angles, self._speeds = angles, speeds
        self.keep_angles = partial(angles.frombytes, live_angles.data.cast("B"))  # after each step of the physics
        self.keep_speeds = partial(speeds.frombytes, live_speeds.data.cast("B"))  # likewise
        self._steps = spans  # [s] how long each step was
        self._supplied = supplied  # share of its voltage that the supply had; of a stiff one, no more is kept
        self.keep_supplied = supplied.append  # before each step of the physics

    def aim(self, goals: Floats) -> None:
        """Sets the goals (n,) [rad] in force from the next step on."""
        self._begins.append(len(self._steps))
        self._aims.append(goals[None])

    def stepped(self, count: int, span: float) -> None:
        """Counts steps of the physics that were kept, each of a length in [s]."""
        self._steps.extend([span] * count)

    def mark(self, time: float, goals: Floats) -> None:
        """Marks a command at a time [s], with its goals (n,) [rad]."""
        self.times.append(time)
        self.counts.append(len(self._steps))
        self._sent.append(goals[None])

    def take(self, record: StepRecord) -> None:
        """Keeps all steps of a record, after those that are there."""
        before = len(self._steps)
        for kept, more in ((self._angles, record.angles), (self._speeds, record.speeds), (self._steps, record.spans)):
            kept.frombytes(np.ascontiguousarray(more).reshape(-1).view(np.uint8).data)
        self.times += record.times.tolist()
        self.counts += (record.counts + before).tolist()
        self._sent.append(record.sent)
        if len(record.aims):
            self._begins += (record.aimed + before).tolist()
            self._aims.append(record.aims)

    @property
    def posture(self) -> Floats:
        """(n,) [rad] now."""
        angles, speeds = self._live
        # MuJoCo's semi-implicit steps run half a step ahead of the held goals; its speeds lie on time
        now: Floats = angles - self._steps[-1] / 2 * speeds
        return now

    def kept(self) -> KeptSteps:
        """Shows all that was kept, without copying: until it is forgotten, nothing more can be kept beside it."""
        spans = np.frombuffer(self._steps)
        angles, speeds = (np.frombuffer(kept).reshape(len(spans), -1) for kept in (self._angles, self._speeds))
        aims, begins = np.concatenate(self._aims), np.array(self._begins, dtype=np.intp)
        ends, supplied = np.array(self.counts, dtype=np.intp), np.frombuffer(self._supplied)
        return KeptSteps(angles, speeds, spans, supplied, aims, begins, ends)

    def sent(self) -> Floats:
        """Lists the goals (m, n) [rad] of all commands."""
        return np.concatenate(self._sent)

    def forget(self) -> None:
        """Begins anew with the last step. Whoever was shown the others may hold them, as profilers of threads do."""
        count = len(self._live[0])
        self._keep_in(self._angles[-count:], self._speeds[-count:], self._steps[-1:], self._supplied[-1:])
        self._begins, self._aims = [0], [self._aims[-1][-1:]]
        self.times, self.counts, self._sent = [], [], []
