"""Deprecated path `kinesic.controller.perform`."""

import re

import pytest

from kinesic.controller import perform


@pytest.mark.parametrize(("name", "path"), sorted(perform.NEW_PATHS.items()))
def test_names_moved_out_of_controller_perform_are_imported_with_a_deprecation_warning(name, path):
    with pytest.warns(DeprecationWarning, match=re.escape(f"perform.{name} is deprecated: use {path}")):
        moved = getattr(perform, name)
    assert f"{moved.__module__}.{moved.__name__}" == path


def test_unknown_name_in_deprecated_module_raises_attribute_error():
    with pytest.raises(AttributeError, match="no attribute facts"):
        _ = perform.facts
