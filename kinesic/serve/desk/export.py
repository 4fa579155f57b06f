"""Writes a document's performance in the formats of other programs, for a client that keeps it where it likes."""

from base64 import b64encode
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from kinesic.body.config import ConfigError
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.files.plain_name import plain_stem
from kinesic.planning.motion_files import write_motion
from kinesic.planning.plan import Plan
from kinesic.serve.wire.questions import Format

MOST_BYTES = 5_000_000  # of a file; in base64 it stays below what may wait for a client
FILE_STEM = "performance"  # of every file that is written here: no text of a client is part of a path


PlanWriter = Callable[[Plan, Path], None]
Writers = Mapping[Format, PlanWriter]
NO_WRITERS: Writers = {}  # no proxy: it goes to another process


def export_name(planned: Plan, format_: Format) -> str:
    """Return the suggested download name, plain ASCII without a folder."""
    return f"{plain_stem(planned.timeline.block.id, fallback=FILE_STEM)}.{format_}"


def export(planned: Plan, format_: Format, more: Writers = NO_WRITERS) -> str:
    """Writes a plan as a file, in base64.

    Args:
        planned: the plan.
        format_: of the file.
        more: writers of formats that this room does not know.

    Raises:
        ConfigError: there is nothing to write, it would be too large, or nobody here writes such files.
        OSError: temporary files cannot be written.
    """
    writer = {**_WRITERS, **more}.get(format_)
    if writer is None:
        raise ConfigError(f"this server writes no .{format_}; `kinesic plan --out scene.{format_}` does")
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{FILE_STEM}.{format_}"
        try:
            writer(planned, path)
        except ConfigError as error:
            raise ConfigError(str(error).replace(str(path), "the file")) from None
        if (size := path.stat().st_size) > MOST_BYTES:
            raise ConfigError(
                f".{format_} of {planned.duration:.0f} s takes {size} bytes, at most {MOST_BYTES}: ask for parts"
            )
        return b64encode(path.read_bytes()).decode()


def _write_motion(planned: Plan, path: Path) -> None:
    write_motion(planned.trajectory, planned.setup.robot, path)


def _write_bap(planned: Plan, path: Path) -> None:
    """Write a BAP file with the suggested download name in its header."""
    write_motion(planned.trajectory, planned.setup.robot, path, called=Path(export_name(planned, "bap")))


def _write_voice(planned: Plan, path: Path) -> None:
    heard = sound(planned)
    if heard is None:
        raise ConfigError("nothing is heard: the document has no speech, or the voice no sound")
    write_wav(heard, path)


_WRITERS: Writers = {
    "npz": _write_motion,
    "csv": _write_motion,
    "bap": _write_bap,
    "wav": _write_voice,
}
