"""Schema of robot files and of `configs/servos.toml`, and its TOML writer."""

import json
from collections.abc import Mapping, Sequence
from typing import Literal

import msgspec

from kinesic.body.choices import Audience, Skin

Triple = tuple[float, float, float]


class Strict(msgspec.Struct, forbid_unknown_fields=True):
    """TOML table whose unknown keys are errors."""


class MirrorTable(Strict, rename={"source": "from", "target": "to"}):
    """TOML table `mirror`: name prefixes of the described and the mirrored side."""

    source: str  # prefix of the side that the file describes, such as `l_`
    target: str  # prefix of the other side, which is its mirror image, such as `r_`


class ImportTable(Strict, rename={"source": "from"}):
    """TOML table `[robot.imported]`, written by `kinesic robots import`."""

    source: str  # file name of the imported robot
    confidence: float  # 0..1: certainty of the mapping
    review: list[str] = []  # hinges and servos that a person must check


class RobotTable(Strict):
    """TOML table `[robot]` with the robot's name and options."""

    name: str  # name in options and reports
    extends: str | None = None  # robot, or file in the same folder, whose tables this file changes
    mirror: MirrorTable | None = None  # derives one side from the other
    skin: Skin | None = None  # skin of the virtual human; bodies must have its names
    imported: ImportTable | None = None  # origin of an imported robot


class CapsuleTable(Strict, rename={"start": "from", "end": "to", "radius": "r"}):
    """TOML entry of a body's list `capsules`."""

    start: Triple  # [m] centre of the first end, in the body's frame
    end: Triple  # [m] centre of the second end
    radius: float  # [m] radius of cylinder and round ends


class BodyTable(Strict):
    """TOML table `[[body]]` of one rigid segment."""

    name: str  # H-Anim name of the segment
    parent: str  # name of the body that carries it; `world` for the base
    pos: Triple  # [m] origin in the parent's frame
    mass: float  # [kg] without the servos mounted on it
    capsules: list[CapsuleTable]  # shape for collisions


class MountTable(Strict):
    """TOML table `mount`: body and position of a hinge's servos."""

    body: str  # body that carries the servos
    at: Triple  # [m] centre of the servos in that body's frame


class LimitsTable(Strict):
    """TOML table `limits` of a hinge without a servo."""

    speed_deg: float  # [deg/s] largest velocity
    acceleration_deg: float  # [deg/s^2] largest acceleration of the unloaded hinge
    torque: float  # [Nm] largest torque


class SourceTable(Strict):
    """TOML table `source`: imported joint that a hinge or coupling represents.

    joint angle = zero_deg + sign * angle of the hinge
    """

    joint: str  # name of the joint in the imported file
    sign: Literal[1, -1] = 1  # -1: the joint rotates in the opposite direction
    zero_deg: float = 0.0  # [deg] joint angle at hinge angle 0


class HingeTable(Strict):
    """TOML table `[[hinge]]`, with a mounted servo or with limits."""

    name: str  # name of the rotation, such as `l_elbow_flexion`
    body: str  # body that the hinge moves
    axis: Triple  # unit vector of positive rotation
    range_deg: tuple[float, float]  # [deg] lowest and highest angle
    servo: str | None = None  # model in `servos.toml` or `[servos]`
    mount: MountTable | None = None  # place of the servos
    limits: LimitsTable | None = None  # limits of a hinge without a servo
    count: int = 1  # servos on the same shaft
    reduction: float = 1.0  # servo revolutions per hinge revolution
    at: Triple = (0.0, 0.0, 0.0)  # [m] centre of rotation in the body's frame
    source: SourceTable | None = None  # joint of the imported file; exported motion has its name, sign and zero


class CouplingTable(Strict):
    """TOML table `[[coupling]]` of a rotation without a servo."""

    name: str  # name of the rotation
    body: str  # body that it moves
    axis: Triple  # unit vector of positive rotation
    range_deg: tuple[float, float]  # [deg] lowest and highest angle
    driver: str  # hinge that drives it
    ratio: float = 1.0  # angle per angle of the driver
    offset_deg: float = 0.0  # [deg] angle at driver angle 0
    source: SourceTable | None = None  # joint of the imported file


class SiteTable(Strict):
    """TOML entry of `[sites]`: a named point on a body."""

    body: str  # body that carries the point
    at: Triple  # [m] position in the body's frame
    facing: Triple  # unit vector of its direction


class ExclusionTable(Strict):
    """TOML entry of `exclude`: a pair without collision checks.

    The fingers of a hand form one body, `l_fingers`.
    """

    pair: tuple[str, str]  # names of two bodies
    why: str  # reason, for human readers


class CollisionTable(Strict):
    """TOML table `[collision]` with clearance and excluded pairs."""

    clearance: float  # [m] smallest distance between bodies
    exclude: list[ExclusionTable] = []  # pairs without collision checks
    contact: float = 0.015  # [m] distance between a hand and the point that it touches; at least clearance + 0.004


class SupplyTable(Strict):
    """TOML table `[supply]` of the power supply."""

    volts: float  # [V] supply voltage
    amps: float  # [A] continuous current


class ServoTable(Strict):
    """TOML table of one servo model in `servos.toml` or `[servos]`."""

    model: int  # model number in the control table
    volt: float  # [V] nominal voltage
    stall_nm: float  # [Nm] stall torque
    stall_a: float  # [A] stall current
    no_load_rpm: float  # [1/min] no-load velocity
    gear: float  # gear ratio
    mass: float  # [kg] mass of one servo
    size: Triple  # [m] width, height, depth
    p_gain: float  # factory position P gain
    d_gain: float  # factory position D gain
    kp_divisor: float  # register units of the P gain per unit of gain
    armature: float  # [kg m^2] rotor inertia at the output
    frictionloss: float  # [Nm] Coulomb friction
    damping: float  # [Nm s/rad] viscous friction
    idle_a: float = 0.0  # [A] current of the electronics alone
    thermal: tuple[float, float] | None = None  # [K/W] winding to surroundings, [J/K] of the winding
    price_usd: float | None = None  # [USD] price of one piece


class AudienceTable(Strict):
    """TOML table `[audience]`: people near the robot."""

    near: Audience = "nobody"  # audience whose limits of contacts planned motion keeps
    limits: str | None = None  # file of regions and policies in the folder of the robot's file


class RobotFile(Strict):
    """TOML file of a robot."""

    robot: RobotTable  # name and options
    body: list[BodyTable]  # rigid segments, one `[[body]]` each
    hinge: list[HingeTable]  # rotations, one `[[hinge]]` each
    chains: dict[str, list[str]]  # bodies from base to tip: `torso`, `neck`, `l_arm`, `r_arm`
    sites: dict[str, SiteTable]  # named points, such as palms and eyes
    collision: CollisionTable  # clearance between bodies
    coupling: list[CouplingTable] = []  # rotations without a servo, one `[[coupling]]` each
    rest: dict[str, float] = {}  # [deg] angle of each hinge at rest, if it is not 0
    targets: dict[str, Triple] = {}  # [m] named points in the world, for gaze and pointing
    servos: dict[str, ServoTable] = {}  # servo models of this robot
    supply: SupplyTable | None = None  # power supply
    audience: AudienceTable | None = None  # people near the robot
    bus: list[object] = []  # wiring of servos, one `[[bus]]` each


def robot_text(file: RobotFile, *, heading: Sequence[str], remarks: Mapping[str, str]) -> str:
    """Return the tables of an imported robot as TOML text.

    Mirror, extends, skin, contact distance, supply and buses are not written.

    Args:
        file: the tables.
        heading: comment lines for the top of the file.
        remarks: hinge or servo -> comment.
    """
    parts = [
        [f"# {line}".rstrip() for line in heading],
        _table("[robot]", {"name": file.robot.name}),
        []
        if file.robot.imported is None
        else _table("[robot.imported]", _select_non_default_fields(file.robot.imported)),
        *(_body(body) for body in file.body),
        *(_hinge(hinge, remarks.get(hinge.name, "")) for hinge in file.hinge),
        *(_table("[[coupling]]", _select_non_default_fields(coupling)) for coupling in file.coupling),
        _table("[chains]", file.chains),
        _table("[sites]", {name: _select_non_default_fields(site) for name, site in file.sites.items()}),
        _table("[rest]", file.rest),
        [
            *_table("[collision]", {"clearance": file.collision.clearance}),
            "exclude = [",
            *(f"  {_value(_select_non_default_fields(entry))}," for entry in file.collision.exclude),
            "]",
        ],
        _table("[targets]", file.targets),
        *(
            _table(f"[servos.{name}]", _select_non_default_fields(servo), remarks.get(name, ""))
            for name, servo in file.servos.items()
        ),
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
    """Return the changed tables of an extending robot as TOML text.

    Values that equal their default are written, too.

    Args:
        bodies: changed bodies.
        hinges: changed hinges.
        sites: changed sites.
        robot: keys of [robot].
        heading: comment lines for the top of the file.
    """
    parts = [
        [f"# {line}".rstrip() for line in heading],
        _table("[robot]", robot),
        *(_table("[[body]]", _select_given_fields(body)) for body in bodies),
        *(_table("[[hinge]]", _select_given_fields(hinge)) for hinge in hinges),
        _table("[sites]", {name: _select_given_fields(site) for name, site in sites.items()}) if sites else [],
    ]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def _table(header: str, rows: Mapping[str, object], remark: str = "") -> list[str]:
    return [f"{header}  # {remark}" if remark else header, *(f"{key} = {_value(value)}" for key, value in rows.items())]


def _body(body: BodyTable) -> list[str]:
    rows = {key: value for key, value in _select_non_default_fields(body).items() if key != "capsules"}
    capsules = [f"  {_value(_select_non_default_fields(capsule))}," for capsule in body.capsules]
    return [*_table("[[body]]", rows), "capsules = [", *capsules, "]"]


def _hinge(hinge: HingeTable, remark: str) -> list[str]:
    rows = _select_non_default_fields(hinge)
    name, *rest = _table("[[hinge]]", rows)[1:]
    return ["[[hinge]]", f"{name}  # {remark}" if remark else name, *rest]


def _select_non_default_fields(table: msgspec.Struct) -> dict[str, object]:
    """Return the non-default fields of a TOML table, by key."""
    fields: dict[str, object] = {}
    for field in msgspec.structs.fields(table):
        value = getattr(table, field.name)
        if value != field.default and value is not None:
            fields[field.encode_name] = value
    return fields


def _select_given_fields(table: msgspec.Struct) -> dict[str, object]:
    """Return the fields of a TOML table that are not None.

    Keys are those of TOML.
    """
    rows = {field.encode_name: getattr(table, field.name) for field in msgspec.structs.fields(table)}
    return {key: value for key, value in rows.items() if value is not None}


def _value(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, msgspec.Struct):
        return _value(_select_non_default_fields(value))
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key} = {_value(inner)}' for key, inner in value.items())} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(_value(inner) for inner in value)}]"
    return repr(value)
