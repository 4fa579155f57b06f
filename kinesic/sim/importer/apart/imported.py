"""Import of an untrusted robot file in a separate, bounded process."""

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from kinesic.body.config import ConfigError
from kinesic.files.unicode_text import escape_surrogates

IMPORT_MODULE = "kinesic.sim.importer.apart.import_process"  # module of the import process
THREAD_VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Bounds:
    """Bounds on the memory and time of one import."""

    duration: float = 300.0  # [s] wall-clock time
    cpu_time: int = 120  # [s] processor time
    memory: int = 2_000_000_000  # [bytes] of data


USUAL_BOUNDS = Bounds()  # memory and time limits that suffice to import every tested robot


class ImportedRobot(msgspec.Struct, frozen=True, tag=True):
    """Files of an imported robot, with notes for the user."""

    text: str  # TOML of the robot
    mapping: tuple[tuple[str, str, str, str], ...]  # hinge, joint of the file, range [deg], rest [deg]
    shell: bytes  # contents of its .npz file, empty without meshes
    confidence: float  # 0..1, of the mapping
    review: tuple[str, ...]  # notes on what a person must check
    left_out: tuple[str, ...]  # notes on parts that are not imported
    doubt: str  # reason that a person must review it, empty if none


class Refusal(msgspec.Struct, frozen=True, tag=True):
    """Reason why a file cannot be imported."""

    reason: str


Answer = ImportedRobot | Refusal


def import_apart(path: Path, *, wished: Sequence[str] = (), bounds: Bounds = USUAL_BOUNDS) -> ImportedRobot:
    """Import an MJCF or URDF humanoid in a separate process.

    Its duration is bounded on all systems, its memory and processor time only on Linux. The answer is data, and nothing
    in it is executed.

    Args:
        path: MJCF or URDF file.
        wished: Requested hinges of joints, each as JOINT=HINGE.
        bounds: Bounds on the other process.

    Raises:
        ConfigError: the file cannot be read, is not a robot, or its import failed or exceeded its bounds.
    """
    place = path.absolute()
    folders = os.pathsep.join(folder or os.getcwd() for folder in sys.path)
    environment = os.environ | dict.fromkeys(THREAD_VARIABLES, "1") | {"PYTHONPATH": folders}
    arguments = [str(place), str(bounds.memory), str(bounds.cpu_time), *wished]
    with TemporaryDirectory() as empty:
        try:
            ended = subprocess.run(
                [sys.executable, "-P", "-m", IMPORT_MODULE, *arguments],
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=bounds.duration,
                cwd=empty,
                env=environment,
                start_new_session=True,  # Ctrl-C must reach only this process, which ends the other
                check=False,
            )
        except subprocess.TimeoutExpired:
            why = f"its import takes longer than {bounds.duration:g} s; simplify its meshes"
            raise ConfigError(f"{path}: {why}") from None
    if ended.returncode:
        raise ConfigError(f"{path}: its import ended with {_describe_cause(ended.returncode, ended.stderr)}")
    try:
        answer: Answer = msgspec.msgpack.decode(ended.stdout, type=Answer)
    except msgspec.DecodeError as error:
        raise ConfigError(f"{path}: its import returned an unreadable answer: {error}") from None
    if isinstance(answer, Refusal):
        raise ConfigError(answer.reason.replace(escape_surrogates(str(place)), str(path)))
    return answer


def _describe_cause(code: int, errors: bytes) -> str:
    """Return the cause of the process's end in one line."""
    if code == -getattr(signal, "SIGXCPU", 0):
        return "signal SIGXCPU: it takes more processor time than any robot needs; simplify its meshes"
    if code < 0:
        return f"signal {-code}: it takes too much memory, or MuJoCo fails; simplify the file"
    lines = errors.decode(errors="replace").strip().splitlines()
    return (
        f"an internal error of kinesic, please report it with the file: {lines[-1] if lines else f'exit code {code}'}"
    )
