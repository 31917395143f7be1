"""The table of what is left out of a brake: the change that it makes, the change that was
predicted, what it saves.
"""

import math
import time
import tracemalloc
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.analysis.fields import fields
from drumlin.fem.mesh.grading import divide
from drumlin.fem.model import respond
from drumlin.fem.preparation.cache import shape_of
from drumlin.fem.preparation.meshes import ELEMENTS
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response
from drumlin_studies.omission import (
    OMISSIONS,
    OmissionChange,
    change,
    predict,
    prepare_straight,
    present,
    scene_without,
)
from drumlin_studies.reduced import sketcher

EXACT_OMISSIONS = {
    "interior fields": "not recovered",
    "second of equal shoes": "condensed once",
    "flexibility under drag, mu = 0": "symmetric part only",
}
"""What is left out without any change, and what is done instead."""


class WholeAndSimple(NamedTuple):
    """A brake computed whole and with something left out: each a function that solves it from the
    start.
    """

    whole: Callable[[], Response]
    simple: Callable[[], Response]


def omissions(
    brake: Brake, name: str, *, elements: int = ELEMENTS, repeats: int = 5
) -> list[dict[str, Any]]:
    """Rows of what can be left out of a brake: the exact ones, each of the others alone, and all of
    these together.

    Changes are relative, between both solutions on `elements` along each lining, as in
    `omission.Change`; what was predicted has the same keys after "predicted_". `seconds` and
    `memory`: shares of the whole solve's saved, medians of `repeats` taken in turn; 0 repeats leave
    them out. A case without an answer stays as a row.
    """
    rows: list[dict[str, Any]] = []
    for part, instead, exact, left in _cases(brake):
        pair = _exact_pair(brake, part, elements) if left is None else _pair(brake, left, elements)
        if pair is None:
            continue
        row: dict[str, Any] = {
            "brake": name,
            "part": part,
            "instead": instead,
            "exact": "yes" if exact else "no",
        }
        try:
            row |= _judged(change(pair.simple(), pair.whole()), "")
            if left is not None:
                row |= _judged(_predicted(brake, left, elements), "predicted_")
            row |= (saved(pair, repeats) if repeats else {}) | {"status": "converged"}
        except NoAnswer as error:
            row["status"] = f"failed: {error}"
        rows.append(row)
    return rows


def prediction_ratios(rows: Sequence[Mapping[str, Any]], key: str) -> list[float]:
    """Predicted over true change `key` (as in `omission.Change`) where the true one lies between
    0.01 % and 30 %.

    Not of what is left out exactly, nor of curvature.
    """
    return [
        row[f"predicted_{key}"] / row[key]
        for row in rows
        if row["exact"] == "no"
        and row["part"] not in {"curvature", "all"}
        and 1e-4 < (row.get(key) or 0.0) < 0.3
    ]


def time_saved(rows: Sequence[Mapping[str, Any]], least: float) -> dict[str, tuple[float, float]]:
    """The least and the largest share of time saved by leaving out each part alone, where it is
    ever above `least`.
    """
    saving: dict[str, list[float]] = {}
    for row in rows:
        if row["exact"] == "no" and "seconds" in row and not row["part"].startswith("all"):
            saving.setdefault(row["part"], []).append(row["seconds"])
    return {
        part: (min(shares), max(shares)) for part, shares in saving.items() if max(shares) > least
    }


def worst_straight(rows: Sequence[Mapping[str, Any]]) -> Mapping[str, Any] | None:
    """The row on which straight edges change p most."""
    straight = [row for row in rows if row["part"] == "curvature" and row.get("pressure")]
    return max(straight, key=lambda row: row["pressure"]) if straight else None


def _cases(brake: Brake) -> list[tuple[str, str, bool, list[str] | None]]:
    """What is left out, what is done instead, whether that is exact, and the names of the omissions
    if it is not.
    """
    names = present(brake)
    curved = [
        name
        for name in names
        if name != "curvature" and ("ring" not in names or name != "coupling")
    ]
    cases: list[tuple[str, str, bool, list[str] | None]] = [
        (part, how, True, None) for part, how in EXACT_OMISSIONS.items()
    ]
    cases += [(part, OMISSIONS[part].instead, False, [part]) for part in names]
    if len(curved) > 1:
        cases.append(("all but curvature", ", ".join(curved), False, curved))
    if curved and "curvature" in names:
        cases.append(("all", ", ".join([*curved, "curvature"]), False, [*curved, "curvature"]))
    return cases


def _judged(found: OmissionChange, prefix: str) -> dict[str, float]:
    return {prefix + key: getattr(found, key) for key in OmissionChange._fields}


def saved(pair: WholeAndSimple, repeats: int) -> dict[str, float]:
    """Shares of time (median of the ratios of `repeats` runs in turn) and of peak memory saved by
    the simpler solve.
    """
    ratios = [_seconds(pair.simple) / _seconds(pair.whole) for _ in range(repeats)]
    return {"seconds": 1 - median(ratios), "memory": 1 - _memory(pair.simple) / _memory(pair.whole)}


def _seconds(solve: Callable[[], object]) -> float:
    """The process's own time, which others on the machine do not stretch."""
    start = time.process_time()
    solve()
    return time.process_time() - start


def _memory(solve: Callable[[], object]) -> int:
    """Largest memory [bytes] that Python and NumPy hold meanwhile."""
    tracemalloc.start()
    try:
        solve()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def _pair(brake: Brake, names: list[str], elements: int) -> WholeAndSimple:
    whole = partial(prepare, elements=elements)
    make = partial(prepare_straight, elements=elements) if "curvature" in names else whole
    return WholeAndSimple(
        lambda: respond(whole(brake), brake), lambda: respond(*scene_without(brake, names, make))
    )


def _exact_pair(brake: Brake, part: str, elements: int) -> WholeAndSimple | None:
    """The pair of something that is left out exactly; None where the brake does not have it."""
    make = partial(prepare, elements=elements)

    def simple() -> Response:
        return respond(make(brake), brake)

    if part == "interior fields":

        def with_fields() -> Response:
            scene = make(brake)
            response = respond(scene, brake)
            for i in range(len(brake.shoes)):
                fields(scene, brake, response, i)
            return response

        return WholeAndSimple(with_fields, simple)
    if part == "second of equal shoes":
        if (
            len({shape_of(brake, shoe) for shoe in brake.shoes}) == len(brake.shoes)
            or brake.ring is not None
        ):
            return None
        return WholeAndSimple(lambda: respond(_each_alone(brake, make), brake), simple)
    if brake.friction > 0:
        return None
    rubbing = vary(brake, {"friction": 0.3})
    return WholeAndSimple(lambda: respond(make(rubbing), brake), simple)


def _each_alone(brake: Brake, make: Callable[[Brake], PreparedModel]) -> PreparedModel:
    """The scene of a brake whose shoes are all condensed, equal or not."""
    parts = [make(brake.model_copy(update={"shoes": (shoe,)})) for shoe in brake.shoes]
    return replace(
        parts[0], brake=brake, bodies=tuple(body for part in parts for body in part.bodies)
    )


def _predicted(brake: Brake, names: Iterable[str], elements: int) -> OmissionChange:
    """`predict`, and for "curvature" in closed form, which a mesh of its own has on every number of
    elements.
    """
    names = list(names)
    if "curvature" not in names:
        return predict(brake, names, respond)
    others = [name for name in names if name != "curvature"]
    sketch = sketcher()
    whole = respond(sketch(brake), brake)
    scene, simple = scene_without(brake, others, sketch)
    rest = respond(scene, simple)
    open_ = simple.model_copy(
        update={"shoes": tuple(_straightened(brake, shoe, elements) for shoe in simple.shoes)}
    )
    found = change(respond(scene, open_), whole)
    waves = max(
        straight_edges(brake, shoe, elements) / size
        if (size := _mean_square(answer.theta, answer.pressure))
        else 0.0
        for shoe, answer in zip(brake.shoes, rest.shoes, strict=True)
    )
    return found._replace(pressure=math.hypot(found.pressure, waves))


def _sagittas(brake: Brake, shoe: Shoe, elements: int) -> tuple[Floats, Floats]:
    """Ends phi (m + 1,) [rad] of the elements along a lining, and how far their chords lie inside
    the arc (m,) [m].
    """
    angles = divide(shoe, brake.size, elements).angles
    return angles, brake.size * (1 - np.cos(np.diff(angles) / 2))


def _straightened(brake: Brake, shoe: Shoe, elements: int) -> Shoe:
    """The shoe with the mean gap of its straight edges, 2/3 of their height, as a clearance."""
    angles, height = _sagittas(brake, shoe, elements)
    middle = np.sort(shoe.frame.theta((angles[:-1] + angles[1:]) / 2))
    height = height[:: shoe.frame.sense]
    gap = shoe.sign * 2 / 3 * height + shoe.lining.clearance_at(middle)
    table = tuple(zip(middle.tolist(), gap.tolist(), strict=True))
    return shoe.model_copy(update={"lining": shoe.lining.model_copy(update={"clearance": table})})


def straight_edges(brake: Brake, shoe: Shoe, elements: int) -> float:
    """Root of the mean square over the lining of the pressure waves [Pa] that straight edges press
    into it.

    An edge of length h whose chord lies s = R (1 - cos(dphi/2)) off the arc leaves a gap that
    repeats itself as s (1 - (2 x/h)^2), of the waves k = 2 pi m/h with the amplitudes 4 s/(pi m)^2.
    A layer of thickness t bonded to a rigid base, in plane stress, answers a wave w without
    friction with the pressure below: the plane problem in waves, of which the limits are E k/2 of a
    half-plane and E/((1 - nu^2) t) of a thin layer.

        p = w 4 G k/(kappa + 1) (2 kappa cosh 2kt + 1 + kappa^2 + (2kt)^2)/(2 kappa sinh 2kt - 4kt).
    """
    angles, height = _sagittas(brake, shoe, elements)
    lining = shoe.lining
    E, nu = lining.material.E_through, lining.material.nu_along_through
    kappa, G = (3 - nu) / (1 + nu), E / (2 * (1 + nu))
    h, m = brake.size * np.diff(angles)[:, None], np.arange(1, 9)
    k = 2 * math.pi * m / h
    a = np.minimum(2 * k * lining.thickness, 50.0)  # the layer is then a half-plane
    stiff = (2 * kappa * np.cosh(a) + 1 + kappa**2 + a**2) / (2 * kappa * np.sinh(a) - 2 * a)
    p = 4 * height[:, None] / (math.pi * m) ** 2 * 4 * G * k / (kappa + 1) * stiff
    return math.sqrt(
        float((np.diff(angles)[:, None] * p**2 / 2).sum()) / float(angles[-1] - angles[0])
    )


def _mean_square(theta: Floats, p: Floats) -> float:
    """Root of the mean square of p over theta, trapezoidal."""
    return math.sqrt(float(np.trapezoid(p**2, theta)) / float(theta[-1] - theta[0]))
