"""Several wires at once: all are asked before the first is heard, so that they wait together."""

from collections.abc import Mapping

from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.cycle import Cycle
from kinesic.hardware.protocol.ticks import Ticks


class BusGroup:
    """The buses of a robot, by name."""

    def __init__(self, buses: Mapping[str, Bus]) -> None:
        """Open ones."""
        self.buses = dict(buses)

    def cycle(self, goals: Mapping[str, Ticks]) -> dict[str, Cycle]:
        """One cycle on every bus; one without goals is only asked."""
        for name, bus in self.buses.items():
            bus.begin(goals.get(name))
        return {name: bus.finish() for name, bus in self.buses.items()}

    def close(self) -> None:
        """Gives all ports back."""
        for bus in self.buses.values():
            bus.wire.close()
