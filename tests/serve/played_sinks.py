"""Stub sinks that provide the time, need arming, or hold until `resume`."""

import numpy as np

from kinesic.serve.messages import ServoHealth, ServoReport

from .simulated import Recorder


class Timed(Recorder):
    """Stub sink that provides the performance time."""

    def __init__(self) -> None:
        super().__init__()
        self.says: float | None = None
        self.speed: float | None = None

    def time(self, clock: float, /) -> float | None:
        return (clock - 1000.0) * self.speed if self.speed is not None else self.says


class TimedServos(Timed):
    """Stub servos that follow once they are armed."""

    def __init__(self) -> None:
        super().__init__()
        self.armed, self.state, self.members = False, "limp", ()

    def health(self) -> ServoHealth:
        nothing = ((),) * 5
        return ServoHealth(np.full(2, 0.5), 41.0, 11.5, True, ServoReport("limp", *nothing))

    def arm(self) -> None:
        self.armed = True

    def disarm(self) -> None:
        self.armed = False

    def revive(self) -> None:
        pass


class Held(Recorder):
    """Stub sink that holds until `resume`."""

    def __init__(self) -> None:
        super().__init__()
        self.held = True

    def needs_resume(self) -> bool:
        return self.held

    def resume(self) -> None:
        self.held = False
