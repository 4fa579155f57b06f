"""Output (sink) to real servos, whose torque clients may enable and disable."""

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
from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import POWERED_STAGES
from kinesic.serve.messages import ServoHealth, ServoPlace, ServoReport, ServoState
from kinesic.serve.sinks.real_time import LOG_CAPACITY

REPORT_DIGITS = 3  # decimal places of loads [-] and voltages [V]


class RealServos:
    """Servos whose supervisor provides the performance time.

    A clearance watch slows the time where tracking errors reduce the clearance too much.
    """

    def __init__(
        self, open_servos: Callable[[], Servos], *, distances: Distances, min_clearance: float, armed: bool = True
    ) -> None:
        """Open the servos.

        Their torque is off before the first command.

        Args:
            open_servos: opens the servos; called again after each disarming.
            distances: distances between the bodies of the robot.
            min_clearance: minimum clearance [m].
            armed: whether commands are forwarded from the beginning; otherwise they are dropped until `arm`.

        Raises:
            BusError: the servos cannot be opened.
        """
        self._open_servos, self._distances, self._min_clearance = open_servos, distances, min_clearance
        self.servos, self.armed = open_servos(), armed
        self._opening = Lock()  # held while the servos are closed and reopened
        self._cycles: deque[Status] = deque(maxlen=LOG_CAPACITY)
        self._caps: ServoCaps | None = None
        self._start_watch()

    def _start_watch(self) -> None:
        self._written = WrittenPostures()
        self._watch = ServoWatch(self._written, self._distances, min_clearance=self._min_clearance)

    def write(self, command: Command, /) -> None:
        """Forward one command if the servos are armed."""
        if self.armed:
            self._written.add(command)
            self.servos.write(command)

    @property
    def pace(self) -> float:
        """Largest joint velocity [rad/s] of the supervisor's own moves."""
        return self.servos.settings.pace

    def limit(self, caps: ServoCaps, /) -> None:
        """Cap velocity and power of the servos, also after they are reopened."""
        self._caps = caps
        self.servos.limit(caps)

    def measurement(self) -> tuple[float, Floats] | None:
        """Return time [s] and angles [rad] of the last measurement.

        None if the servos do not perform.
        """
        status = self.servos.state()
        return (status.time, status.angles) if status.stage.runs else None

    def health(self) -> ServoHealth:
        """Return the latest telemetry of all servos, with torque on or off."""
        status, telemetry = self.servos.state(), self.servos.telemetry()
        load, volts = telemetry.load.round(REPORT_DIGITS), telemetry.volts.round(REPORT_DIGITS)
        columns = (telemetry.celsius, load, volts, telemetry.errors, telemetry.torque)
        return ServoHealth(
            angles=status.angles,
            hottest=status.hottest,
            volts=status.volts,
            faulty=status.faulty,
            servos=ServoReport(self.state, *(tuple(column.tolist()) for column in columns)),
        )

    @property
    def members(self) -> tuple[ServoPlace, ...]:
        """Identity of each servo, in the order of the reports."""
        return tuple(
            ServoPlace(
                servo.bus,
                servo.id,
                servo.hinge,
                servo.model.name,
                servo.model.factory_value(Register.TEMPERATURE_LIMIT),
            )
            for servo in self.servos.members
        )

    @property
    def state(self) -> ServoState:
        """Operating state of the servos."""
        if self._opening.locked():
            return "releasing"
        if not self.servos.running:
            return "ended"
        stage = self.servos.state().stage
        if not self.armed:
            return "limp"
        return "armed" if stage in POWERED_STAGES else "arming"

    def arm(self) -> None:
        """Forward commands to the servos from now on.

        The next command enables the torque.
        """
        self.armed = True

    def disarm(self) -> None:
        """Fold to rest, disable all torque and reopen the servos.

        This takes seconds. Afterwards the servos are open with torque off.

        Raises:
            BusError: a limb is held, torque may still be on, or the servos cannot be reopened.
        """
        with self._opening:
            self.armed = False
            self.servos.release()
            self.servos.close()
            self._reopen()

    def revive(self) -> None:
        """Reopen servos whose supervisor has ended, with torque off.

        This may take a second.

        Raises:
            BusError: the servos cannot be opened.
        """
        with self._opening:
            if not self.servos.running:
                self._reopen()

    def _reopen(self) -> None:
        self.servos = self._open_servos()
        if self._caps is not None:
            self.servos.limit(self._caps)
        self._start_watch()

    def time(self, clock: float, /) -> float | None:
        """Check the clearance and return the performance time [s], or None.

        The servos are slowed or stopped if tracking errors make the clearance too small. None before the first command.
        """
        history = self.servos.history()
        self._cycles.extend(history)
        if self._watch.ingest(history):
            self.servos.slow_to(self._watch.pace)
            if self._watch.over:
                self.servos.stop()
        status = self.servos.state()
        return None if isnan(status.time) else status.time_at(clock)

    def take_cycles(self) -> tuple[Status, ...]:
        """Return the servo status of every cycle since the last call.

        At most the last `LOG_CAPACITY`.
        """
        cycles = tuple(self._cycles)
        self._cycles.clear()
        return cycles

    def needs_resume(self) -> bool:
        """Return whether the servos hold until `resume`, after a long interruption."""
        return self.servos.state().waits == "consent"

    def resume(self) -> None:
        """Resume the servos if they hold."""
        if self.needs_resume():
            self.servos.resume()

    def close(self) -> None:
        """Fold the robot and disable the torque.

        Servos that hold are released.
        """
        with self._opening:
            if self.needs_resume():
                self.servos.release()
            self.servos.close()
