"""Mutations of valid files, chosen by a seeded generator."""

import json
import random
from collections.abc import Iterator
from copy import deepcopy

Tables = dict[str, object]
ODD_VALUES: tuple[object, ...] = (
    -1, 0, 1, 2**63, 10**30, -0.5, 1e300, 0.5, "", "x", "../x", "\u0000", "a" * 300, True, False,
    [], [[]], [1], ["x"], [{}], {}, {"x": 1}, {"name": ["x"]}, [[1, 2], [3]], [0.0, 0.0, 0.0],
)  # fmt: skip


def spelled(value: object) -> str:
    """Return a value as TOML text with inline tables."""
    match value:
        case bool():
            return "true" if value else "false"
        case dict():
            return "{" + ", ".join(f"{json.dumps(str(key))} = {spelled(each)}" for key, each in value.items()) + "}"
        case list() | tuple():
            return "[" + ", ".join(map(spelled, value)) + "]"
        case str():
            return json.dumps(value).replace("\x7f", "\\u007f")
        case float():
            return repr(value) if value == value else "nan"
        case _:
            return str(value)


def toml(tables: Tables) -> str:
    return "".join(f"{json.dumps(key)} = {spelled(value)}\n" for key, value in tables.items())


def places(value: object, *, above: tuple[object, ...] = ()) -> Iterator[tuple[object, ...]]:
    """Return the paths to all items nested in a value."""
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in entries:
        yield (*above, key)
        yield from places(item, above=(*above, key))


def altered(tables: Tables, choose: random.Random) -> Tables:
    """Return a copy with up to three values altered."""
    data: Tables = json.loads(json.dumps(tables))
    for _ in range(choose.choice((1, 1, 1, 2, 3))):
        *way, last = choose.choice(list(places(data)) or [("x",)])
        inside: object = data
        for key in way:
            inside = inside[key]
        assert isinstance(inside, dict | list)
        match choose.choice(("value", "value", "value", "value", "missing", "twice", "renamed", "shape")):
            case "missing" if last in inside or isinstance(inside, list):
                del inside[last]
            case "twice" if isinstance(inside, list):
                inside.append(inside[last])
            case "renamed" if isinstance(inside, dict):
                inside[choose.choice(("x", "", "name", "l_arm", f"{last}x"))] = inside.pop(last, 1)
            case "shape":
                inside[last] = (
                    choose.choice(([inside[last]], {"x": inside[last]}, [inside[last]] * 2))
                    if last in inside or isinstance(inside, list)
                    else 1
                )
            case _:
                inside[last] = deepcopy(choose.choice(ODD_VALUES))
    return data


def damaged(data: bytes, choose: random.Random) -> bytes:
    """Return a copy with bytes changed, removed or inserted."""
    results = bytearray(data)
    for _ in range(choose.choice((1, 1, 2, 4, 16))):
        at = (
            choose.randrange(len(results) + 1) if choose.random() < 0.5 else choose.randrange(min(len(results), 80) + 1)
        )
        match choose.choice(("flip", "flip", "set", "cut", "lose", "insert", "number")):
            case "flip" if at < len(results):
                results[at] ^= 1 << choose.randrange(8)
            case "set" if at < len(results):
                results[at] = choose.choice((0, 1, 127, 128, 255))
            case "cut":
                del results[at:]
            case "lose":
                del results[at : at + choose.randrange(1, 40)]
            case "number":
                results[at : at + 4] = choose.choice((0, 1, 2**31 - 1, 2**31, 2**32 - 1)).to_bytes(4, "little")
            case _:
                results[at:at] = choose.randbytes(choose.randrange(1, 9))
    return bytes(results)
