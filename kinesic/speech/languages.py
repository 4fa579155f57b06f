"""Which of espeak-ng's voices speaks a language."""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

DEFAULT = "en-us"
ALIASES: Mapping[str, str] = {  # tags that the files of espeak-ng spell otherwise
    "en": DEFAULT,
    "en-gb": "en",
    "iw": "he",
    "no": "nb",
    "pt-pt": "pt",
    "zh": "cmn",
    "zh-hk": "yue",
}


@lru_cache(maxsize=4)
def voices(data: Path) -> Mapping[str, str]:
    """Language tag, in small letters -> name of its voice for espeak-ng, from the folder of its data."""
    folder = data / "espeak-ng-data" / "lang"
    return {path.name.lower(): path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def voice_of(language: str, data: Path) -> tuple[str, str]:
    """The voice of a language, and a remark where it is another's.

    A tag that is too precise is made shorter: `de-AT` is spoken by `de`.

    Args:
        language: BCP 47 tag, in any spelling.
        data: folder that holds espeak-ng's data.
    """
    known = voices(data)
    tag = language.strip().replace("_", "-").lower()
    while tag:
        found = known.get(ALIASES.get(tag, tag))
        if found:
            return found, ""
        tag = tag.rpartition("-")[0]
    return known.get(DEFAULT, DEFAULT), f"no voice speaks {language!r}: it is read as if it were English"
