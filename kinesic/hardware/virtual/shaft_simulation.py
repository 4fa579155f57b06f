"""Moves servos on their shafts through time together, and lets faults befall them."""

from collections.abc import Callable, Iterator, Sequence
from math import inf

from kinesic.hardware.virtual.faults import SERVO_KINDS, FaultPlan, PlannedFault
from kinesic.hardware.virtual.physics import Physics
from kinesic.hardware.virtual.servo import VirtualServo

SAME_TIME = 1e-12  # [s]

Event = tuple[float, Callable[[], None]]


class ShaftSimulation:
    """All servos of one physics, on whichever wires they are; its clock is the caller's, and never goes back."""

    def __init__(self, servos: Sequence[VirtualServo], physics: Physics, *, time: float = 0.0) -> None:
        """Powers the servos.

        Args:
            servos: in the order of the physics' shafts.
            physics: what turns them.
            time: [s] now.
        """
        self.servos, self.physics, self.time = tuple(servos), physics, time
        self._electronics = tuple(servo.electronics for servo in servos)
        self._events: list[Event] = []  # the next one last
        for electronics, shaft in zip(self._electronics, physics.shafts(), strict=True):
            electronics.place(shaft, time)

    def expose(self, servos: Sequence[VirtualServo], plan: FaultPlan) -> None:
        """Lets the plan's faults of servos befall some of them; its times count from now."""
        for fault in plan.of(SERVO_KINDS):
            for servo in servos:
                if not fault.servos or servo.id in fault.servos:
                    self._events += [(self.time + when, act) for when, act in _events(fault, servo) if when < inf]
        self._events.sort(key=lambda event: -event[0])

    def advance(self, time: float) -> None:
        """Moves everything on to a time [s]; one that has passed changes nothing."""
        while self.time < time - SAME_TIME:
            self._step(max(self.time, min(time, self._next(), self.time + self.physics.longest)))

    def _next(self) -> float:
        """[s] when something happens that nobody on a wire asks for."""
        event = self._events[-1][0] if self._events else inf
        return min(event, *(electronics.due() for electronics in self._electronics), inf)

    def _step(self, time: float) -> None:
        demands = [electronics.demand(self.time) for electronics in self._electronics]
        self.physics.advance(time - self.time, demands)
        self.time = time
        for electronics, shaft in zip(self._electronics, self.physics.shafts(), strict=True):
            electronics.update_shaft(shaft, time)
        while self._events and self._events[-1][0] <= time:
            self._events.pop()[1]()


def _events(fault: PlannedFault, servo: VirtualServo) -> Iterator[Event]:
    """When a fault begins and ends for a servo, and what it does then."""
    electronics, figure = servo.electronics, fault.figure

    def sets(place: object, name: str, value: float | bool) -> Callable[[], None]:
        return lambda: setattr(place, name, value)

    if fault.kind == "reboot":
        yield fault.start, lambda: servo.reboot(seconds=figure)
    elif fault.kind == "alert":
        yield fault.start, lambda: electronics.fail(int(figure))
    elif fault.kind == "watchdog":
        yield fault.start, electronics.trip
    elif fault.kind == "silent":
        yield fault.start, sets(servo, "mute", True)
        yield fault.end, sets(servo, "mute", False)
    elif fault.kind == "overheat":
        yield fault.start, sets(electronics, "heating", figure)
        yield fault.end, sets(electronics, "heating", 0.0)
    elif fault.kind == "undervoltage":
        yield fault.start, sets(electronics, "volts", figure)
        yield fault.end, sets(electronics, "volts", electronics.volts)
