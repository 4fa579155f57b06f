"""The versions that were tested: all that `make` installs, and nothing that ties them to a place."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
LINES = (ROOT / "requirements.lock").read_text(encoding="utf-8").splitlines()
PINS = dict(line.split("==") for line in LINES if not line.startswith("#"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = ("speech", "face", "dev")


def normalised(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


@pytest.mark.parametrize(
    "needed",
    [*PROJECT["dependencies"], *(each for extra in EXTRAS for each in PROJECT["optional-dependencies"][extra])],
)
def test_what_make_installs_has_a_tested_version_that_the_project_allows(needed: str):
    requirement = Requirement(needed)
    pins = {normalised(name): version for name, version in PINS.items()}
    assert requirement.specifier.contains(pins[normalised(requirement.name)])


def test_versions_are_tied_to_no_place():
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.!+_-]+", line) for line in LINES if not line.startswith("#"))
    assert "kinesic" not in PINS


def test_the_simulator_comes_without_its_studio_which_nothing_uses():
    assert "mujoco-core" in PINS
    assert not {"mujoco", "mujoco-studio"} & PINS.keys()
    assert {"glfw", "PyOpenGL"} <= PINS.keys()  # films need them
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "kinesic").rglob("*.py")]
    assert not any(re.search(r"mujoco[. ](?:import )?studio", text) for text in sources)


def test_make_uses_them():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "TESTED := --constraint requirements.lock" in makefile
    assert makefile.count("$(INSTALL) $(TESTED)") == 3


def test_make_installs_no_extra_of_which_kinesic_uses_nothing():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (listed,) = re.findall(r"^EXTRAS := (.+)$", makefile, re.MULTILINE)
    text = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "kinesic").rglob("*.py"))
    needed = [Requirement(each) for extra in listed.split() for each in PROJECT["optional-dependencies"][extra]]
    assert [each.name for each in needed if not re.search(rf"\b{each.name.replace('-', '_')}\b", text)] == []
    assert set(listed.split()) < set(EXTRAS)
