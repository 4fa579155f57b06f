"""What MuJoCo drops when it reads a URDF: speed limits, and which joints mimic others."""

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree


@dataclass(frozen=True)
class UrdfJoint:
    """The rest of a joint."""

    speed: float | None  # [rad/s]
    mimics: bool


def urdf_joints(path: Path) -> dict[str, UrdfJoint]:
    """Reads a URDF's joints by name; empty for an MJCF.

    Raises:
        xml.etree.ElementTree.ParseError: the file is no XML.
        ValueError: a speed is no number.
    """
    root = ElementTree.parse(path).getroot()
    if root.tag != "robot":
        return {}
    found = {}
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        speed = 0.0 if limit is None else float(limit.get("velocity", 0.0))
        found[joint.get("name", "")] = UrdfJoint(speed if speed > 0 else None, joint.find("mimic") is not None)
    return found
