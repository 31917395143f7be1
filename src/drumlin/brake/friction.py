"""Friction coefficients that depend on pressure, sliding speed and temperature.

The key `friction` of a brake or of a lining is a number or a table of measured coefficients. The
sliding speed belongs to the whole brake, the temperature to the face of each lining. Both are
known before the solve, so that a table over speed and temperature alone gives each lining one
coefficient. A table over the pressure gives each point of the lining a coefficient of its own.
"""

import math
from collections.abc import Sequence
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Annotated, NamedTuple, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.fields import (
    PURE_NUMBER_VALIDATOR,
    PartOfInputFile,
    PressureInFrictionTable,
    SpeedInFrictionTable,
    TemperatureRise,
    array_as_list_of_rows_or_number,
    table_rows_of_function_at_coordinates,
)
from drumlin.brake.units import SMALLEST_NONZERO_NUMBER_IN_SI, quantity_with_usual_unit

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake

FrictionCoefficient = Annotated[
    float,
    Field(ge=0, le=1e6, strict=True),
    AfterValidator(lambda mu: mu if mu >= SMALLEST_NONZERO_NUMBER_IN_SI else 0.0),
    PURE_NUMBER_VALIDATOR,
]
"""The type of a friction coefficient. A value below SMALLEST_NONZERO_NUMBER_IN_SI is set to 0.

The same limit holds for all other quantities of a brake.
"""

SMALLEST_FRICTION_IN_TABLE = 1e-6
"""Smallest friction coefficient that a table may have: a table of friction must be above zero."""

FrictionCoefficientInTable = Annotated[
    float, Field(ge=SMALLEST_FRICTION_IN_TABLE, le=1e6, strict=True), PURE_NUMBER_VALIDATOR
]
"""The type of a friction coefficient of a table, which must be greater than 0."""

WORDS_FOR_FRICTION_TABLE_COLUMNS = {
    "pressure": "pressures",
    "speed": "speeds",
    "temperature_rise": "temperatures",
}
"""Columns of a table of friction: the words for their values in messages, by the column's key."""


class FrictionOverPressureCurve(NamedTuple):
    """The friction coefficient as a function of pressure, at a given speed and temperature.

    The coefficient is linear between two pressures, and constant beyond the first and the last
    pressure.

    Attributes
    ----------
    pressure : (m,) [Pa], growing pressures
    mu : (m,), friction coefficients
    """

    pressure: Floats
    mu: Floats

    def friction_coefficients_at_pressures(self, p: Floats) -> Floats:
        """The friction coefficient at pressures p [Pa], same shape."""
        return np.interp(p, self.pressure, self.mu)

    @property
    def friction_slopes_between_table_rows(self) -> Floats:
        """Slopes (m + 1,) [1/Pa] of the coefficient over the pressure, by growing pressure.

        The first slope, before the first pressure, and the last, beyond the last pressure, are 0.
        """
        return np.concatenate([[0.0], np.diff(self.mu) / np.diff(self.pressure), [0.0]])

    def friction_slopes_at_pressures(self, p: Floats) -> Floats:
        """The derivative of the friction coefficient by the pressure [1/Pa] at p [Pa], same shape.

        At a pressure of the table the result is the slope on the side of higher pressures.
        """
        return self.friction_slopes_between_table_rows[
            np.searchsorted(self.pressure, p, side="right")
        ]


class FrictionTable(PartOfInputFile):
    """A table of friction coefficients over pressure [Pa], sliding speed [m/s] and temperature [K].

    Each key is a column, with a value in each row of the table. The rows are in any order, and have
    each combination of a pressure, a speed and a temperature once. Between its values the
    coefficient is linear in each of these three quantities, and constant beyond them.
    """

    mu: tuple[FrictionCoefficientInTable, ...]
    pressure: tuple[PressureInFrictionTable, ...] = ()
    speed: tuple[SpeedInFrictionTable, ...] = ()
    temperature_rise: tuple[TemperatureRise, ...] = ()

    @property
    def given_columns_by_key(self) -> dict[str, tuple[float, ...]]:
        """The columns of the table that are given, by key, without the coefficients `mu`."""
        return {
            key: values
            for key in WORDS_FOR_FRICTION_TABLE_COLUMNS
            if (values := getattr(self, key))
        }

    @model_validator(mode="after")
    def _check_rows_hold_each_combination_once(self) -> Self:
        """Raise ValueError unless the rows have each combination of the columns' values once."""
        if not self.given_columns_by_key:
            raise ValueError(
                f"mu: give a column beside it: {', '.join(WORDS_FOR_FRICTION_TABLE_COLUMNS)}"
            )
        for key, values in self.given_columns_by_key.items():
            if len(values) != len(self.mu):
                raise ValueError(
                    f"{key}: has {len(values)} values; must have {len(self.mu)}, one for each of mu"
                )
            if len(set(values)) == 1:
                raise ValueError(
                    f"{key}: has the same value in all rows; leave it out, or give another"
                )
        rows = list(zip(*self.given_columns_by_key.values(), strict=True))
        grid = math.prod(len(set(values)) for values in self.given_columns_by_key.values())
        if len(set(rows)) != len(rows) or len(rows) != grid:
            words = " at each of the ".join(
                WORDS_FOR_FRICTION_TABLE_COLUMNS[key] for key in self.given_columns_by_key
            )
            raise ValueError(
                f"mu: has {len(rows)} rows, of which {len(set(rows))} differ; must have {grid}: "
                f"each of the {words} once"
            )
        return self

    def friction_coefficient_curve_at_speed_and_temperature_rise(
        self, speed: float, temperature_rise: float
    ) -> FrictionOverPressureCurve:
        """The coefficient as a function of pressure, at a speed [m/s] and a temperature rise [K].

        If the table has no pressures, the curve has one point, at the pressure 0.
        """
        places = [sorted(set(values)) for values in self.given_columns_by_key.values()]
        rows = dict(
            zip(zip(*self.given_columns_by_key.values(), strict=True), self.mu, strict=True)
        )
        grid = np.array([rows[row] for row in product(*places)]).reshape(list(map(len, places)))
        at = {"speed": speed, "temperature_rise": temperature_rise}
        # The table is interpolated in one column after the other, from the last column on. The
        # first column, the pressure, is left.
        for key, values in reversed(list(zip(self.given_columns_by_key, places, strict=True))):
            if key in at:
                grid = np.apply_along_axis(partial(np.interp, at[key], values), -1, grid)
        pressure = np.array(places[0]) if self.pressure else np.zeros(1)
        return FrictionOverPressureCurve(pressure, grid.reshape(len(pressure)))


def _tag_for_friction_number_or_table(data: object) -> str:
    """The tag by which pydantic chooses the type of friction data: a table or a number."""
    return "friction table" if isinstance(data, dict | FrictionTable) else "friction number"


PRESSURES_OF_TABULATED_FRICTION = np.append(0.0, np.geomspace(1e3, 1e8, 801))
"""Pressures [Pa] of the table that replaces a function of the pressure as `friction`.

Two neighbours differ by 1.4 %. Between them the coefficient is linear, so that 1/(1 + p/p_0) with
p_0 = 1 MPa is met within 1e-5. Linings press with 1e4 to 1e7 Pa; beyond the table the coefficient
is constant.
"""


def _friction_table_from_array_or_function(data: object) -> object:
    """Turn an array or a function into the data of a friction table over the pressure.

    The columns of an array (n, 2) are pressure [Pa] and coefficient. A function takes a pressure
    [Pa] and returns the coefficient. Other data are returned unchanged.
    """
    if callable(data):
        rows: object = table_rows_of_function_at_coordinates(data, PRESSURES_OF_TABULATED_FRICTION)
    else:
        rows = array_as_list_of_rows_or_number(data)
    if not isinstance(rows, list) or rows is data:
        return rows
    pressure, mu = zip(*rows, strict=True)
    # A constant coefficient becomes a number, so that it does not count as dependent on pressure.
    if len(set(mu)) == 1:
        return mu[0]
    if callable(data):
        _require_friction_above_zero_at_pressures(pressure, mu)
    return {"pressure": pressure, "mu": mu}


def _require_friction_above_zero_at_pressures(
    pressures: Sequence[float], coefficients: Sequence[float]
) -> None:
    """Raise ValueError if a user's function gives a coefficient that no table may have.

    The message names the smallest of the pressures [Pa] at which it does. The line on a row of a
    table would name a row that the user has not written.
    """
    for pressure, mu in zip(pressures, coefficients, strict=True):
        if not mu >= SMALLEST_FRICTION_IN_TABLE:
            raise ValueError(
                f"the function gives {mu:.4g} at {quantity_with_usual_unit(pressure, 'Pa')}; it "
                f"must give at least {SMALLEST_FRICTION_IN_TABLE:f} at all pressures up to "
                f"{quantity_with_usual_unit(pressures[-1], 'Pa')}"
            )


FrictionOrTable = Annotated[
    Annotated[FrictionCoefficient, Tag("friction number")]
    | Annotated[FrictionTable, Tag("friction table")],
    Discriminator(_tag_for_friction_number_or_table),
    BeforeValidator(_friction_table_from_array_or_function),
]
"""The type of the key `friction`: a friction coefficient, or a table of coefficients.

In Python it may also be an array (n, 2) of pressures and coefficients, or a function of the
pressure.
"""


def multiplied_friction(written: float | FrictionTable, factor: float) -> float | FrictionTable:
    """A friction coefficient, or a table of friction coefficients, times a factor."""
    if isinstance(written, FrictionTable):
        return written.model_copy(update={"mu": tuple(factor * mu for mu in written.mu)})
    return factor * written


def friction_coefficient_curve_of_lining(
    written: float | FrictionTable, speed: float, temperature_rise: float
) -> FrictionOverPressureCurve:
    """The friction coefficient of a lining as a function of pressure.

    The curve has one point if the coefficient does not depend on the pressure.

    Parameters
    ----------
    written : coefficient or table that the brake file gives for the lining
    speed : sliding speed [m/s]
    temperature_rise : rise of the temperature at the face of the lining [K]
    """
    if isinstance(written, FrictionTable):
        return written.friction_coefficient_curve_at_speed_and_temperature_rise(
            speed, temperature_rise
        )
    return FrictionOverPressureCurve(np.zeros(1), np.array([written]))


def friction_coefficient_as_text(curve: FrictionOverPressureCurve) -> str:
    """A friction coefficient as a text such as "0.3", or "0.42 to 0.36 over the pressure"."""
    if len(curve.mu) == 1:
        return f"{curve.mu[0]:g}"
    return f"{curve.mu[0]:g} to {curve.mu[-1]:g} over the pressure"


def friction_tables_by_brake_file_key(brake: "Brake") -> dict[str, FrictionTable]:
    """The tables of friction of a brake and of its linings by their keys in the brake file."""
    written = {"friction": brake.friction_as_written}
    for i, shoe in enumerate(brake.shoes):
        written[f"shoe[{i}].lining.friction"] = shoe.lining.friction or 0.0
    return {key: table for key, table in written.items() if isinstance(table, FrictionTable)}


def first_key_of_pressure_dependent_friction(brake: "Brake") -> str | None:
    """The first key by which friction depends on the pressure; None if no friction does."""
    for key, table in friction_tables_by_brake_file_key(brake).items():
        if table.pressure:
            return f"{key}.pressure"
    return None


def reason_if_friction_depends_on_pressure(brake: "Brake", what: str) -> str | None:
    """Why a computation does not apply to friction that depends on the pressure.

    The result is None if the friction of the brake does not depend on the pressure.
    `what` names the computation in the text.
    """
    key = first_key_of_pressure_dependent_friction(brake)
    return None if key is None else f"{key}: {what} takes no friction that depends on the pressure"


def require_friction_independent_of_pressure(brake: "Brake", what: str) -> None:
    """Raise BadInput if friction depends on the pressure; `what` names the computation."""
    reason = reason_if_friction_depends_on_pressure(brake, what)
    if reason is not None:
        raise BadInput(reason)


def check_friction_tables_have_sliding_speed(brake: "Brake", key: str, given: bool) -> None:
    """Raise ValueError if a friction table needs a sliding speed that is not given.

    A sliding speed that no table uses is an error as well. `key` is the key of the speed in the
    brake file, and `given` whether the file has this key.
    """
    over_speed = [
        name for name, table in friction_tables_by_brake_file_key(brake).items() if table.speed
    ]
    if over_speed and brake.sliding_speed is None:
        raise ValueError(f"{over_speed[0]}.speed: needs the sliding speed; give {key}")
    if given and not over_speed:
        raise ValueError(f"{key}: has no effect without a table friction.speed; leave it out")
