"""Fuzz readers of bytes and text, each in its own process.

Usage: `python -m tests.fuzz --seconds 60 [TARGET ...]`. With atheris (`pip install atheris`), inputs are guided by code
coverage; without it, inputs are mutated, guided by new error messages. Inputs that failed lie in the folder of
`--corpus`; copy those of mended faults to tests/fuzz/corpus/TARGET, which the tests read.
"""

import argparse
import subprocess
import sys
from dataclasses import dataclass, field
from hashlib import blake2b
from importlib.util import find_spec
from pathlib import Path
from time import monotonic

from tests.fuzz.target_names import TARGET_NAMES
from tests.fuzz.worker import LAST_INPUT

MAX_FAILURES = 20  # number of failures after which a target ends


@dataclass
class Findings:
    """Number of inputs and failures of one target."""

    inputs: int = 0
    accepted: int = 0
    failures: dict[str, Path] = field(default_factory=dict)  # place and kind of the error -> first input with it


def fuzz(name: str, seconds: float, *, seed: int, engine: str, corpus: Path) -> Findings:
    """Fuzz one target for some time [s].

    Fuzzing restarts after each failure.
    """
    folder, findings, end = corpus / name, Findings(), monotonic() + seconds
    folder.mkdir(parents=True, exist_ok=True)
    for round_number in range(MAX_FAILURES):
        if (left := end - monotonic()) < 1.0:
            break
        counts = folder / "counts"
        counts.unlink(missing_ok=True)
        command = [
            sys.executable,
            "-m",
            "tests.fuzz.worker",
            name,
            str(left),
            str(seed + round_number),
            engine,
            str(folder),
        ]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
        said = counts.read_text() if counts.exists() else (done.stdout.splitlines() or ["0 0"])[-1]
        inputs, accepted = map(int, said.split())
        findings.inputs += inputs
        findings.accepted += accepted
        if done.returncode == 0:
            break
        data = (folder / LAST_INPUT).read_bytes() if (folder / LAST_INPUT).exists() else b""
        path = folder / f"failed-{blake2b(data, digest_size=6).hexdigest()}"
        path.write_bytes(data)
        path.with_suffix(".txt").write_text(done.stderr)
        findings.failures.setdefault(_describe_error(done.stderr), path)
    return findings


def _describe_error(text: str) -> str:
    """Return the last place and the kind of an error.

    Equal faults have equal descriptions.
    """
    lines = [line.strip() for line in text.splitlines() if line.strip()] or ["no output"]
    places = [line for line in lines if line.startswith("File ") and "/kinesic/" in line]
    return f"{lines[-1].partition(':')[0]} at {places[-1]}" if places else lines[-1][:200]


def main() -> int:
    """Read options, fuzz, and print a Markdown table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", metavar="TARGET", choices=[*TARGET_NAMES, []])
    parser.add_argument("--seconds", type=float, default=300.0, help="for each target")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--engine", choices=("atheris", "mutations"))
    parser.add_argument("--corpus", type=Path, default=Path("out/fuzz"))
    options = parser.parse_args()
    engine = options.engine or ("atheris" if find_spec("atheris") else "mutations")
    print(
        f"engine {engine}, seed {options.seed}, {options.seconds:g} s each\n\n| target | inputs | accepted | failures |"
    )
    print("|---|---|---|---|", flush=True)
    failed = 0
    for name in options.targets or TARGET_NAMES:
        found = fuzz(name, options.seconds, seed=options.seed, engine=engine, corpus=options.corpus.resolve())
        failed += len(found.failures)
        print(f"| {name} | {found.inputs} | {found.accepted} | {len(found.failures)} |", flush=True)
        for error, path in found.failures.items():
            print(f"    {error} ({path})", flush=True)
    return min(1, failed)


if __name__ == "__main__":
    sys.exit(main())
