"""The licences of others: NOTICE names every package that the project asks for, and nothing else."""

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
ROW = re.compile(r"^  (\S+) +(\S.+)$", re.MULTILINE)


def direct_dependencies() -> set[str]:
    """Return the packages that pyproject.toml names, extras and the build's included."""
    project = PYPROJECT["project"]
    lists = [project["dependencies"], *project["optional-dependencies"].values(), PYPROJECT["build-system"]["requires"]]
    names = {canonicalize_name(Requirement(each).name) for one in lists for each in one}
    return names - {"kinesic"}


def test_notice_gives_the_licence_of_every_direct_dependency_and_of_no_other_package():
    rows = dict(ROW.findall((ROOT / "NOTICE").read_text(encoding="utf-8")))
    assert {canonicalize_name(name) for name in rows} == direct_dependencies()
    assert [name for name, licence in rows.items() if not re.search(r"MIT|BSD|Apache|L?GPL|MPL|its own", licence)] == []
