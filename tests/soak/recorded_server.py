"""Server of `kinesic serve` whose commands and sound are recorded, without a sound device.

Run as a program, `python -m tests.soak.recorded_server FOLDER OPTIONS` runs `kinesic serve OPTIONS` with a stand-in for
the loudspeaker. It writes two files of 64-bit floats. `commands` has a row of machine time [s], clock time [s], angles
and setpoints [rad] for each command, `sound` a row of machine time [s] and root mean square for each 10 ms.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from threading import Event, Thread
from time import monotonic, sleep
from types import ModuleType, SimpleNamespace

import numpy as np

from kinesic.body.command import Command
from kinesic.cli import main
from kinesic.cli.live import serve
from kinesic.serve.sinks.real_time import RealTwin

DEVICE_DELAY = 0.1  # [s] time from a request for samples until they are heard
PART_DURATION = 0.01  # [s] sound of one request


class Loudspeaker:
    """Stand-in for a PortAudio stream that requests samples in real time."""

    folder: Path

    def __init__(
        self, *, samplerate: int, channels: int, dtype: str, latency: float, callback: Callable[..., None]
    ) -> None:
        self.latency, self._count, self._callback = latency, round(PART_DURATION * samplerate), callback
        self._ended, self._thread = Event(), Thread(target=self._play, daemon=True)

    def start(self) -> None:
        self._thread.start()

    def abort(self) -> None:
        self._ended.set()

    def close(self) -> None:
        self._thread.join()

    def _play(self) -> None:
        buffer, due = np.zeros((self._count, 1), np.float32), monotonic()
        with (self.folder / "sound").open("wb", buffering=0) as file:
            while not self._ended.is_set():
                heard = max(due, monotonic() - DEVICE_DELAY) + DEVICE_DELAY
                times = SimpleNamespace(currentTime=monotonic(), outputBufferDacTime=heard)
                self._callback(buffer, self._count, times, None)
                file.write(np.array([heard, np.sqrt(np.mean(buffer**2))]).tobytes())
                due += PART_DURATION
                sleep(max(0.0, due - monotonic()))


class RecordedTwin(RealTwin):
    """Simulated robot that writes all its commands to a file."""

    def __init__(self, *arguments: object, **options: object) -> None:
        super().__init__(*arguments, **options)
        self._file = (Loudspeaker.folder / "commands").open("wb", buffering=0)

    def write(self, command: Command, /) -> None:
        self._file.write(np.array([monotonic(), command.time, *command.angles, *command.setpoints]).tobytes())
        super().write(command)

    def close(self) -> None:
        self._file.close()
        super().close()


def run(folder: Path) -> None:
    """Run `kinesic serve` with the remaining arguments of the program."""
    Loudspeaker.folder = folder
    devices = ModuleType("sounddevice")
    vars(devices).update(
        OutputStream=Loudspeaker, PortAudioError=OSError, query_devices=lambda: [{"max_output_channels": 1}]
    )
    sys.modules["sounddevice"] = devices
    serve.RealTwin = RecordedTwin
    sys.argv = ["kinesic", "serve", *sys.argv[2:]]
    sys.exit(main())


if __name__ == "__main__":
    run(Path(sys.argv[1]))
