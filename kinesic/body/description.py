"""A robot as its TOML describes it, with the mirrored half written out."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kinesic.body.arrays import Floats
from kinesic.body.calibration import NONE, Calibration
from kinesic.body.choices import Skin
from kinesic.body.servo import Drive
from kinesic.body.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class Mount:
    """A drive and where its servos sit (they carry weight)."""

    drive: Drive
    segment: str
    position: Floats  # (3,) [m] in the segment


@dataclass(frozen=True)
class Exclusion:
    """Two segments whose distance does not count, and why."""

    pair: frozenset[str]
    why: str


@dataclass(frozen=True, eq=False)
class Site:
    """A named point on a segment."""

    segment: str
    position: Floats  # (3,) [m] in the segment
    facing: Floats  # (3,) unit, in the segment


@dataclass(frozen=True)
class Supply:
    """What feeds the servos."""

    volts: float
    amps: float  # that it gives for long


@dataclass(frozen=True, eq=False)
class Description:
    """Everything that is written about a robot."""

    name: str
    path: Path
    skeleton: Skeleton
    mounts: tuple[Mount, ...]  # one per hinge, in joint order
    chains: Mapping[str, tuple[str, ...]]  # "torso", "neck", "l_arm", "r_arm" -> segments from the base outward
    sites: Mapping[str, Site]  # at least "l_palm", "r_palm", "eyes"
    exclusions: tuple[Exclusion, ...]
    least_clearance: float  # [m]
    targets: Mapping[str, Floats]  # named points (3,) [m] in the world
    skin: Skin | None = None  # None: it is drawn as it is built
    supply: Supply | None = None  # None: not described
    calibration: Calibration = NONE  # of this one's servos; its ranges are in the skeleton already
