"""Mirror images of the side that a robot's file describes."""

from collections.abc import Callable
from typing import TypeVar

import msgspec

from kinesic.body.robot_schema import (
    BodyTable,
    CapsuleTable,
    CouplingTable,
    HingeTable,
    MirrorTable,
    MountTable,
    RobotFile,
    SiteTable,
    Triple,
)

Table = TypeVar("Table", BodyTable, HingeTable, CouplingTable)
Value = TypeVar("Value")


def with_both_sides(file: RobotFile) -> RobotFile:
    """Add the mirror images of all parts on the described side.

    Chains, sites and rest angles that the file gives for the other side are kept.
    """
    mirror = file.robot.mirror
    if mirror is None:
        return file
    return msgspec.structs.replace(
        file,
        body=_mirror_tables(file.body, mirror, mirror_body),
        hinge=_mirror_tables(file.hinge, mirror, _mirrored_hinge),
        coupling=_mirror_tables(file.coupling, mirror, _mirrored_coupling),
        chains=_both(file.chains, mirror, lambda names: [mirror_name(name, mirror) for name in names]),
        sites=_both(file.sites, mirror, lambda site: mirror_site(site, mirror)),
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


def _mirror_tables(
    tables: list[Table], mirror: MirrorTable, mirrored: Callable[[Table, MirrorTable], Table]
) -> list[Table]:
    """Append the mirror images of the tables on the described side."""
    return tables + [mirrored(table, mirror) for table in tables if table.name.startswith(mirror.source)]


def _both(table: dict[str, Value], mirror: MirrorTable, mirrored: Callable[[Value], Value]) -> dict[str, Value]:
    images = {
        mirror_name(key, mirror): mirrored(value) for key, value in table.items() if key.startswith(mirror.source)
    }
    return table | images | table  # the described side comes first, and written entries override mirrored ones


def _both_pairs(pair: tuple[str, str], mirror: MirrorTable) -> list[tuple[str, str]]:
    image = (_swap_prefix(pair[0], mirror), _swap_prefix(pair[1], mirror))
    return [pair] if set(image) == set(pair) else [pair, image]


def mirror_body(body: BodyTable, mirror: MirrorTable) -> BodyTable:
    """Return the mirror image of a body and its capsules."""
    return BodyTable(
        name=mirror_name(body.name, mirror),
        parent=mirror_name(body.parent, mirror),
        pos=_flipped(body.pos),
        mass=body.mass,
        capsules=[CapsuleTable(_flipped(c.start), _flipped(c.end), c.radius) for c in body.capsules],
    )


def _mirrored_hinge(hinge: HingeTable, mirror: MirrorTable) -> HingeTable:
    return msgspec.structs.replace(
        hinge,
        name=mirror_name(hinge.name, mirror),
        body=mirror_name(hinge.body, mirror),
        axis=_mirrored_axis(hinge.axis),
        at=_flipped(hinge.at),
        mount=None
        if hinge.mount is None
        else MountTable(mirror_name(hinge.mount.body, mirror), _flipped(hinge.mount.at)),
        source=None,  # a joint of the imported file is on one side
    )


def _mirrored_mount(mount: MountTable, mirror: MirrorTable) -> MountTable:
    return MountTable(mirror_name(mount.body, mirror), _flipped(mount.at))


def _mirrored_coupling(coupling: CouplingTable, mirror: MirrorTable) -> CouplingTable:
    return msgspec.structs.replace(
        coupling,
        name=mirror_name(coupling.name, mirror),
        body=mirror_name(coupling.body, mirror),
        driver=mirror_name(coupling.driver, mirror),
        axis=_mirrored_axis(coupling.axis),
        source=None,
    )


def _mirrored_axis(axis: Triple) -> Triple:
    """Mirror a hinge's axis so that equal angles make mirrored postures."""
    x, y, z = axis
    return (-x, y, -z)


def mirror_site(site: SiteTable, mirror: MirrorTable) -> SiteTable:
    """Return the mirror image of a site."""
    return SiteTable(mirror_name(site.body, mirror), _flipped(site.at), _flipped(site.facing))


def _flipped(point: Triple) -> Triple:
    return (point[0], -point[1], point[2])


def mirror_name(name: str, mirror: MirrorTable) -> str:
    """Replace the side prefix of a name, if it has one."""
    return mirror.target + name.removeprefix(mirror.source) if name.startswith(mirror.source) else name


def _swap_prefix(name: str, mirror: MirrorTable) -> str:
    """Replace the side prefix of a name by the opposite prefix."""
    if name.startswith(mirror.target):
        return mirror.source + name.removeprefix(mirror.target)
    return mirror_name(name, mirror)
