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
        "TEST_DISTANCE_BELOW_SINGULAR_FRICTION": ROUND_OFF,
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
        "MOST_NODES_AT_RAISED_DEGREE": MEMORY,
        "DEGREE_OF_ELEMENT_GEOMETRY": "degree above which no shape changes",
    },
    "fem/substructure/body.py": {"NUMBER_OF_FRAME_DISPLACEMENTS": DEFINITION},
    "fem/substructure/elimination.py": {"LEAF_NODES": SPEED},
    "fem/width/correction.py": {
        "REMAINING_ERROR_OVER_WIDTH_CORRECTION": "measured error that is said",
    },
    "fem/width/error.py": {
        "LARGEST_PRESSURE_ERROR_OF_COARSE_ELEMENTS": "any number between 0.05 and 0.45 tells sections that miss the contact",
        "LEVEL_OF_PLANE_STRESS_ERROR_ESTIMATE": "level 0 of the rule that the levels of a solve follow",
        "WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS": "the least degree that varies in a part of one width",
    },
    "fem/analysis/solid_fields.py": {
        "FEWEST_INTERVALS_ACROSS_WIDTH_PIECE": "points of fields that are written or drawn",
        "_NODE_ORDER_OF_TURNED_HEXAHEDRON": FORMAT,
    },
    "peers/hexahedra.py": {
        "DEFAULT_HEXAHEDRA_ALONG_LINING": "default of an option: a minute of work",
        "RELATIVE_SIZE_OF_FREE_SIDE_ELEMENT": "mesh of another program, which has no stated errors",
        **dict.fromkeys(
            (
                "HEXAHEDRON_CORNERS",
                "_BOTTOM_CORNERS_IN_VTK_ORDER",
                "_CORNERS_IN_VTK_ORDER",
                "_EDGE_CORNERS_IN_VTK_ORDER",
            ),
            FORMAT,
        ),
    },
    "fem/width/face.py": {
        "WRITTEN_INTERVALS_PER_WIDTH_PIECE": "points of a face that is written or drawn"
    },
    "fem/width/functions.py": {
        "SAME_HALF_WIDTH_TOLERANCE": ROUND_OFF,
        # Found by trial: other breaks need more functions for the same error, which is stated.
        **dict.fromkeys(
            (
                "BREAK_DISTANCES_BESIDE_WEB",
                "LEAST_LENGTH_BETWEEN_BREAK_AND_SIDE",
                "BREAK_POSITION_IN_SHORT_OVERHANG",
                "LARGEST_OVERHANG_WITHOUT_BREAK",
            ),
            "found by trial, for the work of one solve; the errors that remain are stated",
        ),
    },
    "fem/width/integrals.py": {"SYMMETRIC_AND_ANTISYMMETRIC": DEFINITION},
    "fem/width/ladder.py": {
        "LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR": DEFINITION,
        "NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES": "one even and one odd degree",
        "WIDTH_DEGREE_OF_SECTION_ESTIMATE": "the least degree that varies across a lining beside its web",
        "SECTION_SHARE_OF_TOLERANCE": "half of a tolerance for each of two parts of the error",
        "MOST_SECTION_LEVELS": "bound of the work of one solve; the errors that remain are stated",
        "MOST_UNKNOWNS_FOR_FURTHER_SECTION_LEVEL": "bound of the work of one solve; the errors that remain are stated",
        "LARGEST_SOLID": MEMORY,
        "LARGEST_FIRST_PIECE": "half: most of a lining has all functions of each degree",
        "NEXT_DEGREE_FACTORS": "covers the brakes of an experiment that takes too long for a test",
        "LEAST_FALL": "bound of the work of one solve; the errors that remain are stated",
        "LARGEST_DEGREE_IF_TOLERANCE_MAY_BE_MISSED": "bound of the work of one solve; the errors that remain are stated",
        "ASSUMED_WIDTH_ERROR_EXPONENT": "power for the strongest singularity at a corner",
    },
    "fem/width/prepare.py": {
        "LARGEST_POISSON_RATIO_OF_WIDTH_MODEL": SAID,
        "LARGEST_WIDTH_DEGREE": SAID,
    },
    "fem/equilibrium/group.py": {
        "LARGEST_FRICTION_STEP_BETWEEN_CHECKS": "a quarter of self_locking.LARGEST_FRICTION_STEP",
        "LAST_CHECK_DISTANCE_BELOW_LOCKING": "last digit of a limit that is printed",
    },
    "fem/equilibrium/locking.py": {
        "FRICTION_NEAR_RIGID_LAW_LIMIT": SAID,
        "LARGEST_SOUGHT_FRICTION_RATIO": SAID,
    },
    "fem/equilibrium/problems.py": {"ROWS_AT_A_TIME": SPEED},
    "fem/analysis/holding.py": {
        "FIRST_ROTATION_OF_FULL_SLIP_SEARCH": "start of a geometric search",
        "MOST_INCREMENTS_OF_FULL_SLIP_SEARCH": PASSES,
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
        "SMALLEST_SOUGHT_EXPONENT_ROOT": "limit of a search",
        "ROOTS_TRIED": "steps of a search",
        "LENGTH_OF_PRESSURE_PIECE_AT_CORNER": ROUND_OFF,
        "BOUNDED_EXPONENT": ROUND_OFF,
        "TOLERANCE_OF_COLUMN_END_AT_GAP_KINK": ROUND_OFF,
    },
    "fem/hp/division.py": {
        "SMALLEST_COLUMN": ROUND_OFF,
        "HALF_FORCE_FRACTION_OF_CONTACT": DEFINITION,
        "LONGEST_CONTACT_WITH_CORNER_COLUMNS": DEFINITION,
    },
    "fem/error_control/singular_points.py": {
        "CONTACT_END_BITS": ROUND_OFF,
        "SHORTEST_KNOWN_CONTACT": SAID,
    },
    "fem/hp/element.py": {"SHAPE_FUNCTION_SLOPES_PER_BATCH": SPEED},
    "fem/error_control/levels.py": {"DEG": DEFINITION, "LEVELS": DEFINITION, "MOST_PASSES": PASSES},
    "fem/hp/ring.py": {
        "FULL_TURN_IN_RADIANS": DEFINITION,
        "SAME_ANGLE": ROUND_OFF,
    },
    "fem/substructure/ring.py": {
        "MOST_RAY_CROSSING_STEPS": PASSES,
        "RAY_CROSSING_STEP_TOLERANCE": ROUND_OFF,
    },
    "fem/mesh/abaqus.py": {
        "NODES_PER_CELL": FORMAT,
        "LABELS_PER_LINE_OF_SET": FORMAT,
    },
    "fem/mesh/check.py": dict.fromkeys(
        (
            "MOST_LISTED_NAMES",
            "LARGEST_LINING_END_DIFFERENCE",
            "SAME_POINT",
            "MOST_COUNTED_COINCIDENT_NODES",
            "LARGEST_RELATIVE_MESH_COORDINATE",
            "LARGEST_RELATIVE_MIDDLE_NODE_OFFSET",
            "LARGEST_DISTANCE_OF_CONTACT_FROM_DRUM",
            "LARGEST_OVERLAP_OF_CONTACT_WITH_DRUM",
            "LARGEST_SLOPE_OF_CONTACT_AGAINST_DRUM",
            "SMALLEST_JACOBIAN_RATIO",
        ),
        SAID,
    ),
    "fem/mesh/content.py": {"LARGEST_MESH_FILE_SIZE": MEMORY, "LARGEST_INCLUDE_DEPTH": PASSES},
    "fem/mesh/contact_surface.py": dict.fromkeys(
        (
            "LINING_SHAPE_OFFSET_IN_STANDARD_ERRORS",
            "NODE_ON_DRUM_TOLERANCE",
            "SMOOTHING_NODES_ON_EACH_SIDE",
            "STRAIGHT_EDGE_TOLERANCE",
            "LEAST_STRAIGHT_EDGE_FRACTION",
            "LARGEST_SCATTER_OVER_ROUNDING_SCATTER",
        ),
        JUDGED_MOVE,
    ),
    "fem/mesh/content_of_file.py": {
        "DIGITS_OF_EXACT_COORDINATE": FORMAT,
        "ROUND_DECIMAL_TOLERANCE": ROUND_OFF,
    },
    "fem/mesh/from_file.py": dict.fromkeys(
        (
            "WAVE_HEIGHT_THAT_COUNTS_AS_ZIGZAG",
            "MOST_RISE_FALL_CHANGES_ON_ANY_MESH",
            "SMALLEST_REPORTED_MOVE",
            "FEWEST_NODES_PER_RISE_FALL_CHANGE",
            "MOST_RISE_FALL_CHANGES_OF_LINING_FACE",
        ),
        SAID,
    ),
    "fem/mesh/inp_deck.py": {"MOST_SET_MEMBERS": MEMORY},
    "fem/mesh/inp_parts.py": {"IDENTITY_PLACEMENT": DEFINITION},
    "fem/mesh/msh4.py": {"CELL_NAME_AND_NODE_COUNT_OF_GMSH_TYPE": FORMAT},
    "fem/mesh/of_meshio.py": {"MOST_GROUP_NUMBERS_IN_ARRAY": MEMORY},
    "fem/mesh/plane_cells.py": {
        "CIRCULAR_EDGE_RADIUS_TOLERANCE": "judgement; edges along circles and all others are far from it",
        "CORNERS_PER_PLANE_CELL": FORMAT,
        "CUBIC_EDGE_MIDDLE_WEIGHTS": DEFINITION,
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
        "LARGEST_NONSINGULAR_CORNER_ANGLE": "judgement; slightly re-entrant corners change nothing that is seen",
    },
    "fem/error_control/degrees.py": {
        "MESH_FILE_FORCE_FACTOR": "judgement; a larger one makes stated errors of forces larger",
        "MESH_FILE_CANCELLED_FORCE_FACTOR": "judgement; a larger one makes stated errors of forces larger",
        "MESH_LEVELS": "larger elements at singular points take a level more for the same errors",
        "FINE_MESH_LEVELS": "larger elements at singular points take a level more for the same errors",
        "LEAST_VERTICES_OF_FINE_MESH": "judgement; a smaller one takes a level more for the same errors on coarse meshes",
        "NEGLIGIBLE_SHARE_OF_LEVEL_ERROR": "judgement; a smaller one takes a level more for the same errors",
        "NEGLIGIBLE_DISTANCE_OF_SIDE_FROM_ARC": "judgement; saves time where the sides' error is below all others",
    },
    "fem/mesh/splitting.py": {
        "LARGEST_SIDE_OVER_SINGULAR_POINT_DISTANCE": "judgement; a smaller one makes more triangles",
        "ROUND_OFF_OF_LENGTHS": ROUND_OFF,
    },
    "fem/mesh/file.py": {
        "LONGEST_REPEATED_MESHIO_MESSAGE": "length of a message",
        "MOST_FILE_NODES": MEMORY,
        "LARGEST_NODE_NUMBER_IN_FILE": MEMORY,
        "METRES_PER_UNIT": FORMAT,
    },
    "fem/mesh/arc.py": {"EDGE_ON_ARC_FACE_TOLERANCE": ROUND_OFF, "MESH_KINDS": DEFINITION},
    "fem/mesh/beam.py": {"EDGE_ON_BEAM_SHOE_FACE_TOLERANCE": ROUND_OFF},
    "fem/mesh/grading.py": {
        "MOST_OVERHANG_ELEMENTS": MEMORY,
        "MOST_QUADRATIC_LAYERS": MEMORY,
        "MOST_LINEAR_LAYERS": MEMORY,
    },
    "fem/mesh/vtu.py": {
        "LARGEST_UNPACKED_VTU_SIZE": MEMORY,
        "MOST_VTU_ARRAYS": MEMORY,
        "_BYTES_OF_VTU_HEADER_INTEGER": FORMAT,
    },
    "fem/equilibrium/springs.py": {
        "TOLERANCE_OF_SPRING_PULLS": ROUND_OFF,
        "MOST_SPRING_STEPS": PASSES,
    },
    "fem/model.py": {
        "RELATIVE_SPACING_OF_DOUBLES": DEFINITION,
        "LARGEST_SILENT_OVERLAP": SAID,
        "DEFAULT_PENALTY_FACTOR": "default of an option, whose effect each response states",
        "LARGEST_ANSWER_IMBALANCE": SAID,
        "LARGEST_UNREFINED_ROUND_OFF": SAID,
        "LARGEST_ACCEPTED_PRESSURE_ROUND_OFF": SAID,
        "LARGEST_REFINED_SYSTEM": "limit of time: seconds of a refinement",
        "LARGEST_CORRECTION_OF_CONVERGED_REFINEMENT": ROUND_OFF,
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
    "fem/solve.py": {"REPORTED_PRESSURE_CURVE_IMBALANCE": SAID},
    "response/limits.py": {
        "LARGEST_SILENT_LINING_STRAIN": SAID,
        "LARGEST_ACCEPTED_LINING_STRAIN": SAID,
    },
    "response/response.py": {
        "UNCOMPARED_EDGE_ZONE": DEFINITION,
        "LARGEST_CURVE_STEP": "points of a picture or a table",
        "SHORTEST_CURVE_PIECE_AT_LINING_END": ROUND_OFF,
        "LARGEST_NEUTRAL_FRICTION_WORK_RATIO": ROUND_OFF,
        "ZERO_SHOE_CHANGES": DEFINITION,
        "NEGLIGIBLE_REACTION_OVER_NORMAL_FORCE": ROUND_OFF,
    },
    "response/resultants.py": {
        "GAUSS": DEFINITION,
        "WEIGHTS": DEFINITION,
        "PEAK_SAMPLE_POINTS": DEFINITION,
        "PRESSURE_DROP_LENGTH_AT_SLOT": ROUND_OFF,
    },
    "response/self_locking.py": {"WARNED_FRACTION_OF_LOCKING_FRICTION": SAID},
    "response/show.py": {
        "POINTS_PER_PIECE": "points of a small picture",
        "TOP_OVER_PEAK": "room above the curves of a picture",
    },
}
