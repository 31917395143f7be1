"""The Abaqus and CalculiX keywords that a mesh reader refuses by name or passes over.

A keyword that moves nodes, makes nodes or elements, or changes what a group holds is read or
refused. A keyword that is on no list here is passed over, and a note names it.
"""

from drumlin.fem.mesh.inp_text import InputSection

MAKES_MESH = "makes nodes or elements that do not stand in the file; write the mesh out in full"
REFUSED = {
    "NGEN": MAKES_MESH,
    "NFILL": MAKES_MESH,
    "NCOPY": MAKES_MESH,
    "NMAP": "moves nodes; write the mesh out in full",
    "ELGEN": MAKES_MESH,
    "ELCOPY": MAKES_MESH,
    "IMPERFECTION": "moves nodes; write the mesh out as it is then",
    "SYMMETRIC MODEL GENERATION": MAKES_MESH,
    "PARAMETER": "puts values in place of names; write the values out",
    "MODEL CHANGE": "takes elements out of the model; write only those that are there",
    "CYCLIC SYMMETRY MODEL": "repeats the mesh; write the whole shoe",
    "MAP SOLUTION": "moves nodes; write the mesh out as it is then",
}
"""Keywords that change nodes, elements or groups and are refused, with what to do instead."""

HARMLESS = frozenset(
    """|HEADING|PREPRINT|RESTART|STEP|END STEP|STATIC|DYNAMIC|VISCO|FREQUENCY|BUCKLE|MATERIAL
    |ELASTIC|DENSITY|EXPANSION|PLASTIC|CONDUCTIVITY|SPECIFIC HEAT|HYPERELASTIC
    |DAMPING|FRICTION|DEPVAR
    |USER MATERIAL|SOLID SECTION|SHELL SECTION|SHELL GENERAL SECTION|MEMBRANE SECTION|BEAM SECTION
    |BEAM GENERAL SECTION|CONNECTOR SECTION|CONNECTOR BEHAVIOR|CONNECTOR ELASTICITY|SPRING|DASHPOT
    |MASS|ROTARY INERTIA|GAP|ORIENTATION|DISTRIBUTION|DISTRIBUTION TABLE|AMPLITUDE|TIME POINTS
    |BOUNDARY|CLOAD|DLOAD|DSLOAD|CFLUX|DFLUX|FILM|RADIATE|TEMPERATURE|FIELD|INITIAL CONDITIONS
    |PHYSICAL CONSTANTS|TRANSFORM|SURFACE INTERACTION|SURFACE BEHAVIOR|CONTACT|CONTACT PAIR
    |CONTACT CONTROLS|CONTACT INCLUSIONS|CONTACT EXCLUSIONS|CONTACT PROPERTY ASSIGNMENT
    |CONTACT FORMULATION|CONTACT OUTPUT|CONTACT PRINT|CONTACT FILE|CHANGE FRICTION|CLEARANCE
    |OUTPUT|NODE OUTPUT|ELEMENT OUTPUT|ENERGY OUTPUT|NODE PRINT|NODE FILE|EL PRINT|EL FILE
    |SECTION PRINT|ENERGY PRINT|ENERGY FILE|MONITOR|FILE FORMAT|PRINT|CONTROLS|SOLUTION TECHNIQUE
    |SECTION CONTROLS|HOURGLASS STIFFNESS|NO ANALYSIS|PRE-TENSION SECTION|FILTER|INTEGRATED OUTPUT
    |INTEGRATED OUTPUT SECTION|SURFACE PROPERTY|DAMAGE INITIATION|NODAL THICKNESS""".replace(
        "\n    ", ""
    ).split("|")
)
"""Keywords of materials, sections, loads, steps and output. They change neither coordinates nor
elements nor groups: materials, supports and loads of a brake stand in the brake's file. *TRANSFORM
turns the axes of loads and supports at nodes, and not the nodes."""


def pass_over_section(section: InputSection, seen: dict[str, None]) -> None:
    """Refuse a section that cannot be passed over, and add one that a note must name to `seen`.

    Raises ValueError, with what to do instead.
    """
    keyword = section.keyword
    if keyword in REFUSED:
        raise ValueError(f"*{keyword} {REFUSED[keyword]}")
    if keyword not in HARMLESS:
        seen[f"*{keyword}"] = None
