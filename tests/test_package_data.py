"""Files of the package that wheels contain beside its modules."""

import subprocess
import tomllib
from fnmatch import fnmatch
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SETUPTOOLS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
PATTERNS = SETUPTOOLS["package-data"]["kinesic"]
SOURCES = (
    "*.py",
    "*.cpp",
    "*.h",
    "studio/client/*",
)  # patterns of Python modules and of sources that are compiled or bundled


@pytest.fixture(scope="module")
def tracked() -> list[str]:
    """Paths below the package that git knows, other than sources."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT / "kinesic", capture_output=True, text=True, check=False
    )
    if listed.returncode:
        pytest.skip("no git here, or no clone")
    names = listed.stdout.split("\0")[:-1]
    return [name for name in names if not any(fnmatch(name, source) for source in SOURCES)]


def test_wheel_contains_every_data_file(tracked):
    packed = {
        str(path.relative_to(ROOT / "kinesic")) for pattern in PATTERNS for path in (ROOT / "kinesic").glob(pattern)
    }
    assert sorted(set(tracked) - packed) == []


def test_wheel_contains_no_sources_of_kernels():
    assert SETUPTOOLS["include-package-data"] is False
    assert [pattern for pattern in PATTERNS if pattern.endswith((".cpp", ".h"))] == []
