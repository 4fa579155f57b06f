"""Events that follow from changed records of servos."""

from collections.abc import Iterator, Sequence

from kinesic.hardware.bus.cycle import EventKind, Records
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED


def describe_changes(ids: Sequence[int], before: Records, after: Records) -> Iterator[tuple[int, EventKind, str]]:
    """Describe each changed hardware error, watchdog or torque switch.

    Each item has the servo's id, the kind and a text.

    Args:
        ids: ids of the servos, in the order of the records.
        before: (n,) earlier records.
        after: (n,) new records.
    """
    for servo, was, now in zip(ids, before, after, strict=True):
        if was["hardware_error"] != now["hardware_error"]:
            yield servo, "error", f"hardware error {was['hardware_error']:#04x} -> {now['hardware_error']:#04x}"
        if was["watchdog"] != now["watchdog"] == WATCHDOG_TRIPPED:
            yield servo, "watchdog", "stopped: the bus was silent for too long"
        if was["torque"] != now["torque"]:
            yield servo, "torque", "on" if now["torque"] else "off"
