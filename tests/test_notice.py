"""Licences of dependencies: NOTICE lists exactly the required packages."""

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LICENCE_PATTERN = re.compile(r"MIT|BSD|ISC|Apache|L?GPL|MPL|its own")
LICENCE_ROW = re.compile(r"^  (\S+) +(\S.+)$", re.MULTILINE)


def direct_dependencies() -> set[str]:
    """Return the packages of pyproject.toml, with extras and build requirements."""
    project = PYPROJECT["project"]
    lists = [project["dependencies"], *project["optional-dependencies"].values(), PYPROJECT["build-system"]["requires"]]
    names = {canonicalize_name(Requirement(item).name) for one in lists for item in one}
    return names - {"kinesic"}


def test_notice_lists_licences_of_exactly_the_direct_dependencies():
    rows = dict(LICENCE_ROW.findall((ROOT / "NOTICE").read_text(encoding="utf-8")))
    assert {canonicalize_name(name) for name in rows} == direct_dependencies()
    assert [name for name, licence in rows.items() if not LICENCE_PATTERN.search(licence)] == []
