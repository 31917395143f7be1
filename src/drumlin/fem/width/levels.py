"""The levels of the section's hp elements for shoes whose parts have several widths."""

from dataclasses import replace
from itertools import pairwise

from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.division import RefinementLevel


def level_with_interface_layers_of_coarser_level(
    level: RefinementLevel, coarser: RefinementLevel
) -> RefinementLevel:
    """A level whose layers of elements at interfaces and hinges have the sizes of a coarser level.

    The degree, the columns under the contact, and the layer of elements at the lining's face stay
    those of `level`. Columns at hinges, at grips and at open ends of the lining, and the growth of
    the layers away from the face, are those of `coarser`.
    """
    return replace(
        level,
        interface_layer_size=coarser.interface_layer_size,
        hinge_column_size=coarser.hinge_column_size,
        layer_size_ratio=coarser.layer_size_ratio,
    )


REFINEMENT_LEVELS_OF_SHOES_WITH_SEVERAL_WIDTHS = (
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0],
    *(
        level_with_interface_layers_of_coarser_level(level, coarser)
        for coarser, level in pairwise(REFINEMENT_LEVELS_FROM_COARSE_TO_FINE)
    ),
)
"""The levels of shoes whose parts have several widths, from coarse to fine.

From the second level on, the layers of elements at the interfaces of two parts, and at hinges, have
the sizes of the level before. A layer has all functions of z at each of its rows of nodes, so that
it costs more than in plane stress. But p depends on the elements at interfaces mostly by the
compliance of the shoe. On 21 random brakes with degree 1 across the width ("built" 3100 to 3107,
"free" 2000, 2004, 2008 and 2012, and nine brakes that missed 1 %, of
`drumlin_studies.solid_error`) a column's side has 0.68 times as many unknowns on the second level
as with interface layers of its own size, and the level takes 0.46 times as long. The error of p is
1.31 times as large in the geometric mean (median 1.04), and 3.5 times in the worst case.

The first two levels have the same layers at interfaces, so that their distance does not show the
error due to these layers. Estimates from two levels therefore have larger safety factors than
estimates from three levels (`ladder.section_error_factors`).
"""
