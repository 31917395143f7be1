"""What a finite width does to a lining, put into the modulus of plane stress: a correction, off by
default.

Two things that plane stress leaves out. A lining bonded to a stiff table cannot contract freely
across the width but near its sides: its Lame constant lies between those of plane stress and of
plane strain. And a table that reaches beyond its web bends back like a cantilever plate on the
lining as foundation (Hetenyi 1946, Beams on Elastic Foundation): its sides press less, and the
whole lining is softer in the mean.
"""

import numpy as np

from drumlin.base.errors import BadInput
from drumlin.base.texts import formatted
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Bar
from drumlin.brake.elasticity import elasticity_matrix
from drumlin.brake.fields import Material
from drumlin.brake.file import vary
from drumlin.brake.orthotropic import isotropic_only
from drumlin.brake.surface import DRUM

PLANE_STRAIN_SHARE = 0.5
"""The share of plane strain in a wide lining, by solid shoes: the shoe behind it contracts as well.
"""
LARGEST_CHECKED_NU = (
    0.45  # of a lining up to which the correction has been held against solid shoes
)
TORQUE_DEVIATION, PRESSURE_DEVIATION = (
    0.015,
    0.08,
)  # largest errors over all brakes of the study plane_stress


def between(material: Material, share: float) -> Material:
    """The material of the same nu, as stiff through a lining that is held along the arc as `share`
    plane strain.

    E' = (lambda + 2 mu) (1 - nu^2), lambda that share of the way from plane stress to plane strain.
    """
    E, nu = material.E, material.nu
    matrix = elasticity_matrix(material)
    stress, mu = matrix[0, 1], matrix[2, 2]
    strain = E * nu / ((1 + nu) * (1 - 2 * nu))
    stiff = stress + share * (strain - stress) + 2 * mu
    return material.model_copy(update={"E": float(stiff * (1 - nu**2))})


def held_share(width: float, thickness: float) -> float:
    """The share of plane strain in a lining: none where it is no wider than thick."""
    return PLANE_STRAIN_SHARE * max(0.0, 1 - thickness / width)


def flange_mean(reach: float, stiffness: float, foundation: float) -> float:
    """Mean pressure under a flange over that at the web, which it is clamped to: a strip that
    reaches so far [m].

    D y'''' + K y = 0, y(0) = 1, y'(0) = 0, y''(c) = y'''(c) = 0, with D [N m] of the strip and K
    [Pa/m] of the foundation; the mean of y is -(D/(K c)) (y'''(c) - y'''(0)).
    """
    beta = (foundation / (4 * stiffness)) ** 0.25
    if beta * reach < 1e-3:
        return 1.0
    roots = beta * np.array([1 + 1j, 1 - 1j, -1 + 1j, -1 - 1j])
    scale = np.exp(-np.maximum(roots.real, 0) * reach)  # growing parts count from the free end
    at_end = scale * np.exp(roots * reach)
    rows = np.array(
        [scale, scale * roots, at_end * roots**2 / beta**2, at_end * roots**3 / beta**3]
    )
    factors = np.linalg.solve(rows, np.array([1.0, 0, 0, 0], dtype=complex))
    return float((factors @ ((at_end - scale) / roots)).real / reach)


def corrected(shoe: Shoe) -> Material:
    """The lining's material for plane stress of a shoe of finite width.

    Flanges are those of a table, or of a backing that stands for one, beyond a narrower part behind
    it.
    """
    lining = shoe.lining
    assert isinstance(lining.material, Material)  # why_not
    material = between(lining.material, held_share(lining.width, lining.thickness))
    if not isinstance(shoe.body, Bar):
        return material
    body = shoe.body.plates["shoe"]
    table = shoe.body.plates.get("table", shoe.backing)
    if table is None or body.width >= lining.width:
        return material
    reach = (lining.width - body.width) / 2
    assert isinstance(table.material, Material)  # why_not
    plate = table.material.E * table.thickness**3 / (12 * (1 - table.material.nu**2))
    stretch = material.E / (1 - material.nu**2)  # across the lining, held along the arc
    mean = flange_mean(reach, plate, stretch / lining.thickness)
    share = (body.width + 2 * reach * mean) / lining.width
    return material.model_copy(update={"E": material.E * share})


def why_not(brake: Brake) -> str | None:
    """Why the correction does not apply to a brake (None: it does)."""
    unlike = brake.surface.unlike(DRUM)
    if unlike is not None:
        return unlike
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            return f"shoe {shoe.name!r}: a mesh of its own is a section without widths"
        nu = shoe.lining.material.nu_along_through
        if isinstance(shoe.lining.material, Material) and nu > LARGEST_CHECKED_NU:
            return f"shoe {shoe.name!r}: lining.material.nu = {nu:g}, the correction holds up to {LARGEST_CHECKED_NU:g}"
    return isotropic_only(brake, "the correction")


def said(brake: Brake, other: Brake) -> str:
    """What the correction has made of a brake, and how far it is to be trusted, in a line."""
    pairs = zip(brake.shoes, other.shoes, strict=True)
    factors = [
        after.lining.material.E_through / shoe.lining.material.E_through for shoe, after in pairs
    ]
    times = ", ".join(f"{factor:.3f}" for factor in dict.fromkeys(np.round(factors, 3)))
    return (
        f"corrected for the finite width: modulus of the lining times {times}; torque within "
        f"{formatted(TORQUE_DEVIATION, '.1%')}, p averaged over the width within "
        f"{formatted(PRESSURE_DEVIATION, '.0%')} (L2) of the solid shoes in the study plane_stress"
    )


def finite_width(brake: Brake) -> Brake:
    """The brake whose plane stress is corrected for the widths of its shoes, lining by lining.

    Raises BadInput where the correction does not apply.
    """
    reason = why_not(brake)
    if reason is not None:
        raise BadInput(f"--finite-width: does not apply to this brake: {reason}")
    return vary(
        brake,
        {
            f"shoe[{i}].lining.material.E": material.E
            for i, material in enumerate(map(corrected, brake.shoes))
        },
    )
