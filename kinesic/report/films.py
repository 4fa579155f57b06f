"""Films of a performance, drawn in parallel processes."""

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
from kinesic.files.film_settings import DEFAULT_FILM, FilmSettings
from kinesic.files.growing_film import GrowingFilm
from kinesic.planning.captions import make_captions
from kinesic.planning.face_track import compute_faces
from kinesic.planning.plan import Plan
from kinesic.sim.filming.drawn_face import SCREEN_SIZE, paint_face

FilmKind = Literal["twin", "face"]
FilmProcesses = Mapping[FilmKind, "subprocess.Popen[bytes]"]
FILM_KINDS: tuple[FilmKind, FilmKind] = ("twin", "face")  # film of the whole twin, film of the face alone
FACE_RATE = 30  # [Hz] picture rate of face films
FACE_SIZE = (320, 240)  # [pixels] width and height of face films
FACE_FIELD_OF_VIEW = 12.0  # [deg] vertical field of view, from chin to forehead
FAILURE_PREFIX = "failed "  # prefix of the output line in which a film process reports an error


class FilmJob(Protocol):
    """Interface of a picklable job that draws one film."""

    kind: ClassVar[FilmKind]

    @property
    def after(self) -> Path | None:
        """Path of the face film that this film shows, or None."""

    @staticmethod
    def prepare() -> None:
        """Do the preparation that needs no film data, such as imports."""

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draw the film to a file and return any error text."""


@dataclass(frozen=True, eq=False)
class TwinFilm:
    """Picklable job that draws the film of the twin."""

    kind: ClassVar[FilmKind] = "twin"
    robot: Robot
    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    settings: FilmSettings = DEFAULT_FILM
    units: tuple[Mapping[str, float], ...] = ()  # action units of each picture; none: a face that does nothing
    spoken: tuple[Spoken, ...] = ()  # captions
    after: Path | None = None  # rendered film of its face, which may still grow; None: the face is drawn
    sound: Path | None = None  # a WAV on the same clock

    @classmethod
    def of(cls, plan: Plan, times: Floats, angles: Floats, settings: FilmSettings = DEFAULT_FILM) -> "TwinFilm":
        """Make the job for a measured motion with planned face and captions.

        Times are (m,) [s], angles (m, n) [rad].
        """
        from kinesic.sim.film import moments  # noqa: PLC0415 - reports without films do without

        units = tuple(
            dict(row) for row in compute_faces(plan, moments(float(times[0]), float(times[-1]), settings.rate))
        )
        return cls(plan.setup.robot, times, angles, settings, units, captions_of(plan))

    @staticmethod
    def prepare() -> None:
        """Import MuJoCo in advance."""
        import kinesic.sim.film  # noqa: F401, PLC0415 - another film's process does without

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draw the twin's film to a file and return any error text."""
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
        """Return a function from picture number and time [s] to face pictures.

        None if the face is not animated.
        """
        if self.after is not None:
            with suppress(OSError):  # the face film is missing
                film = GrowingFilm(self.after)
                return lambda k, time: self._either(film.at(time + 0.5 / FACE_RATE), k)
        return (lambda k, time: paint_face(self.units[k], size=SCREEN_SIZE)) if self.units else None

    def _either(self, rendered: Picture | None, k: int) -> Picture:
        """Return the filmed face picture, or paint one if it is missing."""
        return paint_face(self.units[k] if self.units else {}, size=SCREEN_SIZE) if rendered is None else rendered


@dataclass(frozen=True, eq=False)
class FaceFilm:
    """Picklable job that draws the film of the face alone."""

    kind: ClassVar[FilmKind] = "face"
    after: ClassVar[None] = None
    robot: Robot | None  # robot whose head turns the face; None: the face looks ahead, as on a screen
    commands: tuple[Command, ...]  # one for each picture
    rate: float = FACE_RATE  # [Hz]

    @classmethod
    def of(cls, robot: Robot | None, commands: Iterable[Command], rate: float = FACE_RATE) -> "FaceFilm":
        """Make the job for the faces in a command stream."""
        copied_commands = tuple(msgspec.structs.replace(command, face=dict(command.face)) for command in commands)
        return cls(robot, copied_commands, rate)

    @staticmethod
    def prepare() -> None:
        """Paint and cache the skin of the head."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - as above
        from kinesic.face.render.portrait import Portrait  # noqa: PLC0415 - as above

        with suppress(DisplayError), Portrait(size=FACE_SIZE):  # `draw` says why not
            pass

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draw the face film to a file and return any error text."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - as above
        from kinesic.face.render.camera import CLOSE_CAMERA  # noqa: PLC0415 - as above
        from kinesic.face.show.recording import FaceRecording, PortraitSettings  # noqa: PLC0415 - as above

        look = PortraitSettings(size=FACE_SIZE, camera=replace(CLOSE_CAMERA, field_deg=FACE_FIELD_OF_VIEW))
        try:
            with FaceRecording(path, self.robot, look=look, rate=self.rate, progress=progress) as recording:
                for command in self.commands:
                    recording.write(command)
        except DisplayError as error:
            return str(error)
        return ""


def captions_of(plan: Plan) -> tuple[Spoken, ...]:
    """Return the spoken text pieces with their performance times."""
    return tuple((caption.begin, caption.end, caption.text) for caption in make_captions(plan))


FILM_JOBS: Mapping[str, type[FilmJob]] = {"twin": TwinFilm, "face": FaceFilm}


@contextmanager
def film_processes() -> Iterator[FilmProcesses]:
    """Run one prepared drawing process per kind of film within the context."""
    with ExitStack() as opened:
        yield {kind: opened.enter_context(_process(kind)) for kind in FILM_KINDS}


@contextmanager
def _process(kind: FilmKind) -> Iterator["subprocess.Popen[bytes]"]:
    process = subprocess.Popen(
        [sys.executable, "-m", "kinesic.report.film_process", kind],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # Ctrl-C in the terminal must not stop it
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
    jobs: Mapping[Path, FilmJob], processes: FilmProcesses, progress: Callable[[float], None] = lambda fraction: None
) -> dict[Path, str]:
    """Draw films concurrently and return their error texts by path.

    An interruption stops all processes. A film that shows another one follows its progress.

    Args:
        jobs: films by the paths of their files, at most one of a kind.
        processes: processes that draw the films, and then end.
        progress: receives the drawn fraction of all films.

    Returns:
        The error text of each film by its path; empty for a film that exists.
    """
    fractions = dict.fromkeys(jobs, 0.0)
    for path in set(jobs) & {job.after for job in jobs.values()}:
        path.touch()  # announces the film to films that show it

    def draw(path: Path, job: FilmJob) -> str:
        def report_fraction(fraction: float) -> None:
            fractions[path] = fraction
            progress(sum(fractions.values()) / len(fractions))

        error = _draw(processes[job.kind], path, job, report_fraction)
        if error:
            path.unlink(missing_ok=True)  # so that no other film waits for it
        return error

    with ThreadPoolExecutor(max(len(jobs), 1)) as threads:
        waiting = {path: threads.submit(draw, path, job) for path, job in jobs.items()}
        try:
            return {path: future.result() for path, future in waiting.items()}
        except BaseException:
            for process in processes.values():
                process.kill()
            raise


def _draw(
    process: "subprocess.Popen[bytes]", path: Path, job: FilmJob, report_fraction: Callable[[float], None]
) -> str:
    """Draw a film in its process and return any error text."""
    assert process.stdin is not None  # they are pipes, since `_process`
    assert process.stdout is not None
    with process.stdout, suppress(BrokenPipeError):
        with process.stdin:
            process.stdin.write(pickle.dumps((job, path)))
        for line in process.stdout:
            text = line.decode(errors="replace").strip()
            if text.startswith(FAILURE_PREFIX):
                return text.removeprefix(FAILURE_PREFIX)
            report_fraction(float(text))
    code = process.wait()
    cause = f"signal {signal.Signals(-code).name}" if code < 0 else f"code {code}"
    return f"the process that drew ended with {cause}: check OpenGL with `kinesic doctor`" if code else ""
