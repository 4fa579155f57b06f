import sys

import pytest

from kinesic.face.assets.late_scipy import scipy
from kinesic.face.display import DisplayError


def test_lazily_imported_scipy_gives_the_real_subpackage():
    assert scipy.sparse is sys.modules["scipy.sparse"]


def test_missing_scipy_is_reported_with_its_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)
    monkeypatch.delitem(sys.modules, "scipy.spatial", raising=False)
    with pytest.raises(DisplayError, match=r'scipy is not installed: .*kinesic\[face\]"'):
        type(scipy)().spatial  # noqa: B018 - the access imports it


def test_lazily_imported_scipy_has_no_private_attributes():
    assert not hasattr(scipy, "__wrapped__")
