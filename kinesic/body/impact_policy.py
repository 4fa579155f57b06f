"""Limits of contacts with people: body regions and policies of `configs/impacts.toml`.

A policy limits the forces and the energy of planned contacts. No figure is safety-rated or replaces a risk assessment.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import sqrt
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.choices import Audience
from kinesic.body.config import CONFIGS, ConfigError, read_toml, suggestion
from kinesic.body.robot_schema import Strict

FORCE_MARGIN = 1.15  # safety factor on computed contact forces; forces in the twin are up to 1.11 times as large
FIXED_MASS = 1e6  # [kg] mass that stands for infinity, of a body part that cannot move away
ENERGY_ROW = "energy"  # name of the contact quantity that limits the kinetic energy


class RegionTable(Strict):
    """TOML table `[regions.NAME]`: one part of a person's body."""

    mass: float  # [kg] effective mass
    stiffness: float  # [N/m] stiffness of the surface
    quasi_static: float  # [N] largest force while the part cannot move away
    source: str  # origin of the values
    date: str  # date of the source
    transient: float | None = None  # [N] largest force of a short contact with a free part


class PolicyTable(Strict):
    """TOML table `[policies.NAME]`: limits of planned contacts."""

    force: dict[str, float]  # [N] largest force, by region
    energy: float  # [J] largest kinetic energy at the worst point
    clamp: float  # [N] largest force between closing bodies
    source: str  # origin of the values
    date: str  # date of the source


class ImpactFile(Strict):
    """TOML file of body regions and policies."""

    regions: dict[str, RegionTable]  # parts of a person's body
    policies: dict[Audience, PolicyTable]  # limits by audience


@dataclass(frozen=True, eq=False)
class ImpactRows:
    """Contact quantities to compute: forces and root energy, with or without limits.

    The value of row r is scales[r] * sqrt(v' (W + I / masses[r])^-1 v), for velocity v and mobility W of a point.
    """

    names: tuple[str, ...]  # (r,) names of regions, or `ENERGY_ROW`
    masses: Floats  # (r,) [kg] mass of the person's body part
    scales: Floats  # (r,) factor on the square root of twice the contact energy


@dataclass(frozen=True, eq=False)
class ImpactPolicy:
    """Limits of planned contacts near one audience."""

    audience: Audience
    regions: Mapping[str, RegionTable]
    table: PolicyTable
    path: Path  # file of the limits

    @cached_property
    def rows(self) -> ImpactRows:
        """Contact forces and square-root energy, relative to their limits.

        `FORCE_MARGIN` is included.
        """
        limited = [(self.regions[name], limit) for name, limit in self.table.force.items()]
        scales = [FORCE_MARGIN * sqrt(region.stiffness) / limit for region, limit in limited]
        return ImpactRows(
            (*self.table.force, ENERGY_ROW),
            sealed([*(region.mass for region, _ in limited), FIXED_MASS]),
            sealed([*scales, FORCE_MARGIN / sqrt(2.0 * self.table.energy)]),
        )


def force_rows(regions: Mapping[str, RegionTable]) -> ImpactRows:
    """Return the contact quantities of all regions, without limits.

    Forces are in N. The energy row is the square root of the energy in J. `FORCE_MARGIN` is included.
    """
    scales = [FORCE_MARGIN * sqrt(region.stiffness) for region in regions.values()]
    masses = [region.mass for region in regions.values()]
    return ImpactRows(
        (*regions, ENERGY_ROW), sealed([*masses, FIXED_MASS]), sealed([*scales, FORCE_MARGIN / np.sqrt(2.0)])
    )


@lru_cache(maxsize=8)
def read_impact_limits(path: Path = CONFIGS / "impacts.toml") -> ImpactFile:
    """Read body regions and contact limits from a file.

    Raises:
        ConfigError: the file is missing or invalid, or a value is not above 0.
    """
    file = read_toml(path, ImpactFile)
    for name, region in file.regions.items():
        numbers = {"mass": region.mass, "stiffness": region.stiffness, "quasi_static": region.quasi_static}
        numbers |= {} if region.transient is None else {"transient": region.transient}
        _check_positive(path, f"regions.{name}", numbers)
    for name, policy in file.policies.items():
        _check_positive(path, f"policies.{name}", {"energy": policy.energy, "clamp": policy.clamp} | policy.force)
        for region_name in policy.force:
            if region_name not in file.regions:
                known = suggestion(region_name, list(file.regions))
                raise ConfigError(f"{path}: policies.{name}.force: no region {region_name}{known}")
    return file


def _check_positive(path: Path, where: str, numbers: Mapping[str, float]) -> None:
    for key, number in numbers.items():
        if number <= 0.0:
            raise ConfigError(f"{path}: {where}.{key} is {number:g}, must be above 0")


def find_policy(audience: Audience, path: Path | None = None) -> ImpactPolicy | None:
    """Return an audience's contact limits, or None without an audience.

    Args:
        audience: people near the robot.
        path: file of the limits; by default kinesic's own.

    Raises:
        ConfigError: the file is invalid, or has no policy for the audience.
    """
    if audience == "nobody":
        return None
    source = path or CONFIGS / "impacts.toml"
    file = read_impact_limits(source)
    if audience not in file.policies:
        raise ConfigError(f"{source}: no policy {audience}; add [policies.{audience}] with force, energy and clamp")
    return ImpactPolicy(audience, file.regions, file.policies[audience], source)
