"""Whatever text a file name is made of: it is one plain, short name on every operating system."""

import re
from pathlib import Path, PureWindowsPath

from hypothesis import given
from hypothesis import strategies as st

from kinesic.files.plain_name import MAX_STEM_LENGTH, cut_name, is_device_name, plain_stem

HOSTILE = st.one_of(
    st.text(st.characters(), max_size=300),
    st.lists(
        st.sampled_from(("/", "\\", "..", ".", "con", "NUL", "C:", "a", "\0", "\n", " ", "-", "_")), max_size=9
    ).map("".join),
)


@given(HOSTILE)
def test_a_plain_stem_is_one_name_that_no_system_reserves(text: str):
    stem = plain_stem(text, fallback="performance")
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", stem)
    assert len(stem) <= MAX_STEM_LENGTH + 1  # a device's name gets one more
    for name in (stem, f"{stem}.csv"):
        assert not is_device_name(name)
        assert Path(name).name == PureWindowsPath(name).name == name


@given(HOSTILE, st.integers(0, 300))
def test_a_name_is_cut_by_bytes_and_only_at_its_end(text: str, limit: int):
    cut = cut_name(text, limit=limit)
    assert len(cut.encode()) <= limit
    assert text.encode("utf-8", "ignore").decode().startswith(cut)
