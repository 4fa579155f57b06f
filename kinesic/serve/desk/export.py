"""Export of a document's performance to files of other programs."""

from base64 import b64encode
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from kinesic.body.config import ConfigError
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.files.plain_name import plain_stem
from kinesic.planning.files.motion_files import write_motion
from kinesic.planning.plan import Plan
from kinesic.serve.wire.questions import Format

MAX_FILE_SIZE = 5_000_000  # [bytes] largest exported file; its base64 text stays below `Quotas.unread_bytes`
FILE_STEM = "performance"  # stem of all temporary files, so that no client text becomes part of a path


PlanWriter = Callable[[Plan, Path], None]
Writers = Mapping[Format, PlanWriter]
NO_WRITERS: Writers = {}  # default: no additional export formats, empty; a plain dict, because it is pickled


def export_name(plan: Plan, format_: Format) -> str:
    """Return the suggested download name, plain ASCII without a folder."""
    return f"{plain_stem(plan.timeline.block.id, fallback=FILE_STEM)}.{format_}"


def export(plan: Plan, format_: Format, more: Writers = NO_WRITERS) -> str:
    """Return a plan as a base64-encoded file.

    Args:
        plan: the plan.
        format_: file format.
        more: writers of additional formats.

    Raises:
        ConfigError: there is nothing to write, the file would be too large, or there is no writer for the format.
        OSError: temporary files cannot be written.
    """
    writer = {**_FORMAT_WRITERS, **more}.get(format_)
    if writer is None:
        raise ConfigError(f"this server writes no .{format_}; `kinesic plan --out scene.{format_}` does")
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{FILE_STEM}.{format_}"
        try:
            writer(plan, path)
        except ConfigError as error:
            raise ConfigError(str(error).replace(str(path), "the file")) from None
        if (size := path.stat().st_size) > MAX_FILE_SIZE:
            raise ConfigError(
                f".{format_} of {plan.duration:.0f} s takes {size} bytes, at most {MAX_FILE_SIZE}: ask for parts"
            )
        return b64encode(path.read_bytes()).decode()


def _write_motion(plan: Plan, path: Path) -> None:
    write_motion(plan.trajectory, plan.setup.robot, path)


def _write_bap(plan: Plan, path: Path) -> None:
    """Write a BAP file with the suggested download name in its header."""
    write_motion(plan.trajectory, plan.setup.robot, path, called=Path(export_name(plan, "bap")))


def _write_voice(plan: Plan, path: Path) -> None:
    audio = sound(plan)
    if audio is None:
        raise ConfigError("there is no audio: the document has no speech, or the voice has no sound")
    write_wav(audio, path)


_FORMAT_WRITERS: Writers = {  # file format -> function that writes it
    "npz": _write_motion,
    "csv": _write_motion,
    "bap": _write_bap,
    "wav": _write_voice,
}
