"""Variants of a robot file: other body lengths, servos or reductions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import product
from math import isfinite, prod
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError, suggestion
from kinesic.body.robot import Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import BodyTable, HingeTable, RobotFile, Triple, changes_text

VARIED_FEATURES = ("length", "servo", "reduction")  # features of a robot that a design may change
SERVO_RANGE = 360.0  # [deg] rotation range of a servo
VARY_FORM = "WHAT.FEATURE=A,B,..., such as l_shoulder.length=0.20,0.22 or *_elbow_flexion.servo=xm430_w210,xc430_w240"

Design = tuple[tuple[str, str], ...]  # (variable, value) pairs that differ from the robot; empty: unchanged


@dataclass(frozen=True)
class Variable:
    """Design variable of a robot: a feature with the values to try."""

    name: str  # part and feature, such as `l_shoulder.length`
    values: tuple[str, ...]

    @classmethod
    def parse(cls, text: str) -> "Variable":
        """Parse a design variable such as `l_shoulder.length=0.20,0.22`.

        Raises:
            ConfigError: the text has another form.
        """
        name, _, values = text.partition("=")
        parsed = tuple(dict.fromkeys(value.strip() for value in values.split(",") if value.strip()))
        _, _, feature = name.rpartition(".")
        if not parsed or "." not in name:
            raise ConfigError(f"--vary {text}: write {VARY_FORM}")
        if feature not in VARIED_FEATURES:
            raise ConfigError(
                f"--vary {text}: no {feature}{suggestion(feature, list(VARIED_FEATURES))}; write {VARY_FORM}"
            )
        return cls(name.strip(), parsed)


def draw_designs(variables: Sequence[Variable], count: int, *, seed: int = 0) -> list[Design]:
    """Draw different robot designs at random from all combinations.

    If there are at most `count` combinations, all are returned in order.

    Args:
        variables: variables with their values.
        count: maximum number of designs.
        seed: seed of the draw.
    """
    total = prod(len(variable.values) for variable in variables)
    if total <= count:
        values = product(*(variable.values for variable in variables))
        return [tuple(zip((variable.name for variable in variables), matching, strict=True)) for matching in values]
    random, parsed = np.random.default_rng(seed), dict[Design, None]()
    while len(parsed) < count:
        matching = [variable.values[int(random.integers(len(variable.values)))] for variable in variables]
        parsed[tuple((variable.name, value) for variable, value in zip(variables, matching, strict=True))] = None
    return list(parsed)


def build(file: RobotFile, design: Design, path: Path) -> Robot:
    """Build the robot model of a design variant.

    Args:
        file: file of the varied robot.
        design: changes.
        path: path of that file, for messages.

    Raises:
        ConfigError: the design cannot be built; the text gives the reason.
    """
    varied = apply_design(file, design, path)
    for hinge in varied.hinge:
        turned = (hinge.range_deg[1] - hinge.range_deg[0]) * hinge.reduction
        if turned > SERVO_RANGE:
            raise ConfigError(
                f"{hinge.name} turns its servo by {turned:.0f} degrees, more than one turn of {SERVO_RANGE:.0f}; "
                f"the maximum reduction is {SERVO_RANGE / (turned / hinge.reduction):.2g}"
            )
    return Robot.of(robot_from_tables(varied, path))


def apply_design(file: RobotFile, design: Design, path: Path) -> RobotFile:
    """Return a robot file with the changes of a design.

    The mirrored right side changes alike.

    Raises:
        ConfigError: a body or joint does not exist, or a value is invalid.
    """
    for name, value in design:
        target, _, feature = name.rpartition(".")
        if feature == "length":
            file = _change_length(file, target, _number(value, name), path)
        else:
            file = msgspec.structs.replace(file, hinge=_change_drive(file.hinge, target, feature, value, path))
    return file


def without_defaults(file: RobotFile, design: Design, path: Path) -> Design:
    """Drop the design changes that equal the robot's own values.

    Raises:
        ConfigError: see `apply_design`.
    """
    return tuple(change for change in design if apply_design(file, (change,), path) != file)


def _change_drive(hinges: list[HingeTable], pattern: str, feature: str, value: str, path: Path) -> list[HingeTable]:
    """Replace servo or reduction of all joints whose names match a pattern."""
    matching = [hinge.name for hinge in hinges if fnmatchcase(hinge.name, pattern)]
    if not matching:
        raise ConfigError(f"{path}: no hinge {pattern}{suggestion(pattern, [hinge.name for hinge in hinges])}")
    given = value if feature == "servo" else _number(value, f"{pattern}.{feature}")
    changed: list[HingeTable] = []
    for hinge in hinges:
        if hinge.name in matching and hinge.servo is None:
            raise ConfigError(f"{path}: hinge {hinge.name} has limits but no servo, which {feature} requires")
        changed.append(msgspec.structs.replace(hinge, **{feature: given}) if hinge.name in matching else hinge)
    return changed


def _change_length(file: RobotFile, name: str, length: float, path: Path) -> RobotFile:
    """Change the length of a body, measured to the next body.

    Everything attached moves in proportion. The structure's mass scales with the length, while servos keep their mass.
    """
    end = body_end(file, name, path)
    along, factor = end / np.linalg.norm(end), length / float(np.linalg.norm(end))

    def move(point: Triple) -> Triple:
        shift = (factor - 1.0) * float(along @ np.array(point)) * along
        x, y, z = (round(float(value), 6) for value in np.array(point) + shift)
        return (x, y, z)

    return msgspec.structs.replace(
        file,
        body=[_body(body, name, move, factor) for body in file.body],
        hinge=[_hinge(hinge, name, move) for hinge in file.hinge],
        sites={
            key: msgspec.structs.replace(site, at=move(site.at)) if site.body == name else site
            for key, site in file.sites.items()
        },
    )


def body_end(file: RobotFile, name: str, path: Path) -> Floats:
    """Return the end point of a body (3,) [m].

    It is the origin of its only child, or else its site, in the body's frame.

    Raises:
        ConfigError: the body does not exist, or it branches and has no length.
    """
    names = [body.name for body in file.body]
    if name not in names:
        raise ConfigError(f"{path}: no body {name}{suggestion(name, names)}")
    ends = [body.pos for body in file.body if body.parent == name]
    ends = ends or [site.at for site in file.sites.values() if site.body == name]
    if len(ends) != 1 or not any(ends[0]):
        with_length = [body.name for body in file.body if sum(other.parent == body.name for other in file.body) == 1]
        raise ConfigError(
            f"{path}: body {name} carries {len(ends)} others and has no length; "
            f"bodies with a length: {', '.join(with_length)}"
        )
    return np.array(ends[0])


def _body(body: BodyTable, name: str, move: Callable[[Triple], Triple], factor: float) -> BodyTable:
    if body.parent == name:
        return msgspec.structs.replace(body, pos=move(body.pos))
    if body.name != name:
        return body
    capsules = [msgspec.structs.replace(c, start=move(c.start), end=move(c.end)) for c in body.capsules]
    return msgspec.structs.replace(body, mass=round(body.mass * factor, 6), capsules=capsules)


def _hinge(hinge: HingeTable, name: str, move: Callable[[Triple], Triple]) -> HingeTable:
    at = move(hinge.at) if hinge.body == name else hinge.at
    mount = hinge.mount
    if mount is not None and mount.body == name:
        mount = msgspec.structs.replace(mount, at=move(mount.at))
    return msgspec.structs.replace(hinge, at=at, mount=mount)


def _number(text: str, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value) or value <= 0.0:
        raise ConfigError(f"--vary {name}: {text} must be a number above 0, such as 0.2")
    return value


def write_design(file: RobotFile, design: Design, *, name: str, extends: str, heading: Sequence[str]) -> str:
    """Return the text of a robot file that contains a design's changes.

    Args:
        file: file of the varied robot.
        design: changes.
        name: name of the new robot.
        extends: name of the varied robot, or of its file in the folder of the new one.
        heading: lines of the comment at the top.
    """
    varied = apply_design(file, design, Path(extends))
    return changes_text(
        [new for old, new in zip(file.body, varied.body, strict=True) if new != old],
        [new for old, new in zip(file.hinge, varied.hinge, strict=True) if new != old],
        {key: site for key, site in varied.sites.items() if site != file.sites[key]},
        robot={"name": name, "extends": extends},
        heading=heading,
    )
