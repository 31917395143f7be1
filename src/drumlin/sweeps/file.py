"""Sweep files: TOML that says which keys of a brake file vary and which models answer.

Listed values and ranges are combined with one another. Distributions are drawn, `cases` times for
each combination. The draws of a key depend on `seed` and on the key alone: a further key, or more
cases, leaves the earlier draws as they are.
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
from drumlin.fem.mesh.content import read_mesh_bytes
from drumlin.foundation.model import included_effects
from drumlin.models import MODELS
from drumlin.sweeps.cases import SweepCase, is_mesh_key, mesh_files
from drumlin.sweeps.options import MODEL_OPTIONS

MAX_FILE_NESTING = 50
"""Largest depth of tables and lists in one another that is read. A sweep file needs some six; a
file beyond the limit is refused, since copying it would exhaust Python's recursion."""

MOST_CASES = 1_000_000
"""Largest number of cases in a sweep. A million rows fill some 2 GB of memory."""

VALUES_PER_REPORT = 256
"""Listed values that are judged between two reports of progress: some 0.1 s of work."""


class Range(Part):
    """Values from `from` to `to`, `count` of them, evenly spread or by equal factors."""

    start: Annotated[float | str, Field(alias="from")]
    to: float | str
    count: Annotated[int, Field(ge=2, le=MOST_CASES)] = 2
    scale: Literal["linear", "log"] = "linear"


class Distribution(Part):
    """The keys of every distribution: its name, and whether each shoe draws a value of its own."""

    distribution: str
    each_shoe: bool = False


class Uniform(Distribution):
    """Values between `from` and `to`, all equally likely."""

    start: Annotated[float | str, Field(alias="from")]
    to: float | str


class Triangular(Uniform):
    """Values between `from` and `to`, most often `mode`; by default the brake file's value."""

    mode: float | str | None = None


class Normal(Distribution):
    """Values about `mean`, by default the brake file's value, with the standard `deviation`.

    The deviation may be in % of the mean.
    """

    mean: float | str | None = None
    deviation: float | str


class TruncatedNormal(Normal):
    """A normal distribution that is cut off below `from` and above `to`."""

    start: Annotated[float | str, Field(alias="from")] = -math.inf
    to: float | str = math.inf


DISTRIBUTIONS: Mapping[str, type[Distribution]] = {
    "normal": Normal,
    "uniform": Uniform,
    "lognormal": Normal,
    "triangular": Triangular,
    "truncated-normal": TruncatedNormal,
}
"""The class that reads a distribution, by the name that a sweep file gives it."""


class SweepFile(Part):
    """The keys of a sweep file, with the values that the file gives."""

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
    """A sweep ready to be solved.

    Attributes
    ----------
    title : of the sweep file, or else of its brake
    brake : the base brake
    units : SI unit of each varied key; None where the key takes words
    cases : all cases, in the order of the table
    pressure : unit of the table's stresses, "Pa" or "MPa"
    """

    title: str
    brake: Brake
    units: dict[str, str | None]
    cases: list[SweepCase]
    pressure: str = "Pa"


Done = Callable[[int, int], None]
"""A function that shows how many values have been judged, and of how many."""


def read_sweep(path: Path, done: Done = lambda judged, of: None) -> Sweep:
    """Read the sweep that the TOML file `path` describes.

    `done` is told how many values have been judged, and of how many. Raises BadInput with one line
    that names the key, the value and what is allowed.
    """
    try:
        data = read_toml(path)
        _check_size(data)
    except ValueError as error:
        raise BadInput(f"{path}: is not TOML ({error})") from error
    try:
        return sweep_from_data(data, path.parent.resolve(), done)
    except BadInput as error:
        raise BadInput(f"{path}: {error}") from error


def _check_size(data: Any, depth: int = 0) -> None:
    """Raise ValueError for integers beyond TOML's range and for nesting too deep to be copied."""
    if depth > MAX_FILE_NESTING:
        raise ValueError(f"nested deeper than {MAX_FILE_NESTING}")
    if isinstance(data, int) and not -(2**63) <= data < 2**63:
        raise ValueError("an integer beyond 64 bits")
    items = list(data.values()) if isinstance(data, dict) else data
    if isinstance(items, list):
        for item in items:
            _check_size(item, depth + 1)


def sweep_from_data(
    data: Mapping[str, Any], base: Path = Path(), done: Done = lambda judged, of: None
) -> Sweep:
    """Make a sweep from nested data as a sweep file holds them.

    Parameters
    ----------
    data : tables and values by key
    base : folder from which the paths of the brake file and of meshes start
    done : told how many values have been judged, and of how many

    Raises
    ------
    BadInput
        in one line that names the key, the value and what is allowed
    """
    file = validated(SweepFile, data)
    # The brake is read first, since the keys and models are judged by the brake.
    brake = _base_brake(file.brake, base)
    models = _validated_model_options(file.model, brake)
    specs: dict[str, _KeySpec] = {}
    for name, given in file.vary.items():
        specs |= _specs_of_line(brake, name, given, base)
    plan = _plan_cases(file, specs)
    changes = _changes_of_cases(file, specs, plan, len(models))
    _check_values(brake, file.combine, specs, plan, changes, done)
    for name in models:
        reason = MODELS[name].why_not(brake)
        if reason is not None:
            raise BadInput(f"model.{name}: does not apply to this brake: {reason}")
    _check_meshes(brake, specs)
    cases = []
    for change in changes:
        cases += [SweepCase(brake, change, name, options) for name, options in models.items()]
    units = {key: unit_of(brake, key) for key in specs}
    return Sweep(file.title or brake.title, brake, units, cases, file.pressure)


def _base_brake(brake: str | dict[str, Any], base: Path) -> Brake:
    """The brake that a sweep file names by its path or holds as a table."""
    if isinstance(brake, str):
        return read_any(base / brake)
    try:
        return any_from(brake, unit_required=True, base=base)
    except BadInput as error:
        raise BadInput(f"brake.{error}") from error


def _validated_model_options(
    given: Mapping[str, Mapping[str, Any]], brake: Brake
) -> dict[str, dict[str, Any]]:
    """The checked options of each model that the sweep file names."""
    models = {}
    for name, options in given.items():
        if name not in MODELS:
            raise BadInput(f"model.{name}: unknown model; allowed: {', '.join(MODELS)}")
        checked = _validate_sweep_table(f"model.{name}", MODEL_OPTIONS.get(name, Part), options)
        models[name] = checked.model_dump(exclude_none=True)
        # The foundation model refuses a brake on a plane altogether, as its `why_not` says later.
        if "lift" in models[name] and not brake.surface.straight:
            included_effects(brake, models[name]["lift"])
    return models


class _KeySpec(NamedTuple):
    """The values that a varied key takes.

    Attributes
    ----------
    values : the listed values; None where the key is only drawn
    at : values (n,) of the key for numbers u (n,) in (0, 1), which a draw spreads evenly
    """

    values: list[Any] | None
    at: Callable[[Floats], list[Any]]


class _Plan(NamedTuple):
    """How the varied keys make cases.

    Attributes
    ----------
    listed : the values of each key that are taken one by one
    drawn : the keys that are drawn
    repeats : number of draws for each combination of the listed values
    """

    listed: dict[str, list[Any]]
    drawn: list[str]
    repeats: int


def _plan_cases(file: SweepFile, specs: Mapping[str, _KeySpec]) -> _Plan:
    """Decide which keys are drawn and which are listed. Raises BadInput for a wrong `cases`."""
    everything = file.combine == "random"
    drawn = [key for key, spec in specs.items() if everything or spec.values is None]
    if drawn and file.cases is None:
        raise BadInput(f"cases: is missing: how many times {drawn[0]} is drawn, such as 1000")
    if not drawn and file.cases is not None:
        raise BadInput(
            f"cases = {file.cases}: "
            'only for distributions and combine = "random"; nothing is drawn here'
        )
    listed = {}
    for key, spec in specs.items():
        if key not in drawn and spec.values is not None:
            listed[key] = spec.values
    return _Plan(listed, drawn, file.cases or 1)


def _changes_of_cases(
    file: SweepFile, specs: Mapping[str, _KeySpec], plan: _Plan, models: int
) -> list[dict[str, Any]]:
    """The changed keys of each case.

    Parameters
    ----------
    file : the sweep file
    specs : values of each varied key; the changes keep the order of its keys
    plan : how the keys make cases
    models : number of models that solve each of these cases

    Raises
    ------
    BadInput
        for more than MOST_CASES cases, and for lists of unequal lengths that are paired
    """
    draws = {}
    for key in plan.drawn:
        draws[key] = _drawn_values(specs[key], key, file.seed, plan.repeats)
    lengths = list(map(len, plan.listed.values()))
    combinations = math.prod(lengths) if file.combine == "grid" else max(lengths, default=1)
    count = combinations * plan.repeats * models
    if count > MOST_CASES:
        raise BadInput(f"vary: makes {count} cases; allowed: {MOST_CASES}")
    # Each combination of listed values meets the same draws and can be compared.
    changes = []
    for point in _combinations_of_values(file.combine, plan.listed):
        for i in range(plan.repeats):
            changes.append({key: point[key] if key in point else draws[key][i] for key in specs})
    return changes


def _check_values(
    brake: Brake,
    combine: str,
    specs: Mapping[str, _KeySpec],
    plan: _Plan,
    changes: Sequence[Mapping[str, Any]],
    done: Done,
) -> None:
    """Raise BadInput for medians and listed values that no brake can have.

    A distribution is judged by its median alone. A draw that makes no brake becomes a failed case
    of the table.

    Parameters
    ----------
    brake : the base brake
    combine : how the listed values are combined: "grid", "zip" or "random"
    specs : values of each varied key
    plan : how the keys make cases
    changes : the changed keys of each case
    done : told how many values have been judged, and of how many
    """
    # The median is the value at half of the cumulative function.
    half = np.array([0.5])
    medians = {key: spec.at(half)[0] for key, spec in specs.items() if key not in plan.listed}
    vary(brake, medians)
    lengths = list(map(len, plan.listed.values()))
    steps = _cases_per_step(combine, lengths, plan.repeats)
    for (key, values), step in zip(plan.listed.items(), steps, strict=True):
        _check_key(brake, _ListedKey(key, values, changes[::step]), medians, done)


def _check_meshes(brake: Brake, specs: Mapping[str, _KeySpec]) -> None:
    """Raise BadInput or NoAnswer for a mesh file of the sweep that cannot be read."""
    # Each mesh file is read once, before the first case is solved.
    meshes = set(mesh_files(brake, {}))
    for key, spec in specs.items():
        if is_mesh_key(key):
            meshes |= {Path(value) for value in spec.values or () if isinstance(value, str)}
    for path in sorted(meshes):
        try:
            read_mesh_bytes(path)
        except DrumlinError as error:
            raise type(error)(f"mesh = {error}") from error


def _specs_of_line(brake: Brake, name: str, given: Any, base: Path) -> dict[str, _KeySpec]:
    """The values that one line of [vary] gives, by key.

    A distribution of which each shoe draws its own value has a key for each shoe.

    Parameters
    ----------
    brake : the base brake
    name : the key as the sweep file writes it
    given : what the file says under this key: a list, or a table of a range or distribution
    base : folder from which the paths of meshes start
    """
    where = f"vary.{name if name.isidentifier() else json.dumps(name, ensure_ascii=False)}"
    try:
        unit = unit_of(brake, name)
    except BadInput as error:
        raise BadInput(f"{where}: {str(error).removeprefix(f'{name}: ')}") from error
    if isinstance(given, list):
        return {name: _listed_values(where, name, given, unit, base)}
    if not isinstance(given, dict):
        raise BadInput(
            f"{where} = {given!r}: "
            "must be a list of values, { from, to, count } or { distribution, ... }"
        )
    if unit is None:
        raise BadInput(f"{where}: takes words, not numbers; must be a list of values")
    if "distribution" in given:
        return _specs_of_distribution(brake, where, name, given, unit)
    span = _validate_sweep_table(where, Range, given)
    start = _number_in_si(f"{where}.from", span.start, unit)
    end = _number_in_si(f"{where}.to", span.to, unit)
    return {name: _range_values(where, start, end, span)}


def _listed_values(
    where: str, name: str, given: list[Any], unit: str | None, base: Path
) -> _KeySpec:
    """The values of a list.

    Parameters
    ----------
    where : place in the sweep file, for messages
    name : the varied key
    given : the list
    unit : SI unit of the key; None for words
    base : folder from which the paths of meshes start
    """
    if not given:
        raise BadInput(f"{where}: the list is empty; needs at least one value")
    values = [_listed_value(where, value, unit) for value in given]
    if is_mesh_key(name):
        values = [str(base / value) if isinstance(value, str) else value for value in values]

    def at(u: Floats) -> list[Any]:
        """The values whose equal shares of (0, 1) the numbers u (n,) lie in."""
        return [values[i] for i in (u * len(values)).astype(int)]

    return _KeySpec(values, at)


def _specs_of_distribution(
    brake: Brake, where: str, name: str, given: Mapping[str, Any], unit: str
) -> dict[str, _KeySpec]:
    """The values of a distribution, by key.

    Parameters
    ----------
    brake : the base brake
    where : place in the sweep file, for messages
    name : the varied key
    given : the table of the distribution
    unit : SI unit of the key
    """
    kind = given["distribution"]
    if not isinstance(kind, str) or kind not in DISTRIBUTIONS:
        raise BadInput(
            f"{where}.distribution = {kind!r}: unknown; allowed: {', '.join(DISTRIBUTIONS)}"
        )
    distribution = _validate_sweep_table(where, DISTRIBUTIONS[kind], given)
    keys = [name]
    if distribution.each_shoe:
        if not name.startswith("shoe."):
            raise BadInput(
                f"{where}.each_shoe = true: "
                "only for a key of every shoe, such as shoe.lining.thickness"
            )
        keys = [f"shoe[{i}]{name.removeprefix('shoe')}" for i in range(len(brake.shoes))]
    specs = {}
    for key in keys:
        nominal = values_of(brake, key)
        specs[key] = _KeySpec(None, _draw_function(where, distribution, unit, nominal))
    return specs


PartKind = TypeVar("PartKind", bound=Part)


def _validate_sweep_table(where: str, kind: type[PartKind], data: Mapping[str, Any]) -> PartKind:
    """A table of the sweep file as a `kind`. Raises BadInput that names the place of the table."""
    try:
        return validated(kind, data)
    except BadInput as error:
        raise BadInput(f"{where}: {error}") from error


def _listed_value(where: str, value: Any, unit: str | None) -> Any:
    """One listed value: a quantity in SI, a word, or a table with its units."""
    if unit is None:
        return value
    if isinstance(value, list):
        if unit and not _has_units(value):
            raise BadInput(f"{where}: {value}: every number of a table needs its unit")
        return value
    return _number_in_si(where, value, unit)


def _has_units(rows: list[Any]) -> bool:
    """Whether every entry of a table is a text, as a number with its unit is."""
    for row in rows:
        entries = row if isinstance(row, list) else [row]
        if not all(isinstance(entry, str) for entry in entries):
            return False
    return True


def _number_in_si(where: str, value: Any, unit: str) -> float:
    """A quantity in SI; a plain number where the key has no unit."""
    if unit:
        try:
            return to_si(value, unit, unit_required=True)
        except ValueError as error:
            raise BadInput(f"{where} = {value!r}: {error}") from error
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BadInput(f"{where} = {value!r}: must be a number, without unit")
    return float(value)


def _range_values(where: str, start: float, end: float, span: Range) -> _KeySpec:
    """The values of a range between two ends in SI."""
    if span.scale == "linear":
        return _KeySpec(
            values=np.linspace(start, end, span.count).tolist(),
            at=lambda u: (start + u * (end - start)).tolist(),
        )
    if not min(start, end) > 0:
        raise BadInput(f'{where}.scale = "log": needs from and to greater than 0')
    return _KeySpec(
        values=np.geomspace(start, end, span.count).tolist(),
        at=lambda u: (start * (end / start) ** u).tolist(),
    )


def _draw_function(
    where: str, distribution: Distribution, unit: str, nominal: Sequence[Any]
) -> Callable[[Floats], list[float]]:
    """The inverse cumulative function of a distribution as lists; see `_inverse_cumulative`."""
    inverse = _inverse_cumulative(where, distribution, unit, nominal)
    return lambda u: inverse(u).tolist()


def _inverse_cumulative(
    where: str, distribution: Distribution, unit: str, nominal: Sequence[Any]
) -> Callable[[Floats], Floats]:
    """The inverse of a distribution's cumulative function: u (n,) in (0, 1) -> values (n,).

    It does without scipy.stats, which takes a second to load.

    Parameters
    ----------
    where : place in the sweep file, for messages
    distribution : the distribution as the sweep file gives it
    unit : SI unit of the key
    nominal : the brake file's values of the key
    """
    if isinstance(distribution, Normal):
        mean = _centre_in_si(f"{where}.mean", distribution.mean, unit, nominal)
        deviation = _deviation_in_si(f"{where}.deviation", distribution.deviation, mean, unit)
        if isinstance(distribution, TruncatedNormal):
            return _inverse_truncated_normal(where, distribution, unit, mean, deviation)
        if distribution.distribution == "lognormal":
            return _inverse_lognormal(where, distribution, mean, deviation)
        return _inverse_normal(mean, deviation)
    assert isinstance(distribution, Uniform)
    start = _end_in_si(f"{where}.from", distribution.start, unit)
    end = _end_in_si(f"{where}.to", distribution.to, unit)
    if not start < end:
        raise BadInput(
            f"{where}.to = {distribution.to!r}: must be greater than from = {distribution.start!r}"
        )
    if not isinstance(distribution, Triangular):
        return lambda u: start + (end - start) * u
    mode = _centre_in_si(f"{where}.mode", distribution.mode, unit, nominal)
    if not start <= mode <= end:
        raise BadInput(f"{where}.mode = {mode:g}: must be from {start:g} to {end:g}")
    return _inverse_triangular(start, mode, end)


def _centre_in_si(
    where: str, given: float | str | None, unit: str, nominal: Sequence[Any]
) -> float:
    """The mean or mode that is given, or else the brake file's own value.

    Parameters
    ----------
    where : place in the sweep file, for messages
    given : value in the sweep file
    unit : SI unit of the key
    nominal : the brake file's values of the key
    """
    if given is not None:
        return _number_in_si(where, given, unit)
    # Shoes may have different values, of which none is the centre of a common distribution.
    if len(set(nominal)) > 1 or not isinstance(nominal[0], float):
        raise BadInput(f"{where}: is missing, and the brake file has no single number there")
    return float(nominal[0])


def _end_in_si(where: str, given: float | str, unit: str) -> float:
    """An end of a distribution in SI; infinite ends stay."""
    if isinstance(given, float) and math.isinf(given):
        return given
    return _number_in_si(where, given, unit)


def _inverse_normal(mean: float, deviation: float) -> Callable[[Floats], Floats]:
    """The inverse of a normal distribution."""
    from scipy.special import ndtri  # noqa: PLC0415  (0.1 s)

    return lambda u: mean + deviation * ndtri(u)


def _inverse_lognormal(
    where: str, distribution: Normal, mean: float, deviation: float
) -> Callable[[Floats], Floats]:
    """The inverse of a lognormal distribution with a given mean and standard deviation.

    Parameters
    ----------
    where : place in the sweep file, for messages
    distribution : the distribution as the sweep file gives it
    mean, deviation : of the values themselves, not of their logarithms
    """
    from scipy.special import ndtri  # noqa: PLC0415  (0.1 s)

    if not mean > 0:
        raise BadInput(f"{where}.mean = {distribution.mean!r}: must be greater than 0")
    # The standard deviation of the logarithm, and the median that belongs to the mean.
    spread = math.sqrt(math.log1p((deviation / mean) ** 2))
    median = mean * math.exp(-(spread**2) / 2)
    return lambda u: median * np.exp(spread * ndtri(u))


def _inverse_truncated_normal(
    where: str, distribution: TruncatedNormal, unit: str, mean: float, deviation: float
) -> Callable[[Floats], Floats]:
    """The inverse of a normal distribution that is cut off at both ends.

    Parameters
    ----------
    where : place in the sweep file, for messages
    distribution : the distribution as the sweep file gives it
    unit : SI unit of the key
    mean, deviation : of the distribution before it is cut off
    """
    low = (_end_in_si(f"{where}.from", distribution.start, unit) - mean) / deviation
    high = (_end_in_si(f"{where}.to", distribution.to, unit) - mean) / deviation
    if not low < high:
        raise BadInput(
            f"{where}.to = {distribution.to!r}: must be greater than from = {distribution.start!r}"
        )
    return lambda u: mean + deviation * _truncated_standard_normal(u, low, high)


def _inverse_triangular(start: float, mode: float, end: float) -> Callable[[Floats], Floats]:
    """The inverse of a triangular distribution."""
    # The cumulative function at the mode: below it one parabola holds, above it another.
    top = (mode - start) / (end - start)

    def inverse(u: Floats) -> Floats:
        """The values with the cumulative probabilities u (n,) in (0, 1)."""
        rising = np.sqrt(top * u)
        falling = 1 - np.sqrt((1 - top) * (1 - u))
        values: Floats = start + (end - start) * np.where(u < top, rising, falling)
        return values

    return inverse


def _truncated_standard_normal(u: Floats, low: float, high: float) -> Floats:
    """Values (n,) of the standard normal distribution between two ends, for u (n,) in (0, 1).

    The logarithms of the nearer tail keep the digits of ends far from the mean.
    """
    from scipy.special import log_ndtr, ndtri_exp  # noqa: PLC0415  (0.1 s)

    if low > 0:
        return -_truncated_standard_normal(1 - u, -high, -low)
    below, above = log_ndtr(low), log_ndtr(high)
    # log(u (P(high) - P(low))), from the logarithms of P.
    log_inside = np.log(u) + above + np.log1p(-np.exp(below - above))
    values: Floats = ndtri_exp(np.logaddexp(below, log_inside))
    return values


def _deviation_in_si(where: str, given: float | str, mean: float, unit: str) -> float:
    """A standard deviation, absolute or in % of the mean.

    Parameters
    ----------
    where : place in the sweep file, for messages
    given : value in the sweep file
    mean : mean of the distribution, in SI
    unit : SI unit of the key
    """
    if isinstance(given, str) and given.strip().endswith("%"):
        try:
            value = float(given.strip()[:-1]) / 100 * abs(mean)
        except ValueError as error:
            raise BadInput(f'{where} = {given!r}: must be such as "5 %" of the mean') from error
    else:
        value = _number_in_si(where, given, unit)
    if not 0 < value < math.inf:
        reason = " (the mean is 0)" if mean == 0 else ""
        raise BadInput(f"{where} = {given!r}: must be greater than 0{reason}")
    return value


def _drawn_values(spec: _KeySpec, key: str, seed: int, count: int) -> list[Any]:
    """Draw `count` values of a key, by a stream of random numbers that the key has for itself."""
    # A further key in the sweep file leaves the draws of the other keys as they are.
    stream = int.from_bytes(hashlib.sha256(key.encode()).digest()[:8])
    u = np.random.default_rng([seed, stream]).random(count)
    # Random numbers come in steps of 2^-53. A u of 0 would make a normal deviate -infinity.
    return spec.at(np.maximum(u, 2.0**-54))


def _combinations_of_values(
    combine: str, listed: Mapping[str, list[Any]]
) -> Iterator[dict[str, Any]]:
    """The combinations of the listed values; in a grid the last key changes first."""
    lengths = {key: len(values) for key, values in listed.items()}
    if combine == "zip" and len(set(lengths.values())) > 1:
        raise BadInput(f'combine = "zip": needs as many values of each key; there are {lengths}')
    paired = combine == "zip" and bool(listed)
    columns = listed.values()
    for row in zip(*columns, strict=True) if paired else itertools.product(*columns):
        yield dict(zip(listed, row, strict=True))


def _cases_per_step(combine: str, lengths: Sequence[int], repeats: int) -> list[int]:
    """For each listed key the number of cases from one of its values to the next.

    The first case with value number k of a key stands k times this number after the first case.

    Parameters
    ----------
    combine : how the listed values are combined
    lengths : number of values of each listed key
    repeats : number of draws for each combination
    """
    if combine != "grid":
        return [repeats] * len(lengths)
    return [repeats * math.prod(lengths[i + 1 :]) for i in range(len(lengths))]


class _ListedKey(NamedTuple):
    """A key with its listed values, and the changes of the first case with each of the values.

    There may be more changes than values; those beyond belong to no value.
    """

    key: str
    values: Sequence[Any]
    firsts: Sequence[Mapping[str, Any]]


def _check_key(brake: Brake, listed: _ListedKey, medians: Mapping[str, Any], done: Done) -> None:
    """Raise BadInput for a listed value that neither the base brake nor its first case can have.

    Of many numbers only the extremes are judged, where the key allows an interval (`is_interval`)
    and the base brake takes the extremes.

    Parameters
    ----------
    brake : the base brake
    listed : the key and its values
    medians : the medians of the drawn keys
    done : told how many values have been judged, and of how many
    """
    key, values, firsts = listed
    # If a brake takes the extremes of an interval, it takes all numbers between them.
    extremes = _positions_of_extremes(values) if is_interval(brake, key) else []
    places = list(range(len(values)))
    if extremes:
        places = [i for i in places if not isinstance(values[i], float)]
    try:
        for i in extremes:
            vary(brake, {key: values[i]})
    # The base brake does not take all values. Each value may still fit together with values of the
    # other keys.
    except BadInput:
        places = list(dict.fromkeys([*extremes, *range(len(values))]))
    for number, i in enumerate(places):
        if number % VALUES_PER_REPORT == 0:
            done(number, len(places))
        try:
            vary(brake, {key: values[i]})
        except BadInput:
            # The values of the other keys in the same case may make the value fit.
            vary(brake, {**firsts[i], **medians})


def _positions_of_extremes(values: Sequence[Any]) -> list[int]:
    """Positions of the least and the greatest negative number, of 0, and of the positive ones."""
    numbers = [i for i, value in enumerate(values) if isinstance(value, float)]
    found: set[int] = set()
    # The limits of a key may differ for numbers of the two signs.
    for sign in (-1, 0, 1):
        group = [i for i in numbers if np.sign(values[i]) == sign]
        if group:
            found |= {min(group, key=values.__getitem__), max(group, key=values.__getitem__)}
    return sorted(found)
