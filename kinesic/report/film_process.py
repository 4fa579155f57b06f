"""The process that draws one film: its job comes on standard input, the share that is drawn goes out line by line."""

import os
import pickle
import sys

from kinesic.report.films import FAILED, JOBS, FilmJob


def main(kind: str) -> int:
    """Makes ready to draw films of a kind, and draws that of standard input; tells how far it is, or why it cannot."""
    with os.fdopen(os.dup(1), "w", buffering=1) as told:
        os.dup2(2, 1)  # what drivers print is no news of ours
        JOBS[kind].prepare()
        job: FilmJob
        job, path = pickle.loads(sys.stdin.buffer.read())
        why = job.draw(path, lambda share: print(f"{share:.4f}", file=told))
        if why:
            print(f"{FAILED}{' '.join(why.split())}", file=told)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1]))
