"""Planning of documents and motion files without moving the robot."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import perf_counter

from kinesic.bml.block import Block, BmlError
from kinesic.bml.reading.wrapping import is_wrapped
from kinesic.intent.manuscript.pieces import SpokenText
from kinesic.intent.pacing.memory import NO_MEMORY
from kinesic.planning.certify import certify
from kinesic.planning.clearance import Conditioner
from kinesic.planning.files.bap import BAP_SUFFIX, read_bap
from kinesic.planning.files.imported_motion import plan_imported
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.standing_plan import plan_standing_block
from kinesic.session.builtin_documents import locate_document, suggest_document
from kinesic.session.documents import TEXT_SUFFIXES, author_with_setup, make_block, read_block, read_plain_text
from kinesic.session.recorded import SpokenRecording, read_recording
from kinesic.session.setup import set_up

MOTION_FILE_SUFFIXES = (  # suffixes of motion files that can be planned
    BAP_SUFFIX,
    ".bvh",
    ".skm",
    ".amc",
    ".glb",
    ".gltf",
    ".csv",
    ".npz",
    ".mcap",
    ".parquet",
)
DocumentSource = str | bytes | Path  # path, name of a built-in document, or content of a document


def plan(
    text: str | bytes, setup: Setup | None = None, *, source: str = "<text>", conditioned: Conditioner = certify
) -> Plan:
    """Plan the text of a BML, FML or SSML document.

    Args:
        text: of the document.
        setup: robot, style and options; default is upper22 in the neutral style.
        source: name of the document in messages and reports.
        conditioned: turns desired motions into motions within the limits.

    Raises:
        BmlError: the document is refused.
    """
    setup = setup or set_up()
    return _plan_read(lambda: read_block(text, setup, source=source), setup, conditioned)


def plan_plain_text(text: str | bytes, setup: Setup, *, source: str, conditioned: Conditioner = certify) -> Plan:
    """Plan speech and gestures for a text.

    Args:
        text: to be spoken, or the content of its file.
        setup: robot, style and options.
        source: name of the text in messages and reports.
        conditioned: turns desired motions into motions within the limits.
    """
    return _plan_read(lambda: read_plain_text(text, setup, source=source), setup, conditioned)


def plan_parts(parts: Sequence[SpokenText], setup: Setup, *, source: str) -> Iterator[Plan]:
    """Plan a long text part by part.

    Only the current plan is in memory. No gesture is repeated for a minute of speech, also across parts.

    Args:
        parts: of the text, as `kinesic.session.documents.divide_long` returns them.
        setup: robot, style and options.
        source: name of the text in messages and reports.
    """
    memory = NO_MEMORY
    for number, part in enumerate(parts, 1):
        written = author_with_setup(part, setup, memory=memory)
        memory, name = written.memory, f"{source}, part {number} of {len(parts)}"
        yield _plan_read(partial(make_block, written, setup, source=name), setup, certify)


def plan_recording(
    text: str | None,
    recording: SpokenRecording,
    setup: Setup,
    *,
    source: str | None = None,
    conditioned: Conditioner = certify,
) -> Plan:
    """Plan a recording with gestures that match its text or its accents.

    Args:
        text: of the recording; None: that of its file of words, or none.
        recording: sound and times of words.
        setup: robot, style and options.
        source: name in messages and reports; default is the name of the sound file.
        conditioned: turns desired motions into motions within the limits.

    Raises:
        ConfigError: the sound, or the file of words, cannot be read.
    """
    name = source or recording.audio.name
    return _plan_read(lambda: read_recording(text, recording, setup, source=name), setup, conditioned)


def plan_motion_file(path: str | Path, setup: Setup, *, source: str | None = None) -> Plan:
    """Plan the motion of a BAP or captured-motion file.

    Args:
        path: of the file (.bap, or captured motion such as .bvh).
        setup: robot, style and options.
        source: name in messages and reports; default is the path.

    Raises:
        ConfigError: the file is missing or invalid.
    """
    file, name = Path(path), source or str(path)
    if file.suffix.lower() == BAP_SUFFIX:
        return plan_imported(read_bap(file, setup.robot), setup, source=name)
    from kinesic.capture.certified_plan import plan_captured  # noqa: PLC0415 - SciPy's splines are slow to import
    from kinesic.capture.read import read_clip  # noqa: PLC0415 - likewise

    return plan_captured(read_clip(file), setup, source=name)


def is_motion_file(path: str | Path) -> bool:
    """Return whether a path has the suffix of a motion file."""
    return Path(path).suffix.lower() in MOTION_FILE_SUFFIXES


def plan_document(document: DocumentSource, setup: Setup, *, source: str | None = None) -> Plan:
    """Plan a document or motion file, given as path, name or content.

    Args:
        document: path (BML, a text such as .txt, or a motion such as .bap or .bvh), name of a built-in document, or
            BML text.
        setup: robot, style and options.
        source: name in messages and reports; default is the path.

    Raises:
        BmlError: the document is refused, or the file does not exist.
        ConfigError: the motion file is invalid.
    """
    if isinstance(document, bytes) or (isinstance(document, str) and _is_content(document)):
        return plan(document, setup, source=source or "<text>")
    path = Path(document)
    if is_motion_file(path):
        return plan_motion_file(path, setup, source=source)
    if path.suffix.lower() in TEXT_SUFFIXES:
        return plan_plain_text(_read_bytes(path), setup, source=source or str(path))
    return plan(_read_bytes(path), setup, source=source or str(path))


def _is_content(text: str) -> bool:
    """Return whether a text is a document, not a path."""
    return text.lstrip("\ufeff \t\r\n")[:1] in "<{[" or is_wrapped(text)


def _plan_read(read: Callable[[], Block], setup: Setup, conditioned: Conditioner) -> Plan:
    """Plan the block that `read` returns, recording the duration [s] of `read`."""
    began = perf_counter()
    block = read()
    parse_seconds = perf_counter() - began
    return replace(plan_standing_block(block, setup, conditioned=conditioned), parse_seconds=parse_seconds)


def _read_bytes(path: Path) -> bytes:
    """Read a document file, or built-in document of this name, as bytes.

    Raises:
        BmlError: the file does not exist or cannot be read.
    """
    try:
        return locate_document(path).read_bytes()
    except OSError as error:
        raise BmlError(
            f"{path}: {error.strerror}{suggest_document(path)}; give a path, or BML text that begins with <"
        ) from None
    except ValueError as error:
        raise BmlError(f"{str(path)!r}: {error}; give a path, or BML text that begins with <") from None
