import sys

import PIL.Image
import pytest

from kinesic.files.late_pillow import Image, explain_missing_pillow


def test_pillow_stand_in_has_the_attributes_of_the_module():
    assert Image.fromarray is PIL.Image.fromarray
    assert explain_missing_pillow() is None


def test_missing_pillow_error_names_the_extra_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    reason = explain_missing_pillow()
    assert reason is not None
    assert reason.startswith("Pillow is not installed: ")
    assert reason.endswith('kinesic[film]"')
    with pytest.raises(ModuleNotFoundError, match="PIL"):
        type(Image)("ImageMath").eval  # noqa: B018 - the access imports it


def test_pillow_stand_in_has_no_wrapped_attribute():
    assert not hasattr(Image, "__wrapped__")
