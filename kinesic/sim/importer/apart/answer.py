"""Result of an import as plain data: TOML text, shell and notes."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec
import numpy as np

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.robot_schema import robot_text
from kinesic.files.unicode_text import escape_surrogates
from kinesic.sim.importer.apart.imported import Answer, ImportedRobot, Refusal
from kinesic.sim.importer.convert import REVIEW_CONFIDENCE, Mapped, import_humanoid
from kinesic.sim.importer.shell import build_imported_shell
from kinesic.sim.shells.shell import write_shell


def answer_import(path: Path, wished: Sequence[str] = ()) -> bytes:
    """Import a robot and return an `Answer` as MessagePack."""
    answer: Answer
    try:
        answer = _import(path, wished)
    except ConfigError as error:
        answer = Refusal(escape_surrogates(str(error)))
    except MemoryError:
        name = escape_surrogates(str(path))
        answer = Refusal(f"{name}: its import takes more memory than any robot needs; simplify its meshes")
    return msgspec.msgpack.encode(answer)


def _import(path: Path, wished: Sequence[str]) -> ImportedRobot:
    mapped = import_humanoid(path, wished)
    doubt = _describe_doubt(mapped) if mapped.doubtful else ""
    heading = _write_heading(mapped, escape_surrogates(path.name), doubt)
    text = robot_text(mapped.file, heading=heading, remarks=mapped.remarks)
    with TemporaryDirectory(dir=".") as folder:
        toml, mesh = Path(folder) / "robot.toml", Path(folder) / "robot.npz"
        toml.write_text(text, encoding="utf-8")
        shell = build_imported_shell(mapped, Robot.load(toml))
        if shell is not None:
            write_shell(shell, mesh)
        packed = b"" if shell is None else mesh.read_bytes()
    left_out = mapped.figure.tree.left_out
    imported = mapped.file.robot.imported
    review = tuple(note for note in imported.review if note not in left_out) if imported is not None else ()
    return ImportedRobot(text, _list_mapping(mapped), packed, mapped.confidence, review, left_out, doubt)


def _list_mapping(mapped: Mapped) -> tuple[tuple[str, str, str, str], ...]:
    """Return rows of hinge, file's joint, range and rest [deg], without fingers."""
    rows = []
    for hinge in mapped.hinges:
        low, high = np.degrees([hinge.lower, hinge.upper]).round() + 0.0  # no -0
        rest = mapped.file.rest.get(hinge.name, 0.0) + 0.0
        ranges = f"{low:.0f}..{high:.0f}{' assumed' if hinge.assumed else ''}"
        rows.append((hinge.name, mapped.figure.tree.joints[hinge.joint].name, ranges, f"{rest:.0f}"))
    return tuple(rows)


def _write_heading(mapped: Mapped, name: str, doubt: str) -> list[str]:
    return [
        *([f"REVIEW before it moves: {doubt}.", ""] if doubt else []),
        f"Mapped from {name} by `kinesic robots import`; confidence {mapped.confidence:.2f} of 1. Edit freely.",
        "x forward, y left, z up; m, kg, deg, Nm. Zero pose: arms hanging, elbows straight. Beside each hinge: how the",
        "file's joint follows from its angle; at: where its axis passes its segment. Beside each servo: where its",
        "figures come from. Capsules are the file's own primitive shapes, or bones with a human's girth.",
    ]


def _describe_doubt(mapped: Mapped) -> str:
    return (
        f"confidence {mapped.confidence:.2f} is below {REVIEW_CONFIDENCE:g}, so shoulder, elbow or sides may be wrong"
    )
