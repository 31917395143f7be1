"""Module-level numbers of fem, contact, response and mesh_files that were not found by trying: the
reason of each.

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
        "MAX_STEPS_OF_ACTIVE_SET_METHOD": PASSES,
        "MAX_CONTACT_SET_CHANGES_PER_NODE": PASSES,
        "INVERSE_GOLDEN_RATIO": DEFINITION,
        "SMALLEST_ADDED_GAP_OVER_LARGEST_GAP": ROUND_OFF,
        "MAX_ACTIVE_SET_STEPS_WITHOUT_PROGRESS": PASSES,
        "FEWEST_NODES_FOR_COARSE_CONTACT_GUESS": SPEED,
        "MAX_CANDIDATE_SETS_OF_FIRST_TOUCHING_NODES": MEMORY,
        "LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP": ROUND_OFF,
    },
    "contact/equations.py": {
        "UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED": SPEED,
        "MAX_NODES_OF_CONTACT_PROBLEM": MEMORY,
    },
    "contact/self_locking.py": {
        "LARGEST_SOUGHT_SELF_LOCKING_FRICTION": "limit of the search that is said",
        "TEST_DISTANCE_BELOW_SINGULAR_FRICTION": ROUND_OFF,
        "RELATIVE_RESOLUTION_OF_FRICTION_LIMIT": ROUND_OFF,
        "LARGEST_STEP_OF_GROWING_FRICTION": "first step of a search that adapts; a matter of time",
        "LARGEST_CONTACT_FORCE_GROWTH_PER_STEP": "growth up to half of mu_lock, by its pole",
        "NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE": SPEED,
        "DISTANCE_OF_PRESSURE_COMPARISON": "distance at which a pole doubles the pressure",
        "LEAST_GROWTH_OF_UNBOUNDED_PRESSURE": "midway between a growth of 1 and of 2",
        "LARGEST_ROUND_OFF_BETWEEN_EQUAL_PROBLEMS": ROUND_OFF,
        "LARGEST_PRESSURE_DIFFERENCE_OF_SAME_SOLUTION": "any number between 0.004 and 0.7 "
        "tells two answers from two meshes",
    },
    "contact/pressure_friction.py": {
        "NEWTON_TOLERANCE_OF_CONTACT_PRESSURES": "accuracy that is stated",
        "LARGEST_ROUND_OFF_OF_CONTACT_PRESSURES": ROUND_OFF,
        "MAX_NEWTON_STEPS_PER_FRICTION_CHANGE": PASSES,
        "SMALLEST_ADDED_PART_OF_PRESSURE_DEPENDENCE": PASSES,
    },
    "fem/equilibrium/pressure_friction.py": {"MAX_REPEATED_SOLVES_WITH_CHANGED_SUPPORTS": PASSES},
    "contact/stick_slip.py": {
        **dict.fromkeys(("OPEN", "STICK", "FORWARD", "BACKWARD"), "names of states"),
        "MAX_NEWTON_STEPS_FOR_STICK_SLIP_STATES": PASSES,
        "MAX_STICK_SLIP_CHANGES_PER_NODE": PASSES,
        "ROUND_OFF_OF_STICK_SLIP_CONDITIONS": ROUND_OFF,
        "LARGEST_FACTOR_OF_RAISED_FRICTION": PASSES,
        "FIRST_RATIO_OF_RAISED_FRICTION_FACTORS": "step of a search that adapts",
        "SMALLEST_RATIO_OF_RAISED_FRICTION_FACTORS": PASSES,
    },
    "fem/preparation/cache.py": {"MOST_BYTES_OF_CACHED_BODIES": MEMORY},
    "fem/preparation/meshes.py": {
        "MOST_ELEMENTS_ALONG_LINING": MEMORY,
        "MOST_NODES_AT_RAISED_DEGREE": MEMORY,
        "MOST_NODES_WITHOUT_KEPT_FACTORS": MEMORY,
        "DEGREE_OF_SPLIT_ELEMENT_GEOMETRY": "degree above which no shape changes",
    },
    "fem/substructure/body.py": {
        "DEGREES_OF_FREEDOM_OF_BODY_FRAME": DEFINITION,
        "COLUMNS_MULTIPLIED_TOGETHER": SPEED,
    },
    "fem/substructure/elimination.py": {"NODES_OF_SMALLEST_DISSECTION_REGION": SPEED},
    "fem/width/correction.py": {
        "REMAINING_ERROR_OVER_WIDTH_CORRECTION": "measured error that is said",
    },
    "fem/width/error.py": {
        "LARGEST_PRESSURE_ERROR_OF_COARSE_ELEMENTS": "any number between 0.05 and 0.45 tells "
        "sections that miss the contact",
        "LEVEL_OF_PLANE_STRESS_ERROR_ESTIMATE": "level 0 of the rule that the levels of a "
        "solve follow",
        "WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS": "the least degree that varies in a part "
        "of one width",
    },
    "fem/analysis/self_locking.py": {
        "FRICTION_AT_WHICH_RIGHT_ANGLED_CORNER_LOCKS": DEFINITION,
        "SMALLEST_FIRST_FRICTION_OF_REPEATED_SOLVES": "time of a search in friction",
        "FRICTION_STEP_OF_REPEATED_SOLVES": "step of a search whose first failure is bisected",
        "RESOLUTION_OF_REPEATED_SOLVES": "accuracy of a limit that is printed with four digits",
    },
    "fem/analysis/solid_fields.py": {
        "FEWEST_INTERVALS_ACROSS_WIDTH_PIECE": "points of fields that are written or drawn",
        "_NODE_ORDER_OF_TURNED_HEXAHEDRON": FORMAT,
    },
    "peers/hexahedra.py": {
        "DEFAULT_HEXAHEDRA_ALONG_LINING": "default of an option: a minute of work",
        "SIZE_OF_FREE_SIDE_ELEMENT_OVER_MIDDLE_ELEMENT": "mesh of another program, which has no stated errors",
        **dict.fromkeys(
            (
                "SECTION_CORNERS_AND_Z_ENDS_OF_HEXAHEDRON",
                "_BOTTOM_CORNERS_IN_VTK_ORDER",
                "_CORNERS_IN_VTK_ORDER",
                "_EDGE_CORNERS_IN_VTK_ORDER",
            ),
            FORMAT,
        ),
    },
    "fem/width/columns.py": {
        "MOST_CONDENSATION_PLANS": MEMORY,
        "LARGEST_COUPLING_ELIMINATED_AT_ONCE": SPEED,
    },
    "fem/width/face.py": {
        "WRITTEN_PRESSURE_INTERVALS_PER_WIDTH_PIECE": "points of a face that is written or drawn"
    },
    "fem/width/functions.py": {"SAME_HALF_WIDTH_TOLERANCE": ROUND_OFF},
    "fem/width/integrals.py": {"SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS": DEFINITION},
    "fem/width/ladder.py": {
        "LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR": DEFINITION,
        "NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES": "one even and one odd degree",
        "WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE": "the least degree that varies across a "
        "lining beside its web",
        "SECTION_ERROR_SHARE_OF_TOLERANCE": "half of a tolerance for each of two parts of "
        "the error",
        "MOST_LEVELS_FOR_SECTION_ERROR_ESTIMATE": "bound of the work of one solve; the "
        "errors that remain are stated",
        "LEAST_LEVELS_FOR_SECTION_ERROR_ESTIMATE": DEFINITION,
        "MOST_UNKNOWNS_FOR_FURTHER_SECTION_LEVEL": "bound of the work of one solve; the "
        "errors that remain are stated",
        "MOST_BYTES_OF_SOLID": MEMORY,
        "MOST_BYTES_OF_KEPT_MODEL": MEMORY,
        "LARGEST_FIRST_PIECE": "half: most of a lining has all functions of each degree",
        "NEXT_DEGREE_FACTORS": "covers the brakes of an experiment that takes too long for a test",
        "LEAST_FALL": "bound of the work of one solve; the errors that remain are stated",
        "WIDTH_ERROR_SHARE_OF_TOLERANCE": DEFINITION,
        "NUMBER_OF_COMPARED_STEPS": "one step with another degree and one with other pieces",
        "ASSUMED_FALL_OF_ERROR_IN_TWO_STEPS": "the fitted factors change with it, and stated "
        "errors stay",
        "MOST_FUNCTIONS_WITHOUT_FALL": "bound of the work of one solve; the errors that remain "
        "are stated",
        "ASSUMED_WIDTH_ERROR_EXPONENT": "power for the strongest singularity at a corner",
    },
    "fem/width/levels.py": {
        "REFINEMENT_LEVELS_OF_SHOES_WITH_SEVERAL_WIDTHS": "the levels of plane stress, with "
        "interface layers of the level before",
    },
    "fem/width/open_columns.py": {
        "LEAST_DISTANCE_OF_OPEN_COLUMN_FROM_CONTACT": "changes no answer, since contact near an "
        "open column is seen",
        "LARGEST_ROUND_OFF_OF_ANGLE": ROUND_OFF,
    },
    "fem/width/pieces.py": {
        "DEGREES_ON_EQUAL_PIECES": "the lowest two degrees that show the error of plane stress",
        "PLACE_OF_CUT_IN_FIRST_PIECE": "more or less work for the same error, which is stated",
        "PLACE_OF_CUT_IN_OTHER_PIECES": "the middle",
        "LEAST_DIFFERENCE_OF_SPLIT_PIECE": "more or less work for the same error, which is stated",
        "WIDEST_FIRST_PIECE_WITHOUT_CUT": "the length over which the pressure changes at an edge",
    },
    "fem/width/prepare.py": {
        "MOST_NODES_OF_CONTACT_FACE": MEMORY,
        "MATRICES_OF_CONTACT_NODES_WITHOUT_FRICTION": MEMORY,
        "MATRICES_OF_CONTACT_NODES_WITH_FRICTION": MEMORY,
        "MOST_BYTES_OF_KEPT_CHOLESKY_FACTOR": MEMORY,
        "LARGEST_POISSON_RATIO_OF_WIDTH_MODEL": SAID,
        "LARGEST_WIDTH_DEGREE": SAID,
    },
    "fem/width/shoe.py": {
        "MOST_BYTES_OF_COLUMNS_MADE_TOGETHER": MEMORY,
        "FACE_STIFFNESS_ROWS_CONVERTED_TOGETHER": SPEED,
    },
    "fem/equilibrium/group.py": {
        "LARGEST_FRICTION_STEP_BETWEEN_CHECKS": "a quarter of "
        "self_locking.LARGEST_STEP_OF_GROWING_FRICTION",
        "RELATIVE_DISTANCE_OF_LAST_CHECK_BELOW_LOCKING": "last digit of a limit that is printed",
        "MOST_PRESSED_NODES_OF_CONTACT_AT_POINT": "a point lies between two nodes",
    },
    "fem/equilibrium/locking.py": {
        "SMALLEST_FRICTION_RATIO_FOR_ELASTIC_LIMIT": SAID,
        "LARGEST_SOUGHT_ELASTIC_LIMIT_OVER_FRICTION": SAID,
    },
    "fem/equilibrium/problems.py": {"COMPLIANCE_ROWS_ASSEMBLED_AT_A_TIME": SPEED},
    "fem/analysis/holding.py": {
        "FIRST_ROTATION_OF_FULL_SLIP_SEARCH": "start of a geometric search",
        "MOST_INCREMENTS_OF_FULL_SLIP_SEARCH": PASSES,
        "LARGEST_TORQUE_DIFFERENCE_OF_SAME_EQUILIBRIUM": SAID,
        "LARGEST_FOOT_FRICTION_RATIO_DIFFERENCE": SAID,
    },
    "fem/analysis/prepared.py": {
        "DEGREE_ACROSS_WIDTH_FOR_ANALYSES": "a degree whose measured error is said; more "
        "degrees take longer",
    },
    "fem/analysis/wide_moduli.py": {
        "STEP_OF_MODULUS_LOGARITHM": "step whose error is said with the answer"
    },
    "fem/error_control/first_level.py": {"FACTORS_FROM_DISTANCE_TO_FIRST_LEVEL_ERROR": DEFINITION},
    "fem/error_control/adapt.py": {
        "DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE": "what a solve aims at, as README says",
    },
    "fem/hp/corner.py": {
        "SMALLEST_SOUGHT_EXPONENT_ROOT": "limit of a search",
        "NUMBER_OF_TRIED_PRESSURE_EXPONENTS": "steps of a search",
        "LENGTH_OF_PRESSURE_PIECE_AT_CORNER": ROUND_OFF,
        "LARGEST_EXPONENT_OF_BOUNDED_PRESSURE": ROUND_OFF,
        "TOLERANCE_OF_COLUMN_END_AT_GAP_KINK": ROUND_OFF,
    },
    "fem/hp/division.py": {
        "SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS": ROUND_OFF,
        "HALF_FORCE_FRACTION_OF_CONTACT": DEFINITION,
        "LONGEST_CONTACT_WITH_CORNER_COLUMNS": DEFINITION,
    },
    "fem/error_control/singular_points.py": {
        "BINARY_DIGITS_OF_ROUNDED_CONTACT_END": ROUND_OFF,
    },
    "fem/error_control/short_contact.py": {
        "SHORTEST_CONTACT_WITH_KNOWN_PRESSURE": SAID,
        "MARGIN_OF_FORMULA_FOR_SHORT_CONTACTS": "judgement, far above the errors of the formula",
        "MOST_PRESSED_NODES_OF_SHORT_CONTACT": "judgement; more pressed nodes show the ends",
        "ROUND_OFF_OF_GAP": ROUND_OFF,
        "ROUND_OFF_OF_ANGLE": ROUND_OFF,
        "STEEPEST_GAP_AT_SHORT_CONTACT": "bounds the brakes that a search is for; time alone",
        "NUMBER_OF_SAMPLED_GAPS": "steps of a search",
        "ZOOMS_TO_TOUCHING_PLACE": "steps of a search",
    },
    "fem/hp/shoe.py": {
        "CONTACT_STIFFNESS_ROWS_CHANGED_TOGETHER": MEMORY,
        "STRAIGHT_BEAM_COLUMNS_PER_BATCH": MEMORY,
    },
    "fem/hp/element.py": {
        "SHAPE_FUNCTION_SLOPES_PER_BATCH": SPEED,
        "SMALLEST_SIZE_COMPUTED_BY_TRIANGLE": SPEED,
        "ROWS_OF_TRANSPOSED_BLOCK": SPEED,
    },
    "fem/error_control/levels.py": {
        "DEGREE_IN_RADIANS": DEFINITION,
        "REFINEMENT_LEVELS_FROM_COARSE_TO_FINE": DEFINITION,
        "MAX_DIVISIONS_OF_BRAKE_PER_LEVEL": PASSES,
    },
    "fem/hp/ring.py": {
        "FULL_TURN_IN_RADIANS": DEFINITION,
        "SAME_ANGLE_TOLERANCE": ROUND_OFF,
    },
    "fem/substructure/ring.py": {
        "MOST_NEWTON_STEPS_TO_RAY_CROSSING": PASSES,
        "RAY_CROSSING_STEP_TOLERANCE": ROUND_OFF,
    },
    "mesh_files/abaqus.py": {
        "NODES_PER_MESHIO_CELL": FORMAT,
        "LABELS_PER_LINE_OF_SET": FORMAT,
    },
    "fem/mesh/check.py": dict.fromkeys(
        (
            "MOST_GROUP_NAMES_IN_MESSAGE",
            "LARGEST_LINING_END_ANGLE_DIFFERENCE_OF_MESH",
            "SAME_NODE_POSITION_TOLERANCE",
            "MOST_COUNTED_COINCIDENT_NODES",
            "LARGEST_RELATIVE_MESH_COORDINATE",
            "LARGEST_RELATIVE_MIDDLE_NODE_OFFSET",
            "LARGEST_CONTACT_DISTANCE_FROM_DRUM_OVER_RADIUS",
            "LARGEST_CONTACT_OVERLAP_OVER_LINING_THICKNESS",
            "LARGEST_SLOPE_OF_CONTACT_AGAINST_DRUM",
            "SMALLEST_NODE_JACOBIAN_OVER_ELEMENT_SUM",
        ),
        SAID,
    ),
    "mesh_files/content.py": {"LARGEST_MESH_FILE_SIZE": MEMORY, "LARGEST_INCLUDE_DEPTH": PASSES},
    "fem/mesh/contact_surface.py": dict.fromkeys(
        (
            "LINING_SHAPE_OFFSET_IN_STANDARD_ERRORS",
            "NODE_ON_DRUM_TOLERANCE",
            "SMOOTHING_NODES_ON_EACH_SIDE",
            "LARGEST_STRAIGHT_EDGE_OFFSET_OVER_ARC_HEIGHT",
            "LEAST_STRAIGHT_EDGE_FRACTION",
            "LARGEST_SCATTER_OVER_ROUNDING_SCATTER",
        ),
        JUDGED_MOVE,
    ),
    "mesh_files/content_of_file.py": {
        "FEWEST_DIGITS_OF_EXACT_COORDINATE": FORMAT,
        "ROUND_DECIMAL_COORDINATE_TOLERANCE": ROUND_OFF,
    },
    "fem/mesh/from_file.py": dict.fromkeys(
        (
            "ZIGZAG_WAVE_HEIGHT_OVER_LINING_COMPRESSION",
            "MOST_RISE_FALL_CHANGES_ON_ANY_MESH",
            "SMALLEST_REPORTED_MOVE_OVER_LINING_COMPRESSION",
            "LARGEST_PIN_OFFSET_OVER_HOLE_RADIUS",
            "LARGEST_HOLE_RADIUS_SCATTER",
            "LARGEST_ANGLE_BETWEEN_NODES_OF_HOLE",
            "LARGEST_FORCE_LINE_OFFSET_OVER_BRAKE_SIZE",
            "LARGEST_LINING_THICKNESS_DIFFERENCE_OF_MESH",
            "FEWEST_NODES_PER_RISE_FALL_CHANGE",
            "MOST_RISE_FALL_CHANGES_OF_LINING_FACE",
        ),
        SAID,
    ),
    "mesh_files/inp_deck.py": {"MOST_MEMBERS_OF_ALL_DECK_SETS": MEMORY},
    "mesh_files/inp_parts.py": {"IDENTITY_PLACEMENT": DEFINITION},
    "mesh_files/labelled_mesh.py": {"MOST_MEMBERS_OF_GROUP_RANGES": MEMORY},
    "mesh_files/med.py": {
        "NODES_PER_MED_CELL": FORMAT,
        "CARTESIAN_MED_COORDINATES": FORMAT,
        "MOST_NUMBERS_IN_MED_ARRAY": MEMORY,
    },
    "mesh_files/msh4.py": {"CELL_NAME_AND_NODE_COUNT_OF_GMSH_TYPE": FORMAT},
    "mesh_files/nastran.py": dict.fromkeys(
        (
            "CORNERS_OF_NASTRAN_CARD",
            "NODES_OF_NASTRAN_LINE_CARD",
            "MESHIO_CELL_OF_CORNERS_AND_NODES",
        ),
        FORMAT,
    ),
    "mesh_files/nastran_cards.py": dict.fromkeys(
        ("COLUMNS_OF_SMALL_FIELD", "COLUMNS_OF_LARGE_FIELD", "FIELDS_OF_CARD_LINE"), FORMAT
    ),
    "mesh_files/nastran_systems.py": {"BASIC_NASTRAN_SYSTEM": DEFINITION},
    "mesh_files/of_meshio.py": {"MOST_GROUP_NUMBERS_IN_ARRAY": MEMORY},
    "mesh_files/plane_cells.py": {
        "CIRCULAR_EDGE_RADIUS_TOLERANCE": "judgement; edges along circles and all others are "
        "far from it",
        "CORNERS_PER_PLANE_CELL": FORMAT,
        "CUBIC_EDGE_MIDDLE_WEIGHTS": DEFINITION,
        "FLAT_CORNER": "judgement; other corners that bend inwards are refused as inverted",
    },
    "fem/mesh/degree.py": {
        **dict.fromkeys(
            (
                "REFERENCE_TRIANGLE_CORNER_COORDINATES",
                "REFERENCE_SQUARE_CORNER_COORDINATES",
                "CORNER_PAIRS_OF_TRIANGLE_SIDES",
                "CORNER_PAIRS_OF_SQUARE_SIDES",
            ),
            DEFINITION,
        ),
        "STRAIGHT_TRIANGLE": "round-off; a smaller one takes longer for the same stiffness",
    },
    "fem/error_control/changed_shape.py": {
        "STEP": "judgement; steps from 1e-5 to 1e-2 give the same changes to four percent",
    },
    "fem/mesh/smooth_outline.py": {
        "LARGEST_TURN_BETWEEN_CHORDS_OF_CURVE": "judgement; larger ones make stated errors "
        "larger where corners are",
        "LARGEST_NONSINGULAR_CORNER_ANGLE": "judgement; slightly re-entrant corners change "
        "nothing that is seen",
    },
    "fem/error_control/degrees.py": {
        "SHARE_OF_EARLIER_LEVEL_DIFFERENCE": "judgement; a larger one makes stated errors larger",
        "CANCELLED_PART_OF_MESH_SHAPE_ERROR": "judgement; a larger one makes stated errors of "
        "forces larger",
        "SAFETY_FACTOR_OF_MESH_FILE_FORCES": "judgement; a larger one makes stated errors of "
        "forces larger",
        "SAFETY_FACTOR_OF_CANCELLED_MESH_FILE_FORCES": "judgement; a larger one makes stated "
        "errors of forces larger",
        "REFINEMENT_LEVELS_ON_MESH_FILES": "larger elements at singular points take a level "
        "more for the same errors",
        "REFINEMENT_LEVELS_ON_FINE_MESH_FILES": "larger elements at singular points take a "
        "level more for the same errors",
        "FEWEST_VERTICES_OF_FINE_MESH_FILE": "judgement; a smaller one takes a level more "
        "for the same errors on coarse meshes",
        "NEGLIGIBLE_SHARE_OF_LEVEL_ERROR": "judgement; a smaller one takes a level more for "
        "the same errors",
        "NEGLIGIBLE_DISTANCE_OF_SIDE_FROM_ARC": "judgement; saves time where the sides' "
        "error is below all others",
    },
    "fem/mesh/splitting.py": {
        "LARGEST_SIDE_OVER_SINGULAR_POINT_DISTANCE": "judgement; a smaller one makes more "
        "triangles",
        "EQUAL_MESH_LENGTH_TOLERANCE": ROUND_OFF,
    },
    "fem/mesh/file.py": {"METRES_PER_MESH_FILE_UNIT": FORMAT},
    "mesh_files/reading.py": {
        "LONGEST_REPEATED_MESHIO_MESSAGE": "length of a message",
        "MOST_NODES_IN_MESH_FILE": MEMORY,
        "LARGEST_NODE_NUMBER_IN_FILE": MEMORY,
    },
    "fem/mesh/arc.py": {"EDGE_ON_ARC_FACE_TOLERANCE": ROUND_OFF, "MESH_KINDS": DEFINITION},
    "fem/mesh/beam.py": {"EDGE_ON_BEAM_SHOE_FACE_TOLERANCE": ROUND_OFF},
    "fem/mesh/grading.py": {
        "DECIMALS_OF_RATIO_FREE_OF_ROUND_OFF": ROUND_OFF,
        "MOST_ELEMENTS_BEYOND_LINING_END": MEMORY,
        "MOST_QUADRATIC_LAYERS_BEHIND_LINING": MEMORY,
        "MOST_LINEAR_LAYERS_BEHIND_LINING": MEMORY,
    },
    "mesh_files/unv.py": dict.fromkeys(
        (
            "NODE_DATASETS",
            "ELEMENT_DATASET",
            "GROUP_DATASETS_AND_NUMBERS_PER_MEMBER",
            "SYSTEM_DATASETS",
            "UNITS_DATASET",
            "REFUSED_UNV_DATASETS",
            "LINE_FE_DESCRIPTORS",
            "PLANE_FE_DESCRIPTOR_TENS",
            "AXISYMMETRIC_FE_DESCRIPTOR_TENS",
            "LAST_SHELL_FE_DESCRIPTOR",
            "FIRST_SPRING_FE_DESCRIPTOR",
            "CELL_AND_ORDER_OF_UNV_NODES",
            "NODES_OF_ROD",
            "NODES_PER_UNV_LINE",
            "UNV_NODE_TYPE",
            "UNV_ELEMENT_TYPE",
        ),
        FORMAT,
    ),
    "mesh_files/vtu.py": {
        "LARGEST_UNPACKED_VTU_SIZE": MEMORY,
        "MOST_VTU_ARRAYS": MEMORY,
        "_BYTES_OF_VTU_HEADER_INTEGER": FORMAT,
    },
    "fem/equilibrium/springs.py": {
        "RELATIVE_TOLERANCE_OF_SPRING_PULLS": ROUND_OFF,
        "MAX_CONTACT_SOLVES_FOR_SPRING_PULLS": PASSES,
        "RELATIVE_PULL_CHANGE_FOR_BRAKE_COMPLIANCE": ROUND_OFF,
        "MAX_HALVINGS_OF_SPRING_PULL_STEP": PASSES,
    },
    "fem/model.py": {
        "RELATIVE_SPACING_OF_DOUBLES": DEFINITION,
        "LARGEST_SILENT_OVERLAP_OVER_LINING_THICKNESS": SAID,
        "DEFAULT_PENALTY_FACTOR": "default of an option, whose effect each response states",
        "LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SHOE": SAID,
        "LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SOLID_SHOE": SAID,
        "LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED": SAID,
        "LARGEST_ACCEPTED_PRESSURE_ROUND_OFF": SAID,
        "LARGEST_SIZE_OF_REFINED_SYSTEM": "limit of time: seconds of a refinement",
        "LARGEST_CORRECTION_OF_CONVERGED_REFINEMENT": ROUND_OFF,
    },
    "fem/analysis/moving.py": {
        "POINT_STEP_IN_DRUM_RADII_FOR_NODE_MOTION": ROUND_OFF,
        "LARGEST_NODE_MOTION_PER_POINT_MOTION": "tells another division from a moved one",
        "LARGEST_NEGLECTED_CONTACT_NODE_MOTION": ROUND_OFF,
    },
    "fem/analysis/mutual_work.py": {"NUMBER_OF_ELEMENTS_PER_CHUNK": MEMORY},
    "fem/equilibrium/reach.py": {"LARGEST_SHOE_TURN_BEFORE_CONTACT": SAID},
    "fem/error_control/refinement.py": {
        "MAX_CORRECTIONS_OF_ITERATIVE_REFINEMENT": PASSES,
        "RELATIVE_PRESSURE_CORRECTION_AT_CONVERGENCE": ROUND_OFF,
        "LARGEST_RATIO_OF_SUCCESSIVE_CORRECTIONS": "factor by which corrections that "
        "converge shrink",
        "MAX_CONTACT_SETS_OF_REFINEMENT": PASSES,
    },
    "fem/analysis/sensitivity.py": {"FACTOR_FROM_PER_METRE_TO_PERCENT_PER_MM": DEFINITION},
    "fem/equilibrium/sharing.py": {"LARGEST_STRUT_OR_CAM_FORCE_COUNTED_AS_ZERO": ROUND_OFF},
    "fem/solid.py": {"DEFAULT_ERROR_TOLERANCE_OF_SOLID_MODEL": "default of an option that is said"},
    "fem/solve.py": {"SMALLEST_REPORTED_PRESSURE_CURVE_IMBALANCE": SAID},
    "response/limits.py": {
        "LARGEST_SILENT_LINING_STRAIN": SAID,
        "LARGEST_ACCEPTED_LINING_STRAIN": SAID,
    },
    "response/response.py": {
        "UNCOMPARED_EDGE_ZONE_IN_RADIANS": DEFINITION,
        "LARGEST_PRESSURE_CURVE_STEP_IN_RADIANS": "points of a picture or a table",
        "LEAST_ANGLE_FROM_LINING_END_TO_PRESSURE_CURVE_POINT": ROUND_OFF,
        "LARGEST_NEUTRAL_FRICTION_OVER_PRESSURE_WORK": ROUND_OFF,
        "ZERO_CHANGES_OF_SHOE_RESULTS": DEFINITION,
        "NEGLIGIBLE_REACTION_OVER_NORMAL_FORCE": ROUND_OFF,
    },
    "response/resultants.py": {
        "GAUSS": DEFINITION,
        "WEIGHTS": DEFINITION,
        "POINTS_OF_POLYNOMIAL_PIECE_SAMPLED_FOR_PEAK": DEFINITION,
        "PRESSURE_DROP_LENGTH_AT_SLOT": ROUND_OFF,
    },
    "response/self_locking.py": {"WARNED_FRACTION_OF_LOCKING_FRICTION": SAID},
    "response/shoe_stiffness.py": {"SMALLEST_STIFFNESS_RATIO_OF_STIFF_SHOE": SAID},
    "response/show.py": {
        "DRAWN_POINTS_PER_POLYNOMIAL_PIECE": "points of a small picture",
        "TOP_OVER_PEAK": "room above the curves of a picture",
        "WIDTH_OF_SHOWN_LINES": "width of shown lines, which changes no number",
    },
}
