"""What a solve costs against the least that it could: assembly, one factorisation, one back-substitution."""

import time
from collections.abc import Callable
from functools import partial
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse.linalg import splu

from drumlin.brake import Brake, Shoe, vary
from drumlin.fem.body import scalar_basis, stiffness
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.scene import materials_of, prepare

ELEMENTS = 140  # about 20 000 unknowns for a car's shoe
REPEATS = 7


class Cost(NamedTuple):
    """Seconds, medians of repeats: whole solve, further load case, and the three parts of the baseline."""

    unknowns: int
    solve: float
    further: float
    assembly: float
    factorisation: float
    substitution: float

    @property
    def solve_ratio(self) -> float:
        """Whole solve over assembly + one factorisation + one back-substitution."""
        return self.solve / (self.assembly + self.factorisation + self.substitution)

    @property
    def further_ratio(self) -> float:
        """Further load case over the first solve."""
        return self.further / self.solve


def cost(brake: Brake, *, elements: int = ELEMENTS, penalty: float = PENALTY, repeats: int = REPEATS) -> Cost:
    """Measure a brake in one run. The baseline is that of its distinct bodies, hinge clamped.

    A further load case is another friction coefficient on the same bodies.
    """
    scene = prepare(brake, elements=elements)
    other = vary(brake, {"friction": 0.9 * brake.friction})
    bodies = {id(body): (body, shoe) for body, shoe in zip(scene.bodies, brake.shoes, strict=True)}
    phases = np.zeros(3)
    for body, shoe in bodies.values():
        K = stiffness(body.basis, materials_of(shoe))
        free = np.ones(K.shape[0], dtype=bool)
        hinge = body.basis.get_dofs(body.mesh.boundaries["hinge"]).flatten()
        free[2 * hinge] = free[2 * hinge + 1] = False
        K = K[free][:, free].tocsc()
        right = np.ones(K.shape[0])

        factorise = partial(splu, K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        phases += [
            _time(partial(_assemble, body.mesh, shoe), repeats),
            _time(factorise, repeats),
            _time(partial(factorise().solve, right), repeats),
        ]
    return Cost(
        sum(body.unknowns for body, _ in bodies.values()),
        _time(lambda: respond(prepare(brake, elements=elements), brake, penalty=penalty), repeats),
        _time(lambda: respond(scene, other, penalty=penalty), repeats),
        *phases.tolist(),
    )


def measure(brake: Brake, **options: Any) -> list[str]:
    """The cost of a brake as lines for people."""
    c = cost(brake, **options)
    return [
        f"{c.unknowns} unknowns; medians of {REPEATS} repeats in one run",
        f"assembly {c.assembly * 1e3:.1f} ms, factorisation {c.factorisation * 1e3:.1f} ms, "
        f"substitution {c.substitution * 1e3:.1f} ms",
        f"whole solve {c.solve * 1e3:.1f} ms = {c.solve_ratio:.2f} times their sum",
        f"further load case {c.further * 1e3:.1f} ms = 1/{1 / c.further_ratio:.0f} of the first",
    ]


def _assemble(mesh: Any, shoe: Shoe) -> Any:
    return stiffness(scalar_basis(mesh), materials_of(shoe))


def _time(call: Callable[[], object], repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return median(seconds)
