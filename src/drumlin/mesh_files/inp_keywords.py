"""The Abaqus and CalculiX keywords that the reader of meshes refuses or ignores.

A keyword that moves nodes, makes nodes or elements, or changes the members of a group is either
read or refused. All other keywords are ignored. A note names an ignored keyword unless the keyword
is known to be harmless.
"""

from drumlin.mesh_files.inp_text import KeywordSectionOfDeck

REASON_TO_REFUSE_MESH_GENERATION = (
    "makes nodes or elements that do not stand in the file; write the mesh out in full"
)
"""Reason for refusing an Abaqus keyword that generates nodes or elements."""
REFUSED_ABAQUS_KEYWORDS = {
    "NGEN": REASON_TO_REFUSE_MESH_GENERATION,
    "NFILL": REASON_TO_REFUSE_MESH_GENERATION,
    "NCOPY": REASON_TO_REFUSE_MESH_GENERATION,
    "NMAP": "moves nodes; write the mesh out in full",
    "ELGEN": REASON_TO_REFUSE_MESH_GENERATION,
    "ELCOPY": REASON_TO_REFUSE_MESH_GENERATION,
    "IMPERFECTION": "moves nodes; write the mesh out as it is then",
    "SYMMETRIC MODEL GENERATION": REASON_TO_REFUSE_MESH_GENERATION,
    "PARAMETER": "puts values in place of names; write the values out",
    "MODEL CHANGE": "takes elements out of the model; write only those that are there",
    "CYCLIC SYMMETRY MODEL": "repeats the mesh; write the whole shoe",
    "MAP SOLUTION": "moves nodes; write the mesh out as it is then",
}
"""Abaqus keywords that change nodes, elements or groups and are refused, each with the reason.

The reason also tells what the user can do instead.
"""

IGNORED_ABAQUS_KEYWORDS = frozenset(
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
"""Abaqus keywords that the reader of meshes ignores without a note.

They are about materials, sections, loads, steps and output. They change neither coordinates nor
elements nor groups. The materials, supports and loads of a brake come from the brake's file.
*TRANSFORM turns the axes of loads and supports at nodes, and not the nodes.
"""


def refuse_or_note_ignored_section(section: KeywordSectionOfDeck, seen: dict[str, None]) -> None:
    """Refuse or ignore a section of an Abaqus deck whose keyword is not read.

    ValueError is raised for a keyword in `REFUSED_ABAQUS_KEYWORDS`. A keyword that is ignored and
    not in `IGNORED_ABAQUS_KEYWORDS` is added to `seen`, so that a note names it.
    """
    keyword = section.keyword
    if keyword in REFUSED_ABAQUS_KEYWORDS:
        raise ValueError(f"*{keyword} {REFUSED_ABAQUS_KEYWORDS[keyword]}")
    if keyword not in IGNORED_ABAQUS_KEYWORDS:
        seen[f"*{keyword}"] = None
