"""Lock files: all packages installed by `make`, with hashes and without URLs."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from .naming import about

ROOT = Path(__file__).resolve().parent.parent
EXTRAS = ("speech", "face", "voice", "dev")
TOOL_NAMES = ("docs", "release", "compiler")  # lock files without the packages of the core
LOCK_FILES = {name: ROOT / f"requirements-{name}.lock" for name in (*EXTRAS, *TOOL_NAMES)} | {
    "": ROOT / "requirements.lock"
}
MODULE_NAMES = {"hibari-tts": "hibari", "pillow": "PIL"}  # names of modules that differ from those of their packages
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
PIN_PATTERN = re.compile(
    r"([A-Za-z0-9._-]+)==([A-Za-z0-9.!+_-]+)(?: ; ([^\\\n]+))?((?: \\\n    --hash=sha256:[0-9a-f]{64})+)\n"
)


def pins(extra: str) -> dict[str, str]:
    """Return the versions in a lock file by package name."""
    return {
        normalised(entry[1]): entry[2] for entry in PIN_PATTERN.finditer(LOCK_FILES[extra].read_text(encoding="utf-8"))
    }


def normalised(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


LOCKED_REQUIREMENTS = [  # name of a lock file, requirement that it must satisfy
    *((extra, item) for extra in TOOL_NAMES for item in PROJECT["optional-dependencies"][extra]),
    *(("", item) for item in (*PROJECT["dependencies"], *PYPROJECT["build-system"]["requires"])),
    *(
        (extra, item)
        for extra in EXTRAS
        for item in (*PROJECT["dependencies"], *PROJECT["optional-dependencies"][extra])
    ),
]


def test_locked_versions_satisfy_the_project_requirements():
    for extra, needed in LOCKED_REQUIREMENTS:
        requirement = Requirement(needed)
        with about(f"{needed} of {extra or 'the core'}"):
            assert requirement.specifier.contains(pins(extra)[normalised(requirement.name)])


@pytest.mark.parametrize("extra", LOCK_FILES)
def test_requirement_lock_files_contain_only_pins_with_hashes(extra: str):
    text = LOCK_FILES[extra].read_text(encoding="utf-8")
    assert PIN_PATTERN.sub("", text) == ""
    assert "kinesic" not in pins(extra)


def test_requirement_lock_files_have_equal_versions_of_the_same_package():
    everything: dict[str, str] = {}
    for extra in LOCK_FILES:
        for name, version in pins(extra).items():
            assert everything.setdefault(name, version) == version


def test_pyopengl_and_glfw_are_installed_only_where_films_need_them():
    markers = {
        normalised(entry[1]): entry[3] for entry in PIN_PATTERN.finditer(LOCK_FILES[""].read_text(encoding="utf-8"))
    }
    assert markers["pyopengl"] == markers["glfw"] == "sys_platform != 'linux'"
    (rendering,) = [item for item in map(Requirement, PROJECT["dependencies"]) if item.extras == {"rendering"}]
    assert str(rendering.marker) == 'sys_platform != "linux"'


def test_mujoco_is_installed_without_the_mujoco_studio_package():
    assert "mujoco-core" in pins("")
    assert not {"mujoco", "mujoco-studio"} & (pins("").keys() | pins("dev").keys())
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "kinesic").rglob("*.py")]
    assert not any(re.search(r"mujoco[. ](?:import )?studio", text) for text in sources)


def test_make_install_checks_hashes_of_locked_requirements():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "TESTED = $(INSTALL) --require-hashes --requirement" in makefile
    assert makefile.count("$(call TESTED,requirements") == 6
    assert makefile.count("$(call UNCHANGED,") == 6
    assert "--no-deps --no-build-isolation --editable ." in makefile


def test_make_installs_no_unused_extras():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (listed,) = re.findall(r"^EXTRAS := (.+)$", makefile, re.MULTILINE)
    text = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "kinesic").rglob("*.py"))
    needed = [Requirement(item) for extra in listed.split() for item in PROJECT["optional-dependencies"][extra]]
    modules = [MODULE_NAMES.get(item.name, item.name.replace("-", "_")) for item in needed]
    assert [name for name in modules if not re.search(rf"\b{name}\b", text)] == []
    assert set(listed.split()) < set(EXTRAS)
