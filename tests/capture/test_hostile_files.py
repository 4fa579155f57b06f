"""Tests that extreme files give a certified motion or a located error."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from kinesic.capture.certified_plan import plan_captured
from kinesic.capture.read import read_clip
from kinesic.capture.reading.text import CaptureError
from kinesic.planning.setup import Setup

from .clips import bvh, reach
from .independent_limits import assert_within_limits

FILES = 500
Rng = np.random.Generator


def joints(known: Setup, rng: Rng, *, rate=30.0, count=40) -> np.ndarray:
    """Return times and smooth angles (m, 1 + n) of all joints, often in collision."""
    skeleton = known.robot.skeleton
    ends = rng.uniform(skeleton.lower, skeleton.upper, (4, len(skeleton.names)))
    blends = np.linspace(0.0, 3.0, count)
    angles = np.stack([np.interp(blends, range(4), column) for column in ends.T], axis=1)
    return np.concatenate([np.arange(count)[:, None] / rate, angles], axis=1)


def csv(known: Setup, table: np.ndarray) -> bytes:
    header = ",".join(["time_s", *(f"{name}_rad" for name in known.robot.skeleton.names)])
    return "\n".join([header, *(",".join(f"{value:.9g}" for value in row) for row in table)]).encode()


def jumping(known: Setup, rng: Rng) -> bytes:
    table = joints(known, rng)
    table[rng.integers(1, 40, 5), 1:] += rng.uniform(-3.0, 3.0, (5, table.shape[1] - 1))
    return csv(known, table)


def not_a_number(known: Setup, rng: Rng) -> bytes:
    table = joints(known, rng)
    table[rng.integers(40), rng.integers(table.shape[1])] = rng.choice([np.nan, np.inf, 1e300])
    return csv(known, table)


def reversed_in_time(known: Setup, rng: Rng) -> bytes:
    table = joints(known, rng)
    begin = int(rng.integers(0, 38))
    table[begin : begin + 2] = table[begin : begin + 2][::-1]
    return csv(known, table)


def noisy(known: Setup, rng: Rng) -> bytes:
    table = joints(known, rng, rate=float(rng.choice([1.0, 30.0, 1000.0])), count=int(rng.choice([3, 40])))
    table[:, 1:] += rng.normal(0.0, 0.5, table[:, 1:].shape)
    return csv(known, table)


def colliding(known: Setup, rng: Rng) -> bytes:
    return csv(known, joints(known, rng, rate=float(rng.choice([5.0, 1000.0]))))


def whirling(known: Setup, rng: Rng) -> bytes:
    """Return a clip whose body joints, also the spine, rotate arbitrarily."""
    names = ("Spine", "Head", "LeftShoulder", "LeftArm", "LeftForeArm", "RightArm", "RightForeArm")
    rotations = {name: rng.uniform(-180.0, 180.0, (8, 3)) for name in names}
    return bvh(rotations, period=float(rng.choice([1.0, 1 / 30, 1 / 1000])))


def far_away(known: Setup, rng: Rng) -> bytes:
    return bvh(reach(30, height=float(rng.uniform(60.0, 400.0)), speed=5.0), place=tuple(rng.uniform(-1e9, 1e9, 3)))


KINDS: dict[str, Callable[[Setup, Rng], bytes]] = {
    "jumping.csv": jumping,
    "nan.csv": not_a_number,
    "reversed.csv": reversed_in_time,
    "noisy.csv": noisy,
    "colliding.csv": colliding,
    "whirling.bvh": whirling,
    "far.bvh": far_away,
}


@pytest.mark.soak
def test_hostile_motion_capture_files_give_a_motion_within_limits_or_an_error_naming_the_file(
    known: Setup, tmp_path: Path
) -> None:
    """Accept the refusal of a motion too near to the body."""
    outcomes: Counter[str] = Counter()
    for seed in range(FILES):
        name = list(KINDS)[seed % len(KINDS)]
        path = tmp_path / name
        path.write_bytes(KINDS[name](known, np.random.default_rng(seed)))
        message = ""
        try:
            planned = plan_captured(read_clip(path), known, source=str(path))
        except CaptureError as error:
            message = str(error)
        assert not message or str(path) in message
        outcomes[f"{name} {'refused' if message else 'certified'}"] += 1
        if not message:
            assert_within_limits(planned.trajectory, known.limits)
            assert planned.clearance.distances.min() >= known.robot.min_clearance
    assert outcomes["nan.csv certified"] == outcomes["reversed.csv certified"] == 0
    assert outcomes["far.bvh certified"] > 0
