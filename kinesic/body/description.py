"""Contents of a robot's TOML file, with both body sides complete."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kinesic.body.arrays import Floats
from kinesic.body.calibration import NO_CALIBRATION, Calibration
from kinesic.body.choices import Audience, Skin
from kinesic.body.servo import Drive
from kinesic.body.skeleton import Skeleton
from kinesic.body.source_joints import SourceJoint


@dataclass(frozen=True, eq=False)
class Mount:
    """Drive of a hinge, with the body and position of its servos.

    The position matters because servos have weight.
    """

    drive: Drive  # servo model, number of servos and reduction
    segment: str  # name of the segment that carries the servos
    position: Floats  # (3,) [m] position of the servos in the segment


@dataclass(frozen=True)
class Exclusion:
    """Pair of bodies excluded from collision checks, with the reason."""

    pair: frozenset[str]  # names of both bodies
    why: str  # reason for reports


@dataclass(frozen=True, eq=False)
class Site:
    """Named point on a segment, with a facing direction."""

    segment: str
    position: Floats  # (3,) [m] position in the segment
    facing: Floats  # (3,) unit, in the segment


@dataclass(frozen=True)
class Supply:
    """Power supply of the servos."""

    volts: float  # [V] rated voltage
    amps: float  # [A] largest continuous current


@dataclass(frozen=True, eq=False)
class Description:
    """Complete description of a robot."""

    name: str
    path: Path
    skeleton: Skeleton
    mounts: tuple[Mount, ...]  # one per hinge, in joint order
    chains: Mapping[str, tuple[str, ...]]  # "torso", "neck", "l_arm", "r_arm" -> segments from the base outward
    sites: Mapping[str, Site]  # named points: at least "l_palm", "r_palm", "eyes"
    exclusions: tuple[Exclusion, ...]
    min_clearance: float  # [m] required distance between bodies, except excluded pairs
    contact_distance: float  # [m] distance between a hand and the point that it touches
    targets: Mapping[str, Floats]  # named points (3,) [m] in the world
    skin: Skin | None = None  # None: drawn without skin
    supply: Supply | None = None  # None: unknown
    audience: Audience = "nobody"  # people near the robot
    impact_limits: Path | None = None  # file of contact limits; None: kinesic's built-in file
    calibration: Calibration = NO_CALIBRATION  # of the servos; the skeleton has the measured ranges already
    mapping_confidence: float | None = None  # 0..1 certainty of an imported robot's joint mapping; None: not imported
    sources: Mapping[str, SourceJoint] = field(default_factory=dict)  # hinge or coupling -> joint of the imported file
