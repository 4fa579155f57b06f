"""Every reader accepts an altered file or refuses it in one sentence."""

import io
import random
import tempfile
import tomllib
import wave
import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.body.config import CONFIGS, ConfigError
from kinesic.body.robot import Robot
from kinesic.expressivity.context import read_targets
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.faults import FaultPlan
from kinesic.intent.greta.lexicon import read_lexicon
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.mesh_file import read_mesh
from kinesic.sim.log import read_log
from kinesic.sim.servo_factors import Factors
from kinesic.sim.shells.shell import read_shell
from kinesic.speech.recording import RecordingError, read_wav

from ...examples import examples
from .mutations import Tables, altered, damaged, toml

REFUSAL_ERRORS = (ConfigError, BmlError, RecordingError)  # errors with which a reader may refuse a file


@dataclass(frozen=True)
class Reader:
    """A kind of file: its public reader and valid examples."""

    read: Callable[[Path], object]
    valid: Callable[[], Tables]


def _robot(path: Path) -> None:
    robot = Robot.load(path)
    ServoMap.of(robot)


def _lexicon(path: Path) -> None:
    lexicon = Lexicon.load(path)
    lexicon.read_all()
    for name in ("beat", "own", "my own", "wave"):
        lexicon.find(name)


@cache
def _own(name: str) -> Tables:
    return tomllib.loads((CONFIGS / name).read_text(encoding="utf-8"))


def _extension() -> Tables:
    robot = _own("robots/upper22.toml")
    hinge = robot["hinge"][0]
    return {
        "robot": {"name": "own", "extends": "upper22"},
        "hinge": [hinge],
        "body": [robot["body"][1]],
        "chains": robot["chains"],
        "targets": {"cup": [0.3, 0.0, 0.1]},
        "rest": {hinge["name"]: 0.0},
        "collision": {"clearance": 0.01, "exclude": []},
        "servos": {"mine": next(iter(_own("servos.toml").values()))},
        "supply": {"volts": 12.0, "amps": 5.0},
    }


GESTURE_TABLES: Tables = {
    "category": "beat",
    "gesture": [
        {
            "id": "own",
            "keys": [
                {"both": {"at": ["XC", "YCC", "ZNear"], "palm": "up", "shape": "flat", "openness": 0.5}},
                {"right": {"at": [0.1, 0.2, 0.3], "path": {"kind": "wave", "amplitude": [0.1, 0.0, 0.0]}}},
            ],
            "meanings": ["mine"],
            "says": "a gesture",
            "body": {"nod": 5.0, "head": {"turn": 3.0}, "face": {"smile": 0.5}},
        }
    ],
    "synonyms": {"own": ["my own"]},
    "classes": {"mine": {"gesture": "own", "words": ["my"]}},
    "bodies": {"beat": {"nod": 4.0, "trunk": {"tilt": 2.0}}},
}

TOML_READERS = {  # kind of file -> reader and valid tables
    "robot": Reader(_robot, lambda: _own("robots/upper22.toml")),
    "hands": Reader(_robot, lambda: _own("robots/upper36.toml")),
    "extension": Reader(_robot, _extension),
    "lexicon": Reader(_lexicon, lambda: GESTURE_TABLES),
    "style": Reader(Style.load, lambda: _own("styles/angry.toml")),
    "factors": Reader(
        Factors.read, lambda: {"stall": 0.9, "latency": 0.01, "servos": {"XM430-W350": {"stall": 0.8, "gain": 1.1}}}
    ),
    "faults": Reader(FaultPlan.read, lambda: {"seed": 1, "fault": [{"kind": "corrupt", "rate": 0.1}]}),
    "targets": Reader(read_targets, lambda: {"cup": [0.1, 0.2, 0.3]}),
}


def refuses_or_reads(read: Callable[[Path], object], path: Path) -> None:
    with suppress(*REFUSAL_ERRORS):
        read(path)


@pytest.mark.parametrize("kind", TOML_READERS)
@given(seed=st.integers(0, 2**32 - 1))
@examples(200)
def test_altered_toml_files_are_read_or_refused(kind: str, seed: int):
    reader = TOML_READERS[kind]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "own.toml"
        path.write_text(toml(altered(reader.valid(), random.Random(seed))), encoding="utf-8")
        refuses_or_reads(reader.read, path)


@pytest.mark.parametrize("kind", TOML_READERS)
def test_undamaged_example_file_of_each_toml_format_is_read(kind: str, tmp_path: Path):
    reader = TOML_READERS[kind]
    (tmp_path / "own.toml").write_text(toml(reader.valid()), encoding="utf-8")
    reader.read(tmp_path / "own.toml")


@cache
def _wav() -> bytes:
    stream = io.BytesIO()
    with wave.open(stream, "wb") as file:
        file.setparams((2, 3, 8000, 0, "NONE", ""))
        file.writeframes(bytes(range(240)) * 4)
    return stream.getvalue()


def _arrays(**arrays: object) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


@cache
def _log() -> bytes:
    names = np.array(Robot.load().skeleton.names)
    motion = np.zeros((3, len(names)))
    return _arrays(times=np.arange(3.0), names=names, goals=motion, angles=motion)


GRETA_XML = (
    b'<behaviorsets><behaviorset name="a"><signals><signal id="1" name="head=nod" modality="head"/></signals>'
    b"</behaviorset></behaviorsets>"
)
BINARY_READERS: dict[str, tuple[str, Callable[[], bytes], Callable[[Path], object]]] = {
    "recording": ("x.wav", _wav, read_wav),
    "log": ("x.npz", _log, lambda path: read_log(path, Robot.load())),
    "shell": ("x.npz", (CONFIGS / "robots" / "upper22.npz").read_bytes, read_shell),
    "stl": (
        "x.stl",
        lambda: bytes(80) + (1).to_bytes(4, "little") + bytes(50),
        lambda path: read_mesh(path, folder=path.parent),
    ),
    "obj": (
        "x.obj",
        lambda: b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf -1 -2 -3\n",
        lambda path: read_mesh(path, folder=path.parent),
    ),
    "toml": ("x.toml", lambda: b'[robot]\nname = "x"\nextends = "upper22"\n', Robot.load),
    "json": (
        "x.json",
        lambda: b'{"id":"b","gesture":[{"id":"g","lexeme":"beat","start":"0.2"}]}',
        lambda path: parse(path.read_bytes()),
    ),
    "mjcf": (
        "x.xml",
        lambda: b'<mujoco><worldbody><body><joint name="j"/><geom size="1"/></body></worldbody></mujoco>',
        load_robot_tree,
    ),
    "greta": ("x.xml", lambda: GRETA_XML, read_lexicon),
}


@pytest.mark.parametrize("kind", BINARY_READERS)
@given(seed=st.integers(0, 2**32 - 1))
@examples(200)
def test_damaged_binary_files_are_read_or_refused_without_a_crash(kind: str, seed: int):
    name, valid, read = BINARY_READERS[kind]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(damaged(valid(), random.Random(seed)))
        refuses_or_reads(read, path)


ODD_ARRAYS: tuple[object, ...] = (
    np.array(1.0), np.array("x"), np.array(["x"]), np.array([1.0, np.nan]), np.zeros((0, 0)), np.zeros((2, 2, 2)),
    np.array([1 + 2j]), np.array([b"x"]), np.array(["2020-01-01"], dtype="datetime64[D]"), np.zeros(3, dtype="i4,f8"),
    np.array([True, False]), np.zeros(5, dtype=np.uint8), np.full((3, 3), 1e300), np.zeros((1, 3)), np.array(-1),
)  # fmt: skip


def entries(data: bytes) -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        return dict(file)


@pytest.mark.parametrize("kind", ["log", "shell"])
@given(seed=st.integers(0, 2**32 - 1))
@examples(200)
def test_npz_files_with_altered_arrays_are_read_or_refused(kind: str, seed: int):
    name, valid, read = BINARY_READERS[kind]
    choose, arrays = random.Random(seed), dict(entries(valid()))
    for _ in range(choose.choice((1, 1, 2))):
        key = choose.choice(list(arrays))
        arrays[key] = choose.choice(ODD_ARRAYS)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(_arrays(**arrays))
        refuses_or_reads(read, path)


def repacked(data: bytes, name: str, shape: bytes) -> bytes:
    """Return the archive with another declared shape for one array."""
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(stream, "w") as new:
        for entry in old.infolist():
            array = bytearray(old.read(entry))
            if entry.filename == name:
                at, end = array.index(b"'shape': ") + 9, array.index(b"), }") + 1
                array[at : at + len(shape)] = shape
                assert end - at <= len(shape) < 60
                array[at + len(shape) : at + len(shape) + 3] = b", }"
            new.writestr(entry.filename, bytes(array))
    return stream.getvalue()


@pytest.mark.parametrize("kind", ["log", "shell"])
@pytest.mark.parametrize("damage", ["encrypted", "method", "huge"])
def test_corrupt_npz_archives_are_refused(kind: str, damage: str, tmp_path: Path):
    name, valid, read = BINARY_READERS[kind]
    data = bytearray(valid())
    flag = {"encrypted": (6, 8, 1), "method": (8, 10, 99)}
    with zipfile.ZipFile(io.BytesIO(bytes(data))) as archive:
        first = archive.infolist()[0]
    if damage == "huge":
        data = bytearray(repacked(valid(), first.filename, b"(99999999999999,)"))
    else:
        near, far, value = flag[damage]
        data[first.header_offset + near] = value
        data[data.index(b"PK\1\2") + far] = value
    (tmp_path / name).write_bytes(bytes(data))
    with pytest.raises(ConfigError):
        read(tmp_path / name)
