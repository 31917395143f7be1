"""Module-level numbers of fem, contact and response that were not found by trying: the reason of
each.

There are five kinds of reasons. A definition follows from a formula or a name. A format comes from
a file or a library. A limit bounds memory, time or repetitions; beyond the limit drumlin prints a
message and refuses the brake or stops early. A round-off bound lies far above the errors of double
precision and far below what a user sees. A threshold decides when a line of text is printed, and
changes no answer.
"""

DEFINITION, FORMAT = "definition", "format"
MEMORY, PASSES = "limit of memory or size", "limit of passes or steps"
ROUND_OFF, SAID = "round-off", "threshold of a warning or a refusal that names it"
JUDGED_MOVE = "judgement; what is moved, and by how much, is said with the answer"
SPEED = "size of pieces that stay near the processor"

NOT_TUNED: dict[str, dict[str, str]] = {
    "contact/active_set.py": {
        "MOST_PIVOT_STEPS": PASSES,
        "MOST_SET_CHANGES": PASSES,
        "GOLDEN_RATIO": DEFINITION,
        "SMALLEST_EXTRA_GAP": ROUND_OFF,
        "MOST_STEPS_WITHOUT_PROGRESS": PASSES,
        "COARSE_GUESS_FROM_NODES": SPEED,
        "MOST_CANDIDATE_SETS": MEMORY,
        "SET_ROUND_OFF": ROUND_OFF,
    },
    "contact/equations.py": {"BORDERED_ABOVE_UNKNOWNS": SPEED, "MOST_CONTACT_NODES": MEMORY},
    "contact/self_locking.py": {
        "LARGEST_SOUGHT_FRICTION": "limit of the search that is said",
        "POLE_DISTANCE": ROUND_OFF,
        "FRICTION_RESOLUTION": ROUND_OFF,
        "LARGEST_FRICTION_STEP": "first step of a search that adapts; a matter of time",
        "LARGEST_FORCE_GROWTH": "growth up to half of mu_lock, by its pole",
        "COARSE_PATH_ABOVE_NODES": SPEED,
        "LARGEST_DIFFERENCE_BETWEEN_MESHES": "any number between 0.004 and 0.7 tells two answers from two meshes",
    },
    "contact/pressure_friction.py": {
        "FRICTION_TOLERANCE": "accuracy that is stated",
        "MOST_STEPS_TO_FRICTION": PASSES,
        "SMALLEST_FRICTION_PART": PASSES,
    },
    "fem/equilibrium/pressure_friction.py": {"MOST_CHANGES_OF_SUPPORT": PASSES},
    "contact/stick_slip.py": {
        **dict.fromkeys(("OPEN", "STICK", "FORWARD", "BACKWARD"), "names of states"),
        "MOST_STATE_NEWTON_STEPS": PASSES,
        "MOST_STATE_CHANGES": PASSES,
        "STATE_ROUND_OFF": ROUND_OFF,
    },
    "fem/preparation/cache.py": {"CACHE_BYTES": MEMORY},
    "fem/preparation/meshes.py": {
        "MOST_LINING_ELEMENTS": MEMORY,
        "MOST_RAISED_NODES": MEMORY,
        "SHAPE_DEGREE": "degree above which no shape changes",
    },
    "fem/substructure/body.py": {"FRAME": DEFINITION},
    "fem/substructure/elimination.py": {"LEAF_NODES": SPEED},
    "fem/width/correction.py": {
        "REMAINING_SHARE": "measured error that is said",
    },
    "fem/width/error.py": {
        "COARSE_ENOUGH": "any number between 0.05 and 0.45 tells sections that miss the contact",
        "WIDTH_LEVEL": "level 0 of the rule that the levels of a solve follow",
        "WIDTH_DEGREE": "the least degree that varies in a part of one width",
    },
    "fem/analysis/solid_fields.py": {
        "FEWEST_STEPS": "points of fields that are written or drawn",
        "_TURNED": FORMAT,
    },
    "peers/hexahedra.py": {
        "HEXAHEDRA_ALONG_LINING": "default of an option: a minute of work",
        "SIDE_SIZE": "mesh of another program, which has no stated errors",
        **dict.fromkeys(("CORNERS", "_BOTTOM", "_CORNERS_IN_VTK_ORDER", "_EDGES"), FORMAT),
    },
    "fem/width/face.py": {"FACE_STEPS": "points of a face that is written or drawn"},
    "fem/width/functions.py": {
        "SAME_SIDE": ROUND_OFF,
        # Found by trial: other breaks need more functions for the same error, which is stated.
        **dict.fromkeys(
            ("BESIDE_WEB", "LEAST_OUTER_PIECE", "SHORT_OVERHANG", "LEAST_OVERHANG"),
            "found by trial, for the work of one solve; the errors that remain are stated",
        ),
    },
    "fem/width/integrals.py": {"SYMMETRIES": DEFINITION},
    "fem/width/ladder.py": {
        "LARGEST_STATED_DEGREE": DEFINITION,
        "LOOKED_AHEAD": "one even and one odd degree",
        "SECTION_DEGREE": "the least degree that varies across a lining beside its web",
        "SECTION_SHARE": "half of a tolerance for each of two parts of the error",
        "MOST_SECTION_LEVELS": "bound of the work of one solve; the errors that remain are stated",
        "LARGEST_SECTION": "bound of the work of one solve; the errors that remain are stated",
        "LARGEST_SOLID": MEMORY,
        "LARGEST_FIRST_PIECE": "half: most of a lining has all functions of each degree",
        "NEXT_DEGREE_FACTORS": "covers the brakes of an experiment that takes too long for a test",
        "LEAST_FALL": "bound of the work of one solve; the errors that remain are stated",
        "MOST_DEGREE": "bound of the work of one solve; the errors that remain are stated",
        "SLOWEST_FALL": "power for the strongest singularity at a corner",
    },
    "fem/width/prepare.py": {
        "LARGEST_WIDTH_NU": SAID,
        "LARGEST_WIDTH_DEGREE": SAID,
    },
    "fem/equilibrium/group.py": {
        "FRICTION_STEP": "a quarter of self_locking.LARGEST_FRICTION_STEP",
        "CHECK_DISTANCE_FROM_POLE": "last digit of a limit that is printed",
    },
    "fem/equilibrium/locking.py": {"NEAR_LAW": SAID, "FURTHEST_SEARCH": SAID},
    "fem/equilibrium/problems.py": {"ROWS_AT_A_TIME": SPEED},
    "fem/analysis/holding.py": {
        "FIRST_ROTATION": "start of a geometric search",
        "MOST_INCREMENTS": PASSES,
        "LARGEST_TORQUE_DIFFERENCE": SAID,
        "LARGEST_FRICTION_RATIO_DIFFERENCE": SAID,
    },
    "fem/analysis/prepared.py": {
        "ANALYSIS_DEGREE": "a degree whose measured error is said; more degrees take longer",
    },
    "fem/analysis/wide_moduli.py": {"MODULUS_STEP": "step whose error is said with the answer"},
    "fem/error_control/first_level.py": {"FIRST_LEVEL_FACTORS": DEFINITION},
    "fem/error_control/adapt.py": {
        "DEFAULT_TOLERANCE": "what a solve aims at, as README says",
    },
    "fem/hp/corner.py": {
        "SMALLEST_ROOT": "limit of a search",
        "ROOTS_TRIED": "steps of a search",
        "SMALLEST_PIECE": ROUND_OFF,
        "BOUNDED_EXPONENT": ROUND_OFF,
        "TIP_TOLERANCE": ROUND_OFF,
    },
    "fem/hp/division.py": {
        "SMALLEST_COLUMN": ROUND_OFF,
        "HALF_FORCE_PART": DEFINITION,
        "LONGEST_CORNER_CONTACT": DEFINITION,
    },
    "fem/error_control/singular_points.py": {
        "CONTACT_END_BITS": ROUND_OFF,
        "SHORTEST_KNOWN_CONTACT": SAID,
    },
    "fem/hp/element.py": {"SLOPES_PER_BATCH": SPEED},
    "fem/error_control/levels.py": {"DEG": DEFINITION, "LEVELS": DEFINITION, "MOST_PASSES": PASSES},
    "fem/hp/ring.py": {
        "FULL_TURN": DEFINITION,
        "SAME_ANGLE": ROUND_OFF,
    },
    "fem/substructure/ring.py": {
        "MOST_RAY_CROSSING_STEPS": PASSES,
        "LAST_RAY_CROSSING_STEP": ROUND_OFF,
    },
    "fem/mesh/abaqus.py": {
        "NODES_PER_CELL": FORMAT,
        "NUMBERS_PER_LINE": FORMAT,
    },
    "fem/mesh/check.py": dict.fromkeys(
        (
            "MOST_LISTED_NAMES",
            "LARGEST_ARC_DIFFERENCE",
            "SAME_POINT",
            "MOST_COINCIDENT",
            "LARGEST_REACH",
            "MIDDLE_NODE_OFFSET",
            "CONTACT_OFFSET",
            "CONTACT_DEPTH",
            "CONTACT_SLOPE",
            "JACOBIAN_RATIO",
        ),
        SAID,
    ),
    "fem/mesh/content.py": {"LARGEST_MESH": MEMORY, "MOST_NESTED": PASSES},
    "fem/mesh/contact_surface.py": dict.fromkeys(
        (
            "SIGNIFICANT",
            "COORDINATE_ROUND_OFF",
            "SMOOTHING_NODES",
            "STRAIGHT",
            "STRAIGHT_SIDES",
            "MOST_NOISE",
        ),
        JUDGED_MOVE,
    ),
    "fem/mesh/content_of_file.py": {"MOST_DECIMALS": FORMAT, "DIGIT_SLACK": ROUND_OFF},
    "fem/mesh/from_file.py": dict.fromkeys(
        ("ZIGZAG", "FEW_TURNS", "SMALLEST_REPORTED_MOVE", "NODES_PER_TURN", "MOST_TURNS"), SAID
    ),
    "fem/mesh/inp_deck.py": {"MOST_MEMBERS": MEMORY},
    "fem/mesh/inp_parts.py": {"IN_PLACE": DEFINITION},
    "fem/mesh/msh4.py": {"CELL_OF_GMSH": FORMAT},
    "fem/mesh/of_meshio.py": {"MOST_VALUES": MEMORY},
    "fem/mesh/plane_cells.py": {
        "ALONG_CIRCLE": "judgement; edges along circles and all others are far from it",
        "PLANE_SHAPES": FORMAT,
        "CUBIC_MIDDLE": DEFINITION,
        "FLAT_CORNER": "judgement; other corners that bend inwards are refused as inverted",
    },
    "fem/mesh/degree.py": {
        **dict.fromkeys(
            ("TRIANGLE_CORNERS", "SQUARE_CORNERS", "TRIANGLE_SIDES", "SQUARE_SIDES"), DEFINITION
        ),
        "STRAIGHT_TRIANGLE": "round-off; a smaller one takes longer for the same stiffness",
    },
    "fem/error_control/changed_shape.py": {
        "STEP": "judgement; steps from 1e-5 to 1e-2 give the same changes to four percent",
    },
    "fem/mesh/smooth_outline.py": {
        "LARGEST_SMOOTH_TURN": "judgement; larger ones make stated errors larger where corners are",
        "CONVEX_ANGLE": "judgement; slightly re-entrant corners change nothing that is seen",
    },
    "fem/error_control/degrees.py": {
        "FORCE_FACTOR": "judgement; a larger one makes stated errors of forces larger",
        "CANCELLED_FORCE_FACTOR": "judgement; a larger one makes stated errors of forces larger",
        "MESH_LEVELS": "larger elements at singular points take a level more for the same errors",
        "FINE_MESH_LEVELS": "larger elements at singular points take a level more for the same errors",
        "FINE_MESH": "judgement; a smaller one takes a level more for the same errors on coarse meshes",
        "NEGLIGIBLE_SHARE": "judgement; a smaller one takes a level more for the same errors",
        "NEGLIGIBLE_MOVE": "judgement; saves time where the sides' error is below all others",
    },
    "fem/mesh/splitting.py": {
        "SIDE_PER_DISTANCE": "judgement; a smaller one makes more triangles",
        "ROUND_OFF_OF_LENGTHS": ROUND_OFF,
    },
    "fem/mesh/file.py": {
        "LONGEST_REASON": "length of a message",
        "MOST_FILE_NODES": MEMORY,
        "LARGEST_NUMBER": MEMORY,
        "METRES_PER_UNIT": FORMAT,
    },
    "fem/mesh/arc.py": {"FACE_SLACK": ROUND_OFF, "MESH_KINDS": DEFINITION},
    "fem/mesh/beam.py": {"BEAM_SLACK": ROUND_OFF},
    "fem/mesh/grading.py": {
        "MOST_OVERHANG_ELEMENTS": MEMORY,
        "MOST_QUADRATIC_LAYERS": MEMORY,
        "MOST_LINEAR_LAYERS": MEMORY,
    },
    "fem/mesh/vtu.py": {"MOST_UNPACKED": MEMORY, "MOST_ARRAYS": MEMORY, "_HEADER_WIDTHS": FORMAT},
    "fem/equilibrium/springs.py": {
        "SETTLED_PULL": ROUND_OFF,
        "MOST_SPRING_STEPS": PASSES,
    },
    "fem/model.py": {
        "DOUBLE_SPACING": DEFINITION,
        "LARGEST_SILENT_OVERLAP": SAID,
        "PENALTY": "default of an option, whose effect each response states",
        "LARGEST_ANSWER_IMBALANCE": SAID,
        "LARGEST_UNREFINED_ROUND_OFF": SAID,
        "LARGEST_REFINED_ROUND_OFF": SAID,
        "LARGEST_REFINED_SYSTEM": "limit of time: seconds of a refinement",
        "LARGEST_CONVERGED_CORRECTION": ROUND_OFF,
    },
    "fem/analysis/moving.py": {
        "NODE_STEP": ROUND_OFF,
        "LARGEST_NODE_MOTION": "tells another division from a moved one",
        "LARGEST_UNMOVED_MOTION": ROUND_OFF,
    },
    "fem/analysis/mutual_work.py": {"ELEMENTS_AT_A_TIME": MEMORY},
    "fem/equilibrium/reach.py": {"LARGEST_TURN_TO_TOUCH": SAID},
    "fem/error_control/refinement.py": {
        "MOST_CORRECTIONS": PASSES,
        "CONVERGED_CORRECTION": ROUND_OFF,
        "SLOWEST_CONVERGENCE": "factor by which corrections that converge shrink",
        "MOST_REFINED_SETS": PASSES,
    },
    "fem/analysis/sensitivity.py": {"PERCENT_PER_MM": DEFINITION},
    "fem/equilibrium/sharing.py": {"LARGEST_FORCE_THAT_DOES_NOT_PUSH": ROUND_OFF},
    "fem/solid.py": {"DEFAULT_SOLID_TOLERANCE": "default of an option that is said"},
    "fem/solve.py": {"REPORTED_IMBALANCE": SAID},
    "response/limits.py": {"LARGE_STRAIN": SAID, "LARGEST_STRAIN": SAID},
    "response/response.py": {
        "EDGE_ZONE": DEFINITION,
        "CURVE_SPACING": "points of a picture or a table",
        "SMALLEST_CURVE_PIECE": ROUND_OFF,
        "NEITHER": ROUND_OFF,
        "NO_CHANGE": DEFINITION,
        "NO_FORCE": ROUND_OFF,
    },
    "response/resultants.py": {
        "GAUSS": DEFINITION,
        "WEIGHTS": DEFINITION,
        "PEAK_SAMPLES": DEFINITION,
        "JUMP": ROUND_OFF,
    },
    "response/self_locking.py": {"WARNED_SHARE": SAID},
    "response/show.py": {
        "POINTS_PER_PIECE": "points of a small picture",
        "TOP_OVER_PEAK": "room above the curves of a picture",
    },
}
