"""Run each compiled or optional component of an installed kinesic, and print the results as JSON.

The same program on two processors must give equal results: `smoke.py --expect FILE` compares with stored results.
"""

import argparse
import json
import platform
import sys
import time
from pathlib import Path

TOLERANCE = 1e-9  # [rad] or [m] largest difference between results of two processors
PING = "fffffd00010300" + "01194e"  # hexadecimal ping packet of servo 1, from the specification of Protocol 2.0
BEAT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<gesture id="g" lexeme="beat" stroke="1.0"/><faceLexeme id="f" lexeme="joy" start="0.2" end="1.6"/></bml>'
)
SAMPLE_COUNT = 9  # number of postures compared over the plan


def kernel() -> dict[str, object]:
    """Solve inverse kinematics in the compiled kernel."""
    from kinesic import Robot, ik

    arm = Robot.load().arms["l"]
    solution = ik.solve(arm, ik.Reach([0.3, 0.2, -0.1]), start=arm.rest)
    assert solution.residual < 1e-3, solution.residual
    return {"angles": solution.angles.tolist()}


def codec() -> dict[str, object]:
    """Encode a ping packet of the servo protocol."""
    from kinesic.hardware.protocol.packet import ping

    assert ping(1).hex() == PING, ping(1).hex()
    return {"ping": ping(1).hex()}


def plan() -> dict[str, object]:
    """Plan one beat, from BML to a motion within all limits."""
    import kinesic

    planned = kinesic.Performer("upper22").plan(BEAT)
    times = [planned.duration * k / (SAMPLE_COUNT - 1) for k in range(SAMPLE_COUNT)]
    postures = [planned.at(moment).angles.tolist() for moment in times]
    assert max(abs(angle - rest) for angle, rest in zip(postures[4], postures[0], strict=True)) > 0.05
    return {"duration": planned.duration, "postures": postures}


def face() -> dict[str, object]:
    """Move the head's vertices by action units, with SciPy.

    Drawing is not tested, since it needs OpenGL.
    """
    from kinesic.face.assets.action_units import deform
    from kinesic.face.assets.mesh import load_head

    head = load_head()
    moved = deform(head, {"12": 0.8, "26": 0.4})
    assert 0.005 < abs(moved - head.positions).max() < 0.05
    return {"vertices": moved[::100].tolist()}


PARTS = {"kernel": kernel, "codec": codec, "plan": plan, "face": face}


def main() -> None:
    """Run all components, print the results, and optionally compare them."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--expect", type=Path, help="results (JSON) of another processor")
    arguments = parser.parse_args()
    results: dict[str, object] = {}
    for name, calculate in PARTS.items():
        begin = time.monotonic()
        results[name] = calculate()
        print(f"{platform.machine()}: {name} in {time.monotonic() - begin:.1f} s", file=sys.stderr, flush=True)
    print(json.dumps(results))
    if arguments.expect is not None:
        largest = difference(results, json.loads(arguments.expect.read_text(encoding="utf-8")))
        print(f"largest difference from {arguments.expect.name}: {largest:.1e}", file=sys.stderr)
        sys.exit(largest > TOLERANCE)


def difference(one: object, other: object) -> float:
    """Return the largest difference of two results, infinity for unequal structure."""
    if isinstance(one, dict) and isinstance(other, dict) and one.keys() == other.keys():
        return max(difference(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        return max(map(difference, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) if abs(one - other) >= 0.0 else float("inf")  # NaN is like nothing
    return 0.0 if one == other else float("inf")


if __name__ == "__main__":
    main()
