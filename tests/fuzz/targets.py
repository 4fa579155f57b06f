"""Readers of bytes and text, with valid inputs and permitted errors."""

import struct
import wave
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.body.config import CONFIGS, ConfigError
from kinesic.capture.reading.text import CaptureError
from kinesic.expressivity.context import read_targets
from kinesic.expressivity.lexicon.gestuary import read_gestuary
from kinesic.expressivity.lexicon.gesture_card import CARD_FILE, read_card
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.hardware.protocol.packet import Instruction, Reader, packet, status, sync_write
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.virtual.faults import FaultPlan
from kinesic.intent.greta.agent import read_agent
from kinesic.intent.greta.lexicon import read_lexicon
from kinesic.mcp.feedback import read_feedback
from kinesic.planning.files.bap import read_bap
from kinesic.serve.wire.protocol import MessageFramer, read_control
from kinesic.session.documents import read_block, read_plain_text
from kinesic.session.setup import set_up
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.mesh_file import read_mesh
from kinesic.sim.log import read_log
from kinesic.sim.servo_factors import Factors
from kinesic.sim.shells.shell import read_shell
from kinesic.speech.recording import RecordingError, read_wav
from kinesic.speech.timings.reading import read_timed_words
from kinesic.speech.timings.timed_words import TimingError
from tests.capture.reading.test_mutated_files import originals
from tests.expressivity.lexicon.test_gestuary import hand
from tests.fuzz.seeds import (
    BML,
    CONTROLS,
    ELEVENLABS,
    FEEDBACK,
    FML,
    JSON_BML,
    MJCF,
    OBJ,
    POLLY,
    SSML,
    SUBTITLES,
    TEXT,
    TEXTGRID,
    URDF,
    WHISPER,
)
from tests.intent.greta.test_agent import BASELINE_XML, QUALIFIER_XML
from tests.intent.greta.test_lexicon import LEXICON_XML

CARD = b'name = "a"\nlicence = "b"\nsource = "c"'
FILE_NAME = "a.file"
MAX_MESSAGE_SIZE = 4096  # [bytes] largest message of the framing target


@dataclass(frozen=True, eq=False)
class Target:
    """Reader with valid inputs and its errors."""

    read: Callable[[bytes], object]
    seeds: tuple[bytes, ...]
    refusals: tuple[type[Exception], ...] = (ConfigError,)


def list_targets(folder: Path) -> Mapping[str, Target]:
    """Return all targets by name.

    Args:
        folder: empty folder for the files of readers that take a path.
    """
    setup, robot = set_up(), load_robot()

    def beside(name: str, read: Callable[[Path], object]) -> Callable[[bytes], object]:
        path = folder / name

        def read_bytes(data: bytes) -> object:
            path.write_bytes(data)
            return read(path)

        return read_bytes

    bml = (BmlError,)
    targets = {
        "bml": Target(parse, (BML, JSON_BML), bml),
        "document": Target(lambda data: read_block(data, setup), (FML, SSML, BML, JSON_BML), bml),
        "text": Target(lambda data: read_plain_text(data, setup, source="t"), (TEXT, SSML, SUBTITLES), bml),
        "control": Target(read_control, CONTROLS, (ValueError,)),
        "framing": Target(_frame, (b"\n".join((*CONTROLS, BML)) + b"\n\0",), (ValueError,)),
        "packets": Target(_read_packets, _packets(), ()),
        "feedback": Target(lambda data: read_feedback(data.decode("utf-8", "replace")), (FEEDBACK,), ()),
        "gestures": Target(beside("gesture.toml", Lexicon.load), (_gestures(),)),
        "gestuary": Target(beside("gestuary.xml", read_gestuary), (_gestuary(),)),
        "card": Target(
            beside(CARD_FILE, lambda path: read_card(path.parent)), (b'name = "a"\nlicence = "b"\nsource = "c"',)
        ),
        "style": Target(beside("style.toml", Style.load), (_config("styles/calm.toml"), _config("styles/joyful.toml"))),
        "robot": Target(beside("robot.toml", load_robot), (_config("robots/upper22.toml"),)),
        "targets": Target(beside("targets.toml", read_targets), (b"cup = [0.3, 0.1, -0.2]\ndoor = [1, 2, 3]\n",)),
        "faults": Target(
            beside("faults.toml", FaultPlan.read),
            (b'seed = 1\n[[fault]]\nkind = "silent"\nservos = [3]\nstart = 1.0\nseconds = 0.5\n',),
        ),
        "twin": Target(beside("twin.toml", Factors.read), (Factors(gain=0.9).text().encode(),)),
        "words": Target(
            read_timed_words,
            (
                TEXTGRID,
                WHISPER,
                ELEVENLABS,
                POLLY,
                SUBTITLES,
            ),
            (TimingError,),
        ),
        "wav": Target(beside("sound.wav", read_wav), (_wav(),), (RecordingError,)),
        "bap": Target(beside("face.bap", lambda path: read_bap(path, robot)), (_bap(),)),
        "log": Target(beside("log.npz", lambda path: read_log(path, robot)), (_log(robot.skeleton.names),)),
        "shell": Target(beside("shell.npz", read_shell), ((CONFIGS / "robots" / "upper22.npz").read_bytes(),)),
        "stl": Target(beside("mesh.stl", lambda path: read_mesh(path, folder=path.parent)), (_stl(),)),
        "obj": Target(beside("mesh.obj", lambda path: read_mesh(path, folder=path.parent)), (OBJ,)),
        "urdf": Target(beside("robot.urdf", load_robot_tree), (URDF,)),
        "mjcf": Target(beside("robot.xml", load_robot_tree), (MJCF,)),
        "intentions": Target(beside("lexicon.xml", read_lexicon), (LEXICON_XML.encode(),)),
        "baseline": Target(beside("baseline.xml", lambda path: read_agent(path, None)), (BASELINE_XML.encode(),)),
        "qualifiers": Target(beside("qualifiers.xml", lambda path: read_agent(None, path)), (QUALIFIER_XML.encode(),)),
    }
    captured = {
        f"capture-{kind}": Target(_capture(read), (data,), (CaptureError,))
        for kind, (read, data) in originals(folder).items()
    }
    return targets | captured


def _capture(read: Callable[[bytes, str], object]) -> Callable[[bytes], object]:
    """Return a reader of motion files whose errors must name the file."""

    def read_named(data: bytes) -> object:
        try:
            return read(data, FILE_NAME)
        except CaptureError as error:
            if FILE_NAME not in str(error):
                raise AssertionError("the refusal does not name the file") from error
            raise

    return read_named


def _frame(data: bytes) -> None:
    """Compare the messages of a byte stream fed whole and halved."""
    whole, middle = MessageFramer(MAX_MESSAGE_SIZE), len(data) // 2
    split = MessageFramer(MAX_MESSAGE_SIZE)
    assert whole.feed(data) == [*split.feed(data[:middle]), *split.feed(data[middle:])]


def _read_packets(data: bytes) -> None:
    """Compare the packets of a stream fed whole and byte by byte."""
    whole, slow = Reader(), Reader()
    packets = list(whole.feed(data))
    assert packets == [one for byte in data for one in slow.feed(bytes((byte,)))]


def _packets() -> tuple[bytes, ...]:
    reply = status(3, 0x80, bytes(range(18)))
    return (
        packet(1, Instruction.PING) + reply,
        sync_write(116, 4, {k: bytes((0xFF, 0xFF, 0xFD, k)) for k in range(1, 5)}),
        b"\xff\xff" + reply[:9] + reply,
    )


def _config(name: str) -> bytes:
    return (CONFIGS / name).read_bytes()


def _gestures() -> bytes:
    """Return the first gestures of a file of kinesic."""
    return b"\n[[gesture]]".join(_config("gestures/beat.toml").split(b"\n[[gesture]]")[:3]) + b"\n"


def _gestuary() -> bytes:
    phases = f"<phase>{hand()}</phase><phase>{hand('RIGHT')}</phase>"
    return f'<gestuary><gesture category="deictic" id="Own">{phases}</gesture></gestuary>'.encode()


def _wav() -> bytes:
    content = BytesIO()
    with wave.open(content, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(16_000)
        file.writeframes(bytes(3200))
    return content.getvalue()


def _bap() -> bytes:
    rows = [f"{' '.join('1' if k in (3, 7) else '0' for k in range(1, 297))}\n{frame} 100 -200\n" for frame in range(3)]
    return ("3.2 mine 25 3\n" + "".join(rows)).encode()


def _log(names: tuple[str, ...]) -> bytes:
    content = BytesIO()
    angles = np.linspace(0.0, 0.1, 5)[:, None] * np.ones(len(names))
    np.savez_compressed(content, times=np.arange(5) / 100.0, names=np.array(names), goals=angles, angles=angles)
    return content.getvalue()


def _stl() -> bytes:
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]
    rows = [struct.pack("<12fH", *(0.0,) * 3, *(x for k in face for x in corners[k]), 0) for face in faces]
    return bytes(80) + struct.pack("<I", len(faces)) + b"".join(map(bytes, rows))
