"""Reading and checking of a robot's TOML file."""

from collections.abc import Mapping, Sequence
from math import hypot, radians
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.absent_arm import ARM_CHAINS, with_absent_arm
from kinesic.body.arrays import sealed
from kinesic.body.calibration import NO_CALIBRATION, Calibration, narrow_ranges, read_calibration
from kinesic.body.config import CONFIGS, ConfigError, check_inside, read_toml, suggestion
from kinesic.body.description import Description, Exclusion, Mount, Site, Supply
from kinesic.body.muscle import make_muscle
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_mirror import with_both_sides
from kinesic.body.robot_schema import BodyTable, CouplingTable, HingeTable, RobotFile, ServoTable, SourceTable
from kinesic.body.servo import Drive, ServoModel
from kinesic.body.skeleton import Capsule, Coupling, Hinge, Segment, Skeleton
from kinesic.body.source_joints import SourceJoint

FINGER_CHAINS = {"l_fingers", "r_fingers"}  # Names of chains whose segments form one body in collision checks
MAX_AXIS_LENGTH = 1e6  # Largest accepted length of an axis in the file; the smallest is its inverse
RANGE_TOLERANCE = 1e-6  # [deg] accepted excess of a coupled rotation over its range


def servo_models() -> dict[str, ServoModel]:
    """Read all servo models of `configs/servos.toml`, by name."""
    return _models(read_toml(CONFIGS / "servos.toml", dict[str, ServoTable]))


def _models(tables: Mapping[str, ServoTable]) -> dict[str, ServoModel]:
    return {name: ServoModel(name=name, **msgspec.structs.asdict(table)) for name, table in tables.items()}


def read_description(path: Path, *, calibrated: bool = True) -> Description:
    """Read a robot's description from its file.

    Args:
        path: path of the file.
        calibrated: apply the robot's calibration, if there is one.

    Raises:
        ConfigError: a file is missing or invalid.
    """
    file = read_robot(path, RobotFile)
    _check_size(path, file)
    return robot_from_tables(file, path, read_calibration(path, file.robot.name) if calibrated else NO_CALIBRATION)


def _check_size(path: Path, file: RobotFile) -> None:
    """Raise an error for excessive bodies, hinges or capsules, or negative clearance.

    A file with too many of them would keep the machine busy for hours.
    """
    capsules = sum(len(body.capsules) for body in file.body)
    counts = (
        ("bodies", len(file.body), 500),
        ("hinges", len(file.hinge) + len(file.coupling), 200),
        ("capsules", capsules, 5000),
    )
    for what, count, max_count in counts:
        if count > max_count:
            raise ConfigError(f"{path}: {count} {what}, at most {max_count} are allowed")
    if file.collision.clearance < 0.0:
        what = f"{path}: [collision] clearance is {file.collision.clearance:g} m, and segments would touch"
        raise ConfigError(f"{what}; it must be 0 or more, such as 0.01")


def robot_from_tables(file: RobotFile, path: Path, calibration: Calibration = NO_CALIBRATION) -> Description:
    """Make a robot's description from its parsed tables.

    Args:
        file: the tables.
        path: path of the file, for messages.
        calibration: measured values that override the file.

    Raises:
        ConfigError: the tables contradict one another.
    """
    file = with_absent_arm(with_both_sides(file))
    models = servo_models() | _models(file.servos)  # servos of the robot's file override
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
        min_clearance=file.collision.clearance,
        contact_distance=file.collision.contact,
        targets={name: sealed(position) for name, position in file.targets.items()},
        skin=file.robot.skin,
        supply=None if file.supply is None else Supply(file.supply.volts, file.supply.amps),
        audience="nobody" if file.audience is None else file.audience.near,
        impact_limits=_find_impact_limits(file, path),
        calibration=calibration,
        mapping_confidence=None if file.robot.imported is None else file.robot.imported.confidence,
        sources={
            name: SourceJoint(source.joint, float(source.sign), radians(source.zero_deg))
            for name, source in _source_tables(file).items()
            if source is not None
        },
    )


def _find_impact_limits(file: RobotFile, path: Path) -> Path | None:
    """Return the path of the robot's own file of contact limits."""
    name = None if file.audience is None else file.audience.limits
    if name is None:
        return None
    named = path.parent / name
    try:
        check_inside(path.parent, named)
    except ConfigError as error:
        raise ConfigError(f"{path}: [audience] limits = {name!r}: {error}") from None
    return named


def _segment(body: BodyTable) -> Segment:
    capsules = tuple(Capsule(sealed(c.start), sealed(c.end), c.radius) for c in body.capsules)
    parent = None if body.parent == "world" else body.parent
    return Segment(body.name, parent, sealed(body.pos), body.mass, capsules)


def _hinge(hinge: HingeTable, rest: float) -> Hinge:
    axis = np.array(hinge.axis) / np.linalg.norm(hinge.axis)
    lower, upper = (radians(limit) for limit in hinge.range_deg)
    return Hinge(hinge.name, hinge.body, sealed(axis), lower, upper, rest, sealed(hinge.at))


def _mount(hinge: HingeTable, models: Mapping[str, ServoModel]) -> Mount:
    """Return a hinge's drive with the mounting position of its servos.

    A hinge with limits gets a massless drive made from them.
    """
    if hinge.limits is not None:
        limits = hinge.limits
        speed, acceleration = radians(limits.speed_deg), radians(limits.acceleration_deg)
        drive = make_muscle(speed=speed, acceleration=acceleration, torque=limits.torque)
        return Mount(drive, hinge.body, sealed(hinge.at))
    assert hinge.servo is not None  # checked by `_check_drive`
    assert hinge.mount is not None
    drive = Drive(models[hinge.servo], hinge.count, hinge.reduction)
    return Mount(drive, hinge.mount.body, sealed(hinge.mount.at))


def _coupling(coupling: CouplingTable, hinges: list[str]) -> Coupling:
    axis = np.array(coupling.axis) / np.linalg.norm(coupling.axis)
    driver, offset = hinges.index(coupling.driver), radians(coupling.offset_deg)
    return Coupling(coupling.name, coupling.body, sealed(axis), driver, coupling.ratio, offset)


def _check(path: Path, file: RobotFile, servos: list[str]) -> None:
    """Raise an error for invalid names or numbers in a robot's file."""
    bodies: list[str] = []
    for body in file.body:
        _check_unique(path, "body", body.name, bodies)
        if body.parent != "world":
            _check_known(path, f"parent of body {body.name}", body.parent, bodies)
        bodies.append(body.name)
    hinges: list[str] = []
    for hinge in file.hinge:
        _check_unique(path, "hinge", hinge.name, hinges)
        _check_known(path, f"body of hinge {hinge.name}", hinge.body, bodies)
        _check_drive(path, hinge, bodies, servos)
        _check_hinge_numbers(path, hinge, file.rest.get(hinge.name, 0.0))
        hinges.append(hinge.name)
    _check_uniform_drives(path, file)
    _check_couplings(path, file, bodies, hinges)
    _check_sources(path, file)
    for name, members in file.chains.items():
        for body_name in members:
            _check_known(path, f"chain {name}", body_name, bodies)
    for name, site in file.sites.items():
        _check_known(path, f"site {name}", site.body, bodies)
    for name in file.rest:
        _check_known(path, "[rest]", name, hinges)
    for entry in file.collision.exclude:
        for body_name in entry.pair:
            _check_known(path, "[collision] exclude", body_name, [*bodies, *(FINGER_CHAINS & file.chains.keys())])
    if not file.chains.keys() & set(ARM_CHAINS):
        raise ConfigError(f"{path}: [chains] has neither l_arm nor r_arm; at least one arm is needed")
    for site_name in (f"{chain[0]}_palm" for chain in ARM_CHAINS if chain in file.chains):
        _check_known(path, "[sites] needs", site_name, list(file.sites))


def _check_drive(path: Path, hinge: HingeTable, bodies: list[str], servos: list[str]) -> None:
    """Raise an error unless a hinge has a valid servo or limits."""
    if hinge.limits is None:
        if hinge.servo is None or hinge.mount is None:
            raise ConfigError(f"{path}: hinge {hinge.name}: give servo and mount, or limits where no servo turns it")
        _check_known(path, f"mount of hinge {hinge.name}", hinge.mount.body, bodies)
        _check_known(path, f"servo of hinge {hinge.name}", hinge.servo, servos)
        return
    unfit = [key for key in ("servo", "mount") if getattr(hinge, key) is not None]
    unfit += [key for key in ("count", "reduction") if getattr(hinge, key) != 1]
    if unfit:
        raise ConfigError(f"{path}: hinge {hinge.name} has limits and {unfit[0]}: limits are for hinges without servo")
    for key, value in msgspec.structs.asdict(hinge.limits).items():
        if value <= 0:
            raise ConfigError(f"{path}: hinge {hinge.name}: limits.{key} is {value:g}, must be above 0")


def _check_uniform_drives(path: Path, file: RobotFile) -> None:
    """Raise an error for partly missing servos, or buses without servos."""
    without = [hinge.name for hinge in file.hinge if hinge.limits is not None]
    if without and (driven := [hinge.name for hinge in file.hinge if hinge.servo is not None]):
        raise ConfigError(
            f"{path}: {driven[0]} has a servo and {without[0]} has limits: give all hinges servos, or none of them"
        )
    if without and file.bus:
        raise ConfigError(f"{path}: [[bus]], but no hinge has a servo: remove it, or give servos instead of limits")


def _check_couplings(path: Path, file: RobotFile, bodies: list[str], hinges: list[str]) -> None:
    """Raise an error for couplings with invalid driver or range."""
    ranges = {hinge.name: hinge.range_deg for hinge in file.hinge}
    names: list[str] = []
    for coupling in file.coupling:
        _check_unique(path, "hinge", coupling.name, [*hinges, *names])
        names.append(coupling.name)
    for coupling in file.coupling:
        where = f"{path}: coupling {coupling.name}"
        _check_known(path, f"body of coupling {coupling.name}", coupling.body, bodies)
        if coupling.driver in names:
            followed = (
                " itself" if coupling.driver == coupling.name else f" {coupling.driver}, which follows another one"
            )
            raise ConfigError(f"{where}: it follows{followed}; name the hinge with the servo that moves both")
        _check_known(path, f"driver of coupling {coupling.name}", coupling.driver, hinges)
        _check_axis(where, coupling.axis)
        ends = [coupling.offset_deg + coupling.ratio * end for end in ranges[coupling.driver]]
        (least, max_count), (lower, upper) = (min(ends), max(ends)), coupling.range_deg
        if least < lower - RANGE_TOLERANCE or max_count > upper + RANGE_TOLERANCE:
            reached = f"{coupling.driver} leads it to {least:g}..{max_count:g} deg"
            raise ConfigError(f"{where}: {reached}, beyond its range_deg [{lower:g}, {upper:g}]; narrow the driver's")


def _source_tables(file: RobotFile) -> Mapping[str, SourceTable | None]:
    """Return the imported file's joints, by hinge or coupling."""
    hinges = {hinge.name: hinge.source for hinge in file.hinge}
    return hinges | {coupling.name: coupling.source for coupling in file.coupling}


def _check_sources(path: Path, file: RobotFile) -> None:
    """Raise an error if two hinges represent the same imported joint."""
    names: list[str] = []
    for hinge, source in _source_tables(file).items():
        name = hinge if source is None else source.joint
        if name in names:
            raise ConfigError(f"{path}: hinge {hinge}: another hinge has the joint {name} of the imported file, too")
        names.append(name)


def _check_hinge_numbers(path: Path, hinge: HingeTable, rest: float) -> None:
    lower, upper = hinge.range_deg
    if not lower < upper:
        raise ConfigError(f"{path}: hinge {hinge.name}: range_deg is [{lower}, {upper}], must be [low, high]")
    if not lower <= rest <= upper:
        raise ConfigError(f"{path}: [rest] {hinge.name} is {rest} deg, outside [{lower}, {upper}]")
    _check_axis(f"{path}: hinge {hinge.name}", hinge.axis)
    if hinge.count < 1 or hinge.reduction <= 0:
        raise ConfigError(f"{path}: hinge {hinge.name}: count must be at least 1 and reduction above 0")


def _check_axis(where: str, axis: Sequence[float]) -> None:
    """Raise an error if an axis is zero, tiny or huge."""
    if not any(axis):
        raise ConfigError(f"{where}: axis is zero, must be a direction")
    if not 1.0 / MAX_AXIS_LENGTH <= hypot(*axis) <= MAX_AXIS_LENGTH:
        raise ConfigError(f"{where}: axis is {list(axis)}, must be a direction such as [0, 0, 1]")


def _check_unique(path: Path, kind: str, name: str, earlier_names: list[str]) -> None:
    if name in earlier_names:
        raise ConfigError(f"{path}: {kind} {name} is described twice")


def _check_known(path: Path, where: str, name: str, valid_names: list[str]) -> None:
    if name not in valid_names:
        raise ConfigError(f"{path}: {where}: no {name}{suggestion(name, valid_names)}")
