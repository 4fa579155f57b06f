"""Draws the films of a performance, each in a process of its own: beside one another, and none takes another along."""

import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal, Protocol

import msgspec

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.body.robot import Robot

Kind = Literal["twin", "face"]
FilmProcesses = Mapping[Kind, "subprocess.Popen[bytes]"]
KINDS: tuple[Kind, Kind] = ("twin", "face")
TWIN_RATE = 10.0  # [Hz]
FACE_RATE = 16  # [Hz] lips move faster than arms: no closure of theirs is left out
FACE_SIDE = 224  # [pixels]
FAILED = "failed "  # begins the line of a process that says why it could not draw


class FilmJob(Protocol):
    """A film that can be drawn; picklable."""

    kind: ClassVar[Kind]

    @staticmethod
    def prepare() -> None:
        """Imports and computes what does not depend on the film."""

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draws it to a file, telling the share that is done; returns why not, or nothing."""


@dataclass(frozen=True, eq=False)
class TwinFilm:
    """What the twin did."""

    kind: ClassVar[Kind] = "twin"
    robot: Robot
    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]

    @staticmethod
    def prepare() -> None:
        """Imports MuJoCo."""
        import kinesic.sim.film  # noqa: F401, PLC0415 - another film's process does without

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draws it to a file."""
        from kinesic.sim.film import FilmError, film  # noqa: PLC0415 - as above

        try:
            film(self.robot, self.times, self.angles, path, rate=TWIN_RATE, progress=progress, guarded=False)
        except FilmError as error:
            return str(error)
        return ""


@dataclass(frozen=True, eq=False)
class FaceFilm:
    """What the face showed."""

    kind: ClassVar[Kind] = "face"
    robot: Robot
    commands: tuple[Command, ...]  # at `FACE_RATE`

    @classmethod
    def of(cls, robot: Robot, commands: Iterable[Command]) -> "FaceFilm":
        """The film of a robot that follows commands; their faces become picklable."""
        return cls(robot, tuple(msgspec.structs.replace(command, face=dict(command.face)) for command in commands))

    @staticmethod
    def prepare() -> None:
        """Paints the head's skin, which is remembered."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - as above
        from kinesic.face.render.portrait import Portrait  # noqa: PLC0415 - as above

        with suppress(DisplayError), Portrait(size=(FACE_SIDE, FACE_SIDE)):  # `draw` says why not
            pass

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draws it to a file."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - as above
        from kinesic.face.show.recording import FaceRecording, PortraitSettings  # noqa: PLC0415 - as above

        look = PortraitSettings(side=FACE_SIDE)
        try:
            with FaceRecording(path, self.robot, look=look, rate=FACE_RATE, progress=progress) as recording:
                for command in self.commands:
                    recording.write(command)
        except DisplayError as error:
            return str(error)
        return ""


JOBS: Mapping[str, type[FilmJob]] = {"twin": TwinFilm, "face": FaceFilm}


@contextmanager
def film_processes() -> Iterator[FilmProcesses]:
    """Begins processes that make themselves ready to draw; they end at the latest when this is left."""
    with ExitStack() as opened:
        yield {kind: opened.enter_context(_process(kind)) for kind in KINDS}


@contextmanager
def _process(kind: Kind) -> Iterator["subprocess.Popen[bytes]"]:
    process = subprocess.Popen(
        [sys.executable, "-m", "kinesic.report.film_process", kind],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # Ctrl-C in the terminal is not for it
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        for pipe in filter(None, (process.stdin, process.stdout)):
            with suppress(BrokenPipeError):
                pipe.close()


def draw_films(
    jobs: Mapping[Path, FilmJob], processes: FilmProcesses, progress: Callable[[float], None] = lambda share: None
) -> dict[Path, str]:
    """Draws films beside one another; when it is interrupted, the processes that draw end.

    Args:
        jobs: films by the paths of their files, at most one of a kind.
        processes: that draw them, and then end.
        progress: gets the share of all that is drawn.

    Returns:
        Why a film is not there, by its path; empty where it is.
    """
    shares = dict.fromkeys(jobs, 0.0)

    def draw(path: Path, job: FilmJob) -> str:
        def tell(share: float) -> None:
            shares[path] = share
            progress(sum(shares.values()) / len(shares))

        return _draw(processes[job.kind], path, job, tell)

    with ThreadPoolExecutor(max(len(jobs), 1)) as threads:
        waiting = {path: threads.submit(draw, path, job) for path, job in jobs.items()}
        try:
            return {path: found.result() for path, found in waiting.items()}
        except BaseException:
            for process in processes.values():
                process.kill()
            raise


def _draw(process: "subprocess.Popen[bytes]", path: Path, job: FilmJob, tell: Callable[[float], None]) -> str:
    """Hands a job over and listens to its process until it ends."""
    assert process.stdin is not None  # they are pipes, since `_process`
    assert process.stdout is not None
    with process.stdout, suppress(BrokenPipeError):
        with process.stdin:
            process.stdin.write(pickle.dumps((job, path)))
        for line in process.stdout:
            text = line.decode(errors="replace").strip()
            if text.startswith(FAILED):
                return text.removeprefix(FAILED)
            tell(float(text))
    code = process.wait()
    how = f"signal {signal.Signals(-code).name}" if code < 0 else f"code {code}"
    return f"the process that drew ended with {how}: does OpenGL work? `kinesic doctor` says" if code else ""
