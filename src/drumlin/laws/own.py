"""Laws that a user writes as a function of the angle from the hinge.

The function gives the pressure up to a factor. Its integrals are computed numerically, and a brake
is then solved as by the closed-form laws of `drumlin.laws.shapes`.
"""

import inspect
import sysconfig
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, DrumlinError, FailedLawOfUser, NoAnswer
from drumlin.base.texts import value_as_text
from drumlin.laws.shapes import PressureIntegrals, PressureLawOfHingedShoe, ShoeAnglesAndRadii

PressureShapeFunction = Callable[[Floats, ShoeAnglesAndRadii], Any]
"""A function of the angles phi (n,) [rad] from the hinge and of the shoe's `ShoeAnglesAndRadii`.

It returns the pressures (n,) up to a factor.
"""

GAUSS_POINTS_PER_PIECE_OF_LINING = 20
"""Number of Gauss points in each of INTEGRATION_PIECES_OF_LINING pieces of a lining.

The integral of a smooth pressure has no error but round-off. A kink of the pressure inside a piece
causes a relative error of some 1e-5, a jump of some 1e-3.
"""

INTEGRATION_PIECES_OF_LINING = 20
"""Number of equal pieces into which a lining is divided to integrate the pressure."""

NUMBER_OF_ANGLES_SEARCHED_FOR_PEAK_PRESSURE = 2001
"""Number of equally spaced angles among which the largest pressure is sought.

On a lining of 120 degrees the angles are 0.06 degrees apart. The largest of the pressures at these
angles is below a smooth peak by less than 1e-6 of the peak.
"""

LARGEST_NEGLIGIBLE_NEGATIVE_PRESSURE = 1e-12
"""Negative pressure, relative to the largest pressure, that counts as zero.

A user's function that is zero at an end of the lining may return so small a negative pressure there
because of round-off.
"""


def make_law_from_pressure_shape(
    name: str, assumes: str, shape: PressureShapeFunction
) -> PressureLawOfHingedShoe:
    """Make the law of hinged shoes on a drum whose pressure has the given shape.

    Parameters
    ----------
    name : name of the law
    assumes : assumptions of the law, in words
    shape : function that returns the pressures at angles from the hinge, up to a factor

    Raises
    ------
    BadInput
        for a shape that is no function of two arguments
    FailedLawOfUser
        when the law is used: for a shape that raises an exception, or returns other than n finite
        numbers
    NoAnswer
        when the law is used: for a shape that is negative somewhere, or zero everywhere
    """
    _require_function_of_angles_and_layout(name, shape)

    def pressure(phi: Floats, arc: ShoeAnglesAndRadii) -> Floats:
        """The pressures that the user's function returns at the angles phi [rad], after a check.

        They have the shape of `phi`. Round-off below zero is set to zero.
        """
        values = _finite_numbers_returned_by_shape(name, shape, np.ravel(phi), arc)
        least = values.min()
        if least < -LARGEST_NEGLIGIBLE_NEGATIVE_PRESSURE * np.abs(values).max():
            at = np.ravel(phi)[values.argmin()]
            raise NoAnswer(
                f"law {name!r}: its pressure is negative, the lining cannot pull: "
                f"{least:.3g} at {np.degrees(at):.4g} deg from the hinge"
            )
        return np.maximum(values, 0.0).reshape(np.shape(phi))

    def pressure_integrals_on_arc_part(
        whole: ShoeAnglesAndRadii, part: ShoeAnglesAndRadii
    ) -> PressureIntegrals:
        """Integrals of the function over a part of the arc, by Gauss's rule on equal pieces."""
        ends = np.linspace(float(part.phi_1), float(part.phi_2), INTEGRATION_PIECES_OF_LINING + 1)
        x, w = np.polynomial.legendre.leggauss(GAUSS_POINTS_PER_PIECE_OF_LINING)
        half = 0.5 * np.diff(ends)[:, None]
        phi = (ends[:-1, None] + half * (1 + x)).ravel()
        f = pressure(phi, whole) * (half * w).ravel()
        if not f.sum() > 0:
            raise NoAnswer(f"law {name!r}: its pressure is zero on the whole lining")
        return PressureIntegrals(np.asarray(f.sum()), f @ np.cos(phi), f @ np.sin(phi))

    def angle_of_largest_pressure(arc: ShoeAnglesAndRadii) -> Floats:
        """The angle phi [rad] of the largest pressure."""
        phi = np.linspace(
            float(arc.phi_1), float(arc.phi_2), NUMBER_OF_ANGLES_SEARCHED_FOR_PEAK_PRESSURE
        )
        return np.asarray(phi[np.argmax(pressure(phi, arc))])

    return PressureLawOfHingedShoe(
        name,
        assumes,
        lambda arc: pressure_integrals_on_arc_part(arc, arc),
        pressure,
        angle_of_largest_pressure,
        pressure_integrals_on_arc_part=pressure_integrals_on_arc_part,
    )


def _finite_numbers_returned_by_shape(
    name: str, shape: PressureShapeFunction, phi: Floats, layout: ShoeAnglesAndRadii
) -> Floats:
    """The numbers (n,) that the function of the law `name` returns at the angles phi (n,) [rad].

    One number that the function returns stands for all angles. Raises FailedLawOfUser if the
    function fails, or returns other than n finite numbers.
    """
    asked = f"law {name!r}: its function must return a finite number for each angle; it "
    values = _real_numbers_returned_by_shape(shape, phi, layout, asked)
    values = np.broadcast_to(values, phi.shape) if values.ndim == 0 else values
    if values.shape != phi.shape:
        raise FailedLawOfUser(
            f"{asked}got {len(phi)} angles and returned an array of shape {values.shape}"
        )
    is_wrong = ~np.isfinite(values)
    if is_wrong.any():
        raise FailedLawOfUser(f"{asked}returned {values[is_wrong][0]} at {phi[is_wrong][0]:g} rad")
    return values


def _real_numbers_returned_by_shape(
    shape: PressureShapeFunction, phi: Floats, layout: ShoeAnglesAndRadii, asked: str
) -> Floats:
    """The numbers that the user's function returns at the angles phi (n,) [rad], of any shape.

    Raises FailedLawOfUser if the function raises an exception, or returns other values than real
    numbers; the message tells the exception and its line in the user's file. `asked` is the begin
    of the message, which names the law and ends with "it ".
    """
    try:
        returned = shape(phi, layout)
    except DrumlinError:
        raise
    except Exception as error:
        hint = _place_in_code_of_user(error)
        if isinstance(error, AttributeError) and isinstance(error.obj, ShoeAnglesAndRadii):
            hint += "; the layout has phi_1 and phi_2 [rad], R and a [m]"
        raise FailedLawOfUser(
            f"{asked}failed with {type(error).__name__}: {error}{hint}"
        ) from error
    try:
        values = np.asarray(returned)
        is_real = values.dtype.kind in "biuf"
    except ValueError:
        # numpy makes no array of lists with different lengths.
        is_real = False
    if not is_real:
        raise FailedLawOfUser(f"{asked}returned {value_as_text(returned)}")
    return values.astype(float)


def _place_in_code_of_user(error: Exception) -> str:
    """The last line of the user's own code that led to an exception, as " (FILE, line 3)".

    The lines of Python's and of installed packages, in which the exception may arise, do not help
    to find the fault. The text is "" if no line of the user's led to the exception.
    """
    installed = tuple(
        sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")
    )
    # The first line is the call of the user's function in this module.
    places = traceback.extract_tb(error.__traceback__)[1:]
    own = [place for place in places if not place.filename.startswith(installed)]
    return f" ({Path(own[-1].filename).name}, line {own[-1].lineno})" if own else ""


def _require_function_of_angles_and_layout(name: str, shape: object) -> None:
    """Raise BadInput if the shape of the law `name` cannot be called with two arguments."""
    asked = (
        f"law {name!r}: must be a function of two arguments, the angles phi from the hinge and the "
        "shoe's layout, such as def shape(phi, layout)"
    )
    if not callable(shape):
        raise BadInput(f"{asked}; it is {shape!r}")
    if isinstance(shape, np.ufunc) and shape.nin != 2:
        # A function such as np.sin takes its further arguments as places for its result.
        raise BadInput(f"{asked}; it is {shape!r}, a function of {shape.nin}")
    try:
        arguments = inspect.signature(shape)
    except ValueError:
        # Some functions written in C do not tell their arguments.
        return
    try:
        arguments.bind("phi", "layout")
    except TypeError:
        raise BadInput(f"{asked}; its arguments are {arguments}") from None
