"""Reading of sweep files: TOML files that say which keys of a brake vary and which models solve it.

The values of lists and ranges are combined with one another. Values of distributions are drawn at
random, `cases` times for each combination. The random values of a key depend on `seed` and on the
key alone: another key in the file, or a larger number of cases, does not change the values drawn
before.
"""

import hashlib
import itertools
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, TypeVar

import numpy as np
from pydantic import Field

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, DrumlinError
from drumlin.base.written_numbers import (
    number_from_text_as_people_write_it,
    number_without_unit_from_text,
)
from drumlin.brake.brake import Brake
from drumlin.brake.fields import PartOfInputFile, Title
from drumlin.brake.file import (
    are_allowed_values_of_key_an_interval,
    make_validated_brake_part,
    read_data_of_brake_file,
    si_unit_of_brake_key,
    values_of_brake_key,
    vary,
)
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data, read_drum_or_plane_brake
from drumlin.brake.units import quantity_in_si, quantity_with_usual_unit
from drumlin.foundation.model import validated_names_of_effects_to_include
from drumlin.mesh_files.content import read_bytes_of_mesh_file
from drumlin.models import MODELS, model_options_given_by_user
from drumlin.sweeps.cases import SweepCase, is_key_of_mesh_file, paths_of_mesh_files
from drumlin.sweeps.options import OPTION_CLASSES_BY_MODEL_NAME
from drumlin.sweeps.sample import (
    CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE,
    positions_of_sample_cases,
)

LARGEST_NESTING_DEPTH_OF_SWEEP_FILE = 50
"""Largest allowed depth of tables and lists within one another in a sweep file.

Sweep files need a depth of some six. A deeper file is refused, since a copy of its data would
exceed Python's recursion limit.
"""

MOST_CASES_OF_SWEEP = 1_000_000
"""Largest number of cases in a sweep. The results of a million cases fill some 2 GB of memory."""

VALUES_CHECKED_PER_PROGRESS_UPDATE = 256
"""Number of listed values that are checked between two updates of the progress bar.

Checking them takes some 0.1 s.
"""


class Range(PartOfInputFile):
    """A number `count` of values from `from` to `to`, at equal distances or at equal factors."""

    start: Annotated[float | str, Field(alias="from")]
    to: float | str
    count: Annotated[int, Field(ge=2, le=MOST_CASES_OF_SWEEP)] = 2
    scale: Literal["linear", "log"] = "linear"


class Distribution(PartOfInputFile):
    """The keys of every distribution: its kind, and whether each shoe draws a value of its own."""

    distribution: str
    each_shoe: bool = False


class Uniform(Distribution):
    """A uniform distribution: values between `from` and `to`, all equally likely."""

    start: Annotated[float | str, Field(alias="from")]
    to: float | str


class Triangular(Uniform):
    """A triangular distribution: values between `from` and `to`, the most likely one is `mode`.

    By default the mode is the brake file's value.
    """

    mode: float | str | None = None


class Normal(Distribution):
    """A normal or lognormal distribution with a `mean` and a standard `deviation`.

    By default the mean is the brake file's value. The deviation may be in % of the mean.
    """

    mean: float | str | None = None
    deviation: float | str


class TruncatedNormal(Normal):
    """A normal distribution without the values below `from` and above `to`."""

    start: Annotated[float | str, Field(alias="from")] = -math.inf
    to: float | str = math.inf


DISTRIBUTION_CLASSES_BY_NAME: Mapping[str, type[Distribution]] = {
    "normal": Normal,
    "uniform": Uniform,
    "lognormal": Normal,
    "triangular": Triangular,
    "truncated-normal": TruncatedNormal,
}
"""The class that reads a distribution, by the distribution's name in sweep files."""


KEYS_OF_DISTRIBUTIONS_ONLY = ("mean", "deviation", "mode", "each_shoe")
"""Keys of a distribution that a range does not have."""


class SweepFile(PartOfInputFile):
    """The keys of a sweep file and their values, as the file gives them."""

    hints_on_other_keys: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("rotation", "friction", "drum", "plane", "shoe", "actuation"),
        " (a key of brake files; the key 'brake' of a sweep file names the brake file)",
    )

    title: Title | None = None
    brake: Annotated[str, Field(pattern=r"^[^\x00-\x1f]*$")] | dict[str, Any]
    combine: Literal["grid", "zip", "random"] = "grid"
    cases: Annotated[int, Field(ge=1, le=MOST_CASES_OF_SWEEP)] | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    pressure: Literal["Pa", "MPa"] = "Pa"
    certify: str | int = CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE
    model: Annotated[
        dict[str, dict[str, Any]], Field(default_factory=lambda: {"fem": {}}, min_length=1)
    ]
    vary: Annotated[dict[str, Any], Field(min_length=1)]


class Sweep(NamedTuple):
    """A sweep ready to be solved.

    Attributes
    ----------
    title : title of the sweep file, or of its brake if the sweep has no title
    brake : the base brake, with the values of the brake file
    units : SI unit of each varied key; None if the key takes words
    cases : all cases, in the order of the table
    pressure : unit of stresses in the table, "Pa" or "MPa"
    sample : positions of the cases that are solved on all levels and also state the errors of the
        other cases; empty if each case states its own errors
    """

    title: str
    brake: Brake
    units: dict[str, str | None]
    cases: list[SweepCase]
    pressure: str = "Pa"
    sample: tuple[int, ...] = ()


ShowProgressOfCheckedValues = Callable[[int, int], None]
"""A function that shows progress; it takes the number of checked values and of all values."""


def read_sweep_from_toml_file(
    path: Path, done: ShowProgressOfCheckedValues = lambda judged, of: None
) -> Sweep:
    """Read a sweep from the TOML file `path`.

    `done` is called with the number of values checked so far, and of all values. Raises BadInput
    with one line that names the wrong key, its value and what is allowed.
    """
    try:
        data = read_data_of_brake_file(path)
        _check_integers_and_nesting_depth(data)
    except ValueError as error:
        raise BadInput(f"{path}: is not TOML ({error})") from error
    try:
        return sweep_from_file_data(data, path.parent.resolve(), done)
    except BadInput as error:
        raise BadInput(f"{path}: {error}") from error


def _check_integers_and_nesting_depth(data: Any, depth: int = 0) -> None:
    """Raise ValueError for integers beyond 64 bits and for nesting that is too deep.

    `depth` is the number of tables and lists that contain `data`.
    """
    if depth > LARGEST_NESTING_DEPTH_OF_SWEEP_FILE:
        raise ValueError(f"nested deeper than {LARGEST_NESTING_DEPTH_OF_SWEEP_FILE}")
    if isinstance(data, int) and not -(2**63) <= data < 2**63:
        raise ValueError("an integer beyond 64 bits")
    items = list(data.values()) if isinstance(data, dict) else data
    if isinstance(items, list):
        for item in items:
            _check_integers_and_nesting_depth(item, depth + 1)


def sweep_from_file_data(
    data: Mapping[str, Any],
    base: Path = Path(),
    done: ShowProgressOfCheckedValues = lambda judged, of: None,
    brake: Brake | None = None,
) -> Sweep:
    """Make a sweep from the nested data of a sweep file.

    Parameters
    ----------
    data : tables and values by key
    base : folder to which the paths of the brake file and of mesh files are relative
    done : called with the number of values checked so far, and of all values
    brake : the base brake; None if the data name it under the key "brake"

    Raises
    ------
    BadInput
        with one line that names the wrong key, its value and what is allowed
    """
    if brake is not None:
        data = {**data, "brake": brake.title}
    file = make_validated_brake_part(SweepFile, data)
    # The brake is read first, since allowed keys and models depend on the brake.
    brake = _base_brake_of_sweep(file.brake, base) if brake is None else brake
    models = _validated_model_options(file.model, brake)
    specs: dict[str, _PossibleValuesOfVariedKey] = {}
    for name, given in file.vary.items():
        specs |= _values_of_keys_in_vary_line(brake, name, given, base)
    # Form the cases from the values of all keys, and check that the brake can have these values.
    plan = _plan_of_listed_and_drawn_keys(file, specs)
    changes = _new_values_of_each_case(file, specs, plan, len(models))
    _require_brake_that_allows_each_value(brake, file.combine, specs, plan, changes, done)
    for name in models:
        reason = MODELS[name].why_not(brake)
        if reason is not None:
            raise BadInput(f"model.{name}: does not apply to this brake: {reason}")
    _check_mesh_files_are_readable(brake, specs)
    # Each combination of values is solved by each model.
    cases = []
    for change in changes:
        cases += [SweepCase(brake, change, name, options) for name, options in models.items()]
    units = {key: si_unit_of_brake_key(brake, key) for key in specs}
    sample = positions_of_sample_cases(cases, file.certify, file.seed)
    return Sweep(file.title or brake.title, brake, units, cases, file.pressure, sample)


def _base_brake_of_sweep(brake: str | dict[str, Any], base: Path) -> Brake:
    """The base brake of a sweep, read from the path or the table that the sweep file gives."""
    if isinstance(brake, str):
        return read_drum_or_plane_brake(base / brake)
    try:
        return make_drum_or_plane_brake_from_data(brake, unit_required=True, base=base)
    except BadInput as error:
        raise BadInput(f"brake.{error}") from error


def _validated_model_options(
    given: Mapping[str, Mapping[str, Any]], brake: Brake
) -> dict[str, dict[str, Any]]:
    """The checked options of each model that the sweep file names, by the model's name."""
    models = {}
    for name, options in given.items():
        if name not in MODELS:
            raise BadInput(f"model.{name}: unknown model; allowed: {', '.join(MODELS)}")
        checked = _validated_table_of_sweep_file(
            f"model.{name}", OPTION_CLASSES_BY_MODEL_NAME.get(name, PartOfInputFile), options
        )
        models[name] = model_options_given_by_user(**checked.model_dump())
        # Check the names of effects under the option `lift`. On a plane the whole foundation model
        # is refused later.
        if "lift" in models[name] and not brake.surface.is_plane_and_not_drum:
            validated_names_of_effects_to_include(brake, models[name]["lift"])
    return models


class _PossibleValuesOfVariedKey(NamedTuple):
    """The values that a varied key can have.

    Attributes
    ----------
    values : values of a list or range; None for a distribution
    at : inverse of the cumulative distribution function. It turns random numbers u (n,), uniform in
        (0, 1), into random values (n,) of the key.
    """

    values: list[Any] | None
    at: Callable[[Floats], list[Any]]


class _PlanToCombineVariedKeyValues(NamedTuple):
    """The plan by which the values of the varied keys are combined to cases.

    Attributes
    ----------
    listed : values of each key whose values (of a list or range) are all taken, one by one
    drawn : names of the keys whose values are drawn at random
    draws_per_combination : number of random draws for each combination of listed values
    """

    listed: dict[str, list[Any]]
    drawn: list[str]
    draws_per_combination: int


def _plan_of_listed_and_drawn_keys(
    file: SweepFile, specs: Mapping[str, _PossibleValuesOfVariedKey]
) -> _PlanToCombineVariedKeyValues:
    """Decide which keys are drawn at random and which take their listed values one by one.

    Raises BadInput if `cases` (the number of draws) is missing, or given although no key is drawn.
    """
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
    return _PlanToCombineVariedKeyValues(listed, drawn, file.cases or 1)


def _new_values_of_each_case(
    file: SweepFile,
    specs: Mapping[str, _PossibleValuesOfVariedKey],
    plan: _PlanToCombineVariedKeyValues,
    models: int,
) -> list[dict[str, Any]]:
    """The new values of the varied keys, by key, for each case.

    Parameters
    ----------
    file : the sweep file
    specs : values of each varied key, in the order of the table's columns
    plan : plan by which the values are combined to cases
    models : number of models that solve each case

    Raises
    ------
    BadInput
        for more than MOST_CASES_OF_SWEEP cases, and for lists of unequal lengths under combine =
        "zip"
    """
    draws = {}
    for key in plan.drawn:
        draws[key] = _draw_random_values_of_key(
            specs[key], key, file.seed, plan.draws_per_combination
        )
    lengths = list(map(len, plan.listed.values()))
    combinations = math.prod(lengths) if file.combine == "grid" else max(lengths, default=1)
    count = combinations * plan.draws_per_combination * models
    if count > MOST_CASES_OF_SWEEP:
        raise BadInput(f"vary: makes {count} cases; allowed: {MOST_CASES_OF_SWEEP}")
    # Each combination of listed values gets the same random values of the other keys, so that the
    # combinations can be compared.
    changes = []
    for point in _combinations_of_listed_values(file.combine, plan.listed):
        for i in range(plan.draws_per_combination):
            changes.append({key: point[key] if key in point else draws[key][i] for key in specs})
    return changes


def _require_brake_that_allows_each_value(
    brake: Brake,
    combine: str,
    specs: Mapping[str, _PossibleValuesOfVariedKey],
    plan: _PlanToCombineVariedKeyValues,
    changes: Sequence[Mapping[str, Any]],
    done: ShowProgressOfCheckedValues,
) -> None:
    """Raise BadInput for listed values, or medians of distributions, that no brake can have.

    Of a distribution only the median is checked. A random value that no brake can have gives a
    failed case in the table.

    Parameters
    ----------
    brake : the base brake
    combine : way in which listed values are combined: "grid", "zip" or "random"
    specs : values of each varied key
    plan : plan by which the values are combined to cases
    changes : new values of the varied keys for each case
    done : called with the number of values checked so far, and of all values
    """
    # The median is the value at which the cumulative distribution is 0.5.
    half = np.array([0.5])
    medians = {key: spec.at(half)[0] for key, spec in specs.items() if key not in plan.listed}
    vary(brake, medians)
    lengths = list(map(len, plan.listed.values()))
    steps = _numbers_of_cases_until_next_value_of_each_key(
        combine, lengths, plan.draws_per_combination
    )
    for (key, values), step in zip(plan.listed.items(), steps, strict=True):
        _check_listed_values_of_key(
            brake, _VariedKeyWithListedValues(key, values, changes[::step]), medians, done
        )


def _check_mesh_files_are_readable(
    brake: Brake, specs: Mapping[str, _PossibleValuesOfVariedKey]
) -> None:
    """Raise BadInput or NoAnswer if a mesh file that the sweep names cannot be read."""
    # Collect the mesh files of the base brake and of the varied keys; each is read once.
    meshes = set(paths_of_mesh_files(brake, {}))
    for key, spec in specs.items():
        if is_key_of_mesh_file(key):
            meshes |= {Path(value) for value in spec.values or () if isinstance(value, str)}
    for path in sorted(meshes):
        try:
            read_bytes_of_mesh_file(path)
        except DrumlinError as error:
            raise type(error)(f"mesh = {error}") from error


def _values_of_keys_in_vary_line(
    brake: Brake, name: str, given: Any, base: Path
) -> dict[str, _PossibleValuesOfVariedKey]:
    """The values, by key of the brake file, that one line of the table [vary] gives.

    A line gives the values of one key, or, if each shoe draws its own value from a distribution,
    the values of one key for each shoe.

    Parameters
    ----------
    brake : the base brake
    name : key as it is written in the sweep file
    given : content of the line: a list, or a table with a range or a distribution
    base : folder to which paths of mesh files are relative
    """
    where = f"vary.{name if name.isidentifier() else json.dumps(name, ensure_ascii=False)}"
    try:
        unit = si_unit_of_brake_key(brake, name)
    except BadInput as error:
        raise BadInput(f"{where}: {str(error).removeprefix(f'{name}: ')}") from error
    if isinstance(given, list):
        return {name: _values_of_key_given_as_list(where, name, given, unit, base)}
    if not isinstance(given, dict):
        raise BadInput(
            f"{where} = {given!r}: "
            "must be a list of values, { from, to, count } or { distribution, ... }"
        )
    if unit is None:
        raise BadInput(f"{where}: takes words, not numbers; must be a list of values")
    if "distribution" in given:
        return _values_of_key_given_as_distribution(brake, where, name, given, unit)
    of_distribution = [key for key in given if key in KEYS_OF_DISTRIBUTIONS_ONLY]
    if of_distribution:
        raise BadInput(
            f"{where}.distribution: is missing, and {of_distribution[0]} belongs to one; write "
            f'distribution = "normal" or another of {", ".join(DISTRIBUTION_CLASSES_BY_NAME)}'
        )
    span = _validated_table_of_sweep_file(where, Range, given)
    start = _value_of_sweep_file_as_number_in_si(f"{where}.from", span.start, unit)
    end = _value_of_sweep_file_as_number_in_si(f"{where}.to", span.to, unit)
    return {name: _values_of_key_given_as_range(where, start, end, span)}


def _values_of_key_given_as_list(
    where: str, name: str, given: list[Any], unit: str | None, base: Path
) -> _PossibleValuesOfVariedKey:
    """The values of a varied key that the sweep file gives as a list.

    Parameters
    ----------
    where : place in the sweep file, for error messages
    name : the varied key
    given : the list in the sweep file
    unit : SI unit of the key; "" for a number without unit, None for words
    base : folder to which paths of mesh files are relative
    """
    if not given:
        raise BadInput(f"{where}: the list is empty; needs at least one value")
    values = [_listed_value_in_si(where, value, unit) for value in given]
    if is_key_of_mesh_file(name):
        values = [str(base / value) if isinstance(value, str) else value for value in values]

    def listed_values_for_random_numbers(u: Floats) -> list[Any]:
        """The values for random numbers u (n,) in (0, 1): each listed value is equally likely."""
        return [values[i] for i in (u * len(values)).astype(int)]

    return _PossibleValuesOfVariedKey(values, listed_values_for_random_numbers)


def _values_of_key_given_as_distribution(
    brake: Brake, where: str, name: str, given: Mapping[str, Any], unit: str
) -> dict[str, _PossibleValuesOfVariedKey]:
    """The values of a varied key that the sweep file gives as a distribution.

    They are returned by key. If each shoe draws its own value, there is one key for each shoe.

    Parameters
    ----------
    brake : the base brake
    where : place in the sweep file, for error messages
    name : the varied key
    given : table of the distribution in the sweep file
    unit : SI unit of the key
    """
    kind = given["distribution"]
    if not isinstance(kind, str) or kind not in DISTRIBUTION_CLASSES_BY_NAME:
        raise BadInput(
            f"{where}.distribution = {kind!r}: unknown; allowed: "
            f"{', '.join(DISTRIBUTION_CLASSES_BY_NAME)}"
        )
    distribution = _validated_table_of_sweep_file(where, DISTRIBUTION_CLASSES_BY_NAME[kind], given)
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
        nominal = values_of_brake_key(brake, key)
        specs[key] = _PossibleValuesOfVariedKey(
            None,
            _make_inverse_cumulative_function_that_returns_list(where, distribution, unit, nominal),
        )
    return specs


SweepFileTableClass = TypeVar("SweepFileTableClass", bound=PartOfInputFile)


def _validated_table_of_sweep_file(
    where: str, kind: type[SweepFileTableClass], data: Mapping[str, Any]
) -> SweepFileTableClass:
    """A table of the sweep file, checked and read as an object of the class `kind`.

    Raises BadInput with a message that begins with `where`, the place of the table.
    """
    try:
        return make_validated_brake_part(kind, data)
    except BadInput as error:
        raise BadInput(f"{where}: {error}") from error


def _listed_value_in_si(where: str, value: Any, unit: str | None) -> Any:
    """One value of a list in the sweep file, with numbers converted to SI.

    A word, and a list of numbers with their units, are returned unchanged. `unit` is the SI unit of
    the key: "" for a number without unit, None for words.
    """
    if unit is None:
        return value
    if isinstance(value, list):
        if unit and not _has_only_text_entries(value):
            raise BadInput(f"{where}: {value}: every number of a table needs its unit")
        return value
    return _value_of_sweep_file_as_number_in_si(where, value, unit)


def _has_only_text_entries(rows: list[Any]) -> bool:
    """Whether every entry of a list, or list of lists, is a text such as "3 mm"."""
    for row in rows:
        entries = row if isinstance(row, list) else [row]
        if not all(isinstance(entry, str) for entry in entries):
            return False
    return True


def _value_of_sweep_file_as_number_in_si(where: str, value: Any, unit: str) -> float:
    """A value of the sweep file as a number in SI; `unit` is "" for a number without unit."""
    if unit:
        try:
            return quantity_in_si(value, unit, unit_required=True)
        except ValueError as error:
            raise BadInput(f"{where} = {value!r}: {error}") from error
    try:
        number = number_without_unit_from_text(value)
    except ValueError as error:
        raise BadInput(f"{where} = {value!r}: {error}") from error
    if isinstance(number, bool) or not isinstance(number, int | float) or not math.isfinite(number):
        raise BadInput(f"{where} = {value!r}: must be a number, without unit")
    return float(number)


def _values_of_key_given_as_range(
    where: str, start: float, end: float, span: Range
) -> _PossibleValuesOfVariedKey:
    """The values of a varied key given as a range; its ends `start` and `end` are in SI."""
    if span.scale == "linear":
        return _PossibleValuesOfVariedKey(
            values=np.linspace(start, end, span.count).tolist(),
            at=lambda u: (start + u * (end - start)).tolist(),
        )
    if not min(start, end) > 0:
        raise BadInput(f'{where}.scale = "log": needs from and to greater than 0')
    return _PossibleValuesOfVariedKey(
        values=np.geomspace(start, end, span.count).tolist(),
        at=lambda u: (start * (end / start) ** u).tolist(),
    )


def _make_inverse_cumulative_function_that_returns_list(
    where: str, distribution: Distribution, unit: str, nominal: Sequence[Any]
) -> Callable[[Floats], list[float]]:
    """A function that turns random numbers u (n,) in (0, 1) into a list of values of a key.

    The values have the given distribution; see `_make_inverse_cumulative_function` for the
    parameters.
    """
    inverse = _make_inverse_cumulative_function(where, distribution, unit, nominal)
    return lambda u: inverse(u).tolist()


def _make_inverse_cumulative_function(
    where: str, distribution: Distribution, unit: str, nominal: Sequence[Any]
) -> Callable[[Floats], Floats]:
    """The inverse of a distribution's cumulative function, for drawing random values.

    It turns random numbers u (n,), uniform in (0, 1), into values (n,) in SI. The module
    scipy.stats is not used, since it takes a second to load.

    Parameters
    ----------
    where : place in the sweep file, for error messages
    distribution : distribution as the sweep file gives it
    unit : SI unit of the key
    nominal : values of the key in the brake file
    """
    if isinstance(distribution, Normal):
        mean = _mean_or_mode_in_si(f"{where}.mean", distribution.mean, unit, nominal)
        deviation = _standard_deviation_in_si(
            f"{where}.deviation", distribution.deviation, mean, unit
        )
        if isinstance(distribution, TruncatedNormal):
            return _make_inverse_of_cumulative_truncated_normal_distribution(
                where, distribution, unit, mean, deviation
            )
        if distribution.distribution == "lognormal":
            return _make_inverse_of_cumulative_lognormal_distribution(
                where, distribution, mean, deviation
            )
        return _make_inverse_of_cumulative_normal_distribution(mean, deviation)
    assert isinstance(distribution, Uniform)
    start = _limit_of_distribution_in_si(f"{where}.from", distribution.start, unit)
    end = _limit_of_distribution_in_si(f"{where}.to", distribution.to, unit)
    if not start < end:
        raise BadInput(
            f"{where}.to = {distribution.to!r}: must be greater than from = {distribution.start!r}"
        )
    if not isinstance(distribution, Triangular):
        return lambda u: start + (end - start) * u
    mode = _mean_or_mode_in_si(f"{where}.mode", distribution.mode, unit, nominal)
    if not start <= mode <= end:
        raise BadInput(f"{where}.mode = {mode:g}: must be from {start:g} to {end:g}")
    return _make_inverse_of_cumulative_triangular_distribution(start, mode, end)


def _mean_or_mode_in_si(
    where: str, given: float | str | None, unit: str, nominal: Sequence[Any]
) -> float:
    """The mean or mode of a distribution in SI: the given value, or else the brake file's value.

    Parameters
    ----------
    where : place in the sweep file, for error messages
    given : value in the sweep file; None if the file does not give it
    unit : SI unit of the key
    nominal : values of the key in the brake file
    """
    if given is not None:
        return _value_of_sweep_file_as_number_in_si(where, given, unit)
    # If the sweep file does not give it, the brake file must have one value for all shoes.
    if len(set(nominal)) > 1 or not isinstance(nominal[0], float):
        raise BadInput(f"{where}: is missing, and the brake file has no single number there")
    return float(nominal[0])


def _limit_of_distribution_in_si(where: str, given: float | str, unit: str) -> float:
    """The lower or upper limit of a distribution in SI; an infinite limit stays infinite."""
    if isinstance(given, float) and math.isinf(given):
        return given
    return _value_of_sweep_file_as_number_in_si(where, given, unit)


def _make_inverse_of_cumulative_normal_distribution(
    mean: float, deviation: float
) -> Callable[[Floats], Floats]:
    """The inverse of a normal distribution's cumulative function."""
    from scipy.special import ndtri  # noqa: PLC0415  (0.1 s)

    return lambda u: mean + deviation * ndtri(u)


def _make_inverse_of_cumulative_lognormal_distribution(
    where: str, distribution: Normal, mean: float, deviation: float
) -> Callable[[Floats], Floats]:
    """The inverse of a lognormal distribution's cumulative function.

    Parameters
    ----------
    where : place in the sweep file, for error messages
    distribution : distribution as the sweep file gives it
    mean, deviation : mean and standard deviation of the values, not of their logarithms
    """
    from scipy.special import ndtri  # noqa: PLC0415  (0.1 s)

    if not mean > 0:
        raise BadInput(f"{where}.mean = {distribution.mean!r}: must be greater than 0")
    # `spread` is the standard deviation of the values' logarithm. The median follows from the mean.
    spread = math.sqrt(math.log1p((deviation / mean) ** 2))
    median = mean * math.exp(-(spread**2) / 2)
    return lambda u: median * np.exp(spread * ndtri(u))


def _make_inverse_of_cumulative_truncated_normal_distribution(
    where: str, distribution: TruncatedNormal, unit: str, mean: float, deviation: float
) -> Callable[[Floats], Floats]:
    """The inverse of the cumulative function of a normal distribution that is cut off at both ends.

    Parameters
    ----------
    where : place in the sweep file, for error messages
    distribution : distribution as the sweep file gives it
    unit : SI unit of the key
    mean, deviation : mean and standard deviation of the distribution before it is cut off
    """
    # Both limits are measured from the mean in standard deviations.
    low = (
        _limit_of_distribution_in_si(f"{where}.from", distribution.start, unit) - mean
    ) / deviation
    high = (_limit_of_distribution_in_si(f"{where}.to", distribution.to, unit) - mean) / deviation
    if not low < high:
        raise BadInput(
            f"{where}.to = {distribution.to!r}: must be greater than from = {distribution.start!r}"
        )
    return lambda u: (
        mean + deviation * _inverse_of_cumulative_truncated_standard_normal(u, low, high)
    )


def _make_inverse_of_cumulative_triangular_distribution(
    start: float, mode: float, end: float
) -> Callable[[Floats], Floats]:
    """The inverse of a triangular distribution's cumulative function."""
    # `top` is the cumulative probability of the mode. The cumulative function is one parabola below
    # the mode and another parabola above.
    top = (mode - start) / (end - start)

    def values_at_cumulative_probability(u: Floats) -> Floats:
        """The values (n,) that have the cumulative probabilities u (n,) in (0, 1)."""
        rising = np.sqrt(top * u)
        falling = 1 - np.sqrt((1 - top) * (1 - u))
        values: Floats = start + (end - start) * np.where(u < top, rising, falling)
        return values

    return values_at_cumulative_probability


def _inverse_of_cumulative_truncated_standard_normal(u: Floats, low: float, high: float) -> Floats:
    """The inverse of the standard normal distribution's cumulative function, cut off at two ends.

    It turns cumulative probabilities u (n,) in (0, 1) into values (n,) between `low` and `high`.
    It computes with logarithms of probabilities, which stay accurate if both ends are far from the
    mean.
    """
    from scipy.special import log_ndtr, ndtri_exp  # noqa: PLC0415  (0.1 s)

    # If both ends are above the mean, mirror the distribution: probabilities near 0 are more
    # accurate than probabilities near 1.
    if low > 0:
        return -_inverse_of_cumulative_truncated_standard_normal(1 - u, -high, -low)
    below, above = log_ndtr(low), log_ndtr(high)
    # This is log(u (P(high) - P(low))), computed from log P(high) and log P(low), with the
    # cumulative standard normal distribution P.
    log_inside = np.log(u) + above + np.log1p(-np.exp(below - above))
    values: Floats = ndtri_exp(np.logaddexp(below, log_inside))
    return values


def _standard_deviation_in_si(where: str, given: float | str, mean: float, unit: str) -> float:
    """The standard deviation of a distribution in SI.

    Parameters
    ----------
    where : place in the sweep file, for error messages
    given : value in the sweep file, absolute or in % of the mean
    mean : mean of the distribution, in SI
    unit : SI unit of the key
    """
    if isinstance(given, str) and given.strip().endswith("%"):
        try:
            value = number_from_text_as_people_write_it(given.strip()[:-1]) / 100 * abs(mean)
        except ValueError as error:
            raise BadInput(f'{where} = {given!r}: must be such as "5 %" of the mean') from error
    else:
        value = _value_of_sweep_file_as_number_in_si(where, given, unit)
    if not 0 < value < math.inf:
        reason = " (the mean is 0)" if mean == 0 else ""
        raise BadInput(f"{where} = {given!r}: must be greater than 0{reason}")
    return value


def _draw_random_values_of_key(
    spec: _PossibleValuesOfVariedKey, key: str, seed: int, count: int
) -> list[Any]:
    """Draw `count` random values of a varied key.

    The values depend on the seed and on the name of the key only.
    """
    # Each key has its own stream of random numbers, so that a further key in the sweep file does
    # not change the values of the other keys.
    stream = int.from_bytes(hashlib.sha256(key.encode()).digest()[:8])
    u = np.random.default_rng([seed, stream]).random(count)
    # Random numbers are multiples of 2^-53. The number 0 would give a normal distribution the value
    # -infinity, so that 2^-54 replaces it.
    return spec.at(np.maximum(u, 2.0**-54))


def _combinations_of_listed_values(
    combine: str, listed: Mapping[str, list[Any]]
) -> Iterator[dict[str, Any]]:
    """Yield each combination of the listed values, as values by key.

    With "zip" the n-th values of all keys form a combination. Otherwise all combinations are made,
    and the value of the last key changes fastest.
    """
    lengths = {key: len(values) for key, values in listed.items()}
    if combine == "zip" and len(set(lengths.values())) > 1:
        raise BadInput(f'combine = "zip": needs as many values of each key; there are {lengths}')
    paired = combine == "zip" and bool(listed)
    columns = listed.values()
    for row in zip(*columns, strict=True) if paired else itertools.product(*columns):
        yield dict(zip(listed, row, strict=True))


def _numbers_of_cases_until_next_value_of_each_key(
    combine: str, lengths: Sequence[int], draws_per_combination: int
) -> list[int]:
    """For each listed key, the number m of cases that have one value before its next value comes.

    The first case that has value k of the key is case k m, counted from 0.

    Parameters
    ----------
    combine : way in which listed values are combined: "grid", "zip" or "random"
    lengths : number of values of each listed key
    draws_per_combination : number of random draws for each combination of listed values
    """
    if combine != "grid":
        return [draws_per_combination] * len(lengths)
    return [draws_per_combination * math.prod(lengths[i + 1 :]) for i in range(len(lengths))]


class _VariedKeyWithListedValues(NamedTuple):
    """A varied key with its listed values.

    Attributes
    ----------
    key : the key of the brake file
    values : its listed values
    first_cases_by_value : list whose entry i has the new values of all varied keys in the first
        case with the value number i of this key; the list may be longer than `values`
    """

    key: str
    values: Sequence[Any]
    first_cases_by_value: Sequence[Mapping[str, Any]]


def _check_listed_values_of_key(
    brake: Brake,
    listed: _VariedKeyWithListedValues,
    medians: Mapping[str, Any],
    done: ShowProgressOfCheckedValues,
) -> None:
    """Raise BadInput for a listed value that is not allowed for its key.

    A value is allowed if the base brake can have it, or if the brake of the first case with this
    value can have it. If the key allows all numbers of an interval
    (`are_allowed_values_of_key_an_interval`), and the base brake can have the smallest and the
    largest listed number, the numbers between them are not checked.

    Parameters
    ----------
    brake : the base brake
    listed : the key and its listed values
    medians : medians of the keys that are drawn at random
    done : called with the number of values checked so far, and of all values
    """
    key, values, first_cases_by_value = listed
    # If a brake can have the extreme numbers of an interval, it can have all numbers between them.
    extremes = (
        _positions_of_smallest_and_largest_of_each_sign(values)
        if are_allowed_values_of_key_an_interval(brake, key)
        else []
    )
    places = list(range(len(values)))
    if extremes:
        places = [i for i in places if not isinstance(values[i], float)]
    try:
        for i in extremes:
            vary(brake, {key: values[i]})
    # The base brake cannot have an extreme number. In a case with new values of other keys a number
    # may still be allowed.
    except BadInput:
        places = list(dict.fromkeys([*extremes, *range(len(values))]))
    for number, i in enumerate(places):
        if number % VALUES_CHECKED_PER_PROGRESS_UPDATE == 0:
            done(number, len(places))
        try:
            vary(brake, {key: values[i]})
        except BadInput:
            # Try the value together with the new values of the other keys in the same case.
            try:
                vary(brake, {**first_cases_by_value[i], **medians})
            except BadInput as error:
                raise BadInput(_message_with_unit_of_value(brake, key, values[i], error)) from error


def _message_with_unit_of_value(brake: Brake, key: str, value: Any, error: BadInput) -> str:
    """The message of an error on a listed value, with the value's unit if the message has none.

    A sweep has numbers in SI. The message "radius = -0.0001: must be greater than 0" becomes
    "radius = -0.1 mm: must be greater than 0".
    """
    unit = si_unit_of_brake_key(brake, key)
    if not unit or not isinstance(value, float):
        return str(error)
    return str(error).replace(f" = {value!r}: ", f" = {quantity_with_usual_unit(value, unit)}: ", 1)


def _positions_of_smallest_and_largest_of_each_sign(values: Sequence[Any]) -> list[int]:
    """The positions of the extreme numbers in a list of values, in ascending order.

    Extreme numbers are the smallest and largest negative number, 0, and the smallest and largest
    positive number, as far as the list has them.
    """
    numbers = [i for i, value in enumerate(values) if isinstance(value, float)]
    found: set[int] = set()
    # A key may allow other numbers below 0 than above 0.
    for sign in (-1, 0, 1):
        group = [i for i in numbers if np.sign(values[i]) == sign]
        if group:
            found |= {min(group, key=values.__getitem__), max(group, key=values.__getitem__)}
    return sorted(found)
