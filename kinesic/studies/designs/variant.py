"""Variants of a robot's file: bodies of another length, hinges with another servo or reduction."""

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

FEATURES = ("length", "servo", "reduction")
FULL_TURN = 360.0  # [deg] of a servo
FORM = "WHAT.FEATURE=A,B,..., such as l_shoulder.length=0.20,0.22 or *_elbow_flexion.servo=xm430_w210,xc430_w240"

Design = tuple[tuple[str, str], ...]  # (variable, value) of what differs; empty: the robot as it is


@dataclass(frozen=True)
class Variable:
    """What is varied: a feature of a body or of hinges, and the values that it takes."""

    name: str  # WHAT.FEATURE
    values: tuple[str, ...]

    @classmethod
    def parse(cls, text: str) -> "Variable":
        """Reads WHAT.FEATURE=A,B,...

        Raises:
            ConfigError: it is not of that form.
        """
        name, _, values = text.partition("=")
        found = tuple(dict.fromkeys(value.strip() for value in values.split(",") if value.strip()))
        _, _, feature = name.rpartition(".")
        if not found or "." not in name:
            raise ConfigError(f"--vary {text}: write {FORM}")
        if feature not in FEATURES:
            raise ConfigError(f"--vary {text}: no {feature}{suggestion(feature, list(FEATURES))}; write {FORM}")
        return cls(name.strip(), found)


def draw_designs(variables: Sequence[Variable], count: int, *, seed: int = 0) -> list[Design]:
    """Draws different designs at random from all combinations; all of them in order where they are no more.

    Args:
        variables: each with its values.
        count: of designs, at most.
        seed: the same seed draws the same ones.
    """
    total = prod(len(variable.values) for variable in variables)
    if total <= count:
        values = product(*(variable.values for variable in variables))
        return [tuple(zip((variable.name for variable in variables), chosen, strict=True)) for chosen in values]
    random, found = np.random.default_rng(seed), dict[Design, None]()
    while len(found) < count:
        chosen = [variable.values[int(random.integers(len(variable.values)))] for variable in variables]
        found[tuple((variable.name, value) for variable, value in zip(variables, chosen, strict=True))] = None
    return list(found)


def build(file: RobotFile, design: Design, path: Path) -> Robot:
    """Makes the robot of a design.

    Args:
        file: of the robot that is varied.
        design: what differs.
        path: of that file, for messages.

    Raises:
        ConfigError: it cannot be built; says why.
    """
    varied = apply_design(file, design, path)
    for hinge in varied.hinge:
        turned = (hinge.range_deg[1] - hinge.range_deg[0]) * hinge.reduction
        if turned > FULL_TURN:
            raise ConfigError(
                f"{hinge.name} turns its servo by {turned:.0f} degrees, and one turn is {FULL_TURN:.0f}; "
                f"a reduction of {FULL_TURN / (turned / hinge.reduction):.2g} is the most"
            )
    return Robot.of(robot_from_tables(varied, path))


def apply_design(file: RobotFile, design: Design, path: Path) -> RobotFile:
    """Changes a robot's file as a design says; a side that is mirrored follows.

    Raises:
        ConfigError: there is no such body or hinge, or a value is none.
    """
    for name, value in design:
        what, _, feature = name.rpartition(".")
        if feature == "length":
            file = _stretched(file, what, _number(value, name), path)
        else:
            file = msgspec.structs.replace(file, hinge=_redriven(file.hinge, what, feature, value, path))
    return file


def without_defaults(file: RobotFile, design: Design, path: Path) -> Design:
    """Leaves out of a design what the robot has anyway.

    Raises:
        ConfigError: as `apply_design`.
    """
    return tuple(change for change in design if apply_design(file, (change,), path) != file)


def _redriven(hinges: list[HingeTable], pattern: str, feature: str, value: str, path: Path) -> list[HingeTable]:
    """Gives all hinges whose names match another servo or reduction."""
    chosen = [hinge.name for hinge in hinges if fnmatchcase(hinge.name, pattern)]
    if not chosen:
        raise ConfigError(f"{path}: no hinge {pattern}{suggestion(pattern, [hinge.name for hinge in hinges])}")
    given = value if feature == "servo" else _number(value, f"{pattern}.{feature}")
    changed: list[HingeTable] = []
    for hinge in hinges:
        if hinge.name in chosen and hinge.servo is None:
            raise ConfigError(f"{path}: hinge {hinge.name} has limits and no servo, and {feature} is of a servo")
        changed.append(msgspec.structs.replace(hinge, **{feature: given}) if hinge.name in chosen else hinge)
    return changed


def _stretched(file: RobotFile, name: str, length: float, path: Path) -> RobotFile:
    """Gives a body another length, from its origin to that of the next one: all that it carries goes along with it.

    Its structure weighs as much more as it is longer; servos weigh what they do.
    """
    end = body_end(file, name, path)
    along, factor = end / np.linalg.norm(end), length / float(np.linalg.norm(end))

    def moved(place: Triple) -> Triple:
        shift = (factor - 1.0) * float(along @ np.array(place)) * along
        x, y, z = (round(float(value), 6) for value in np.array(place) + shift)
        return (x, y, z)

    return msgspec.structs.replace(
        file,
        body=[_body(body, name, moved, factor) for body in file.body],
        hinge=[_hinge(hinge, name, moved) for hinge in file.hinge],
        sites={
            key: msgspec.structs.replace(site, at=moved(site.at)) if site.body == name else site
            for key, site in file.sites.items()
        },
    )


def body_end(file: RobotFile, name: str, path: Path) -> Floats:
    """Finds (3,) [m] where a body ends: the origin of the only one that it carries, or its site.

    Raises:
        ConfigError: there is no such body, or it branches, and so has no length.
    """
    known = [body.name for body in file.body]
    if name not in known:
        raise ConfigError(f"{path}: no body {name}{suggestion(name, known)}")
    ends = [body.pos for body in file.body if body.parent == name]
    ends = ends or [site.at for site in file.sites.values() if site.body == name]
    if len(ends) != 1 or not any(ends[0]):
        alone = [body.name for body in file.body if sum(other.parent == body.name for other in file.body) == 1]
        raise ConfigError(f"{path}: body {name} carries {len(ends)} others and has no length; {', '.join(alone)} have")
    return np.array(ends[0])


def _body(body: BodyTable, name: str, moved: Callable[[Triple], Triple], factor: float) -> BodyTable:
    if body.parent == name:
        return msgspec.structs.replace(body, pos=moved(body.pos))
    if body.name != name:
        return body
    capsules = [msgspec.structs.replace(c, start=moved(c.start), end=moved(c.end)) for c in body.capsules]
    return msgspec.structs.replace(body, mass=round(body.mass * factor, 6), capsules=capsules)


def _hinge(hinge: HingeTable, name: str, moved: Callable[[Triple], Triple]) -> HingeTable:
    at = moved(hinge.at) if hinge.body == name else hinge.at
    mount = hinge.mount
    if mount is not None and mount.body == name:
        mount = msgspec.structs.replace(mount, at=moved(mount.at))
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
    """Writes a design as a robot's file that extends another and says only what differs.

    Args:
        file: of the robot that is varied.
        design: what differs.
        name: of the new robot.
        extends: name of the robot that is varied, or of its file in the folder of the new one.
        heading: lines of the comment at its top.
    """
    varied = apply_design(file, design, Path(extends))
    return changes_text(
        [new for old, new in zip(file.body, varied.body, strict=True) if new != old],
        [new for old, new in zip(file.hinge, varied.hinge, strict=True) if new != old],
        {key: site for key, site in varied.sites.items() if site != file.sites[key]},
        robot={"name": name, "extends": extends},
        heading=heading,
    )
