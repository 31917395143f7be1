"""A brake by finite elements from the file up: divided, condensed, solved, finer until its error is
small enough.
"""

from dataclasses import replace
from functools import partial

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import DEFAULT, Tolerance, adapt, check_tolerance
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.mesh.arc import DEFAULT_KIND
from drumlin.fem.model import PENALTY, check_penalty, respond
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.finite_width import finite_width as corrected
from drumlin.fem.preparation.finite_width import said
from drumlin.fem.preparation.meshes import ELEMENTS
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.balance import loaded, shoe_balance, worst
from drumlin.response.merit import with_merits
from drumlin.response.response import Response

UNSAID = 1e-8  # by how much the balance of p(theta) may be worse than the nodal one without a word


def solve(
    brake: Brake,
    *,
    elements: int | None = None,
    kind: str | None = None,
    tolerance: float | None = None,
    penalty: float = PENALTY,
    finite_width: bool = False,
    cache: Cache | None = None,
) -> Response:
    """Divide, condense and solve a brake, finer and finer until its estimated errors are below a
    tolerance.

    tolerance: of the estimated relative errors of p (L2, outside the edge zones) and of the torque;
    NoAnswer is raised where it is not reached. By default DEFAULT, or the error that is reached.
    With `elements` or a `kind` a brake is solved on one mesh, without estimate, as one with a mesh
    file is. BadInput is raised for these and a tolerance together, and as by `check_divided`.
    finite_width: the linings' moduli corrected for the widths of the shoes, see
    fem/preparation/finite_width.py. cache: bodies of earlier solves.
    """
    if finite_width:
        other = corrected(brake)
        found = solve(
            other, elements=elements, kind=kind, tolerance=tolerance, penalty=penalty, cache=cache
        )
        return replace(found, notes=(*found.notes, said(brake, other)))
    check_penalty(penalty)
    for option, value in {"elements": elements, "kind": kind}.items():
        if tolerance is not None and value is not None:
            raise BadInput(
                f"--tolerance = {tolerance:g}: chooses the elements; leave out --{option} = {value}"
            )
    brake.check_meshable()
    answer = partial(respond, penalty=penalty)
    if tolerance is not None:
        check_tolerance(brake, tolerance)
        found = adapt(brake, Tolerance(tolerance, tolerance), answer, cache=cache).response
    elif _levelled(brake, elements, kind):
        found = adapt(brake, DEFAULT, answer, must=False, cache=cache).response
    else:
        found = answer(scene_of(brake, elements=elements, kind=kind, cache=cache), brake)
    if not brake.surface.straight:
        found = _with_curve_balance(brake, found)
    return with_merits(brake, found)


def scene_of(
    brake: Brake,
    *,
    elements: int | None = None,
    kind: str | None = None,
    cache: Cache | None = None,
) -> PreparedModel:
    """The scene that `solve` ends on, for what is done with the brake besides: holding, wear,
    slopes, pictures.

    A brake that has no answer as it slides is divided by the second level. Raises BadInput as
    `solve`.
    """
    check_divided(brake, elements=elements, kind=kind)
    if not _levelled(brake, elements, kind):
        elements = ELEMENTS if elements is None else elements
        return prepare(brake, elements=elements, kind=kind or DEFAULT_KIND, cache=cache)
    try:
        return adapt(brake, DEFAULT, respond, must=False, cache=cache).scene
    except NoAnswer:
        return prepare(brake, LEVELS[1], cache=cache)


def check_divided(brake: Brake, *, elements: int | None = None, kind: str | None = None) -> None:
    """Raise BadInput for elements or a kind where no part is divided by them; a ring has elements,
    but one kind.
    """
    given = {"kind": kind} if brake.ring else {"elements": elements, "kind": kind}
    for option, value in given.items():
        if value is not None and all(shoe.mesh for shoe in brake.shoes):
            raise BadInput(
                f"--{option} = {value}: all shoes have mesh files, whose elements stay as they are"
            )


def _levelled(brake: Brake, elements: int | None, kind: str | None) -> bool:
    """Whether a brake is divided by levels, not by one mesh."""
    return elements is None and kind is None and not any(shoe.mesh for shoe in brake.shoes)


def _with_curve_balance(brake: Brake, found: Response) -> Response:
    """The response with a note where p(theta) on the round drum balances worse than the forces at
    the mesh's nodes.
    """
    under = loaded(brake, found)
    curve = worst([shoe_balance(under, i, shoe) for i, shoe in enumerate(found.shoes)])
    if max(curve.force - found.balance.force, curve.moment - found.balance.moment) <= UNSAID:
        return found
    note = (
        f"p(theta) on the round drum balances to {curve.force:.1e} (force) and {curve.moment:.1e} (moment) only: "
        "the lining's elements are not quite as round"
    )
    return replace(found, notes=(*found.notes, note))
