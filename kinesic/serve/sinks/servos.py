"""Servos as a sink of the server: their supervisor owns the time, and somebody may take and give their torque."""

from collections import deque
from collections.abc import Callable
from math import isnan
from threading import Lock

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.body.dynamics import Distances
from kinesic.controller.watch.servos import ServoWatch, WrittenPostures
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import POWERED
from kinesic.serve.messages import ServoHealth, ServoPlace, ServoReport, ServoState
from kinesic.serve.sinks.real_time import KEPT

DIGITS = 3  # of loads and voltages


class RealServos:
    """Servos, whose supervisor owns the time, and slows it where their errors leave too little clearance."""

    def __init__(
        self, open_servos: Callable[[], Servos], *, distances: Distances, least: float, armed: bool = True
    ) -> None:
        """Opens the servos; none has torque before the first command.

        Args:
            open_servos: opens them, also anew after their torque was taken.
            distances: of the robot.
            least: [m] clearance that it asks for.
            armed: whether commands are handed on from the beginning; else they are dropped until `arm`.

        Raises:
            BusError: they cannot be opened.
        """
        self._open_servos, self._distances, self._least = open_servos, distances, least
        self.servos, self.armed = open_servos(), armed
        self._opening = Lock()  # held while they are given back and opened anew
        self._cycles: deque[Status] = deque(maxlen=KEPT)
        self._begin_watch()

    def _begin_watch(self) -> None:
        self._written = WrittenPostures()
        self._watch = ServoWatch(self._written, self._distances, least=self._least)

    def write(self, command: Command, /) -> None:
        """Hands one command on, if servos are to follow."""
        if self.armed:
            self._written.add(command)
            self.servos.write(command)

    def seen(self) -> tuple[float, Floats] | None:
        """When the supervisor measured last, and the angles then; None when it does not perform."""
        status = self.servos.state()
        return (status.time, status.angles) if status.stage.runs else None

    def health(self) -> ServoHealth:
        """How all servos are together, and each of them, with torque or without."""
        status, told = self.servos.state(), self.servos.telemetry()
        each = (told.celsius, told.load.round(DIGITS), told.volts.round(DIGITS), told.errors, told.torque)
        return ServoHealth(
            angles=status.angles,
            hottest=status.hottest,
            volts=status.volts,
            faulty=status.faulty,
            servos=ServoReport(self.state, *(tuple(figures.tolist()) for figures in each)),
        )

    @property
    def members(self) -> tuple[ServoPlace, ...]:
        """What each servo is, in the order of the reports."""
        return tuple(
            ServoPlace(each.bus, each.id, each.hinge, each.model.name, each.model.starts(Register.TEMPERATURE_LIMIT))
            for each in self.servos.members
        )

    @property
    def state(self) -> ServoState:
        """Whether servos follow, and what else they do."""
        if self._opening.locked():
            return "releasing"
        if not self.servos.running:
            return "ended"
        stage = self.servos.state().stage
        if not self.armed:
            return "limp"
        return "armed" if stage in POWERED else "arming"

    def arm(self) -> None:
        """Hands commands on from now on: the next one gives the servos torque."""
        self.armed = True

    def disarm(self) -> None:
        """Folds to rest and takes all torque; returns once the servos are open anew, and limp. It takes seconds.

        Raises:
            BusError: a limb is held, it is not sure that every servo is limp, or they cannot be opened anew.
        """
        with self._opening:
            self.armed = False
            self.servos.release()
            self.servos.close()
            self._open_anew()

    def revive(self) -> None:
        """Opens servos anew whose supervisor has ended, without torque; it may take a second.

        Raises:
            BusError: they cannot be opened.
        """
        with self._opening:
            if not self.servos.running:
                self._open_anew()

    def _open_anew(self) -> None:
        self.servos = self._open_servos()
        self._begin_watch()

    def time(self, clock: float, /) -> float | None:
        """Time [s] of the performance by the supervisor, wherever it stands; None before there is one."""
        history = self.servos.history()
        self._cycles.extend(history)
        if self._watch.see(history):
            self.servos.slow_to(self._watch.pace)
            if self._watch.over:
                self.servos.stop()
        status = self.servos.state()
        return None if isnan(status.time) else status.time_at(clock)

    def cycles(self) -> tuple[Status, ...]:
        """Goals and angles of the supervisor's cycles since the last call."""
        found = tuple(self._cycles)
        self._cycles.clear()
        return found

    def waits(self) -> bool:
        """Whether the servos hold until somebody consents, as they were out of hand for more than a second."""
        return self.servos.state().waits == "consent"

    def resume(self) -> None:
        """Lets the servos go on, if they wait for that."""
        if self.waits():
            self.servos.resume()

    def close(self) -> None:
        """Waits until the robot has folded and is limp; nobody has to consent any more."""
        with self._opening:
            if self.waits():
                self.servos.release()
            self.servos.close()
