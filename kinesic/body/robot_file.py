"""From a robot's TOML to its description: the mirrored half is made, and every name is checked."""

from collections.abc import Mapping, Sequence
from math import hypot, radians
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.calibration import NONE, Calibration, narrow_ranges, read_calibration
from kinesic.body.config import CONFIGS, ConfigError, read_toml, suggestion
from kinesic.body.description import Description, Exclusion, Mount, Site, Supply
from kinesic.body.muscle import muscle
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_mirror import with_both_sides
from kinesic.body.robot_schema import BodyTable, CouplingTable, HingeTable, RobotFile, ServoTable
from kinesic.body.servo import Drive, ServoModel
from kinesic.body.skeleton import Capsule, Coupling, Hinge, Segment, Skeleton

FINGERS = {"l_fingers", "r_fingers"}  # chains that count as one body for distances
MAX_AXIS_LENGTH = 1e6  # of an axis before it is scaled to 1, and the inverse of the smallest
SLACK = 1e-6  # [deg] by which a coupling may leave its range


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
    file = read_robot(path, RobotFile)
    _check_whole(path, file)
    return robot_from_tables(file, path, read_calibration(path, file.robot.name) if calibrated else NONE)


def _check_whole(path: Path, file: RobotFile) -> None:
    """Refuses more than any robot has, which would keep the machine busy for hours, and a clearance that is none."""
    capsules = sum(len(body.capsules) for body in file.body)
    counts = (
        ("bodies", len(file.body), 500),
        ("hinges", len(file.hinge) + len(file.coupling), 200),
        ("capsules", capsules, 5000),
    )
    for what, count, most in counts:
        if count > most:
            raise ConfigError(f"{path}: {count} {what}, at most {most} are taken")
    if file.collision.clearance < 0.0:
        what = f"{path}: [collision] clearance is {file.collision.clearance:g} m, and segments would meet"
        raise ConfigError(f"{what}; it must be 0 or more, such as 0.01")


def robot_from_tables(file: RobotFile, path: Path, calibration: Calibration = NONE) -> Description:
    """Makes a robot's description of its tables.

    Args:
        file: as it is written.
        path: where, for messages.
        calibration: laid over it.

    Raises:
        ConfigError: the tables do not fit one another.
    """
    file = with_both_sides(file)
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
            couplings=tuple(_coupling(coupling, [hinge.name for hinge in hinges]) for coupling in file.coupling),
        ),
        mounts=tuple(_mount(hinge, models) for hinge in hinges),
        chains={name: tuple(bodies) for name, bodies in file.chains.items()},
        sites={name: Site(site.body, sealed(site.at), sealed(site.facing)) for name, site in file.sites.items()},
        exclusions=tuple(Exclusion(frozenset(entry.pair), entry.why) for entry in file.collision.exclude),
        least_clearance=file.collision.clearance,
        targets={name: sealed(position) for name, position in file.targets.items()},
        skin=file.robot.skin,
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
    """Mounts a hinge's drive: its servo, or, where only limits are given, a weightless drive that keeps them."""
    if hinge.limits is not None:
        limits = hinge.limits
        speed, acceleration = radians(limits.speed_deg), radians(limits.acceleration_deg)
        drive = muscle(speed=speed, acceleration=acceleration, torque=limits.torque)
        return Mount(drive, hinge.body, sealed(hinge.at))
    assert hinge.servo is not None  # `_check_drive` has seen to it
    assert hinge.mount is not None
    drive = Drive(models[hinge.servo], hinge.count, hinge.reduction)
    return Mount(drive, hinge.mount.body, sealed(hinge.mount.at))


def _coupling(coupling: CouplingTable, hinges: list[str]) -> Coupling:
    axis = np.array(coupling.axis) / np.linalg.norm(coupling.axis)
    driver, offset = hinges.index(coupling.driver), radians(coupling.offset_deg)
    return Coupling(coupling.name, coupling.body, sealed(axis), driver, coupling.ratio, offset)


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
    _check_couplings(path, file, bodies, hinges)
    for name, members in file.chains.items():
        for body_name in members:
            _known(path, f"chain {name}", body_name, bodies)
    for name, site in file.sites.items():
        _known(path, f"site {name}", site.body, bodies)
    for name in file.rest:
        _known(path, "[rest]", name, hinges)
    for entry in file.collision.exclude:
        for body_name in entry.pair:
            _known(path, "[collision] exclude", body_name, [*bodies, *(FINGERS & file.chains.keys())])
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


def _check_couplings(path: Path, file: RobotFile, bodies: list[str], hinges: list[str]) -> None:
    """Refuses couplings that follow no hinge with a servo, or are led out of their range."""
    ranges = {hinge.name: hinge.range_deg for hinge in file.hinge}
    names: list[str] = []
    for coupling in file.coupling:
        _unique(path, "hinge", coupling.name, [*hinges, *names])
        names.append(coupling.name)
    for coupling in file.coupling:
        where = f"{path}: coupling {coupling.name}"
        _known(path, f"body of coupling {coupling.name}", coupling.body, bodies)
        if coupling.driver in names:
            own = " itself" if coupling.driver == coupling.name else f" {coupling.driver}, which follows another one"
            raise ConfigError(f"{where}: it follows{own}; name the hinge with the servo that moves both")
        _known(path, f"driver of coupling {coupling.name}", coupling.driver, hinges)
        _check_axis(where, coupling.axis)
        ends = [coupling.offset_deg + coupling.ratio * end for end in ranges[coupling.driver]]
        (least, most), (lower, upper) = (min(ends), max(ends)), coupling.range_deg
        if least < lower - SLACK or most > upper + SLACK:
            led = f"{coupling.driver} leads it to {least:g}..{most:g} deg"
            raise ConfigError(f"{where}: {led}, beyond its range_deg [{lower:g}, {upper:g}]; narrow the driver's")


def _check_figures(path: Path, hinge: HingeTable, rest: float) -> None:
    lower, upper = hinge.range_deg
    if not lower < upper:
        raise ConfigError(f"{path}: hinge {hinge.name}: range_deg is [{lower}, {upper}], must be [low, high]")
    if not lower <= rest <= upper:
        raise ConfigError(f"{path}: [rest] {hinge.name} is {rest} deg, outside [{lower}, {upper}]")
    _check_axis(f"{path}: hinge {hinge.name}", hinge.axis)
    if hinge.count < 1 or hinge.reduction <= 0:
        raise ConfigError(f"{path}: hinge {hinge.name}: count must be at least 1 and reduction above 0")


def _check_axis(where: str, axis: Sequence[float]) -> None:
    """Refuse an axis without a direction or a computable length."""
    if not any(axis):
        raise ConfigError(f"{where}: axis is zero, must be a direction")
    if not 1.0 / MAX_AXIS_LENGTH <= hypot(*axis) <= MAX_AXIS_LENGTH:
        raise ConfigError(f"{where}: axis is {list(axis)}, must be a direction such as [0, 0, 1]")


def _unique(path: Path, kind: str, name: str, known: list[str]) -> None:
    if name in known:
        raise ConfigError(f"{path}: {kind} {name} is described twice")


def _known(path: Path, where: str, name: str, known: list[str]) -> None:
    if name not in known:
        raise ConfigError(f"{path}: {where}: no {name}{suggestion(name, known)}")
