"""The derivatives of the torque by the moduli of a solid shoe's parts, by central differences.

For a three-dimensional (solid) shoe only the flexibility at its contact nodes and loads is known,
because the displacements inside the body are not computed. The flexibility is therefore computed
again with each modulus a little larger and a little smaller. The derivative of the torque then
follows from the adjoint and the difference of the flexibilities.

If all moduli of a shoe are multiplied by one factor, its flexibility is divided by this factor. The
sum of the derivatives over all parts is therefore known exactly, and shows the error of the
differences.
"""

import math
from collections.abc import Callable
from functools import cache, partial
from typing import NamedTuple

from drumlin.base.arrays import Floats
from drumlin.brake.file import vary
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.width.face import ContactFaceWithWidth
from drumlin.fem.width.prepare import condense_and_couple_shoe_with_width

STEP_OF_MODULUS_LOGARITHM = 1e-3
"""Change of the logarithm of a modulus in the central differences.

The error of a difference is at most STEP_OF_MODULUS_LOGARITHM^2/6 = 2e-7 of the slope, see
`TorqueSlopesByLogarithmOfModuli`. The error by round-off is as large: it is the relative round-off
of a condensed body, some 1e-10, divided by the step. A larger step is less exact, and a smaller
step loses digits.
"""
MATERIAL_KEY_BY_PART_NAME = {"lining": "lining", "backing": "backing", "shoe": "body"}
"""The key of the brake file that holds the material of a part, by the part's name in the slopes."""


class LoadsAndAdjointLoads(NamedTuple):
    """The loads of a shoe in the solution, and the adjoint loads by which they are multiplied.

    Attributes
    ----------
    pressures : pressures (n,) [Pa] at the contact nodes
    signed_friction : friction coefficient, positive if the drum drags the lining towards larger
        angles of the shoe's frame
    load_column_factors : factors (l,) by which the body's load columns make up the other loads on
        the shoe
    gap_multipliers : adjoint multipliers (n,) of the weighted gaps (integrals of the gap times each
        node's shape function)
    adjoint_load_factors : factors (l,) by which the load columns make up the adjoint load
    """

    pressures: Floats
    signed_friction: float
    load_column_factors: Floats
    gap_multipliers: Floats
    adjoint_load_factors: Floats

    def work_of_adjoint_loads_on_body(self, body: ShoeSubstructure) -> float:
        """The work [N m] of the adjoint loads on a body's displacements under the actual loads."""
        p, load, flexibility = self.pressures, self.load_column_factors, body.flexibility
        friction = self.signed_friction * p
        closed = flexibility.gap_closure_by_pressure @ p + flexibility.gap_closure_by_load @ load
        # A brake without friction has no torque, and so no slopes.
        assert flexibility.gap_closure_by_friction is not None
        closed = closed + flexibility.gap_closure_by_friction @ friction
        moved = flexibility.motion_of_load_points(p, friction, load)
        return float(self.gap_multipliers @ closed + self.adjoint_load_factors @ moved)


class TorqueSlopesByLogarithmOfModuli(NamedTuple):
    """The slopes [N m] of the torque by the logarithm of each part's modulus, and their error.

    The keys of `slopes` are the names of the parts. `error` [N m] has two parts. The first part is
    the difference between the sum of the derivatives and the exact derivative by a common factor on
    all moduli of the shoe. It shows the round-off error, but errors by the step may cancel in the
    sum. The second part is therefore STEP_OF_MODULUS_LOGARITHM^2/6 times the derivatives. The
    second part is the error of the difference if the flexibility is 1/E, and a bound if it is 1/(1
    + E/E_0), as for a part that acts together with parts of a modulus E_0.
    """

    slopes: dict[str, float]
    error: float


FunctionOfBodiesWithChangedModuli = Callable[
    [int], dict[str, tuple[ShoeSubstructure, ShoeSubstructure]]
]
"""Function that takes the index of a shoe in the brake and returns bodies with changed moduli.

The keys of the result are the names of the shoe's parts. The first body of a pair has a larger
modulus of this part, the second body a smaller one.
"""


def function_that_condenses_shoes_with_other_moduli(
    scene: PreparedModel,
) -> FunctionOfBodiesWithChangedModuli:
    """The function that condenses solid shoes of a prepared model with changed moduli.

    Shoes of one shape share their bodies, which are condensed when they are first needed.
    """
    shapes = scene.cache_keys_of_shoe_shapes
    condensed = cache(partial(_condensed_shoes_with_larger_and_smaller_moduli, scene))
    return lambda i: condensed(shapes.index(shapes[i]))


def _condensed_shoes_with_larger_and_smaller_moduli(
    scene: PreparedModel, i: int
) -> dict[str, tuple[ShoeSubstructure, ShoeSubstructure]]:
    """For each part of shoe `i`, the condensed shoe with a larger and with a smaller modulus."""
    brake, face = scene.brake, scene.bodies[i].line
    # The function is called only for prepared models of three-dimensional shoes.
    assert isinstance(face, ContactFaceWithWidth)
    bodies = {}
    for part, key in MATERIAL_KEY_BY_PART_NAME.items():
        owner = getattr(brake.shoes[i], key)
        if owner is None:
            continue
        pair = []
        for step in (STEP_OF_MODULUS_LOGARITHM, -STEP_OF_MODULUS_LOGARITHM):
            modulus = {f"shoe[{i}].{key}.material.E": owner.material.E * math.exp(step)}
            pair.append(
                condense_and_couple_shoe_with_width(
                    vary(brake, modulus).shoes[i],
                    brake.size,
                    scene.divisions[i],
                    face.functions,
                    True,
                    {},
                )
            )
        bodies[part] = (pair[0], pair[1])
    return bodies


def torque_slopes_by_moduli_of_solid_shoe(
    body: ShoeSubstructure,
    changed: dict[str, tuple[ShoeSubstructure, ShoeSubstructure]],
    loads: LoadsAndAdjointLoads,
) -> TorqueSlopesByLogarithmOfModuli:
    """The slopes of the torque by the moduli of a solid shoe at a given contact stiffness.

    Parameters
    ----------
    body : the substructure of the shoe
    changed : for each part's name, the shoe with a larger and with a smaller modulus of this part
    loads : loads and adjoint loads of the shoe
    """
    slopes = {}
    for part, (stiff, soft) in changed.items():
        more, less = (loads.work_of_adjoint_loads_on_body(each) for each in (stiff, soft))
        slopes[part] = (more - less) / (2 * STEP_OF_MODULUS_LOGARITHM)
    whole = -loads.work_of_adjoint_loads_on_body(body)
    by_step = STEP_OF_MODULUS_LOGARITHM**2 / 6 * math.fsum(map(abs, slopes.values()))
    return TorqueSlopesByLogarithmOfModuli(
        slopes, abs(math.fsum(slopes.values()) - whole) + by_step
    )
