"""Spoken form of e-mail addresses and host names."""

import re
from collections.abc import Iterator

from kinesic.intent.reading.language import Language

_HOST_ENDINGS = (  # top-level domains that are no common English words
    "com|org|net|edu|gov|mil|int|info|biz|io|ai|dev|app|eu|uk|de|fr|ch|nl|jp|cn|ru|br|pt|pl|se|dk|fi|ca|au|nz|kr|tv"
)
_HOST_PATTERN = rf"(?:[A-Za-z0-9][A-Za-z0-9-]{{0,62}}\.){{1,4}}(?:{_HOST_ENDINGS})(?![\w-])"
_EMAIL_PATTERN = r"[A-Za-z0-9][\w.+-]{0,63}@(?:[A-Za-z0-9-]{1,63}\.){1,4}[A-Za-z]{2,24}(?![\w-])"
ADDRESS_PATTERN = rf"(?<![\w@./-])(?:{_EMAIL_PATTERN}|{_HOST_PATTERN})"  # e-mail addresses and host names
_HOST_BEFORE = re.compile(rf"(?<![\w@./-]){_HOST_PATTERN}$")
_PART_PATTERN = re.compile(r"[.@]|[^\W_]+")
_SIGN_CLASSES = {".": ("dot_word", "dot"), "@": ("at_word", "at")}  # sign -> word class of its name, English name


def split_address(address: str, language: Language) -> Iterator[str]:
    """Yield the spoken words of an address (`at`, `dot`)."""
    for part in _PART_PATTERN.findall(address):
        if part in _SIGN_CLASSES:
            name, word = _SIGN_CLASSES[part]
            yield "".join(language.classes.get(name, ())) or word
        else:
            yield part


def ends_with_host(text: str) -> bool:
    """Return whether a text ends with a host name."""
    return _HOST_BEFORE.search(text) is not None
