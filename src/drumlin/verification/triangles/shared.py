"""Shoes that share forces, on a rigid drum: each solved under forces that are sought by the shoes'
own answers.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from drumlin.base.arrays import Bools
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.verification.triangles.contact import Found, contact, tip
from drumlin.verification.triangles.face import Face


def shared(brake: Brake, faces: list[Face], first: list[Bools]) -> tuple[list[Shoe], list[Found]]:
    """The shoes under the forces that they share, and what they do; `faces` are those under 1 N.

    A strut passes on what the foot of its shoe bears on; the forces of a cam have its sum and move
    both tips alike. Raises NoAnswer where that has no answer.
    """
    names = [shoe.name for shoe in brake.shoes]
    shoes, found = list(brake.shoes), dict[int, Found]()

    def under(i: int, force: float) -> float:
        """Solve shoe i under a force [N]; how far its tip goes [m]."""
        one, shoe = faces[i], shoes[i].under(force)
        one = replace(one, loaded=force * one.loaded, yields=force**2 * one.yields)
        failure: NoAnswer | None = None
        for sense in shoe.senses:
            try:
                (found[i],) = contact(brake, [one], [shoe], None, [first[i]], (sense,))
            except NoAnswer as error:
                failure = failure or error
                continue
            shoes[i] = shoe
            return tip(brake, one, shoe, found[i], sense)
        assert failure is not None
        raise failure

    behind = {names.index(link.to) for link in brake.links}
    free = [i for i in range(len(names)) if i not in behind]
    if brake.actuation is not None and brake.actuation.is_cam:
        a, b, total = free[0], free[1], brake.actuation.total
        brentq(
            lambda force: under(a, force) - under(b, total - force),
            1e-3 * total,
            0.999 * total,
            xtol=1e-12 * total,
        )
    else:
        for i in free:
            under(i, shoes[i].actuation.force)
    left = list(brake.links)
    # A chain of links goes from shoe to shoe: the link whose first shoe is solved comes next.
    while left:
        link = next(one for one in left if names.index(one.source) in found)
        left.remove(link)
        i = names.index(link.source)
        drum = brake.friction * brake.spin * faces[i].tangent - faces[i].normal
        reaction = -(found[i].force[:, None] * drum).sum(axis=0) - shoes[i].actuation.vector
        under(names.index(link.to), float(np.hypot(*reaction)))
    return shoes, [found[i] for i in range(len(names))]
