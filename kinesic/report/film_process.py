"""Process that draws one film, whose job arrives on standard input."""

import os
import pickle
import sys

from kinesic.report.films import FAILURE_PREFIX, FILM_JOBS, FilmJob


def main(kind: str) -> int:
    """Draw the film read from standard input, printing progress or an error."""
    with os.fdopen(os.dup(1), "w", buffering=1) as output:
        os.dup2(2, 1)  # output of graphics drivers must not mix with progress
        FILM_JOBS[kind].prepare()
        job: FilmJob
        job, path = pickle.loads(sys.stdin.buffer.read())
        why = job.draw(path, lambda share: print(f"{share:.4f}", file=output))
        if why:
            print(f"{FAILURE_PREFIX}{' '.join(why.split())}", file=output)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1]))
