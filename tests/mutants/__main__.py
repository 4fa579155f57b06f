"""Run mutants of the safety-critical parts, and list those that no test notices.

`make mutants` runs it; CONTRIBUTING says what to do with survivors.
"""

import argparse
import random
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue

from listed import read_equivalent, read_targets
from mutations import Edit, find_sites
from trial import Outcome, Sandbox

HERE = Path(__file__).parent
TREE = HERE.parent.parent
MIN_KILLED_FRACTION = 0.8  # smallest fraction of killed mutants in each part, without equivalent mutants


@dataclass(frozen=True)
class Mutant:
    """Small change of one module that tests must notice."""

    part: str
    module: str
    source: bytes  # source of the unchanged module
    edit: Edit
    tests: tuple[str, ...]

    @property
    def name(self) -> tuple[str, str, str]:
        """Return the module, the line and its changed text."""
        return self.module, *self.edit.lines(self.source)

    def __str__(self) -> str:
        module, was, now = self.name
        return f"{module}:{self.edit.line(self.source)}\n  - {was}\n  + {now}"


def choose(each: int, seed: int, parts: list[str]) -> list[Mutant]:
    """Choose random mutants of each part, at most one per source place."""
    targets = read_targets()
    if unknown := set(parts) - set(targets):
        raise SystemExit(f"no such part: {', '.join(sorted(unknown))}; there are: {', '.join(targets)}")
    return [mutant for part in parts or targets for mutant in _choose_in(part, targets[part], each, seed)]


def _choose_in(part: str, modules: dict[str, list[str]], count: int, seed: int) -> list[Mutant]:
    drawn = random.Random(f"{seed} {part}")
    sources = {module: (TREE / module).read_bytes() for module in modules}
    sites = [(module, site) for module, source in sources.items() for site in find_sites(source)]
    drawn.shuffle(sites)
    return [
        Mutant(part, module, sources[module], drawn.choice(site), tuple(modules[module]))
        for module, site in sites[:count]
    ]


def try_all(mutants: list[Mutant], jobs: int, folder: Path) -> list[Outcome]:
    """Run mutants in parallel, print survivors, and return the outcomes in order."""
    free: SimpleQueue[Sandbox] = SimpleQueue()
    for job in range(jobs):
        free.put(Sandbox.make(TREE, folder / str(job)))

    def time_tests(tests: tuple[str, ...]) -> float:
        sandbox = free.get()
        try:
            return sandbox.time_tests(tests)
        finally:
            free.put(sandbox)

    def try_one(numbered: tuple[int, Mutant]) -> Outcome:
        number, mutant = numbered
        sandbox = free.get()
        print(f"\r{number} of {len(mutants)} ", end="", file=sys.stderr, flush=True)
        try:
            changed = mutant.edit.apply(mutant.source)
            outcome = sandbox.try_mutant(mutant.module, changed, mutant.tests, usual=usual[mutant.tests])
            if outcome == "survived":
                print(f"\r{mutant}", flush=True)
            return outcome
        finally:
            free.put(sandbox)

    with ThreadPoolExecutor(jobs) as pool:
        suites = list(dict.fromkeys(mutant.tests for mutant in mutants))
        usual = dict(zip(suites, pool.map(time_tests, suites), strict=True))
        return list(pool.map(try_one, enumerate(mutants, 1)))


def report(mutants: list[Mutant], outcomes: list[Outcome], same: list[Mutant]) -> bool:
    """Print each part's fraction of killed mutants, and return whether all suffice."""
    counts = Counter((mutant.part, outcome) for mutant, outcome in zip(mutants, outcomes, strict=True))
    parts = list(dict.fromkeys(mutant.part for mutant in (*mutants, *same)))
    shares = []
    print(f"\n{'part':12} killed endless survived equivalent share")
    for name, members in (*((part, [part]) for part in parts), ("all", parts)):
        killed, endless, survived = (
            sum(counts[part, kind] for part in members) for kind in ("killed", "timeout", "survived")
        )
        equivalent = sum(mutant.part in members for mutant in same)
        tried = killed + endless + survived
        shares.append((killed + endless) / tried if tried else 1.0)
        print(f"{name:12} {killed:6} {endless:7} {survived:8} {equivalent:10} {100 * shares[-1]:3.0f} %")
    return min(shares) >= MIN_KILLED_FRACTION


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="python tests/mutants", description=__doc__)
    parser.add_argument("parts", nargs="*", help="parts of targets/*.toml; all of them if none is named")
    parser.add_argument("--each", type=int, default=10, help="mutants of each part")
    parser.add_argument("--seed", type=int, default=1, help="another one chooses other mutants")
    parser.add_argument("--jobs", type=int, default=2, help="processes side by side")
    asked = parser.parse_args()
    equivalent = read_equivalent()
    chosen = choose(asked.each, asked.seed, asked.parts)
    same = [item for item in chosen if item.name in equivalent]
    mutants = [item for item in chosen if item not in same]
    with tempfile.TemporaryDirectory(prefix="kinesic-mutants-") as folder:
        outcomes = try_all(mutants, asked.jobs, Path(folder).resolve())
    return 0 if report(mutants, outcomes, same) else 1


if __name__ == "__main__":
    sys.exit(main())
