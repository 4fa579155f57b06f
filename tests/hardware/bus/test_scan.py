import pytest

from kinesic.hardware.bus.scan import Sighting, scan_bus
from kinesic.hardware.protocol.device import Found
from kinesic.hardware.protocol.wire import Wire
from kinesic.hardware.virtual.faults import CALM, FaultPlan, PlannedFault
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus


def port(baud: int = 1_000_000, faults: FaultPlan = CALM):
    """Opens a wire with three servos at any baud rate."""
    _, buses = build_bus(
        [
            Cable(
                "body",
                (ServoFitting(1), ServoFitting(7, model="xl430_w250"), ServoFitting(20)),
                baud=baud,
                faults=faults,
            )
        ]
    )

    def opened(rate: int) -> Wire:
        wire = MemoryWire(buses["body"])
        wire.baud = rate
        return wire

    return opened


@pytest.mark.parametrize("baud", [57_600, 1_000_000, 4_000_000])
def test_servos_are_found_at_their_baud_rate(baud: int):
    steps: list[int] = []
    found = scan_bus(port(baud), bauds=(57_600, 1_000_000, 4_000_000), step=lambda: steps.append(1))
    assert found == (
        Sighting(Found(1, 1020, 52), baud, shared=False),
        Sighting(Found(7, 1060, 52), baud, shared=False),
        Sighting(Found(20, 1020, 52), baud, shared=False),
    )
    assert len(steps) == 3


def test_ids_that_are_given_are_asked_one_by_one():
    found = scan_bus(port(), bauds=(1_000_000,), ids=(7, 8))
    assert [sighting.servo.id for sighting in found] == [1, 7, 20]


def test_an_id_that_two_servos_have_is_told():
    faults = FaultPlan((PlannedFault("duplicate_id", servos=(20,)),))
    found = scan_bus(port(faults=faults), bauds=(1_000_000,), ids=(20,))
    assert [sighting.servo.id for sighting in found if not sighting.shared] == [1, 7]
