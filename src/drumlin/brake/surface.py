"""The friction surface of a brake, a drum or a plane: its coordinate, geometry and output texts.

One class `Brake` and one class `Shoe` serve both kinds of surface. The differences between a drum
and a plane are in the subclasses of these two classes and in the constants FRICTION_SURFACE_OF_DRUM
and FRICTION_SURFACE_OF_PLANE. No module outside `drumlin.brake` asks for the class of a brake.

The coordinate q counts along the surface: it is the angle theta [rad] on a drum and x [m] on a
plane. Ends of linings, tables of clearances, pressures and contact arcs of a shoe are given in q.
Three numbers of a brake relate q to lengths:

- `Brake.length_per_surface_coordinate` is ds/dq, the length along the surface per unit of q: the
radius R on a drum,
  1 on a plane. By virtual work it also converts a friction force to the effect of the brake, which
  is a torque on a drum and a braking force on a plane.
- `Brake.size` [m] is the reference length of the brake: R on a drum, the length of the first lining
  on a plane.
- `ShoeFrame.surface_coordinate_per_phi` is the change of q per unit of phi. The coordinate phi =
s/size belongs to the
  frame of a shoe, and the finite elements use it. On a drum phi is an angle and the unit is 1. On a
  plane phi is a length divided by the size.

`ShoeFrame.surface_coordinates_of_phi` and `ShoeFrame.phi_of_surface_coordinates` convert between q
and phi. The results of all models are in q. A `Shoe` has the rest of the geometry: where its frame
lies, and how far its points are from the surface. The laws of hinged shoes and the foundation model
hold on a drum only: they refuse a plane.

A brake file has either a table [drum] or a table [plane]. `DrumBrake` and `FlatBrake` are the
classes for these two kinds of file. Only the code that reads files uses them by name.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.units import angle_as_text_in_degrees, length_as_text_in_mm


@dataclass(frozen=True)
class FrictionSurface:
    """The geometry of a friction surface, and the units and words for it in outputs.

    The effect of a brake is its torque on a drum, and its braking force on a plane.

    Parameters
    ----------
    name : name of the surface, "drum" or "plane"
    name_of_moving_body : name of the body that moves, "drum" or "body"
    words_before_direction : words before the direction of motion, such as "drum turns"
    direction_pattern_for_tables : pattern for the direction of motion in tables of results; {}
        stands for the direction
    coordinate_name : name of the coordinate q along the surface, "theta" or "x"
    coordinate_unit : SI unit of q
    shown_unit : unit in which q is shown to people
    si_to_shown_unit_factor : factor that converts q from the SI unit to the shown unit
    coordinate_as_text : function that writes a value of q with its unit
    axis_label_in_python, axis_label_in_report, axis_label_in_explorer : labels of an axis of q in a
        Python session, in a report and in the explorer
    word_for_motion : word for the motion of the surface, "rotation" or "slide"
    word_for_held_load : word for the load that holds the surface, "moment" or "force"
    word_for_torque_or_brake_force : word for the effect, "torque" or "braking force"
    unit_of_torque_or_brake_force : SI unit of the effect
    symbol_of_torque_or_brake_force : letter for the effect in formulas
    key_of_torque_or_brake_force : key of the effect in tables
    short_word_for_torque_or_brake_force : word for the effect in a narrow column of text
    heading_of_torque_or_brake_force : heading of a narrow column for the effect, with the unit
    brake_factor_formula : formula of the brake factor
    coordinate_change_by_full_turn : change of q by a full turn, 2 pi on a drum; 0 on a plane, which
        has no turns
    """

    name: str
    name_of_moving_body: str
    words_before_direction: str
    direction_pattern_for_tables: str
    coordinate_name: str
    coordinate_unit: str
    shown_unit: str
    si_to_shown_unit_factor: float
    coordinate_as_text: Callable[[float], str]
    axis_label_in_python: str
    axis_label_in_report: str
    axis_label_in_explorer: str
    word_for_motion: str
    word_for_held_load: str
    word_for_torque_or_brake_force: str
    unit_of_torque_or_brake_force: str
    symbol_of_torque_or_brake_force: str
    key_of_torque_or_brake_force: str
    short_word_for_torque_or_brake_force: str
    heading_of_torque_or_brake_force: str
    brake_factor_formula: str
    coordinate_change_by_full_turn: float

    @property
    def is_plane_and_not_drum(self) -> bool:
        """Whether the surface is a plane and not a drum."""
        return self.coordinate_change_by_full_turn == 0

    def reason_why_surface_is_not_required_one(self, other: "FrictionSurface") -> str | None:
        """Text for an error message that the shoes do not press on the required surface, `other`.

        The two surfaces are a drum and a plane. The text is None if this surface is `other`.
        """
        return None if self == other else f"its shoes press on a {self.name}, not on a {other.name}"

    def unit_tangents_of_surface(self, q: Floats) -> Floats:
        """Unit tangents (2, ...) of the surface at the coordinates q, towards growing q."""
        if self.is_plane_and_not_drum:
            return np.array([np.ones(np.shape(q)), np.zeros(np.shape(q))])
        return np.array([-np.sin(q), np.cos(q)])

    def unit_normals_into_surface(self, q: Floats) -> Floats:
        """Unit normals (2, ...) of the surface at the coordinates q.

        They point from an internal lining into the drum, or from a lining into the plane.
        """
        if self.is_plane_and_not_drum:
            return np.array([np.zeros(np.shape(q)), -np.ones(np.shape(q))])
        return np.array([np.cos(q), np.sin(q)])

    def moments_of_unit_normal_and_tangential_forces(self, q: Floats, size: float) -> Floats:
        """Moments (2, ...) [m] about the origin of unit forces on the surface at the coordinates q.

        The first row is for unit forces along the normals (`unit_normals_into_surface`), the second
        row for unit forces along the surface, towards growing q. `size` [m] is the drum's radius.
        """
        zero = np.zeros(np.shape(q))
        if self.is_plane_and_not_drum:
            return np.array([-np.asarray(q), zero])
        return np.array([zero, zero + size])

    def half_distance_rounded_to_whole_turns(self, twice: float) -> float:
        """Round the distance `twice`/2 between two coordinates q to a multiple of a full turn.

        On a plane the result is 0. `twice` is given in place of the distance because, for the
        middles of two linings, it is the sum of one lining's ends minus the sum of the other's.
        """
        return (
            0.0
            if self.is_plane_and_not_drum
            else self.coordinate_change_by_full_turn
            * round(twice / (2 * self.coordinate_change_by_full_turn))
        )

    def coordinate_plus_turns_nearest_to_middle(self, q: float, middle: float) -> float:
        """The coordinate q plus the number of whole turns that brings it nearest to `middle`."""
        return (
            q
            if self.is_plane_and_not_drum
            else middle + math.remainder(q - middle, self.coordinate_change_by_full_turn)
        )


# The friction surface of every brake on a drum.
FRICTION_SURFACE_OF_DRUM = FrictionSurface(
    name="drum",
    name_of_moving_body="drum",
    words_before_direction="drum turns",
    direction_pattern_for_tables="{}",
    coordinate_name="theta",
    coordinate_unit="rad",
    shown_unit="deg",
    si_to_shown_unit_factor=math.degrees(1),
    coordinate_as_text=angle_as_text_in_degrees,
    axis_label_in_python="angle θ [deg]",
    axis_label_in_report="angle on the drum θ [deg]",
    axis_label_in_explorer="angle on the drum θ [deg]",
    word_for_torque_or_brake_force="torque",
    unit_of_torque_or_brake_force="N m",
    symbol_of_torque_or_brake_force="T",
    key_of_torque_or_brake_force="torque",
    short_word_for_torque_or_brake_force="torque",
    heading_of_torque_or_brake_force="torque\n[N m]",
    word_for_motion="rotation",
    word_for_held_load="moment",
    brake_factor_formula="T/(F R)",
    coordinate_change_by_full_turn=2 * math.pi,
)
# The friction surface of every brake on a plane.
FRICTION_SURFACE_OF_PLANE = FrictionSurface(
    name="plane",
    name_of_moving_body="body",
    words_before_direction="body slides along",
    direction_pattern_for_tables="slides {}",
    coordinate_name="x",
    coordinate_unit="m",
    shown_unit="mm",
    si_to_shown_unit_factor=1e3,
    coordinate_as_text=length_as_text_in_mm,
    axis_label_in_python="place x [mm]",
    axis_label_in_report="place x [mm]",
    axis_label_in_explorer="place on the plane x [mm]",
    word_for_torque_or_brake_force="braking force",
    unit_of_torque_or_brake_force="N",
    symbol_of_torque_or_brake_force="F",
    key_of_torque_or_brake_force="braking_force",
    short_word_for_torque_or_brake_force="braking",
    heading_of_torque_or_brake_force="braking\nforce [N]",
    word_for_motion="slide",
    word_for_held_load="force",
    brake_factor_formula="B/F",
    coordinate_change_by_full_turn=0.0,
)
