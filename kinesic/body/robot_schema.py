"""The tables of a robot's TOML and of `configs/servos.toml`, and how they are written; `robot_file` reads them."""

import json
from collections.abc import Mapping, Sequence

import msgspec

from kinesic.body.choices import Skin

Triple = tuple[float, float, float]


class Strict(msgspec.Struct, forbid_unknown_fields=True):
    """A table whose unknown keys are errors."""


class MirrorTable(Strict, rename={"source": "from", "target": "to"}):
    """Name prefixes of the described and of the derived side."""

    source: str
    target: str


class ImportTable(Strict, rename={"source": "from"}):
    """[robot.imported], of a robot that was mapped by `kinesic robots import`."""

    source: str
    confidence: float
    review: list[str] = []


class RobotTable(Strict):
    """[robot]."""

    name: str
    extends: str | None = None  # another robot, of which this file says only what is different: see `robot_extension`
    mirror: MirrorTable | None = None
    skin: Skin | None = None  # drawn on the skeleton, whose bodies must have the names of those of `human`
    imported: ImportTable | None = None


class CapsuleTable(Strict, rename={"start": "from", "end": "to", "radius": "r"}):
    """One entry of `capsules`."""

    start: Triple
    end: Triple
    radius: float


class BodyTable(Strict):
    """[[body]]."""

    name: str
    parent: str
    pos: Triple
    mass: float
    capsules: list[CapsuleTable]


class MountTable(Strict):
    """`mount` of a hinge."""

    body: str
    at: Triple


class LimitsTable(Strict):
    """`limits` of a hinge without a servo."""

    speed_deg: float  # [deg/s]
    acceleration_deg: float  # [deg/s^2] of the hinge with nothing on it
    torque: float  # [Nm]


class HingeTable(Strict):
    """[[hinge]]: with a servo and where it is mounted, or with limits alone."""

    name: str
    body: str
    axis: Triple
    range_deg: tuple[float, float]
    servo: str | None = None
    mount: MountTable | None = None
    limits: LimitsTable | None = None
    count: int = 1
    reduction: float = 1.0
    at: Triple = (0.0, 0.0, 0.0)


class CouplingTable(Strict):
    """[[coupling]]: a turn without a servo."""

    name: str
    body: str
    axis: Triple
    range_deg: tuple[float, float]
    driver: str  # the hinge that it follows
    ratio: float = 1.0
    offset_deg: float = 0.0


class SiteTable(Strict):
    """One entry of [sites]."""

    body: str
    at: Triple
    facing: Triple


class ExclusionTable(Strict):
    """One entry of `exclude`; the fingers of a hand, `l_fingers`, are one body."""

    pair: tuple[str, str]
    why: str


class CollisionTable(Strict):
    """[collision]."""

    clearance: float
    exclude: list[ExclusionTable] = []


class SupplyTable(Strict):
    """[supply]."""

    volts: float
    amps: float


class ServoTable(Strict):
    """One servo model."""

    model: int
    volt: float
    stall_nm: float
    stall_a: float
    no_load_rpm: float
    gear: float
    mass: float
    size: Triple
    p_gain: float
    d_gain: float
    kp_divisor: float
    armature: float
    frictionloss: float
    damping: float
    idle_a: float = 0.0
    thermal: tuple[float, float] | None = None
    price_usd: float | None = None


class RobotFile(Strict):
    """A whole robot. `bus` is read by hardware."""

    robot: RobotTable
    body: list[BodyTable]
    hinge: list[HingeTable]
    chains: dict[str, list[str]]
    sites: dict[str, SiteTable]
    collision: CollisionTable
    coupling: list[CouplingTable] = []
    rest: dict[str, float] = {}
    targets: dict[str, Triple] = {}
    servos: dict[str, ServoTable] = {}
    supply: SupplyTable | None = None
    bus: list[object] = []


def robot_text(file: RobotFile, *, heading: Sequence[str], remarks: Mapping[str, str]) -> str:
    """Writes a robot without mirror and without buses as TOML.

    Args:
        file: the tables.
        heading: lines of the comment at its top.
        remarks: hinge or servo -> comment.
    """
    parts = [
        [f"# {line}".rstrip() for line in heading],
        _table("[robot]", {"name": file.robot.name}),
        [] if file.robot.imported is None else _table("[robot.imported]", _plain(file.robot.imported)),
        *(_body(body) for body in file.body),
        *(_hinge(hinge, remarks.get(hinge.name, "")) for hinge in file.hinge),
        *(_table("[[coupling]]", _plain(coupling)) for coupling in file.coupling),
        _table("[chains]", file.chains),
        _table("[sites]", {name: _plain(site) for name, site in file.sites.items()}),
        _table("[rest]", file.rest),
        [
            *_table("[collision]", {"clearance": file.collision.clearance}),
            "exclude = [",
            *(f"  {_value(_plain(entry))}," for entry in file.collision.exclude),
            "]",
        ],
        _table("[targets]", file.targets),
        *(_table(f"[servos.{name}]", _plain(servo), remarks.get(name, "")) for name, servo in file.servos.items()),
    ]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def changes_text(
    bodies: Sequence[BodyTable],
    hinges: Sequence[HingeTable],
    sites: Mapping[str, SiteTable],
    *,
    robot: Mapping[str, str],
    heading: Sequence[str],
) -> str:
    """Writes what a robot that extends another one has of its own, with values that are the default, too.

    Args:
        bodies: that differ.
        hinges: that differ.
        sites: that differ.
        robot: keys of [robot].
        heading: lines of the comment at its top.
    """
    parts = [
        [f"# {line}".rstrip() for line in heading],
        _table("[robot]", robot),
        *(_table("[[body]]", _written(body)) for body in bodies),
        *(_table("[[hinge]]", _written(hinge)) for hinge in hinges),
        _table("[sites]", {name: _written(site) for name, site in sites.items()}) if sites else [],
    ]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def _table(header: str, rows: Mapping[str, object], remark: str = "") -> list[str]:
    return [f"{header}  # {remark}" if remark else header, *(f"{key} = {_value(value)}" for key, value in rows.items())]


def _body(body: BodyTable) -> list[str]:
    rows = {key: value for key, value in _plain(body).items() if key != "capsules"}
    capsules = [f"  {_value(_plain(capsule))}," for capsule in body.capsules]
    return [*_table("[[body]]", rows), "capsules = [", *capsules, "]"]


def _hinge(hinge: HingeTable, remark: str) -> list[str]:
    rows = _plain(hinge)
    name, *rest = _table("[[hinge]]", rows)[1:]
    return ["[[hinge]]", f"{name}  # {remark}" if remark else name, *rest]


def _plain(table: msgspec.Struct) -> dict[str, object]:
    """Lists the fields of a table under the names that a file has for them, without those at their defaults."""
    found: dict[str, object] = {}
    for field in msgspec.structs.fields(table):
        value = getattr(table, field.name)
        if value != field.default and value is not None:
            found[field.encode_name] = value
    return found


def _written(table: msgspec.Struct) -> dict[str, object]:
    """Lists the fields of a table under the names that a file has for them, without those that are None."""
    rows = {field.encode_name: getattr(table, field.name) for field in msgspec.structs.fields(table)}
    return {key: value for key, value in rows.items() if value is not None}


def _value(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, msgspec.Struct):
        return _value(_plain(value))
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key} = {_value(inner)}' for key, inner in value.items())} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(_value(inner) for inner in value)}]"
    return repr(value)
