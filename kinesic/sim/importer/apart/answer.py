"""Answer an import with plain data: TOML text, shell and notes."""

from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec
import numpy as np

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.robot_schema import robot_text
from kinesic.sim.importer.apart.imported import Answer, ImportedRobot, Refusal
from kinesic.sim.importer.convert import REVIEW_BELOW, Mapped, import_humanoid
from kinesic.sim.importer.shell import own_shell
from kinesic.sim.shells.shell import write_shell


def answer_import(path: Path) -> bytes:
    """Return an `Answer` as MessagePack: the robot, or why it is refused."""
    answer: Answer
    try:
        answer = _import(path)
    except ConfigError as error:
        answer = Refusal(str(error))
    except MemoryError:
        answer = Refusal(f"{path}: its import takes more memory than any robot needs; simplify its meshes")
    return msgspec.msgpack.encode(answer)


def _import(path: Path) -> ImportedRobot:
    found = import_humanoid(path)
    doubt = _doubt(found) if found.doubtful else ""
    text = robot_text(found.file, heading=_heading(found, path.name, doubt), remarks=found.remarks)
    with TemporaryDirectory(dir=".") as folder:
        toml, mesh = Path(folder) / "robot.toml", Path(folder) / "robot.npz"
        toml.write_text(text, encoding="utf-8")
        shell = own_shell(found, Robot.load(toml, calibrated=False))
        if shell is not None:
            write_shell(shell, mesh)
        packed = b"" if shell is None else mesh.read_bytes()
    return ImportedRobot(text, _mapping(found), packed, found.figure.tree.left_out, doubt)


def _mapping(found: Mapped) -> tuple[tuple[str, str, str, str], ...]:
    """Tabulate which hinge of the file became which."""
    rows = []
    for hinge in found.hinges:
        low, high = np.degrees([hinge.lower, hinge.upper]).round() + 0.0  # no -0
        rest = found.file.rest.get(hinge.name, 0.0) + 0.0
        ranges = f"{low:.0f}..{high:.0f}{' assumed' if hinge.assumed else ''}"
        rows.append((hinge.name, found.figure.tree.joints[hinge.joint].name, ranges, f"{rest:.0f}"))
    return tuple(rows)


def _heading(found: Mapped, name: str, doubt: str) -> list[str]:
    return [
        *([f"REVIEW before it moves: {doubt}.", ""] if doubt else []),
        f"Mapped from {name} by `kinesic robots import`; confidence {found.confidence:.2f} of 1. Edit freely.",
        "x forward, y left, z up; m, kg, deg, Nm. Zero pose: arms hanging, elbows straight. Beside each hinge: how the",
        "file's joint follows from its angle; at: where its axis passes its segment. Beside each servo: where its",
        "figures come from. Capsules are the file's own primitive shapes, or bones with a human's girth.",
    ]


def _doubt(found: Mapped) -> str:
    return f"confidence {found.confidence:.2f} is below {REVIEW_BELOW:g}, so shoulder, elbow or sides may be wrong"
