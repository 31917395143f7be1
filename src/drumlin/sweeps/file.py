"""Sweep files: TOML that says which keys of a brake file take which values, and which models
answer.

Listed values and ranges are combined; distributions are drawn, `cases` times for each combination.
The draws of a key depend on `seed` and the key alone: another key more, or more cases, leaves the
draws there were as they are.
"""

import hashlib
import itertools
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

import numpy as np
from pydantic import Field

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, DrumlinError
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Part, Title
from drumlin.brake.file import is_interval, read_toml, unit_of, validated, values_of, vary
from drumlin.brake.plane_brake import any_from, read_any
from drumlin.brake.units import to_si
from drumlin.fem.mesh.content import mesh_bytes
from drumlin.foundation.model import lifted
from drumlin.models import MODELS
from drumlin.sweeps.cases import Case, mesh_files, names_mesh
from drumlin.sweeps.options import OPTIONS

DEEPEST = 50  # tables and lists in one another; a sweep file has some six
MOST_CASES = 1_000_000  # a million rows fill some 2 GB


class Range(Part):
    """Values from `from` to `to`, `count` of them, evenly spread or by equal factors."""

    start: Annotated[float | str, Field(alias="from")]
    to: float | str
    count: Annotated[int, Field(ge=2, le=MOST_CASES)] = 2
    scale: Literal["linear", "log"] = "linear"


class Distribution(Part):
    """What is common to all: the name, and whether each shoe draws its own value."""

    distribution: str
    each_shoe: bool = False


class Uniform(Distribution):
    """Between `from` and `to`."""

    start: Annotated[float | str, Field(alias="from")]
    to: float | str


class Triangular(Uniform):
    """Between `from` and `to`, most often `mode`; default: the brake file's value."""

    mode: float | str | None = None


class Normal(Distribution):
    """`mean`, by default the brake file's value, and standard `deviation`, which may be in % of the
    mean.
    """

    mean: float | str | None = None
    deviation: float | str


class TruncatedNormal(Normal):
    """The same, cut off below `from` and above `to`."""

    start: Annotated[float | str, Field(alias="from")] = -math.inf
    to: float | str = math.inf


DISTRIBUTIONS: Mapping[str, type[Distribution]] = {
    "normal": Normal,
    "uniform": Uniform,
    "lognormal": Normal,
    "triangular": Triangular,
    "truncated-normal": TruncatedNormal,
}


class SweepFile(Part):
    """A sweep file as it is written."""

    title: Title | None = None
    brake: Annotated[str, Field(pattern=r"^[^\x00-\x1f]*$")] | dict[str, Any]
    combine: Literal["grid", "zip", "random"] = "grid"
    cases: Annotated[int, Field(ge=1, le=MOST_CASES)] | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    pressure: Literal["Pa", "MPa"] = "Pa"
    model: Annotated[
        dict[str, dict[str, Any]], Field(default_factory=lambda: {"fem": {}}, min_length=1)
    ]
    vary: Annotated[dict[str, Any], Field(min_length=1)]


class Sweep(NamedTuple):
    """A sweep made ready: title, base brake, SI unit of each varied key (None: words), cases, unit
    of its stresses.
    """

    title: str
    brake: Brake
    units: dict[str, str | None]
    cases: list[Case]
    pressure: str = "Pa"


Done = Callable[[int, int], None]


def read_sweep(path: Path, done: Done = lambda judged, of: None) -> Sweep:
    """The sweep described by the TOML file `path`.

    done: told how many values have been judged, and of how many. Raises BadInput with one line that
    names the key, the value and what is allowed.
    """
    try:
        data = read_toml(path)
        _check_size(data)
    except ValueError as error:
        raise BadInput(f"{path}: is not TOML ({error})") from error
    try:
        return sweep_from(data, path.parent.resolve(), done)
    except BadInput as error:
        raise BadInput(f"{path}: {error}") from error


def _check_size(data: Any, depth: int = 0) -> None:
    """Raise ValueError for integers and nesting beyond what TOML promises and what can be copied."""
    if depth > DEEPEST:
        raise ValueError(f"nested deeper than {DEEPEST}")
    if isinstance(data, int) and not -(2**63) <= data < 2**63:
        raise ValueError("an integer beyond 64 bits")
    for item in data.values() if isinstance(data, dict) else data if isinstance(data, list) else ():
        _check_size(item, depth + 1)


def sweep_from(
    data: Mapping[str, Any], base: Path = Path(), done: Done = lambda judged, of: None
) -> Sweep:
    """A sweep from nested data as a sweep file has it; `base`: folder that the paths of brake and
    meshes start from.

    done: as of `read_sweep`. Raises BadInput with one line.
    """
    file = validated(SweepFile, data)
    brake = _base_brake(file.brake, base)
    models = _models(file.model, brake)
    specs = {
        key: spec
        for name, value in file.vary.items()
        for key, spec in _specs(brake, name, value, base).items()
    }
    drawn = [key for key, spec in specs.items() if file.combine == "random" or spec.values is None]
    if drawn and file.cases is None:
        raise BadInput(f"cases: is missing: how many times {drawn[0]} is drawn, such as 1000")
    if not drawn and file.cases is not None:
        raise BadInput(
            f'cases = {file.cases}: only for distributions and combine = "random"; nothing is drawn here'
        )
    listed = {
        key: spec.values
        for key, spec in specs.items()
        if key not in drawn and spec.values is not None
    }
    draws, repeats = (
        {key: _draw(specs[key], key, file.seed, file.cases or 1) for key in drawn},
        file.cases or 1,
    )
    lengths = [len(values) for values in listed.values()]
    count = math.prod(lengths) if file.combine == "grid" else max(lengths, default=1)
    if count * repeats * len(models) > MOST_CASES:
        raise BadInput(f"vary: makes {count * repeats * len(models)} cases; allowed: {MOST_CASES}")
    changes = [
        {key: point[key] if key in point else draws[key][i] for key in specs}
        for point in _combined(file.combine, listed)
        for i in range(repeats)
    ]
    middle = {key: spec.at(np.array([0.5]))[0] for key, spec in specs.items() if key not in listed}
    # Distributions are judged by their medians. A draw that is no brake becomes a failed case of
    # the table.
    vary(brake, middle)
    steps = _steps(file.combine, lengths, repeats)
    for (key, values), step in zip(listed.items(), steps, strict=True):
        _check(brake, key, values, changes[::step], middle, done)
    for name in models:
        reason = MODELS[name].why_not(brake)
        if reason is not None:
            raise BadInput(f"model.{name}: does not apply to this brake: {reason}")
    cases = [
        Case(brake, change, name, options) for change in changes for name, options in models.items()
    ]
    named = [value for key, spec in specs.items() if names_mesh(key) for value in spec.values or ()]
    meshes = {*mesh_files(brake, {}), *(Path(value) for value in named if isinstance(value, str))}
    for path in sorted(meshes):
        try:
            mesh_bytes(path)
        except DrumlinError as error:
            raise type(error)(f"mesh = {error}") from error
    units = {key: unit_of(brake, key) for key in specs}
    return Sweep(file.title or brake.title, brake, units, cases, file.pressure)


def _base_brake(brake: str | dict[str, Any], base: Path) -> Brake:
    if isinstance(brake, str):
        return read_any(base / brake)
    try:
        return any_from(brake, unit_required=True, base=base)
    except BadInput as error:
        raise BadInput(f"brake.{error}") from error


def _models(given: Mapping[str, Mapping[str, Any]], brake: Brake) -> dict[str, dict[str, Any]]:
    """The options of each model, checked."""
    models = {}
    for name, options in given.items():
        if name not in MODELS:
            raise BadInput(f"model.{name}: unknown model; allowed: {', '.join(MODELS)}")
        models[name] = _part(f"model.{name}", OPTIONS.get(name, Part), options).model_dump(
            exclude_none=True
        )
        if "lift" in models[name] and not brake.surface.straight:
            lifted(brake, models[name]["lift"])
    return models


class _Spec(NamedTuple):
    """What a key takes: `values` one by one (None: only draws), and `at`: its values for u (n,)
    even in (0, 1).
    """

    values: list[Any] | None
    at: Callable[[Floats], list[Any]]


def _specs(brake: Brake, name: str, given: Any, base: Path) -> dict[str, _Spec]:
    """What [vary] says under a name: by key, where each shoe draws its own."""
    said = f"vary.{name if name.isidentifier() else json.dumps(name, ensure_ascii=False)}"
    try:
        unit = unit_of(brake, name)
    except BadInput as error:
        raise BadInput(f"{said}: {str(error).removeprefix(f'{name}: ')}") from error
    if isinstance(given, list):
        if not given:
            raise BadInput(f"{said}: the list is empty; needs at least one value")
        values = [_value(said, value, unit) for value in given]
        if names_mesh(name):
            values = [str(base / value) if isinstance(value, str) else value for value in values]
        return {name: _Spec(values, lambda u: [values[i] for i in (u * len(values)).astype(int)])}
    if not isinstance(given, dict):
        raise BadInput(
            f"{said} = {given!r}: must be a list of values, {{ from, to, count }} or {{ distribution, ... }}"
        )
    if unit is None:
        raise BadInput(f"{said}: takes words, not numbers; must be a list of values")
    if "distribution" not in given:
        span = _part(said, Range, given)
        ends = [_number(f"{said}.from", span.start, unit), _number(f"{said}.to", span.to, unit)]
        return {name: _range(said, ends, span)}
    kind = given["distribution"]
    if not isinstance(kind, str) or kind not in DISTRIBUTIONS:
        raise BadInput(
            f"{said}.distribution = {kind!r}: unknown; allowed: {', '.join(DISTRIBUTIONS)}"
        )
    law = _part(said, DISTRIBUTIONS[kind], given)
    if not law.each_shoe:
        return {name: _Spec(None, _law(said, law, unit, values_of(brake, name)))}
    if not name.startswith("shoe."):
        raise BadInput(
            f"{said}.each_shoe = true: only for a key of every shoe, such as shoe.lining.thickness"
        )
    keys = [f"shoe[{i}]{name.removeprefix('shoe')}" for i in range(len(brake.shoes))]
    return {key: _Spec(None, _law(said, law, unit, values_of(brake, key))) for key in keys}


K = TypeVar("K", bound=Part)


def _part(said: str, kind: type[K], data: Mapping[str, Any]) -> K:
    try:
        return validated(kind, data)
    except BadInput as error:
        raise BadInput(f"{said}: {error}") from error


def _value(said: str, value: Any, unit: str | None) -> Any:
    """One listed value: a quantity in SI, a word, or a table with its units."""
    if unit is None:
        return value
    if isinstance(value, list):
        if unit and not all(
            isinstance(leaf, str)
            for row in value
            for leaf in (row if isinstance(row, list) else [row])
        ):
            raise BadInput(f"{said}: {value}: every number of a table needs its unit")
        return value
    return _number(said, value, unit)


def _number(said: str, value: Any, unit: str) -> float:
    """A quantity in SI; a plain number where the key has no unit."""
    if unit:
        try:
            return to_si(value, unit, unit_required=True)
        except ValueError as error:
            raise BadInput(f"{said} = {value!r}: {error}") from error
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BadInput(f"{said} = {value!r}: must be a number, without unit")
    return float(value)


def _range(said: str, ends: list[float], span: Range) -> _Spec:
    a, b = ends
    if span.scale == "linear":
        return _Spec(np.linspace(a, b, span.count).tolist(), lambda u: (a + u * (b - a)).tolist())
    if not min(ends) > 0:
        raise BadInput(f'{said}.scale = "log": needs from and to greater than 0')
    return _Spec(np.geomspace(a, b, span.count).tolist(), lambda u: (a * (b / a) ** u).tolist())


def _law(
    said: str, law: Distribution, unit: str, nominal: Sequence[Any]
) -> Callable[[Floats], list[float]]:
    """The inverse of a distribution's cumulative one: u (n,) in (0, 1) -> values."""
    inverse = _inverse(said, law, unit, nominal)
    return lambda u: inverse(u).tolist()


def _inverse(
    said: str, law: Distribution, unit: str, nominal: Sequence[Any]
) -> Callable[[Floats], Floats]:
    """The same, arrays; without scipy.stats, which takes a second to load."""
    from scipy.special import ndtri  # noqa: PLC0415  (0.1 s)

    def middle(name: str, given: float | str | None) -> float:
        """What is given, or else the brake file's own value."""
        if given is not None:
            return _number(f"{said}.{name}", given, unit)
        if len(set(nominal)) > 1 or not isinstance(nominal[0], float):
            raise BadInput(
                f"{said}.{name}: is missing, and the brake file has no single number there"
            )
        return float(nominal[0])

    def end(name: str, given: float | str) -> float:
        return given if given in (-math.inf, math.inf) else _number(f"{said}.{name}", given, unit)

    if isinstance(law, Normal):
        mean = middle("mean", law.mean)
        deviation = _deviation(f"{said}.deviation", law.deviation, mean, unit)
        if isinstance(law, TruncatedNormal):
            low, high = (
                (end(*pair) - mean) / deviation for pair in (("from", law.start), ("to", law.to))
            )
            if not low < high:
                raise BadInput(f"{said}.to = {law.to!r}: must be greater than from = {law.start!r}")
            return lambda u: mean + deviation * _cut_normal(u, low, high)
        if law.distribution == "lognormal":
            if not mean > 0:
                raise BadInput(f"{said}.mean = {law.mean!r}: must be greater than 0")
            spread = math.sqrt(math.log1p((deviation / mean) ** 2))
            median = mean * math.exp(-(spread**2) / 2)
            return lambda u: median * np.exp(spread * ndtri(u))
        return lambda u: mean + deviation * ndtri(u)
    assert isinstance(law, Uniform)
    a, b = end("from", law.start), end("to", law.to)
    if not a < b:
        raise BadInput(f"{said}.to = {law.to!r}: must be greater than from = {law.start!r}")
    if not isinstance(law, Triangular):
        return lambda u: a + (b - a) * u
    c = middle("mode", law.mode)
    if not a <= c <= b:
        raise BadInput(f"{said}.mode = {c:g}: must be from {a:g} to {b:g}")
    top = (c - a) / (b - a)
    return lambda u: (
        a + (b - a) * np.where(u < top, np.sqrt(top * u), 1 - np.sqrt((1 - top) * (1 - u)))
    )


def _cut_normal(u: Floats, low: float, high: float) -> Floats:
    """The normal distribution's inverse between two ends, by the logarithms of the tail that is
    nearer to them.
    """
    from scipy.special import log_ndtr, ndtri_exp  # noqa: PLC0415  (0.1 s)

    if low > 0:
        return -_cut_normal(1 - u, -high, -low)
    below, above = log_ndtr(low), log_ndtr(high)
    found: Floats = ndtri_exp(
        np.logaddexp(below, np.log(u) + above + np.log1p(-np.exp(below - above)))
    )
    return found


def _deviation(said: str, given: float | str, mean: float, unit: str) -> float:
    """A standard deviation, absolute or in % of the mean."""
    if isinstance(given, str) and given.strip().endswith("%"):
        try:
            value = float(given.strip()[:-1]) / 100 * abs(mean)
        except ValueError as error:
            raise BadInput(f'{said} = {given!r}: must be such as "5 %" of the mean') from error
    else:
        value = _number(said, given, unit)
    if not 0 < value < math.inf:
        raise BadInput(
            f"{said} = {given!r}: must be greater than 0{' (the mean is 0)' if mean == 0 else ''}"
        )
    return value


def _draw(spec: _Spec, key: str, seed: int, count: int) -> list[Any]:
    """The draws of a key, by its own stream of random numbers."""
    stream = int.from_bytes(
        hashlib.sha256(key.encode()).digest()[:8]
    )  # in steps of 2^-53; 0 would be -infinity
    return spec.at(np.maximum(np.random.default_rng([seed, stream]).random(count), 2.0**-54))


def _combined(combine: str, listed: Mapping[str, list[Any]]) -> Iterator[dict[str, Any]]:
    """The combinations of the listed values; of a grid the last key changes first."""
    lengths = {key: len(values) for key, values in listed.items()}
    if combine == "zip" and len(set(lengths.values())) > 1:
        raise BadInput(f'combine = "zip": needs as many values of each key; there are {lengths}')
    rows = (
        zip(*listed.values(), strict=True)
        if combine == "zip" and listed
        else itertools.product(*listed.values())
    )
    for row in rows:
        yield dict(zip(listed, row, strict=True))


def _steps(combine: str, lengths: Sequence[int], repeats: int) -> list[int]:
    """Of each listed key how many cases lie between its values: the case with the value k, first of
    all, is k times that many cases after the first one.
    """
    if combine != "grid":
        return [repeats] * len(lengths)
    return [repeats * math.prod(lengths[i + 1 :]) for i in range(len(lengths))]


TOLD = 256
"""Values that are judged before progress is told of again, which takes some 0.1 s."""


def _check(
    brake: Brake,
    key: str,
    values: Sequence[Any],
    firsts: Sequence[Mapping[str, Any]],
    middle: Mapping[str, Any],
    done: Done,
) -> None:
    """Raise BadInput for a listed value that no brake can have: neither the base brake nor the
    first case with it.

    Of many numbers the extremes alone are judged, where the key `is_interval` and the base brake
    takes them.

    Parameters
    ----------
    brake : the base brake
    key, values : what is varied, as of `vary`, and its values
    firsts : the changes of the first case with each of the values, in the order of the values
    middle : the medians of what is drawn
    done : told how many values have been judged, and of how many
    """
    ends = _ends(values) if is_interval(brake, key) else []
    places = [i for i, value in enumerate(values) if not (ends and isinstance(value, float))]
    try:
        for i in ends:
            vary(brake, {key: values[i]})
    # The base brake does not take all values. Each may still fit together with values of the other
    # keys.
    except BadInput:
        places = list(dict.fromkeys([*ends, *range(len(values))]))
    for number, i in enumerate(places):
        if number % TOLD == 0:
            done(number, len(places))
        try:
            vary(brake, {key: values[i]})
        except BadInput:
            vary(brake, {**firsts[i], **middle})


def _ends(values: Sequence[Any]) -> list[int]:
    """Where the least and the greatest number of each sign, and 0, stand among the values."""
    numbers = [i for i, value in enumerate(values) if isinstance(value, float)]
    found: set[int] = set()
    for sign in (-1, 0, 1):
        own = [i for i in numbers if (values[i] > 0) - (values[i] < 0) == sign]
        if own:
            found |= {min(own, key=values.__getitem__), max(own, key=values.__getitem__)}
    return sorted(found)
