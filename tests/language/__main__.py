"""Report the wording of the project: docstrings, constants, docs and commit messages.

`make check` runs it. It fails if a metric is beyond its limit; `--list N` shows the first N offenders of each.
"""

import argparse
import sys

from .commits import check_commits
from .measure import measure


def main() -> int:
    """Print all metrics; return 1 if one is beyond its limit."""
    parser = argparse.ArgumentParser(prog="python -m tests.language", description=__doc__)
    parser.add_argument("--list", type=int, default=0, metavar="N", help="offenders of each kind to show")
    options = parser.parse_args()
    metrics = measure()
    for metric in metrics:
        verdict = "ok" if metric.is_met else f"over the limit of {metric.limit:.0%}"
        print(f"{metric.kind}: {len(metric.offenders)} of {metric.count} ({metric.fraction:.1%}), {verdict}")
        for offender in metric.offenders[: options.list or (0 if metric.is_met else 10)]:
            print(f"  {offender.place}: {offender.text[:160]}")
    commits = check_commits()
    print(commits.report)
    return 0 if commits.is_met and all(metric.is_met for metric in metrics) else 1


sys.exit(main())
