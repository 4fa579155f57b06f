"""Reader of SmartBody skeletons (.sk) and motions (.skm)."""

import re
from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.capture.reading.text import (
    MAX_JOINTS,
    CaptureError,
    check_times,
    decode,
    parse_count,
    parse_numbers,
    split_lines,
)
from kinesic.capture.skeleton_motion import CapturedJoint, CapturedMotion

CHANNEL_WIDTHS: Mapping[str, int] = {"XPos": 1, "YPos": 1, "ZPos": 1, "Quat": 3}  # kind of channel -> numbers per frame
SYNC_NAMES: Mapping[str, str] = {  # BML sync point by the name of a time in a .skm file
    "ready": "ready",
    "strokeStart": "strokeStart",
    "emphasis": "stroke",
    "stroke": "strokeEnd",
    "relax": "relax",
}

_NUMBER_PATTERN = r"\s+([-+\d.eE]+)"  # one number after white space
_JOINT_PATTERN = re.compile(
    rf"(?P<end>\}})|(?:root|joint)\s+(?P<name>\S+)\s*\{{\s*offset{3 * _NUMBER_PATTERN}"
    rf"(?:\s+prerot\s+axis{3 * _NUMBER_PATTERN}\s+ang{_NUMBER_PATTERN})?"
)
_COMMENT_PATTERN = re.compile(r"#.*")  # comment up to the end of the line
_CHANNELS_PATTERN = re.compile(r"^channels\s+(\d+)\s*$", re.MULTILINE)  # line with the number of channels
_TIME_PATTERN = re.compile(r"^(\w+) time:\s*(\S+)", re.MULTILINE)  # line with the time of a sync point


def read_skeleton(data: bytes, source: str) -> tuple[CapturedJoint, ...]:
    """Read the joints of a SmartBody skeleton (.sk), parents first.

    Raises:
        CaptureError: the data is not a skeleton.
    """
    joints: list[CapturedJoint] = []
    ancestors: list[str] = []
    names: set[str] = set()
    for match in _JOINT_PATTERN.finditer(_COMMENT_PATTERN.sub("", decode(data, source))):
        if match["end"]:
            ancestors = ancestors[:-1]
            continue
        name = match["name"]
        if name in names or len(names) == MAX_JOINTS:
            raise CaptureError(f"{source}: joint {name[:40]!r} occurs twice, or is one of more than {MAX_JOINTS}")
        numbers = parse_numbers(match.groups(default="0")[2:], f"{source}: joint {name[:40]!r}")
        turn = np.radians(numbers[6]) * numbers[3:6]  # the axis is a unit vector or zero
        joints.append(CapturedJoint(name, ancestors[-1] if ancestors else None, numbers[:3], sealed(turn)))
        ancestors.append(name)
        names.add(name)
    if not joints:
        raise CaptureError(f"{source}: not a skeleton: it has no joints")
    return tuple(joints)


def read_motion(data: bytes, source: str) -> CapturedMotion:
    """Read a SmartBody motion file (.skm).

    Raises:
        CaptureError: the data is not a motion.
    """
    lines = split_lines(data, source)
    text = "\n".join(lines)
    head = _CHANNELS_PATTERN.search(text)
    if head is None:
        raise CaptureError(f"{source}: not a motion: it needs channels and at least two frames")
    first_line = text.count("\n", 0, head.start()) + 1
    count = parse_count(head[1], f"{source}:{first_line}: channels", most=MAX_JOINTS * len(CHANNEL_WIDTHS))
    columns: dict[tuple[str, str], slice] = {}
    width = 0
    for number, line in enumerate(lines[first_line : first_line + count], start=first_line + 1):
        name, _, kind = line.strip().partition(" ")
        if kind not in CHANNEL_WIDTHS:
            channels = ", ".join(CHANNEL_WIDTHS)
            raise CaptureError(
                f"{source}:{number}: channel {line.strip()[:40]!r}; it must be a joint and one of {channels}"
            )
        columns[name, kind] = slice(width, width := width + CHANNEL_WIDTHS[kind])
    times, rows = [], []
    for number, line in enumerate(lines, start=1):
        if not line.startswith("kt "):
            continue
        words = line.split()
        if len(words) < 3 or words[2] != "fr" or len(words) - 3 != width:
            raise CaptureError(f"{source}:{number}: its channels require {width} numbers in each frame")
        row = parse_numbers((words[1], *words[3:]), f"{source}:{number}")
        times.append(row[0])
        rows.append(row[1:])
    check_times(sealed(times), source)
    syncs = {
        SYNC_NAMES[name]: float(parse_numbers([time], f"{source}: {name} time")[0])
        for name, time in _TIME_PATTERN.findall(text)
        if name in SYNC_NAMES
    }
    return CapturedMotion(sealed(times), columns, sealed(rows), syncs)
