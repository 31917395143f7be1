"""The functions of `import drumlin`: each takes a brake or its file's path, and calls one room.

The command line calls the same functions. A room of the package is imported by the first call that
needs it, so that this module loads at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from drumlin.base.errors import BadInput

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake
    from drumlin.brake.surface import FrictionSurface
    from drumlin.comparison import Comparison
    from drumlin.fem.analysis.fields import Fields
    from drumlin.fem.analysis.holding import Hold
    from drumlin.fem.analysis.sensitivity import Sensitivity
    from drumlin.lining_wear.whole_brake import WearRun
    from drumlin.response.response import Response
    from drumlin.sweeps.cases import Row
    from drumlin.verification.check import Verdict
    from drumlin.verification.reference import Reference

    BrakeOrPath = Brake | Path | str

MOST_STEPS = 10_000
"""Largest number of increments of a holding brake: their states fill some 100 MB of JSON."""

Say = Callable[[str], None]
"""A function that shows a line of progress."""


def _unheard(_: str) -> None:
    """Show no line of progress."""


class _Source(NamedTuple):
    """A brake with the text of its file, the file's folder, and a command that names it."""

    brake: Brake
    text: str
    folder: Path | None
    command: str


def _brake_of(brake: BrakeOrPath) -> Brake:
    """The brake itself, or the brake of a file."""
    from drumlin.brake import read_any

    return read_any(brake) if isinstance(brake, str | Path) else brake


def _source_of(brake: BrakeOrPath) -> _Source:
    """The brake with its text: that of its file, or what `write_brake` would write."""
    from drumlin.base.texts import typed
    from drumlin.brake import read_any
    from drumlin.brake.file import toml_text
    from drumlin.brake.writing import brake_text

    # A brake without a file has no folder beside which reference values could be stored.
    if not isinstance(brake, str | Path):
        return _Source(brake, brake_text(brake), None, "drumlin.reference(brake)")
    path = Path(brake)
    text = toml_text(path)
    command = typed(["drumlin", "reference", str(path)])
    return _Source(read_any(path, text), text, path.parent, command)


def _given(**options: Any) -> dict[str, Any]:
    """The options that have a value, see `drumlin.models.given_options`."""
    from drumlin.models import given_options

    return given_options(**options)


def _in_si(option: str, value: float | str, unit: str) -> float:
    """The value [SI] of an option that is a number in SI or a text with a unit."""
    from drumlin.brake.units import quantity

    return quantity(option, value, unit) if isinstance(value, str) else value


def solve(
    brake: BrakeOrPath,
    model: str = "fem",
    *,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
    tolerance: float | None = None,
    finite_width: bool = False,
    worn_in: bool = False,
    model_error: bool = True,
    across: int | None = None,
    fields: Path | str | None = None,
    sections: int | None = None,
    lift: Sequence[str] | None = None,
) -> Response:
    """Solve a brake by one model: torque, pressure on each lining, reactions, estimated errors.

    Parameters
    ----------
    brake : the brake, or the path of its file
    model : "fem", finite elements; "solid", solid shoes; "foundation"; or a law such as "sine"
    elements : finite elements along each lining ("fem", "solid"); None: as the error needs
    kind : "quad2", "quad1", "tri2" or "tri1", elements of the parametric mesh ("fem")
    penalty : contact stiffness as a multiple of E/t of the lining, up to inf ("fem", "solid")
    tolerance : relative error of p (L2) and of the torque that is to be reached ("fem", "solid")
    finite_width : whether the answer is corrected for the widths of the shoes ("fem")
    worn_in : whether the linings are worn until their pressure no longer changes ("fem")
    model_error : whether the error of plane stress itself is estimated, with `finite_width` the
        error that remains; not for worn-in linings ("fem")
    across : elements over half the width of a lining ("solid")
    fields : path of a .vtu file for displacements and stresses in the shoes ("solid")
    sections : sections of each beam ("foundation")
    lift : names of simplifications to lift, or ["all"] ("foundation")

    Returns
    -------
    Response
        torque [N m], of each shoe p(theta) [Pa over rad], reactions [N], figures of merit, the load
        of the drum's bearings [N]; on a plane the braking force [N] and places [m]

    Raises
    ------
    BadInput
        for an unknown model, a model that does not apply, an option out of range or of another
        model
    NoAnswer
        for self-locking, no equilibrium, no convergence, a tolerance that is not reached

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> round(drumlin.solve(brake).torque), round(drumlin.solve(brake, "sine").torque)
    (448, 435)
    """
    from drumlin.models import check_options, pick

    whole = _brake_of(brake)
    options = _given(
        elements=elements,
        kind=kind,
        penalty=penalty,
        tolerance=tolerance,
        finite_width=finite_width,
        worn_in=worn_in,
        across=across,
        fields=None if fields is None else Path(fields),
        sections=sections,
        lift=lift,
    )
    # The model is picked first: that no such model exists says more than a wrong option.
    chosen = pick(model, whole)
    check_options(model, options)
    if finite_width and worn_in:
        raise BadInput("--finite-width: does not apply to worn-in linings")
    if finite_width and not model_error:
        raise BadInput("--no-model-error: --finite-width states the error that remains")
    if model == "fem" and model_error and not worn_in:
        options["model_error"] = True
    return chosen.solve(whole, **options)


def compare(
    brake: BrakeOrPath,
    case: str = "",
    repeats: int = 1,
    models: Sequence[str] | None = None,
    *,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
    tolerance: float | None = None,
    finite_width: bool = False,
) -> Comparison[Brake]:
    """Solve a brake by all models that apply, side by side.

    Parameters
    ----------
    brake : the brake, or the path of its file
    case : a name for the table; "": the brake's title
    repeats : how often each model is timed
    models : names of the models; None: all that apply and answer at once
    elements : finite elements along each lining, see `solve`
    kind : of the finite elements, see `solve`
    penalty : contact stiffness of the finite elements, see `solve`
    tolerance : relative error of the finite elements, see `solve`
    finite_width : whether the answer of the finite elements is corrected, see `solve`

    Returns
    -------
    Comparison
        `responses` by model, `rows` of a table with the errors against the finite elements
        (fractions) and run times [s]; a model without an answer is a row that says why

    Raises
    ------
    BadInput
        for an option out of range

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> sorted(drumlin.compare(brake, models=["sine", "cosine"]).responses)
    ['cosine', 'sine']
    """
    from drumlin.comparison import compare as side_by_side

    options = _given(
        elements=elements,
        kind=kind,
        penalty=penalty,
        tolerance=tolerance,
        finite_width=finite_width,
    )
    return side_by_side(_brake_of(brake), case, repeats, models, **options)


def sweep(path: Path | str, *, jobs: int | None = 1) -> list[Row]:
    """Solve every case of a sweep file.

    Parameters
    ----------
    path : of the TOML file that names the brake, the keys that vary and how
    jobs : processes that solve side by side; None: one a core

    Returns
    -------
    list of dict
        one row a case, in the file's order: its changed keys, then its numbers in SI, and "status",
        which says why a case has none

    Raises
    ------
    BadInput
        for a file that cannot be read or is no sweep, in one line

    Examples
    --------
    >>> rows = drumlin.sweep("loads.toml")
    >>> [row["friction"] for row in rows], rows[0]["status"]
    ([0.3, 0.4], 'solved')
    """
    from drumlin.sweeps.run import solve_sweep_file as all_rows

    return all_rows(path, jobs=jobs)


def wear(
    brake: BrakeOrPath,
    model: str = "fem",
    *,
    distance: float | str | None = None,
    coefficient: float | str | None = None,
    exponent: float = 1.0,
    torque: float | str | None = None,
    reverse: float | str | None = None,
    guided: bool = False,
    tolerance: float | None = None,
    elements: int | None = None,
    kind: str | None = None,
    sections: int | None = None,
    lift: Sequence[str] | None = None,
    say: Say = _unheard,
) -> WearRun:
    """Run a brake in: wear its linings by Archard's law.

    Parameters
    ----------
    brake : the brake, or the path of its file
    model : "fem" or "foundation", the elastic model that is worn
    distance : sliding distance [m], or a text: "20 km", or "20" for 20 times 1/(k K) with K = E/t
        of the lining; None: until p and torque are settled
    coefficient : k of wear [1/Pa], or a text such as "1e-5 mm^3/(N m)"; with an exponent: at 1 MPa
    exponent : of the pressure in the rate of wear
    torque : torque [N m], or a text with its unit, that the actuation holds; None: the actuation
        stays. On a plane the braking force [N]
    reverse : sliding distance, as `distance`, after which the drum turns back again and again
    guided : whether the shoes move along their middle radius without turning ("fem")
    tolerance : relative error of p (L2) of a step
    elements : finite elements along each lining, see `solve`
    kind : of the finite elements, see `solve`
    sections : sections of each beam ("foundation")
    lift : simplifications of the foundation model to lift, see `solve`
    say : told in words what is done, as it begins

    Returns
    -------
    WearRun
        `states` from the unworn one on, each with distance [m], depth [m], pressure [Pa] and torque
        [N m]; `target`, what wear tends to; `lines()` and `as_dict()`

    Raises
    ------
    BadInput
        for a model that does not wear, an option out of range or of the other model
    NoAnswer
        for no equilibrium, no convergence, self-locking, a lining that is worn through

    Examples
    --------
    >>> run = drumlin.wear(drumlin.example("double_shoe"), elements=12, distance="2")
    >>> bool(run.states[-1].depth.max() > 0)
    True
    """
    from drumlin.lining_wear import linings, whole_brake

    worn = _brake_of(brake)
    # Guides are data of the brake, so that wear needs no option for them.
    worn = linings.put_shoes_on_guides(worn) if guided else worn
    worn.check_meshable()
    on_mesh = _given(elements=elements, kind=kind)
    on_springs = _given(sections=sections, lift=lift)
    # Options of one model are refused for the other one by name.
    only_mesh = on_mesh | _given(guided=guided)
    whole_brake.check_wear_options(model, only_mesh, on_springs)
    law = whole_brake.make_wear_law(coefficient, exponent)
    held = None if torque is None else _in_si("--torque", torque, worn.surface.effect_unit)
    options = on_mesh if model == "fem" else on_springs
    setups = whole_brake.wear_setups(worn, model, both_ways=reverse is not None, **options)
    say("wearing")
    return whole_brake.run_wear(
        setups,
        law,
        distance=distance,
        reverse=reverse,
        torque=held,
        tolerance=tolerance,
    )


class HoldingRun(NamedTuple):
    """The states of a holding brake from rest on."""

    brake: Brake
    states: tuple[Hold, ...]

    def as_dict(self) -> list[dict[str, Any]]:
        """The states as plain data for JSON, in SI; the keys are those of `drumlin hold --json`."""
        from drumlin.fem.analysis.holding import states_as_plain_data

        return states_as_plain_data(list(self.states))


def hold(
    brake: BrakeOrPath,
    *,
    rotation: float | str | None = None,
    steps: int = 20,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
    say: Say = _unheard,
) -> HoldingRun:
    """Hold the drum: from rest through partial slip to full slip, as it is turned.

    Parameters
    ----------
    brake : the brake, or the path of its file
    rotation : how far the drum is turned against the shoes [rad], or a text such as "0.02 deg"; on
        a plane how far the body slides [m]; None: to full slip
    steps : increments of the rotation, 1 to 10 000
    elements : finite elements along each lining, see `solve`
    kind : of the finite elements, see `solve`
    penalty : contact stiffness, see `solve`
    say : told in words which shoes are held, as it begins

    Returns
    -------
    HoldingRun
        `states`, `steps` + 1 of them, each with rotation [rad], moment [N m], share of the nodes
        that stick, dissipated work [J] and p and traction [Pa] of each shoe

    Raises
    ------
    BadInput
        for a brake without friction or an option out of range
    NoAnswer
        for a shoe that does not touch, self-locking, no convergence

    Examples
    --------
    >>> run = drumlin.hold(drumlin.example("double_shoe"), elements=12, steps=4)
    >>> len(run.states), run.states[-1].sticking
    (5, 0.0)
    """
    import numpy as np

    from drumlin.fem.analysis import holding
    from drumlin.fem.solve import prepare_finest_division

    held = _brake_of(brake)
    held.check_meshable()
    if not 1 <= steps <= MOST_STEPS:
        raise BadInput(f"--steps = {steps}: must be from 1 to {MOST_STEPS}")
    on_mesh, stiffness = _given(elements=elements, kind=kind), _given(penalty=penalty)
    end = None if rotation is None else _in_si("--rotation", rotation, held.surface.unit)
    scene = prepare_finest_division(held, **on_mesh)
    if end is None:
        end = holding.find_full_slip_rotation(scene, held, **stiffness)
    # The state at rest comes first, so that there is one state more than increments.
    rotations = np.linspace(0.0, end, steps + 1)
    states = holding.hold_drum_through_rotations(scene, held, rotations, say=say, **stiffness)
    return HoldingRun(held, tuple(states))


def sensitivity(
    brake: BrakeOrPath,
    *,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
) -> Sensitivity:
    """How the torque changes with friction, force, moduli, clearance and hinge: exact slopes.

    Parameters
    ----------
    brake : the brake, or the path of its file
    elements : finite elements along each lining, see `solve`
    kind : of the finite elements, see `solve`
    penalty : contact stiffness, see `solve`

    Returns
    -------
    Sensitivity
        `torque` T [N m], `friction` dT/dmu [N m], `S` = (mu/T) dT/dmu, and the slopes of each shoe;
        on a plane T is the braking force [N]

    Raises
    ------
    BadInput
        for an option out of range
    NoAnswer
        for a brake without friction, self-locking, no equilibrium

    Examples
    --------
    >>> slopes = drumlin.sensitivity(drumlin.example("double_shoe"))
    >>> slopes.S > 1
    True
    """
    from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity as slopes
    from drumlin.fem.solve import prepare_finest_division

    on_mesh, stiffness = _given(elements=elements, kind=kind), _given(penalty=penalty)
    whole = _brake_of(brake)
    whole.check_meshable()
    return slopes(prepare_finest_division(whole, **on_mesh), whole, **stiffness)


class LockingLimit(NamedTuple):
    """The friction coefficient at which shoes lock themselves.

    `shoes`: the shoes that meet the drum together, by name. `friction`: mu_lock, inf where they do
    not lock up to the largest friction that was looked at. `bounded`: whether the answer ends there
    at a finite pressure; otherwise the pressure grows without bound.
    """

    shoes: tuple[str, ...]
    friction: float
    bounded: bool


def self_locking(
    brake: BrakeOrPath,
    *,
    most: float | None = None,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float = math.inf,
) -> tuple[LockingLimit, ...]:
    """Find the friction coefficient at which a brake locks itself, by finite elements.

    Parameters
    ----------
    brake : the brake, or the path of its file
    most : friction coefficient up to which the limit is looked for; None: 1000
    elements : finite elements along each lining, see `solve`
    kind : of the finite elements, see `solve`
    penalty : contact stiffness, see `solve`; inf: exact contact

    Returns
    -------
    tuple of LockingLimit
        one a group of shoes: a shoe on a rigid drum is a group, and so are all shoes on an elastic
        ring, on a cam or on struts

    Raises
    ------
    BadInput
        for an option out of range
    NoAnswer
        for a group without equilibrium

    Examples
    --------
    >>> limits = drumlin.self_locking(drumlin.example("double_shoe"), elements=12)
    >>> [limit.shoes for limit in limits]
    [('right',), ('left',)]
    """
    from drumlin.contact.self_locking import LARGEST_SOUGHT_FRICTION
    from drumlin.fem.analysis.self_locking import friction_limits_of_groups
    from drumlin.fem.model import check_penalty
    from drumlin.fem.solve import prepare_finest_division

    on_mesh = _given(elements=elements, kind=kind)
    check_penalty(penalty)
    whole = _brake_of(brake)
    whole.check_meshable()
    found = friction_limits_of_groups(
        prepare_finest_division(whole, **on_mesh),
        whole,
        LARGEST_SOUGHT_FRICTION if most is None else most,
        penalty,
    )
    return tuple(
        LockingLimit(
            tuple(whole.shoes[i].name for i in members), end.friction, end.pressure_stays_finite
        )
        for members, end in found.items()
    )


def reference(brake: BrakeOrPath, output: Path | str | None = None) -> Reference:
    """Make reference values of a brake by two programs, with uncertainties; this takes minutes.

    Parameters
    ----------
    brake : the brake, or the path of its file
    output : path of the JSON file to write; None: no file

    Returns
    -------
    Reference
        torque [N m], and of each shoe torque [N m], reactions [N] and p [Pa] at whole degrees, each
        with its uncertainty; on a plane the braking force [N] and whole millimetres

    Raises
    ------
    BadInput
        for a brake that finite elements do not apply to, with a mesh file, or a file that may not
        be written
    NoAnswer
        for a brake without equilibrium

    Examples
    --------
    >>> found = drumlin.reference(drumlin.example("short_block"))
    >>> round(found.torque.value, 4), found.torque.uncertainty < 1e-6
    (20.0995, True)
    """
    from drumlin.base.files import check_outputs
    from drumlin.verification.reference import compute_reference as values_of
    from drumlin.verification.reference_file import reference_data, write_reference

    source = _source_of(brake)
    path = None if output is None else Path(output)
    check_outputs(path)
    found = values_of(source.brake, source.text, source.command)
    if path is not None:
        write_reference(reference_data(found), path)
    return found


class CheckResult(NamedTuple):
    """How far a p(theta) is from reference values.

    `verdicts`: one a shoe, relative distances. `tolerance`: that of p in L2 and of the torque.
    `reference`: path of the reference values, or "made anew". `surface`: drum or plane.
    """

    verdicts: tuple[Verdict, ...]
    tolerance: float
    reference: str
    surface: FrictionSurface

    @property
    def within(self) -> bool:
        """Whether every shoe is within the tolerance."""
        from drumlin.verification.check import are_within_tolerance

        return are_within_tolerance(self.verdicts, self.tolerance)

    def lines(self) -> list[str]:
        """The verdicts for people; the last line is the verdict on all shoes."""
        from drumlin.verification.check import verdict_lines

        return verdict_lines(self.verdicts, self.tolerance, self.surface)


def check(
    brake: BrakeOrPath,
    result: Path | str,
    *,
    reference: Path | str | None = None,
    tolerance: float = 0.01,
    say: Say = _unheard,
) -> CheckResult:
    """Compare anybody's p(theta) with reference values.

    Parameters
    ----------
    brake : the brake, or the path of its file
    result : path of a CSV file with the columns "shoe", "theta [deg]" (on a plane "x [mm]") and
        "p [MPa]"; other units as well
    reference : path of reference values; None: the stored values of the brake's file, else values
        that are made anew, which takes minutes
    tolerance : of p in L2 and of the torque, relative, between 0 and 1
    say : told in words when reference values must be made anew

    Returns
    -------
    CheckResult
        a verdict on each shoe, with relative distances of p and torque; `within`, `lines()`

    Raises
    ------
    BadInput
        for a table that cannot be read, or reference values of another brake
    NoAnswer
        for a brake without equilibrium, where values are made anew

    Examples
    --------
    >>> try:
    ...     drumlin.check(drumlin.example("double_shoe"), "nowhere.csv", tolerance=2)
    ... except drumlin.BadInput as fault:
    ...     print(fault)
    --tolerance = 2: must be greater than 0 and less than 1
    """
    from drumlin.studies import REPOSITORY
    from drumlin.verification.check import judge_curves as verdicts_on
    from drumlin.verification.check import read_curves
    from drumlin.verification.reference import compute_reference as values_of
    from drumlin.verification.reference_file import read_reference, stored_reference_path

    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    source = _source_of(brake)
    curves = read_curves(Path(result), source.brake)
    # Reference values are looked for beside the brake file first, then among drumlin's own.
    values = Path("reports") / "reference" / "values"
    beside = () if source.folder is None else (source.folder,)
    known = reference or stored_reference_path(source.text, *beside, values, REPOSITORY / values)
    if known is None:
        say("no stored reference: columns of high degree, then triangles")
        found, name = values_of(source.brake, source.text, source.command), "made anew"
    else:
        found, name = read_reference(Path(known)), str(known)
    verdicts = verdicts_on(source.brake, found, curves)
    return CheckResult(tuple(verdicts), tolerance, name, source.brake.surface)


def fields(
    brake: BrakeOrPath,
    output: Path | str | None = None,
    *,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
) -> tuple[Fields, ...]:
    """Displacements and stresses in the shoes, and in an elastic drum ring, by finite elements.

    Parameters
    ----------
    brake : the brake, or the path of its file
    output : path of a .vtu file to write, for ParaView; None: no file
    elements : finite elements along each lining, see `solve`
    kind : of the finite elements, see `solve`
    penalty : contact stiffness, see `solve`

    Returns
    -------
    tuple of Fields
        one a shoe, then the drum ring where it is elastic: points (n, 2) [m], displacement (n, 2)
        [m], stress (n, 3) xx, yy, xy [Pa], von Mises stress (n,) [Pa]

    Raises
    ------
    BadInput
        for an option out of range, or a file that does not end in .vtu
    NoAnswer
        for self-locking, no equilibrium, no convergence

    Examples
    --------
    >>> right, left = drumlin.fields(drumlin.example("double_shoe"), elements=12)
    >>> right.stress.shape[1], bool(right.von_mises.max() > 0)
    (3, True)
    """
    from drumlin.base.files import check_outputs
    from drumlin.fem.analysis.fields import recover_all_fields, write_fields_as_vtu
    from drumlin.fem.model import solve_prepared_model
    from drumlin.fem.solve import prepare_finest_division

    path = None if output is None else Path(output)
    if path is not None and path.suffix != ".vtu":
        raise BadInput(f"--fields = {str(path)!r}: must end in .vtu")
    check_outputs(path)
    on_mesh, stiffness = _given(elements=elements, kind=kind), _given(penalty=penalty)
    solved = _brake_of(brake)
    solved.check_meshable()
    scene = prepare_finest_division(solved, **on_mesh)
    found = recover_all_fields(scene, solved, solve_prepared_model(scene, solved, **stiffness))
    if path is not None:
        write_fields_as_vtu(path, found)
    return tuple(found)


def write_brake(brake: BrakeOrPath, output: Path | str) -> None:
    """Write a brake as a file that reads as exactly this brake, every quantity with its unit.

    Parameters
    ----------
    brake : the brake, or the path of its file
    output : path of the new file

    Returns
    -------
    None
        paths of mesh files are written as they are in the brake, seen from the current folder

    Raises
    ------
    BadInput
        for a file that is there already, since brake files are written by hand; for a path that
        cannot be written, or a mesh file whose name is no UTF-8

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> drumlin.write_brake(brake, "my.toml")
    >>> drumlin.read_brake("my.toml") == brake
    True
    """
    from drumlin.base.files import write_new
    from drumlin.brake.writing import brake_text

    write_new(Path(output), brake_text(_brake_of(brake)))


def example(name: str) -> Brake:
    """Read an example brake by its name; `drumlin init` lists the names.

    Parameters
    ----------
    name : such as "double_shoe", "duplex" or "post_brake"

    Returns
    -------
    Brake
        frozen, validated data in SI units

    Raises
    ------
    BadInput
        for an unknown name; the line lists the examples

    Examples
    --------
    >>> drumlin.example("duplex").title
    'duplex, shoes on abutments'
    """
    from drumlin.brake import read_any
    from drumlin.studies import example as example_text
    from drumlin.studies import examples

    text = example_text(name)
    return read_any(examples()[name], text)
