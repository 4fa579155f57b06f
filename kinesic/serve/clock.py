"""The clock that all processes read: the machine's monotonic one, less an offset that they share."""

from ctypes import c_double
from multiprocessing.sharedctypes import RawValue
from time import monotonic


class Clock:
    """Seconds since the server began, less the time that stood still."""

    def __init__(self) -> None:
        """At zero."""
        self._offset = RawValue(c_double, monotonic())

    def now(self) -> float:
        """[s]."""
        return monotonic() - float(self._offset.value)

    def at(self, clock: float) -> float:
        """[s] at a time of the machine's monotonic clock [s]."""
        return clock - float(self._offset.value)

    def set(self, time: float) -> None:
        """Makes it now a time [s]: only the loop does."""
        self._offset.value = monotonic() - time
