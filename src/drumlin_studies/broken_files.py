"""Brake files broken on purpose: bytes lost or doubled, values out of all proportion, keys renamed,
files too large.
"""

import math
import random
import tomllib
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

UNITS = ("mm", "m", "deg", "rad", "N", "kN", "Pa", "GPa", "s", "", "furlong")


class Sound(NamedTuple):
    """What is broken: the texts of sound brake files, and of the one whose first shoe is meshed."""

    brakes: tuple[bytes, ...]
    meshed: bytes


class Input(NamedTuple):
    """Files by name; `brake.toml` is what drumlin reads. `must_fail`: no number may come of it."""

    kind: str
    files: dict[str, bytes]
    must_fail: bool


def noisy_text(rng: random.Random, sound: Sound) -> Input:
    """A brake file with bytes dropped, doubled, swapped or overwritten."""
    return Input("brake file: bytes", {"brake.toml": noise(rng, rng.choice(sound.brakes))}, False)


def changed_values(rng: random.Random, sound: Sound) -> Input:
    """One to four values of a brake file scaled, negated, made infinite or given another unit."""
    data = tomllib.loads(rng.choice(sound.brakes).decode())
    places = list(_leaves(data))
    for place in rng.sample(places, min(len(places), rng.randint(1, 4))):
        _put(data, place, _other_value(rng, _get(data, place)))
    return Input("brake file: values", {"brake.toml": toml(data)}, False)


def broken_structure(rng: random.Random, sound: Sound) -> Input:
    """A brake file with a key renamed or a value of another type: no brake any more."""
    data = tomllib.loads(rng.choice(sound.brakes).decode())
    named = [
        place
        for place in _leaves(data)
        if isinstance(place[-1], str) and place[-1] not in {"title", "name"}
    ]
    *parents, key = rng.choice(named)
    owner = _get(data, tuple(parents))
    if rng.random() < 0.5:
        owner[key + rng.choice(["_", "x", " "])] = owner.pop(key)
    else:
        owner[key] = rng.choice(
            [{"a": 1}, [], [[1, 2], 3], True, "", "12", "3 mm mm", "nan mm", "NaN", "1e999 m"]
        )
    return Input("brake file: structure", {"brake.toml": toml(data)}, True)


def huge_file(rng: random.Random, sound: Sound) -> Input:
    """A brake file that is deep, long or wide beyond sense."""
    text = rng.choice(sound.brakes).decode()
    texts: list[Callable[[], str]] = [
        lambda: text + "\nx = " + "[" * 50_000,
        lambda: text + "\n# " + "x" * 2_000_000,
        lambda: "[a." + ".".join("b" for _ in range(20_000)) + "]",
        lambda: text.replace('width = "', 'width = "' + "9" * 5_000, 1),
        lambda: "\0" * 900_000,
        lambda: text.replace("[[shoe]]", "[[shoe]]\n" * 20_000, 1),
    ]
    return Input("brake file: huge", {"brake.toml": rng.choice(texts)().encode()}, True)


def noise(rng: random.Random, data: bytes, words: Sequence[str] = ()) -> bytes:
    """Bytes dropped, doubled, inserted, overwritten, turned round, or some of `words` among them."""
    found = bytearray(data)
    for _ in range(rng.choice([1, 1, 2, 5, 40])):
        at = rng.randrange(len(found) + 1)
        end = min(len(found), at + rng.choice([1, 1, 3, 20, 200]))
        what = rng.randrange(6 if words else 5)
        if what == 0:
            del found[at:end]
        elif what == 1:
            found[at:at] = found[at:end] * rng.choice([1, 1, 50])
        elif what == 2:
            found[at:at] = bytes([rng.randrange(256)])
        elif what == 3 and at < len(found):
            found[at] = rng.choice(b'0123456789.-e"[]{}=\n ,nafi\0\x1b')
        elif what == 5:
            found[at:at] = rng.choice(words).encode(errors="replace")
        else:
            found[at:end] = found[at:end][::-1]
    return bytes(found)


def _other_value(rng: random.Random, value: Any) -> Any:
    if isinstance(value, str) and value[:1] in "0123456789-+." and " " in value:
        number, unit = value.split(" ", 1)
        factor = rng.choice(
            [
                0,
                -1,
                1,
                1e300,
                1e-300,
                math.nan,
                math.inf,
                10 ** rng.uniform(-9, 9),
                rng.uniform(0.3, 3),
            ]
        )
        shift = rng.choice([0, 0, 0, rng.uniform(-100, 100)])
        return f"{float(number) * factor + shift!r} {unit if rng.random() < 0.9 else rng.choice(UNITS)}"
    if isinstance(value, bool | str):
        return rng.choice([value, value, "clockwise", "external", "beam", "", "ü"])
    return rng.choice(
        [0, -1, value, rng.uniform(0, 5), 1e9, math.inf, math.nan, 10 ** rng.uniform(-12, 12)]
    )


def _leaves(data: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _leaves(value, (*place, key))
    elif isinstance(data, list):
        for i, value in enumerate(data):
            yield from _leaves(value, (*place, i))
    else:
        yield place


def _get(data: Any, place: tuple[Any, ...]) -> Any:
    for step in place:
        data = data[step]
    return data


def _put(data: Any, place: tuple[Any, ...], value: Any) -> None:
    _get(data, place[:-1])[place[-1]] = value


def toml(data: Any) -> bytes:
    """Nested data as TOML: everything below the top as inline tables."""
    return "".join(
        f"{_quoted(str(key))} = {_inline(value)}\n" for key, value in data.items()
    ).encode(errors="replace")


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return (
            "{"
            + ", ".join(f"{_quoted(str(key))} = {_inline(item)}" for key, item in value.items())
            + "}"
        )
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Raw):
        return value.text
    return _quoted(value) if isinstance(value, str) else repr(value)


def _quoted(text: str) -> str:
    plain = {'"': '\\"', "\\": "\\\\"}
    return (
        '"'
        + "".join(plain.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in text)
        + '"'
    )


class Raw(NamedTuple):
    """What stands in a file without quotes."""

    text: str
