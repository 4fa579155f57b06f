"""Tests that other, emulated processors give the same joint angles.

`apt-get install g++-aarch64-linux-gnu qemu-user-static` (Debian) is all that the second one needs.
"""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.robot import Robot
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.seeds import seeds

REPOSITORY_ROOT = Path(__file__).parents[2]
HEADER_FOLDER = REPOSITORY_ROOT / "kinesic" / "ik" / "kernel"  # C++ headers of the kernel
COMPILER_FLAGS = ["-std=c++17", "-O3", "-fno-strict-aliasing", "-ffp-contract=off"]  # compiler flags of setup.py
LEFT_ARM = Robot.load().arms["l"]  # chain of the left arm

Question = tuple[str, Floats, Floats, Floats, Floats]  # kind, place, pointing, palm, start


def _first(*names: str) -> str | None:
    return next((result for name in names if (result := shutil.which(name))), None)


MACHINE_COMMANDS = {  # machine -> compiler command and emulator command
    "this one": ((_first("g++", "c++"),), ()),
    "no vector types": ((_first("g++", "c++"), "-DKINESIC_PLAIN_LANES"), ()),  # as for MSVC
    "aarch64": (
        (_first("aarch64-linux-gnu-g++", "aarch64-linux-gnu-g++-12"),),
        (_first("qemu-aarch64-static", "qemu-aarch64"),),
    ),
}


@pytest.mark.parametrize(
    "machine", [*(pytest.param(name, marks=pytest.mark.soak) for name in ("this one", "no vector types")), "aarch64"]
)
def test_ik_kernel_compiled_for_other_processors_gives_the_same_angles(machine, tmp_path):
    compiler, translator = MACHINE_COMMANDS[machine]
    if None in (*compiler, *translator):
        pytest.skip(f"no compiler for {machine}, or nothing that runs its programs")
    program = tmp_path / "arms"
    sources = [Path(__file__).with_name("programs") / "arms.cpp", HEADER_FOLDER / "arm_angles.cpp"]
    subprocess.run([*compiler, *COMPILER_FLAGS, "-static", f"-I{HEADER_FOLDER}", *sources, "-o", program], check=True)
    questions = _questions(LEFT_ARM, 120)
    written = "\n".join([_arm(LEFT_ARM), *(_written(question) for question in questions)])
    done = subprocess.run([*translator, program], input=written, capture_output=True, text=True, check=True)
    rows = [np.array([float.fromhex(word) for word in line.split()]) for line in done.stdout.splitlines()]
    here = [_answer(LEFT_ARM, question) for question in questions]
    worst = max(float(np.abs(one[: len(two)] - two).max()) for one, two in zip(here, rows, strict=True))
    assert worst < 1e-9 if translator else worst == 0.0


def _questions(chain: Chain, count: int) -> list[Question]:
    """Return targets of every kind, some of them out of reach."""
    random, asked = default_rng(81), []
    for k in range(count):
        angles, start = random.uniform(chain.lower, chain.upper, (2, len(chain.rest)))
        rotations, centres = chain.frames(angles)
        place = np.array(centres[-2]) * (1.6 if k % 7 == 6 else 1.0)
        along = centres[-1] - centres[-2]
        asked.append((("solve", "hold", "reach")[k % 3], place, along, rotations[-1] @ chain.palm, start))
    return asked


def _answer(chain: Chain, question: Question) -> Floats:
    kind, place, pointing, palm, start = question
    arm = arm_of(chain)
    if kind == "reach":
        angles = start.copy()
        arm.reach(place, angles)
        return angles
    solution = (
        arm.solve(place, pointing, palm, None, start, None, None)
        if kind == "solve"
        else arm.hold(place, pointing, palm, start)
    )
    assert solution is not None
    return solution[0]


def _arm(chain: Chain) -> str:
    linkage = linkage_of(chain)
    rows = [
        [len(linkage.pivots), len(linkage.links), len(seeds(linkage))],
        [*linkage.origin, *chain.palm.tolist(), linkage.side, linkage.farthest, linkage.closest],
        *([len(link.pivots), *link.bone] for link in linkage.links),
        *([*pivot.axis, pivot.lower, pivot.upper, pivot.rest] for pivot in linkage.pivots),
        *(seed.angles for seed in seeds(linkage)),
        linkage.mobility,
    ]
    return "\n".join(" ".join(repr(float(value)) for value in row) for row in rows)


def _written(question: Question) -> str:
    kind, place, pointing, palm, start = question
    parts = [place, start] if kind == "reach" else [place, pointing, palm, start]
    return " ".join([kind, *(repr(float(value)) for part in parts for value in part)])
