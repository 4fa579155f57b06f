"""Process that imports a robot file with bounded memory and time.

    python -P -m kinesic.sim.importer.apart.import_process FILE MEMORY CPU_TIME [JOINT=HINGE ...]

Standard output gets an `Answer` as MessagePack. The current folder must be empty and may be discarded: MuJoCo writes
its log there. The bounds are set before MuJoCo is imported.
"""

import os
import sys
from contextlib import suppress

KILL_DELAY = 5  # [s] CPU time between the signal for the time limit and the forced end


def bound_process(*, memory: int, cpu_time: int) -> None:
    """Bound the memory [bytes] and processor time [s] of this process.

    It has no effect on Windows.
    """
    if sys.platform != "win32":
        import resource  # noqa: PLC0415 - Windows has none

        resource_limits = (
            (resource.RLIMIT_DATA, memory, memory),
            (resource.RLIMIT_CPU, cpu_time, cpu_time + KILL_DELAY),
            (resource.RLIMIT_CORE, 0, 0),
        )
        for kind, soft, hard in resource_limits:
            with suppress(ValueError, OSError):  # a lower bound is already set and stays in force
                resource.setrlimit(kind, (soft, hard))


def main(path: str, memory: str, cpu_time: str, *wished: str) -> None:
    """Import a robot and write the result to standard output."""
    bound_process(memory=int(memory), cpu_time=int(cpu_time))
    output = os.dup(1)
    os.dup2(2, 1)  # output of libraries must not mix with the answer
    from pathlib import Path  # noqa: PLC0415 - after the bounds

    from kinesic.sim.importer.apart.answer import answer_import  # noqa: PLC0415

    with os.fdopen(output, "wb") as stream:
        stream.write(answer_import(Path(path), wished))


if __name__ == "__main__":
    main(*sys.argv[1:])
