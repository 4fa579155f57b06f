"""Simulation of all servos and their shafts, with planned faults."""

from collections.abc import Callable, Iterator, Sequence
from math import inf

from kinesic.hardware.virtual.faults import SERVO_KINDS, FaultPlan, PlannedFault
from kinesic.hardware.virtual.physics import Physics
from kinesic.hardware.virtual.servo import VirtualServo

TIME_TOLERANCE = 1e-12  # [s] rounding tolerance of times

Event = tuple[float, Callable[[], None]]


class ShaftSimulation:
    """Simulation of servos and their shafts, on any number of wires.

    The caller owns the clock, which never decreases.
    """

    def __init__(self, servos: Sequence[VirtualServo], physics: Physics, *, time: float = 0.0) -> None:
        """Start the simulation with all servos powered.

        Args:
            servos: servos in the order of the physics' shafts.
            physics: physics of the shafts.
            time: [s] current time.
        """
        self.servos, self.physics, self.time = tuple(servos), physics, time
        self._electronics = tuple(servo.electronics for servo in servos)
        self._events: list[Event] = []  # in descending order of time
        for electronics, shaft in zip(self._electronics, physics.shafts(), strict=True):
            electronics.place(shaft, time)

    def expose(self, servos: Sequence[VirtualServo], plan: FaultPlan) -> None:
        """Schedule the servo faults of a plan, relative to the present time."""
        for fault in plan.of(SERVO_KINDS):
            for servo in servos:
                if not fault.servos or servo.id in fault.servos:
                    self._events += [(self.time + when, act) for when, act in _events(fault, servo) if when < inf]
        self._events.sort(key=lambda event: -event[0])

    def advance(self, time: float) -> None:
        """Advance all wires, servos and shafts to a time [s].

        A past time has no effect.
        """
        while self.time < time - TIME_TOLERANCE:
            self._step(max(self.time, min(time, self._next(), self.time + self.physics.max_step)))

    def _next(self) -> float:
        """Return the time [s] of the next fault or autonomous action."""
        event = self._events[-1][0] if self._events else inf
        return min([event, *[electronics.due() for electronics in self._electronics]])

    def _step(self, time: float) -> None:
        demands = [electronics.demand(self.time) for electronics in self._electronics]
        self.physics.advance(time - self.time, demands)
        self.time = time
        for electronics, shaft in zip(self._electronics, self.physics.shafts(), strict=True):
            electronics.update_shaft(shaft, time)
        while self._events and self._events[-1][0] <= time:
            self._events.pop()[1]()


def _events(fault: PlannedFault, servo: VirtualServo) -> Iterator[Event]:
    """Yield begin and end times of a servo fault, with their effects."""
    electronics, value = servo.electronics, fault.effective_value

    def setter(target: object, name: str, new_value: float | bool) -> Callable[[], None]:
        return lambda: setattr(target, name, new_value)

    if fault.kind == "reboot":
        yield fault.start, lambda: servo.reboot(seconds=value)
    elif fault.kind == "alert":
        yield fault.start, lambda: electronics.fail(int(value))
    elif fault.kind == "watchdog":
        yield fault.start, electronics.trip
    elif fault.kind == "silent":
        yield fault.start, setter(servo, "mute", True)
        yield fault.end, setter(servo, "mute", False)
    elif fault.kind == "overheat":
        yield fault.start, setter(electronics, "heating", value)
        yield fault.end, setter(electronics, "heating", 0.0)
    elif fault.kind == "undervoltage":
        yield fault.start, setter(electronics, "volts", value)
        yield fault.end, setter(electronics, "volts", electronics.volts)
