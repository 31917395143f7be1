"""The correction of plane stress for a lining of finite width, off by default.

Plane stress neglects two effects. A lining that is bonded to a stiff table cannot contract freely
across its width except near its sides: its Lame constant lies between the constants of plane stress
and plane strain. And a table that is wider than its web bends away from the lining like a
cantilever plate on an elastic foundation (Hetenyi 1946, Beams on Elastic Foundation): the sides of
the lining press less, and the whole lining is softer on average. The correction puts both effects
into the modulus of the lining.
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
"""Share of plane strain in a lining that is much wider than thick.

A share of 0 is plane stress, and 1 is plane strain. The value agrees with computations of solid
shoes, in which the shoe behind the lining contracts across its width as well.
"""
LARGEST_CHECKED_NU = 0.45
"""Largest Poisson's ratio of a lining for which the correction was compared with solid shoes.

The correction refuses linings with a larger ratio.
"""
TORQUE_DEVIATION = 0.015
"""Largest relative difference of the corrected torque from the torque of solid shoes.

It is the largest over all brakes of the study plane_stress. A note of the response states it.
"""
PRESSURE_DEVIATION = 0.08
"""Largest relative difference in L2 of the corrected pressure from that of solid shoes.

The pressure of the solid shoes is averaged over the width. The difference is the largest over all
brakes of the study plane_stress. A note of the response states it.
"""


def material_between_plane_states(material: Material, share: float) -> Material:
    """The material that is as stiff in plane stress as a lining between plane stress and strain.

    The share of plane strain, `share`, is 0 for plane stress and 1 for plane strain. Poisson's
    ratio nu stays. A lining that is held along the arc has the stiffness lambda + 2 mu through its
    thickness. The Lame constant lambda is interpolated between those of plane stress and plane
    strain. The modulus that has this stiffness in plane stress is E' = (lambda + 2 mu) (1 - nu^2).
    """
    E, nu = material.E, material.nu
    matrix = elasticity_matrix(material)
    plane_stress, mu = matrix[0, 1], matrix[2, 2]
    plane_strain = E * nu / ((1 + nu) * (1 - 2 * nu))
    through = plane_stress + share * (plane_strain - plane_stress) + 2 * mu
    return material.model_copy(update={"E": float(through * (1 - nu**2))})


def plane_strain_share_of_lining(width: float, thickness: float) -> float:
    """The share of plane strain in a lining; 0 if the lining is no wider than it is thick."""
    return PLANE_STRAIN_SHARE * max(0.0, 1 - thickness / width)


def mean_pressure_under_flange(reach: float, stiffness: float, foundation: float) -> float:
    """Mean pressure under a flange of a shoe's table, relative to the pressure under its web.

    The flange is a strip that is clamped to the web and free at its side. The lining is its elastic
    foundation. The pressure y of the lining, relative to that at the web, falls with the deflection
    of the strip, which is that of a cantilever on an elastic foundation:

        D y'''' + K y = 0,  y(0) = 1, y'(0) = 0, y''(c) = y'''(c) = 0.

    The mean of y over the reach c is -(D/(K c)) (y'''(c) - y'''(0)).

    Parameters
    ----------
    reach : distance c from the web to the side [m]
    stiffness : plate stiffness D of the strip [N m]
    foundation : stiffness K of the lining per area [Pa/m]
    """
    beta = (foundation / (4 * stiffness)) ** 0.25
    # Below this length the flange is rigid, and the linear system is singular to round-off.
    if beta * reach < 1e-3:
        return 1.0

    # The deflection is a sum of four exponentials. The growing ones are scaled to 1 at the free
    # end, so that no term overflows.
    roots = beta * np.array([1 + 1j, 1 - 1j, -1 + 1j, -1 - 1j])
    scale = np.exp(-np.maximum(roots.real, 0) * reach)
    at_end = scale * np.exp(roots * reach)
    moment_at_end = at_end * roots**2 / beta**2
    shear_at_end = at_end * roots**3 / beta**3
    # The four conditions fix the factors: deflection 1 and slope 0 at the web, no moment and no
    # shear force at the free end.
    conditions = np.array([scale, scale * roots, moment_at_end, shear_at_end])
    factors = np.linalg.solve(conditions, np.array([1.0, 0, 0, 0], dtype=complex))
    return float((factors @ ((at_end - scale) / roots)).real / reach)


def lining_material_for_width(shoe: Shoe) -> Material:
    """The material of a shoe's lining, with its modulus corrected for the widths of the shoe.

    The flanges of a shoe are the parts of its table on both sides of a narrower web. If the shoe
    has no table, its backing counts as the table.
    """
    lining = shoe.lining
    assert isinstance(lining.material, Material)  # why_not
    material = material_between_plane_states(
        lining.material, plane_strain_share_of_lining(lining.width, lining.thickness)
    )
    if not isinstance(shoe.body, Bar):
        return material
    web = shoe.body.plates["shoe"]
    table = shoe.body.plates.get("table", shoe.backing)
    if table is None or web.width >= lining.width:
        return material
    reach = (lining.width - web.width) / 2
    assert isinstance(table.material, Material)  # why_not
    plate_stiffness = table.material.E * table.thickness**3 / (12 * (1 - table.material.nu**2))
    # The lining is compressed through its thickness while the shoe holds it along the arc.
    modulus = material.E / (1 - material.nu**2)
    mean = mean_pressure_under_flange(reach, plate_stiffness, modulus / lining.thickness)
    bearing_share = (web.width + 2 * reach * mean) / lining.width
    return material.model_copy(update={"E": material.E * bearing_share})


def reason_why_not_corrected(brake: Brake) -> str | None:
    """Why the correction for finite widths does not apply to a brake; None if it applies."""
    unlike = brake.surface.unlike(DRUM)
    if unlike is not None:
        return unlike
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            return f"shoe {shoe.name!r}: a mesh of its own is a section without widths"
        material = shoe.lining.material
        nu = material.nu_along_through
        if isinstance(material, Material) and nu > LARGEST_CHECKED_NU:
            return (
                f"shoe {shoe.name!r}: lining.material.nu = {nu:g}, "
                f"the correction holds up to {LARGEST_CHECKED_NU:g}"
            )
    return isotropic_only(brake, "the correction")


def correction_note(brake: Brake, other: Brake) -> str:
    """The note of a response on the correction for finite widths, with its largest errors.

    The note states by what factors the moduli of the linings of `brake` were changed. `other` is
    the corrected brake.
    """
    factors = [
        after.lining.material.E_through / before.lining.material.E_through
        for before, after in zip(brake.shoes, other.shoes, strict=True)
    ]
    different = dict.fromkeys(np.round(factors, 3))
    times = ", ".join(f"{factor:.3f}" for factor in different)
    torque = formatted(TORQUE_DEVIATION, ".1%")
    pressure = formatted(PRESSURE_DEVIATION, ".0%")
    return (
        f"corrected for the finite width: modulus of the lining times {times}; torque within "
        f"{torque}, p averaged over the width within {pressure} (L2) of the solid "
        "shoes in the study plane_stress"
    )


def correct_for_finite_width(brake: Brake) -> Brake:
    """A copy of a brake in which the modulus of each lining is corrected for the shoe's widths.

    Raises
    ------
    BadInput
        if the correction does not apply to the brake
    """
    reason = reason_why_not_corrected(brake)
    if reason is not None:
        raise BadInput(f"--finite-width: does not apply to this brake: {reason}")
    moduli = {}
    for i, shoe in enumerate(brake.shoes):
        moduli[f"shoe[{i}].lining.material.E"] = lining_material_for_width(shoe).E
    return vary(brake, moduli)
