"""What can be left out of a brake, and how much that changes: predicted beforehand on a sketch of the brake.

The prediction is the difference between two sketches (sketch.py), one of the brake and one of what is left of it.
To first order it is the pressure's answer to the gap  F p  that the omitted flexibility F opened under it, so that
it goes as the ratio of stiffnesses; but contact may also open or close, and nothing is calibrated.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.components import Beam, Body
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem import assembly
from drumlin.fem.assembly import Scene
from drumlin.fem.hp.adapt import Tolerance, adapt, check_tolerance
from drumlin.fem.hp.levels import Respond, steps
from drumlin.fem.mesh.arc import shoe_mesh
from drumlin.fem.reduced import sketcher, with_closed_forms
from drumlin.response.norms import pressure_distance
from drumlin.response.response import Response

SAVING = (("ring", "shoe"), ("ring",), ("shoe",))
"""What takes a third of a solve or more, in the order in which it is tried; the other parts cost next to nothing."""
SHARE = 0.5  # of a tolerance that may be spent on leaving out; the mesh has the rest
SAFETY = 1.5  # on predictions that are used unseen: on brakes from stiff to soft they are 0.9 to 1.15 times the truth

Make = Callable[[Brake], Scene]


class Omission(NamedTuple):
    """A part that can be left out: its name, what is done instead, and whether a brake has it."""

    name: str
    instead: str
    in_brake: Callable[[Brake], bool]


def _arc(shoe: Shoe) -> bool:
    return shoe.mesh is None and not isinstance(shoe.body, Beam)


OMISSIONS = {
    part.name: part
    for part in (
        Omission("ring", "taken as rigid", lambda brake: brake.drum.ring is not None),
        Omission(
            "coupling",
            "each shoe presses the ring alone",
            lambda brake: brake.drum.ring is not None and len(brake.shoes) > 1,
        ),
        Omission(
            "shoe",
            "taken as rigid",
            lambda brake: any(isinstance(shoe.body, Body) and _arc(shoe) for shoe in brake.shoes),
        ),
        Omission(
            "backing",
            "left away; the shoe stands behind the lining at once",
            lambda brake: any(shoe.backing is not None and _arc(shoe) for shoe in brake.shoes),
        ),
        Omission(
            "drag",
            "friction acts on the moments, and does not shear what is elastic",
            lambda brake: brake.friction > 0,
        ),
        Omission(
            "curvature",
            "elements with straight edges",
            lambda brake: all(shoe.mesh is None for shoe in brake.shoes),
        ),
    )
}
"""What changes the answer when it is left out. A post's beam and block stay: the one ends where the other begins."""


class Change(NamedTuple):
    """Relative changes that an omission makes: torque of the brake, p (L2 outside the edge zones, worst shoe).

    `shoes`: the changes of the shoes' torques, all counted with one sign, relative to the torque of the brake: a bound
    on its own change, in which they cancel in part; `reaction`: of the hinge reactions, the worst; `peak`
    and `each`: of the peak pressures and of the shoes' own torques, the worst.
    """

    torque: float
    pressure: float
    shoes: float
    reaction: float
    peak: float
    each: float


def change(simple: Response, whole: Response) -> Change:
    """The change from the response of the `whole` brake to that of the simpler one."""
    pairs = list(zip(simple.shoes, whole.shoes, strict=True))
    off = [a.torque - b.torque for a, b in pairs]
    size = whole.torque or 1.0
    return Change(
        abs(sum(off)) / size,
        max(_pressure(a, b) for a, b in pairs),
        sum(map(abs, off)) / size,
        max(_length(a.hinge_reaction - b.hinge_reaction) / (_length(b.hinge_reaction) or 1.0) for a, b in pairs),
        max(abs(a.peak_pressure - b.peak_pressure) / (b.peak_pressure or 1.0) for a, b in pairs),
        max(abs(a.torque - b.torque) / (b.torque or 1.0) for a, b in pairs),
    )


def _pressure(a: Any, b: Any) -> float:
    return pressure_distance(a, b) if b.pressure.any() else float(a.pressure.any())


def _length(vector: Floats) -> float:
    return float(np.linalg.norm(vector))


def present(brake: Brake) -> list[str]:
    """Names of what a brake has that can be left out of it."""
    return [name for name, part in OMISSIONS.items() if part.in_brake(brake)]


def simplified(brake: Brake, names: Iterable[str]) -> Brake:
    """The brake without `names`, as far as a brake file says it: ring, shoe, backing."""
    names = set(names)
    if unknown := sorted(names - set(OMISSIONS)):
        raise BadInput(f"{unknown[0]!r}: cannot be left out; allowed: {', '.join(OMISSIONS)}")
    gone = {key: None for name, key in (("shoe", "body"), ("backing", "backing")) if name in names}
    shoes = tuple(shoe.model_copy(update=gone) if _arc(shoe) else shoe for shoe in brake.shoes)
    drum = brake.drum.model_copy(update={"ring": None}) if "ring" in names else brake.drum
    return brake.model_copy(update={"drum": drum, "shoes": shoes})


def scene_without(brake: Brake, names: Iterable[str], make: Make = assembly.prepare) -> tuple[Scene, Brake]:
    """The scene that `make` makes of a brake without `names`, and what is left of the brake to `respond` for.

    "curvature" depends on the mesh and so is the business of `make`: see `prepare_straight`.
    """
    names = set(names)
    simple = simplified(brake, names)
    if "drag" in names and brake.friction > 0:
        scene = _undragged(make(simple.model_copy(update={"friction": 0.0})), simple)
    else:
        scene = make(simple)
    return replace(scene, apart="coupling" in names), simple


def _undragged(scene: Scene, brake: Brake) -> Scene:
    """A scene prepared for mu = 0, for a brake with friction: under drag nothing gives way."""
    made: dict[int, assembly.Body] = {}
    for body, shoe in zip(scene.bodies, brake.shoes, strict=True):
        if id(body) not in made:
            x, y = body.line.xy - shoe.own_pin[:, None]
            rigid = np.stack([[1 + 0 * x, 0 * x], [0 * x, 1 + 0 * x], [-y, x]]).transpose(0, 2, 1).reshape(3, -1)
            held = -rigid @ body.coupling.T.T
            made[id(body)] = replace(body, closing_dragged=np.zeros_like(body.closing_pressed), held_dragged=held)
    ring = scene.ring and replace(scene.ring, dragged=tuple(np.zeros_like(d) for d in scene.ring.dragged))
    return replace(scene, brake=brake, bodies=tuple(made[id(body)] for body in scene.bodies), ring=ring)


def prepare_straight(brake: Brake, *, elements: int) -> Scene:
    """`prepare` on quadratic quadrilaterals with straight edges."""

    import skfem  # noqa: PLC0415  (meshes alone load it)

    def mesher(shoe: Shoe, radius: float) -> Any:
        mesh = shoe_mesh(shoe, radius, elements)
        corners = skfem.MeshQuad(np.ascontiguousarray(mesh.p[:, : mesh.nvertices]), mesh.t, validate=False)
        straight = skfem.MeshQuad2.from_mesh(corners)
        return replace(straight, _subdomains=mesh.subdomains, _boundaries=mesh.boundaries)

    return assembly.prepare(brake, elements=elements, mesher=mesher)


def predict(brake: Brake, names: Sequence[str], respond: Respond, sketch: Make | None = None) -> Change:
    """What leaving `names` out of a brake changes, predicted on sketches in some milliseconds.

    `sketch`: a sketcher that may have meshed the linings before. Raises NoAnswer where one of the two sketches has
    no equilibrium: then nothing is predicted.
    """
    sketch = sketch or sketcher()
    whole = respond(sketch(brake), brake)
    return change(respond(*scene_without(brake, names, sketch)), whole)


def adapt_without(brake: Brake, tolerance: float, respond: Respond, cache: assembly.Cache | None = None) -> Response:
    """`adapt`, without the ring and the shoes' elasticity where that is predicted to stay below the tolerance.

    Predicted changes count SAFETY times and are part of the response's error. Afterwards what is left out is added
    in closed form to the final meshes: where that changes more than the tolerance leaves room for, the brake is
    solved again with everything.
    """
    check_tolerance(brake, tolerance)
    names, predicted = _chosen(brake, SHARE * tolerance, respond)
    like: Response | None = None
    if names:
        with suppress(NoAnswer):  # of the simpler brake, or of the whole one: then it says so itself
            like, within = _without(brake, names, predicted, tolerance, respond, cache)
            if within:
                return like
    along = steps(brake, respond, cache, like=like)
    return adapt(brake, Tolerance(tolerance, tolerance), respond, along=along).response


def _without(
    brake: Brake,
    names: Sequence[str],
    predicted: Change,
    tolerance: float,
    respond: Respond,
    cache: assembly.Cache | None,
) -> tuple[Response, bool]:
    """The response of a brake without `names`, and whether its error stays within the tolerance; where the sketch has
    not resolved the contact, that of the first level."""
    simple = simplified(brake, names)
    along = steps(simple, respond, cache)

    def seen_on(scene: Scene, found: Response) -> Change:
        shortest = min((b - a for shoe in found.shoes for a, b in shoe.contact_arcs), default=math.tau)
        return change(found, respond(with_closed_forms(scene, brake, shortest), brake, start=found))

    first = next(along)
    if _size(seen_on(*first)) > tolerance:  # the sketch did not resolve the contact
        return first.response, False
    left = Tolerance(*[tolerance - _size(predicted)] * 2)
    scene, found = adapt(simple, left, respond, along=chain([first], along))
    seen = seen_on(scene, found)
    largest = Change(*map(max, predicted, seen))
    more = {"pressure": largest.pressure, "torque": largest.each, "peak": largest.peak, "reaction": largest.reaction}
    shoes = tuple(replace(shoe, error=_with(shoe.error, more)) for shoe in found.shoes)
    error = _with(found.error, more | {"torque": largest.shoes})
    lines = [
        f"{' and '.join(names)}: taken as rigid, predicted to change torque by at most {predicted.shoes:.1e}, "
        f"p by {predicted.pressure:.1e} (L2); on the final mesh {seen.shoes:.1e} and {seen.pressure:.1e}"
    ]
    kept = [line for line in found.left_out if line not in assembly.lacking(simple)]
    within = max(error["pressure"], error["torque"]) <= tolerance
    return replace(found, error=error, shoes=shoes, left_out=(*kept, *assembly.lacking(brake), *lines)), within


def _with(error: Mapping[str, float] | None, more: Mapping[str, float]) -> dict[str, float]:
    """Errors with what was left out."""
    return {name: value + SAFETY * more[name] for name, value in (error or {}).items()}


def _size(predicted: Change) -> float:
    """What of a tolerance a prediction takes."""
    return SAFETY * max(predicted.shoes, predicted.pressure)


def _chosen(brake: Brake, allowed: float, respond: Respond) -> tuple[tuple[str, ...], Change]:
    """What of SAVING may be left out within `allowed`, and the change that is predicted; () where nothing may."""
    nothing, has = Change(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), present(brake)
    unsketched = (shoe.mesh or shoe.flat or shoe.grip(brake.drum.radius) for shoe in brake.shoes)
    if any(unsketched) or assembly.why_not(brake) is not None:
        return (), nothing
    candidates = [names for names in SAVING if set(names) <= set(has)]
    if not candidates:
        return (), nothing
    try:
        sketch = sketcher()
        whole = respond(sketch(brake), brake)
        for names in candidates:
            predicted = change(respond(*scene_without(brake, names, sketch)), whole)
            if _size(predicted) <= allowed:
                return names, predicted
    except NoAnswer:
        pass
    return (), nothing
