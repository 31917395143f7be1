"""Turn the arguments of `drumlin.sweep` in Python into the data of a sweep file.

A number in Python is in SI units, while a sweep file has a unit on every quantity. This module adds
the units, so that sweeps from Python and from files are then checked and solved by the same code.
"""

from collections.abc import Mapping, Sequence, Set
from typing import Any

import numpy as np

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.file import si_unit_of_brake_key, values_of_brake_key, vary

RANGE_AND_DISTRIBUTION_KEYS_IN_UNIT_OF_VARIED_KEY = ("from", "to", "mean", "mode", "deviation")
"""Keys of a range or distribution that hold a quantity in the unit of the varied key."""


def sweep_file_data_from_python_values(
    brake: Brake,
    values: Mapping[str, Any],
    models: str | Sequence[str] | Set[str] | Mapping[str, Mapping[str, Any]],
    **keys: Any,
) -> dict[str, Any]:
    """The data of a sweep file without its brake, from values in Python.

    Parameters
    ----------
    brake : the brake, to which the keys belong
    values : for each key of the brake its values: a list or array, or a mapping with the range or
        distribution, as in a sweep file; numbers are in SI units
    models : name of a model, names of models, or options by the name of a model
    keys : further keys of the sweep file; None leaves a key out

    Raises
    ------
    BadInput
        for an unknown key of the brake, and for values of another kind
    """
    if not isinstance(values, Mapping) or not values:
        raise BadInput('vary: must be a dict of keys and their values, {"friction": [0.3, 0.4]}')
    for key in values:
        if not isinstance(key, str):
            raise BadInput(f'vary: has the key {key!r}; a key is a text such as "friction"')
    options = _options_by_name_of_model(models)
    data = {name: value for name, value in keys.items() if value is not None}
    vary_table = {
        key: _sweep_values_of_key_with_units(brake, key, given) for key, given in values.items()
    }
    return {**data, "model": options, "vary": vary_table}


def _options_by_name_of_model(models: Any) -> dict[str, Any]:
    """The options of each model by its name; see `sweep_file_data_from_python_values`."""
    if isinstance(models, str):
        return {models: {}}
    is_list = isinstance(models, Mapping | Sequence | Set)
    if not is_list or not all(isinstance(name, str) for name in models):
        raise BadInput(
            f'model = {models!r}: must be a name such as "fem", a list of names, or a dict of '
            "names and their options"
        )
    if isinstance(models, Mapping):
        return dict(models)
    # The names in a set are sorted, because a set has no order.
    return {name: {} for name in (sorted(models) if isinstance(models, Set) else models)}


def _sweep_values_of_key_with_units(brake: Brake, key: str, given: Any) -> Any:
    """The values of one key as a sweep file has them: a list, a range or a distribution."""
    try:
        unit = si_unit_of_brake_key(brake, key)
    except BadInput as error:
        raise BadInput(f"vary: {error}") from error
    if isinstance(given, Mapping):
        return {
            name: _value_with_unit(value, unit)
            if name in RANGE_AND_DISTRIBUTION_KEYS_IN_UNIT_OF_VARIED_KEY
            else value
            for name, value in given.items()
        }
    if isinstance(given, str) or not isinstance(given, Sequence | np.ndarray):
        raise BadInput(
            f"vary[{key!r}] = {given!r}: must be a list or an array of values, or a dict with "
            '"from", "to" and "count", or with a "distribution"'
        )
    return [_listed_value_with_unit(brake, key, value, unit) for value in given]


def _listed_value_with_unit(brake: Brake, key: str, value: Any, unit: str | None) -> Any:
    """One value of a key as a sweep file has it, with units; tables and functions become rows."""
    if not callable(value) and not (isinstance(value, np.ndarray) and value.ndim):
        return _value_with_unit(value, unit)
    tables = values_of_brake_key(vary(brake, {key: value}), key)
    if len(set(tables)) > 1:
        raise BadInput(f"vary[{key!r}]: a function gives each shoe its own table; name one shoe")
    place = "rad" if brake.surface.coordinate_unit == "rad" else "m"
    return [[f"{at!r} {place}", f"{gap!r} {unit}"] for at, gap in tables[0]]


def _value_with_unit(value: Any, unit: str | None) -> Any:
    """A number with its SI unit as text; a number without unit and a text stay as they are.

    An array of several numbers becomes a list, which the check of the sweep's data refuses.
    """
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, int | float) and not isinstance(value, bool) and unit:
        return f"{value!r} {unit}"
    return value
