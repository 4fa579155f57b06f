"""Looks for servos at every id and baud rate."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from kinesic.hardware.protocol.device import Cold, Found
from kinesic.hardware.protocol.registers import BAUD_RATES, Register
from kinesic.hardware.protocol.wire import BusError, Wire

LOOKS = 3
_SPAN = Register.REALTIME_TICK.field.address, 28  # what two servos hardly ever have in common


@dataclass(frozen=True)
class Sighting:
    """A servo, and where it was found."""

    servo: Found
    baud: int  # [bit/s]
    shared: bool  # several servos seem to have this id


def scan_bus(
    opened: Callable[[int], Wire],
    *,
    bauds: Iterable[int] = BAUD_RATES,
    ids: Iterable[int] = (),
    step: Callable[[], None] = lambda: None,
) -> tuple[Sighting, ...]:
    """Looks for servos.

    Args:
        opened: opens the port at a baud rate.
        bauds: [bit/s] to try.
        ids: to ask one by one as well, where nobody of this id answered all being asked.
        step: is called after each baud rate.

    Raises:
        BusError: the port does not open.
    """
    found: list[Sighting] = []
    for baud in bauds:
        wire = opened(baud)
        try:
            cold = Cold(wire)
            servos = {servo.id: servo for servo in cold.everyone()}
            for servo in ids:
                alone = cold.ping(servo) if servo not in servos else None
                if alone is not None:
                    servos[servo] = alone
            found += [Sighting(servo, baud, is_shared(cold, servo.id)) for _, servo in sorted(servos.items())]
        finally:
            wire.close()
        step()
    return tuple(found)


def is_shared(cold: Cold, servo: int) -> bool:
    """Whether several servos have this id: their answers to a ping agree, but not those of their clocks and sensors."""
    for _ in range(LOOKS):
        try:
            cold.read_span(servo, *_SPAN)
        except BusError:
            continue
        return False
    return True
