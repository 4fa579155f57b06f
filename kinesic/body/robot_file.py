"""From a robot's TOML to its description: the mirrored half is made, and every name is checked."""

from collections.abc import Callable, Mapping
from math import radians
from pathlib import Path
from typing import TypeVar

import msgspec
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.calibration import NONE, Calibration, narrow_ranges, read_calibration
from kinesic.body.config import CONFIGS, ConfigError, read_toml, suggestion
from kinesic.body.description import Description, Exclusion, Mount, Site, Supply
from kinesic.body.muscle import muscle
from kinesic.body.robot_schema import (
    BodyTable,
    CapsuleTable,
    HingeTable,
    MirrorTable,
    MountTable,
    RobotFile,
    ServoTable,
    SiteTable,
    Triple,
)
from kinesic.body.servo import Drive, ServoModel
from kinesic.body.skeleton import Capsule, Hinge, Segment, Skeleton

Table = TypeVar("Table", BodyTable, HingeTable)
Value = TypeVar("Value")


def servo_models() -> dict[str, ServoModel]:
    """Reads all servo models of `configs/servos.toml`, by name."""
    return _models(read_toml(CONFIGS / "servos.toml", dict[str, ServoTable]))


def _models(tables: Mapping[str, ServoTable]) -> dict[str, ServoModel]:
    return {name: ServoModel(name=name, **msgspec.structs.asdict(table)) for name, table in tables.items()}


def read_description(path: Path, *, calibrated: bool = True) -> Description:
    """Reads a robot's description.

    Args:
        path: of its file.
        calibrated: with its calibration laid over it, if there is one.

    Raises:
        ConfigError: a file is missing or wrong.
    """
    file = read_toml(path, RobotFile)
    _check_size(path, file)
    return robot_from_tables(file, path, read_calibration(path, file.robot.name) if calibrated else NONE)


def _check_size(path: Path, file: RobotFile) -> None:
    """Refuses more than any robot has, which would keep the machine busy for hours."""
    capsules = sum(len(body.capsules) for body in file.body)
    counts = (("bodies", len(file.body), 500), ("hinges", len(file.hinge), 200), ("capsules", capsules, 5000))
    for what, count, most in counts:
        if count > most:
            raise ConfigError(f"{path}: {count} {what}, at most {most} are taken")


def robot_from_tables(file: RobotFile, path: Path, calibration: Calibration = NONE) -> Description:
    """Makes a robot's description of its tables.

    Args:
        file: as it is written.
        path: where, for messages.
        calibration: laid over it.

    Raises:
        ConfigError: the tables do not fit one another.
    """
    file = _with_both_sides(file)
    models = servo_models() | _models(file.servos)  # the robot's own servos win
    _check(path, file, list(models))
    file = msgspec.structs.replace(file, hinge=narrow_ranges(file.hinge, calibration, path))
    _check(path, file, list(models))
    order = [body.name for body in file.body]
    hinges = sorted(file.hinge, key=lambda hinge: order.index(hinge.body))
    return Description(
        name=file.robot.name,
        path=path,
        skeleton=Skeleton(
            segments=tuple(_segment(body) for body in file.body),
            hinges=tuple(_hinge(hinge, radians(file.rest.get(hinge.name, 0.0))) for hinge in hinges),
        ),
        mounts=tuple(_mount(hinge, models) for hinge in hinges),
        chains={name: tuple(bodies) for name, bodies in file.chains.items()},
        sites={name: Site(site.body, sealed(site.at), sealed(site.facing)) for name, site in file.sites.items()},
        exclusions=tuple(Exclusion(frozenset(entry.pair), entry.why) for entry in file.collision.exclude),
        least_clearance=file.collision.clearance,
        targets={name: sealed(position) for name, position in file.targets.items()},
        supply=None if file.supply is None else Supply(file.supply.volts, file.supply.amps),
        calibration=calibration,
    )


def _segment(body: BodyTable) -> Segment:
    capsules = tuple(Capsule(sealed(c.start), sealed(c.end), c.radius) for c in body.capsules)
    parent = None if body.parent == "world" else body.parent
    return Segment(body.name, parent, sealed(body.pos), body.mass, capsules)


def _hinge(hinge: HingeTable, rest: float) -> Hinge:
    axis = np.array(hinge.axis) / np.linalg.norm(hinge.axis)
    lower, upper = (radians(limit) for limit in hinge.range_deg)
    return Hinge(hinge.name, hinge.body, sealed(axis), lower, upper, rest, sealed(hinge.at))


def _mount(hinge: HingeTable, models: Mapping[str, ServoModel]) -> Mount:
    """Its servo where it is mounted; without one, what its limits make of it, which weighs nothing."""
    if hinge.limits is not None:
        limits = hinge.limits
        speed, acceleration = radians(limits.speed_deg), radians(limits.acceleration_deg)
        drive = muscle(speed=speed, acceleration=acceleration, torque=limits.torque)
        return Mount(drive, hinge.body, sealed(hinge.at))
    assert hinge.servo is not None  # `_check_drive` has seen to it
    assert hinge.mount is not None
    drive = Drive(models[hinge.servo], hinge.count, hinge.reduction)
    return Mount(drive, hinge.mount.body, sealed(hinge.mount.at))


def _with_both_sides(file: RobotFile) -> RobotFile:
    mirror = file.robot.mirror
    if mirror is None:
        return file
    return msgspec.structs.replace(
        file,
        body=_doubled(file.body, mirror, _mirrored_body),
        hinge=_doubled(file.hinge, mirror, _mirrored_hinge),
        chains=_both(file.chains, mirror, lambda names: [_renamed(name, mirror) for name in names]),
        sites=_both(file.sites, mirror, lambda site: _mirrored_site(site, mirror)),
        rest=_both(file.rest, mirror, lambda degrees: degrees),
        collision=msgspec.structs.replace(
            file.collision,
            exclude=[
                msgspec.structs.replace(entry, pair=pair)
                for entry in file.collision.exclude
                for pair in _both_pairs(entry.pair, mirror)
            ],
        ),
    )


def _doubled(tables: list[Table], mirror: MirrorTable, mirrored: Callable[[Table, MirrorTable], Table]) -> list[Table]:
    """The tables, then the mirror images of those on the described side."""
    return tables + [mirrored(table, mirror) for table in tables if table.name.startswith(mirror.source)]


def _both(table: dict[str, Value], mirror: MirrorTable, mirrored: Callable[[Value], Value]) -> dict[str, Value]:
    images = {_renamed(key, mirror): mirrored(value) for key, value in table.items() if key.startswith(mirror.source)}
    return table | images | table  # the described side first; what is written out wins


def _both_pairs(pair: tuple[str, str], mirror: MirrorTable) -> list[tuple[str, str]]:
    image = (_swapped(pair[0], mirror), _swapped(pair[1], mirror))
    return [pair] if set(image) == set(pair) else [pair, image]


def _mirrored_body(body: BodyTable, mirror: MirrorTable) -> BodyTable:
    return BodyTable(
        name=_renamed(body.name, mirror),
        parent=_renamed(body.parent, mirror),
        pos=_flipped(body.pos),
        mass=body.mass,
        capsules=[CapsuleTable(_flipped(c.start), _flipped(c.end), c.radius) for c in body.capsules],
    )


def _mirrored_hinge(hinge: HingeTable, mirror: MirrorTable) -> HingeTable:
    x, y, z = hinge.axis
    return msgspec.structs.replace(
        hinge,
        name=_renamed(hinge.name, mirror),
        body=_renamed(hinge.body, mirror),
        axis=(-x, y, -z),  # so that equal angles are mirror postures
        at=_flipped(hinge.at),
        mount=None if hinge.mount is None else MountTable(_renamed(hinge.mount.body, mirror), _flipped(hinge.mount.at)),
    )


def _mirrored_site(site: SiteTable, mirror: MirrorTable) -> SiteTable:
    return SiteTable(_renamed(site.body, mirror), _flipped(site.at), _flipped(site.facing))


def _flipped(point: Triple) -> Triple:
    return (point[0], -point[1], point[2])


def _renamed(name: str, mirror: MirrorTable) -> str:
    return mirror.target + name.removeprefix(mirror.source) if name.startswith(mirror.source) else name


def _swapped(name: str, mirror: MirrorTable) -> str:
    """The name on the other side, whichever side it is on."""
    if name.startswith(mirror.target):
        return mirror.source + name.removeprefix(mirror.target)
    return _renamed(name, mirror)


def _check(path: Path, file: RobotFile, servos: list[str]) -> None:
    """Refuses what the schema cannot: names that exist nowhere, twice, or in the wrong order, and empty ranges."""
    bodies: list[str] = []
    for body in file.body:
        _unique(path, "body", body.name, bodies)
        if body.parent != "world":
            _known(path, f"parent of body {body.name}", body.parent, bodies)
        bodies.append(body.name)
    hinges: list[str] = []
    for hinge in file.hinge:
        _unique(path, "hinge", hinge.name, hinges)
        _known(path, f"body of hinge {hinge.name}", hinge.body, bodies)
        _check_drive(path, hinge, bodies, servos)
        _check_figures(path, hinge, file.rest.get(hinge.name, 0.0))
        hinges.append(hinge.name)
    _check_alike(path, file)
    for name, members in file.chains.items():
        for body_name in members:
            _known(path, f"chain {name}", body_name, bodies)
    for name, site in file.sites.items():
        _known(path, f"site {name}", site.body, bodies)
    for name in file.rest:
        _known(path, "[rest]", name, hinges)
    for entry in file.collision.exclude:
        for body_name in entry.pair:
            _known(path, "[collision] exclude", body_name, bodies)
    for chain in ("l_arm", "r_arm"):
        _known(path, "[chains] needs", chain, list(file.chains))
    for site_name in ("l_palm", "r_palm"):
        _known(path, "[sites] needs", site_name, list(file.sites))


def _check_drive(path: Path, hinge: HingeTable, bodies: list[str], servos: list[str]) -> None:
    """Refuses a hinge that nothing turns, or two things do."""
    if hinge.limits is None:
        if hinge.servo is None or hinge.mount is None:
            raise ConfigError(f"{path}: hinge {hinge.name}: give servo and mount, or limits where no servo turns it")
        _known(path, f"mount of hinge {hinge.name}", hinge.mount.body, bodies)
        _known(path, f"servo of hinge {hinge.name}", hinge.servo, servos)
        return
    unfit = [key for key in ("servo", "mount") if getattr(hinge, key) is not None]
    unfit += [key for key in ("count", "reduction") if getattr(hinge, key) != 1]
    if unfit:
        raise ConfigError(f"{path}: hinge {hinge.name} has limits and {unfit[0]}: limits are for hinges without servo")
    for key, value in msgspec.structs.asdict(hinge.limits).items():
        if value <= 0:
            raise ConfigError(f"{path}: hinge {hinge.name}: limits.{key} is {value:g}, must be above 0")


def _check_alike(path: Path, file: RobotFile) -> None:
    """Refuses a robot of which only a part has servos."""
    without = [hinge.name for hinge in file.hinge if hinge.limits is not None]
    if without and (driven := [hinge.name for hinge in file.hinge if hinge.servo is not None]):
        raise ConfigError(
            f"{path}: {driven[0]} has a servo and {without[0]} has limits: give all hinges servos, or none of them"
        )
    if without and file.bus:
        raise ConfigError(f"{path}: [[bus]], but no hinge has a servo: remove it, or give servos instead of limits")


def _check_figures(path: Path, hinge: HingeTable, rest: float) -> None:
    lower, upper = hinge.range_deg
    if not lower < upper:
        raise ConfigError(f"{path}: hinge {hinge.name}: range_deg is [{lower}, {upper}], must be [low, high]")
    if not lower <= rest <= upper:
        raise ConfigError(f"{path}: [rest] {hinge.name} is {rest} deg, outside [{lower}, {upper}]")
    if not any(hinge.axis):
        raise ConfigError(f"{path}: hinge {hinge.name}: axis is zero, must be a direction")
    if hinge.count < 1 or hinge.reduction <= 0:
        raise ConfigError(f"{path}: hinge {hinge.name}: count must be at least 1 and reduction above 0")


def _unique(path: Path, kind: str, name: str, known: list[str]) -> None:
    if name in known:
        raise ConfigError(f"{path}: {kind} {name} is described twice")


def _known(path: Path, where: str, name: str, known: list[str]) -> None:
    if name not in known:
        raise ConfigError(f"{path}: {where}: no {name}{suggestion(name, known)}")
