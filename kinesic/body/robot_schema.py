"""The tables of a robot's TOML and of `configs/servos.toml`."""

import msgspec

Triple = tuple[float, float, float]


class Strict(msgspec.Struct, forbid_unknown_fields=True):
    """A table whose unknown keys are errors."""


class MirrorTable(Strict, rename={"source": "from", "target": "to"}):
    """Name prefixes of the described and of the derived side."""

    source: str
    target: str


class RobotTable(Strict):
    """[robot]."""

    name: str
    mirror: MirrorTable | None = None


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


class HingeTable(Strict):
    """[[hinge]]."""

    name: str
    body: str
    axis: Triple
    range_deg: tuple[float, float]
    servo: str
    mount: MountTable
    count: int = 1
    reduction: float = 1.0


class SiteTable(Strict):
    """One entry of [sites]."""

    body: str
    at: Triple
    facing: Triple


class ExclusionTable(Strict):
    """One entry of `exclude`."""

    pair: tuple[str, str]
    why: str


class CollisionTable(Strict):
    """[collision]."""

    clearance: float
    exclude: list[ExclusionTable] = []


class RobotFile(Strict):
    """A whole robot. `bus` is read by hardware."""

    robot: RobotTable
    body: list[BodyTable]
    hinge: list[HingeTable]
    chains: dict[str, list[str]]
    sites: dict[str, SiteTable]
    collision: CollisionTable
    rest: dict[str, float] = {}
    targets: dict[str, Triple] = {}
    bus: list[object] = []


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
