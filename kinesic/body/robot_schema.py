"""The tables of a robot's TOML and of `configs/servos.toml`."""

import msgspec

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
    mirror: MirrorTable | None = None
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
    at: Triple = (0.0, 0.0, 0.0)


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
    servos: dict[str, ServoTable] = {}
    supply: SupplyTable | None = None
    bus: list[object] = []
