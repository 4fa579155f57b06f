"""Connections of a supervisor to the servos and to the planner."""

from collections.abc import Callable
from dataclasses import dataclass

from kinesic.hardware.protocol.wire import Wire
from kinesic.hardware.supervisor.channel import Channel
from kinesic.hardware.supervisor.status import EventLog


@dataclass(frozen=True, eq=False)
class SupervisorContext:
    """Connections of a supervisor: wires, planner and log."""

    opens: Callable[[str], Wire]  # opens the wire of a bus by its name, or raises BusError
    channel: Channel  # channel to the planner
    planner: Callable[[], bool]  # returns whether the planner is alive
    journal: EventLog
    announce: Callable[[], None] = lambda: None  # publishes the open ports, or raises BusError
