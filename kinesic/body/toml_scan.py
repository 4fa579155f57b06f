"""Looks a TOML text over before it is parsed: what would keep the parser busy for minutes, or exhaust it, is refused.

The time of the parser grows with the square of the parts of a dotted key, and it calls itself for every nesting.
"""

import re

MOST_PARTS = 32  # of a dotted key
MOST_NESTED = 32  # lists and tables inside one another

_PART = r"""(?:"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|[\w+-]++)"""  # of a key, or a value
_DOT = r"[ \t]*+\.[ \t]*+"
_BASIC = r"""\"{3}(?:[^"\\]|\\.?|"{1,2}(?!"))*+(?:"{3,5}|\Z)"""  # strings of several lines
_LITERAL = r"""'{3}(?:[^']|'{1,2}(?!'))*+(?:'{3,5}|\Z)"""
_DEEP = rf"(?P<deep>{_PART}(?:{_DOT}{_PART}){{{MOST_PARTS}}})"
_REST = r"""[^\w+"'#\[\]{}-]++|."""
_TOKENS = re.compile(
    rf"{_BASIC}|{_LITERAL}|{_DEEP}|{_PART}(?:{_DOT}{_PART})*+|\#[^\n]*+|(?P<open>[\[{{])|(?P<close>[\]}}])|{_REST}",
    re.DOTALL,
)


def find_excess(text: str) -> str:
    """Says what of a text is too much to be parsed, and where; nothing when it may be parsed."""
    nested = 0
    for token in _TOKENS.finditer(text):
        match token.lastgroup:
            case "open":
                nested += 1
                if nested > MOST_NESTED:
                    return f"in {_line(text, token)} more than {MOST_NESTED} lists or tables are inside one another"
            case "close":
                nested -= 1
            case "deep":
                return f"a key in {_line(text, token)} has more than {MOST_PARTS} parts; a.b.c has three"
    return ""


def _line(text: str, token: re.Match[str]) -> str:
    return f"line {text.count(chr(10), 0, token.start()) + 1}"
