"""Any text becomes a short file name, valid on every system."""

import re
from pathlib import Path, PureWindowsPath

from hypothesis import given
from hypothesis import strategies as st

from kinesic.files.plain_name import MAX_STEM_LENGTH, cut_name, is_device_name, plain_stem

HOSTILE_TEXTS = st.one_of(
    st.text(st.characters(), max_size=300),
    st.lists(
        st.sampled_from(("/", "\\", "..", ".", "con", "NUL", "C:", "a", "\0", "\n", " ", "-", "_")), max_size=9
    ).map("".join),
)


@given(HOSTILE_TEXTS)
def test_plain_stem_is_a_short_portable_file_name(text: str):
    stem = plain_stem(text, fallback="performance")
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", stem)
    assert len(stem) <= MAX_STEM_LENGTH + 1  # A device name is extended by one character
    for name in (stem, f"{stem}.csv"):
        assert not is_device_name(name)
        assert Path(name).name == PureWindowsPath(name).name == name


@given(HOSTILE_TEXTS, st.integers(0, 300))
def test_long_name_is_truncated_by_bytes_at_its_end(text: str, limit: int):
    cut = cut_name(text, limit=limit)
    assert len(cut.encode()) <= limit
    assert text.encode("utf-8", "ignore").decode().startswith(cut)
