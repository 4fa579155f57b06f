"""Check commit messages with gitlint and the rules in `.gitlint`."""

import subprocess
import sys
from dataclasses import dataclass

from .measure import TREE_ROOT

LAST_UNCHECKED_COMMIT = "12f9f98af48a8f037c055cf3da76cbe43dc44163"  # later commits are checked; earlier ones were


@dataclass(frozen=True, eq=False)
class CommitCheck:
    """Result of checking the commits, with gitlint's report."""

    is_met: bool
    report: str


def check_commits() -> CommitCheck:
    """Run gitlint on all commits after the last unchecked one.

    A copy without the history of that commit passes, and its report says so.
    """
    if _git("merge-base", "--is-ancestor", LAST_UNCHECKED_COMMIT, "HEAD").returncode != 0:
        return CommitCheck(True, "commits: not checked, the history is missing")
    commits = f"{LAST_UNCHECKED_COMMIT}..HEAD"
    count = _git("rev-list", "--no-merges", "--count", commits).stdout.strip()
    if count == "0":
        return CommitCheck(True, "commits: none to check")
    command = [sys.executable, "-m", "gitlint.cli", "--commits", commits]
    result = subprocess.run(command, cwd=TREE_ROOT, capture_output=True, text=True, check=False)
    is_met = result.returncode == 0
    heading = f"commits: {count} checked, {'ok' if is_met else 'some break a rule'}"
    return CommitCheck(is_met, "\n".join([heading, *(result.stdout + result.stderr).splitlines()]))


def _git(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", *arguments], cwd=TREE_ROOT, capture_output=True, text=True, check=False)
