"""Draws the films of a performance, each in a process of its own: beside one another, and none takes another along."""

import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, Literal, Protocol

import msgspec

from kinesic.body.arrays import Floats, Picture
from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.files.caption_band import Spoken
from kinesic.files.film_settings import USUAL, FilmSettings
from kinesic.files.growing_film import GrowingFilm
from kinesic.planning.captions import captions
from kinesic.planning.face_track import faces
from kinesic.planning.plan import Plan
from kinesic.sim.filming.drawn_face import SCREEN, paint_face

FilmKind = Literal["twin", "face"]
FilmProcesses = Mapping[FilmKind, "subprocess.Popen[bytes]"]
KINDS: tuple[FilmKind, FilmKind] = ("twin", "face")
FACE_RATE = 30  # [Hz] as the film of the robot, whose head shows it
FACE_SIZE = (320, 240)  # [pixels]; a screen shows it smaller
FACE_FIELD = 12.0  # [deg] from chin to forehead
FAILED = "failed "  # begins the line of a process that says why it could not draw


class FilmJob(Protocol):
    """A film that can be drawn; picklable."""

    kind: ClassVar[FilmKind]

    @property
    def after(self) -> Path | None:
        """Another film that it shows, and follows while that is drawn."""

    @staticmethod
    def prepare() -> None:
        """Imports and computes what does not depend on the film."""

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draws it to a file, telling the share that is done; returns why not, or nothing."""


@dataclass(frozen=True, eq=False)
class TwinFilm:
    """A film of the twin through a performance, with its face on its head."""

    kind: ClassVar[FilmKind] = "twin"
    robot: Robot
    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    settings: FilmSettings = USUAL
    units: tuple[Mapping[str, float], ...] = ()  # action units of each picture; none: a face that does nothing
    spoken: tuple[Spoken, ...] = ()  # captions
    after: Path | None = None  # the film of its face, while it is drawn; where it does not come, a plain face is drawn
    sound: Path | None = None  # a WAV on the same clock

    @classmethod
    def of(cls, plan: Plan, times: Floats, angles: Floats, settings: FilmSettings = USUAL) -> "TwinFilm":
        """The film of a motion that was measured at (m,) [s], (m, n) [rad], with the face and words of its plan."""
        from kinesic.sim.film import moments  # noqa: PLC0415 - reports without films do without

        units = tuple(dict(row) for row in faces(plan, moments(float(times[0]), float(times[-1]), settings.rate)))
        return cls(plan.setup.robot, times, angles, settings, units, captions_of(plan))

    @staticmethod
    def prepare() -> None:
        """Imports MuJoCo."""
        import kinesic.sim.film  # noqa: F401, PLC0415 - another film's process does without

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draws it to a file."""
        from kinesic.sim.film import FilmError, film  # noqa: PLC0415 - as above

        try:
            film(
                self.robot,
                self.times,
                self.angles,
                path,
                size=self.settings.size,
                rate=self.settings.rate,
                faces=self._faces(),
                spoken=self.spoken,
                sound=self.sound,
                progress=progress,
                guarded=False,
            )
        except FilmError as error:
            return str(error)
        return ""

    def _faces(self) -> Callable[[int, float], Picture] | None:
        """What gives the face of a picture, by its number and its time [s]."""
        if self.after is not None:
            with suppress(OSError):  # it is not there
                film = GrowingFilm(self.after)
                return lambda k, time: self._either(film.at(time + 0.5 / FACE_RATE), k)
        return (lambda k, time: paint_face(self.units[k], size=SCREEN)) if self.units else None

    def _either(self, rendered: Picture | None, k: int) -> Picture:
        """The rendered face of a picture, or where there is none a painted one."""
        return paint_face(self.units[k] if self.units else {}, size=SCREEN) if rendered is None else rendered


@dataclass(frozen=True, eq=False)
class FaceFilm:
    """A film of the face through a performance."""

    kind: ClassVar[FilmKind] = "face"
    after: ClassVar[None] = None
    robot: Robot | None  # whose head turns the face; None: it looks ahead, as on a screen
    commands: tuple[Command, ...]  # one for each picture
    rate: float = FACE_RATE  # [Hz]

    @classmethod
    def of(cls, robot: Robot | None, commands: Iterable[Command], rate: float = FACE_RATE) -> "FaceFilm":
        """The film of a robot that follows commands at a rate [Hz]; their faces become picklable."""
        own = tuple(msgspec.structs.replace(command, face=dict(command.face)) for command in commands)
        return cls(robot, own, rate)

    @staticmethod
    def prepare() -> None:
        """Paints the head's skin, which is remembered."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - as above
        from kinesic.face.render.portrait import Portrait  # noqa: PLC0415 - as above

        with suppress(DisplayError), Portrait(size=FACE_SIZE):  # `draw` says why not
            pass

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draws it to a file."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - as above
        from kinesic.face.render.camera import CLOSE  # noqa: PLC0415 - as above
        from kinesic.face.show.recording import FaceRecording, PortraitSettings  # noqa: PLC0415 - as above

        look = PortraitSettings(size=FACE_SIZE, camera=replace(CLOSE, field_deg=FACE_FIELD))
        try:
            with FaceRecording(path, self.robot, look=look, rate=self.rate, progress=progress) as recording:
                for command in self.commands:
                    recording.write(command)
        except DisplayError as error:
            return str(error)
        return ""


def captions_of(plan: Plan) -> tuple[Spoken, ...]:
    """What is said when, on performance time."""
    return tuple((said.begin, said.end, said.text) for said in captions(plan))


JOBS: Mapping[str, type[FilmJob]] = {"twin": TwinFilm, "face": FaceFilm}


@contextmanager
def film_processes() -> Iterator[FilmProcesses]:
    """Begins processes that make themselves ready to draw; they end at the latest when this is left."""
    with ExitStack() as opened:
        yield {kind: opened.enter_context(_process(kind)) for kind in KINDS}


@contextmanager
def _process(kind: FilmKind) -> Iterator["subprocess.Popen[bytes]"]:
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
    """Draws films beside one another, one that shows another as far as that is; interrupted, the processes end.

    Args:
        jobs: films by the paths of their files, at most one of a kind.
        processes: that draw them, and then end.
        progress: gets the share of all that is drawn.

    Returns:
        Why a film is not there, by its path; empty where it is.
    """
    shares = dict.fromkeys(jobs, 0.0)
    for path in set(jobs) & {job.after for job in jobs.values()}:
        path.touch()  # it is coming

    def draw(path: Path, job: FilmJob) -> str:
        def tell(share: float) -> None:
            shares[path] = share
            progress(sum(shares.values()) / len(shares))

        why = _draw(processes[job.kind], path, job, tell)
        if why:
            path.unlink(missing_ok=True)  # so that nobody waits for it
        return why

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
