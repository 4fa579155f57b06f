"""The files that were tested: all that `make` installs, each by its hash, and nothing that ties them to a place."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
EXTRAS = ("speech", "face", "dev")
LISTS = {extra: ROOT / f"requirements-{extra}.lock" for extra in EXTRAS} | {"": ROOT / "requirements.lock"}
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
ENTRY = re.compile(
    r"([A-Za-z0-9._-]+)==([A-Za-z0-9.!+_-]+)(?: ; ([^\\\n]+))?((?: \\\n    --hash=sha256:[0-9a-f]{64})+)\n"
)


def pins(extra: str) -> dict[str, str]:
    """Return the versions of a list by the names of their packages."""
    return {normalised(entry[1]): entry[2] for entry in ENTRY.finditer(LISTS[extra].read_text(encoding="utf-8"))}


def normalised(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


NEEDED = [
    *(("", each) for each in (*PROJECT["dependencies"], *PYPROJECT["build-system"]["requires"])),
    *(
        (extra, each)
        for extra in EXTRAS
        for each in (*PROJECT["dependencies"], *PROJECT["optional-dependencies"][extra])
    ),
]


@pytest.mark.parametrize(("extra", "needed"), NEEDED)
def test_what_make_installs_has_a_tested_version_that_the_project_allows(extra: str, needed: str):
    requirement = Requirement(needed)
    assert requirement.specifier.contains(pins(extra)[normalised(requirement.name)])


@pytest.mark.parametrize("extra", LISTS)
def test_every_file_is_known_by_its_hash_and_by_no_address(extra: str):
    text = LISTS[extra].read_text(encoding="utf-8")
    assert ENTRY.sub("", text) == ""
    assert "kinesic" not in pins(extra)


def test_all_lists_have_the_same_versions():
    everything: dict[str, str] = {}
    for extra in LISTS:
        for name, version in pins(extra).items():
            assert everything.setdefault(name, version) == version


def test_the_simulator_comes_without_its_studio_which_nothing_uses():
    assert {"mujoco-core", "glfw", "pyopengl"} <= pins("").keys()  # films need the last two
    assert not {"mujoco", "mujoco-studio"} & (pins("").keys() | pins("dev").keys())
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "kinesic").rglob("*.py")]
    assert not any(re.search(r"mujoco[. ](?:import )?studio", text) for text in sources)


def test_make_installs_by_hashes_and_stops_where_a_file_was_exchanged():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "TESTED = $(INSTALL) --require-hashes --requirement" in makefile
    assert makefile.count("$(call TESTED,requirements") == 3
    assert makefile.count("$(call UNCHANGED,") == 3
    assert "--no-deps --no-build-isolation --editable ." in makefile


def test_make_installs_no_extra_of_which_kinesic_uses_nothing():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (listed,) = re.findall(r"^EXTRAS := (.+)$", makefile, re.MULTILINE)
    text = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "kinesic").rglob("*.py"))
    needed = [Requirement(each) for extra in listed.split() for each in PROJECT["optional-dependencies"][extra]]
    assert [each.name for each in needed if not re.search(rf"\b{each.name.replace('-', '_')}\b", text)] == []
    assert set(listed.split()) < set(EXTRAS)
