"""GitHub workflows: valid, with pinned actions and few rights."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


@pytest.mark.skipif(shutil.which("actionlint") is None, reason="actionlint is not installed")
def test_github_workflow_files_are_valid():
    checked = subprocess.run(["actionlint", *WORKFLOWS], cwd=ROOT, capture_output=True, text=True, check=False)
    assert (checked.returncode, checked.stdout) == (0, "")


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_github_actions_are_pinned_by_commit_with_their_version_in_a_comment(path: Path):
    used = re.findall(r"uses: (\S+)(.*)", path.read_text(encoding="utf-8"))
    loose = [name for name, _ in used if not name.startswith("./") and not re.search(r"@[0-9a-f]{40}$", name)]
    unnamed = [name for name, version in used if "@" in name and not re.match(r" # v\d+\.\d+\.\d+$", version)]
    assert used
    assert (loose, unnamed) == ([], [])


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_github_workflows_have_read_permissions_unless_a_job_requests_more(path: Path):
    assert "\npermissions:\n  contents: read\n" in path.read_text(encoding="utf-8")


def test_each_github_workflow_job_has_a_time_limit():
    for path in WORKFLOWS:
        text = path.read_text(encoding="utf-8")
        assert text.count("runs-on:") == text.count("timeout-minutes:")


def test_workflow_of_tests_covers_successive_python_versions_from_the_oldest_supported():
    (listed,) = re.findall(r"python: \[(.+)\]", (ROOT / ".github/workflows/test.yml").read_text(encoding="utf-8"))
    (oldest,) = re.findall(r'requires-python = ">=(3\.\d+)"', (ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    versions = re.findall(r'"(3\.\d+)"', listed)
    assert versions[0] == oldest
    assert versions == [f"3.{minor}" for minor in range(int(oldest[2:]), int(oldest[2:]) + len(versions))]
