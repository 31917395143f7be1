"""What each key of a brake file means, in words, beside what its type says.

The manual lists these meanings, and the JSON schema of a brake file carries them into editors.
"""

from collections.abc import Iterable
from typing import Any

from drumlin.brake.components import (
    Actuation,
    ArcBody,
    Backing,
    BeamBody,
    Drum,
    DrumLining,
    DrumRing,
    Misfit,
    OutOfRoundHarmonic,
)
from drumlin.brake.components import TableOfTSection as SectionTable
from drumlin.brake.drive import BrakeChamber, DriveOfAllShoes, StrutOrStrapBetweenShoes
from drumlin.brake.drum_brake import DrumBrake, DrumShoe
from drumlin.brake.fields import Material, OrthotropicMaterial, PartOfInputFile, Point
from drumlin.brake.friction import FrictionTable
from drumlin.brake.further_loads import FurtherForceOnShoe, Gravity, Lever, ShoeMass, Spring
from drumlin.brake.pattern import DrumPattern, FlatPattern
from drumlin.brake.plane_brake import FlatBody, FlatBrake, FlatLining, FlatMisfit, FlatShoe, Plane
from drumlin.brake.support import Abutment, Anchor, Guide, MeshGroups

KeyMeaningsOfPart = tuple[str, type[PartOfInputFile], dict[str, str]]
"""A part of a file: its heading, the class that reads it, and the meaning of each key."""

_KEY_MEANINGS_OF_SECTION = {
    "thickness": "depth of the section in the plane of the brake",
    "width": "width of the section across the plane of the brake",
    "material": "material of the section",
    "bending_stiffness": "EI; replaces the EI that follows from the section",
}
_KEY_MEANINGS_OF_HEAT = {
    "temperature_rise": "temperature of the part above that at which it was made, at the face "
    "towards the friction surface",
    "back_temperature_rise": "the same at its far face, by default as at the near face; the "
    "temperature is linear in between",
}
_KEY_MEANINGS_OF_ARC = {
    "start": "angle at which the arc begins",
    "end": "angle at its end, greater than `start`",
}

_KEY_MEANINGS_OF_SHOE = {
    "name": "name of the shoe in tables and file names",
    "hinge": "the pin about which the shoe turns, or the pin of its lever",
    "pivot": "the pin by which the shoe hangs on a lever; `hinge` is then the pin of the lever",
    "abutment": "the table `[shoe.abutment]`, in place of a hinge",
    "guide": "the table `[shoe.guide]`, in place of a hinge",
    "anchor": "the tables `[[shoe.anchor]]`: faces that push and cannot pull; the shoe rests on "
    "those that the solution finds, and can then leave its abutment too",
    "lining": "the table `[shoe.lining]`; on a drum also `[[shoe.lining]]`, a table for each "
    "of several linings",
    "backing": "the table `[shoe.backing]`",
    "body": "the table `[shoe.body]`; without it the shoe is rigid",
    "actuation": "the table `[shoe.actuation]`; left out if a strut pushes the shoe",
    "force": "the tables `[[shoe.force]]`: further forces on the shoe",
    "mass": "the mass of shoe and lining, on which weight and rotation act",
    "pattern": "repeats the shoe at equal steps, see below",
    "mesh": "a mesh file, of Gmsh, Abaqus, Nastran, Salome or VTK for example, in place of the "
    "parametric mesh",
    "mesh_unit": "unit of the coordinates in the mesh file",
    "mesh_frame": "whether the mesh has the coordinates of the brake or the shoe's own coordinates",
    "groups": "names or numbers of the groups in the mesh file: `{ lining = 1, contact = "
    '"FRICTION" }`',
    "mesh_interference": "confirms that the contact line of the mesh lies in the drum or the plane "
    "on purpose",
}
_KEY_MEANINGS_OF_EVERY_BRAKE = {
    "actuation": "the table `[actuation]`: one cylinder or cam for all shoes",
    "link": "the tables `[[link]]`: struts between shoes",
    "spring": "the tables `[[spring]]`: springs between shoes, or from a shoe to the frame",
    "lever": "the tables `[[lever]]`: levers on one shoe that push another by a strut",
    "gravity": "the table `[gravity]`: weight acts on the masses of the shoes",
}
_MEANING_OF_GRIP = (
    "length of the body's back that a pivot or a guide holds, by default the body's thickness; "
    "with a hinge: length of the back that is bolted to the lever"
)
_KEY_MEANINGS_OF_SHOE_BODY = {
    "width": "width of the rectangular section or of the web", "material": "material of the body",
    "grip": _MEANING_OF_GRIP,
    "table": "makes the section a T: the plate between lining and web, `{ thickness = ..., width = "
        "... }`",
    "bending_stiffness": "EI of the section; replaces the EI of width and material",
    **_KEY_MEANINGS_OF_HEAT}  # fmt: skip

KEY_MEANINGS_OF_BRAKE_FILE_PARTS: tuple[KeyMeaningsOfPart, ...] = (
    ("The brake", DrumBrake, {
        "title": "title of tables, figures and reports",
        "rotation": "sense in which the drum turns",
        "friction": "friction coefficient μ of linings that have none of their own, or its table",
        "drum": "the table `[drum]`",
        "shoe": "the tables `[[shoe]]`, one for each shoe", **_KEY_MEANINGS_OF_EVERY_BRAKE,
        "shoe_speed": "speed at which the shoes turn about the drum's centre, as those of a "
            "centrifugal clutch; it acts on the masses of the shoes"}),
    ("`friction`: a table", FrictionTable, {
        "mu": "friction coefficient of each row of the table",
        "pressure": "pressure of each row", "speed": "sliding speed of each row",
        "temperature_rise": "temperature rise at the lining's face of each row"}),
    ("`[drum]`", Drum, {
        "radius": "radius R of the friction surface",
        "ring": "the table `[drum.ring]`; without it the drum is rigid",
        "out_of_round": "deviation of the friction surface from a circle, as harmonics; see below",
        "angle": "angle by which the drum, with its harmonics, has turned", **_KEY_MEANINGS_OF_HEAT,
        "expansion": "coefficient of thermal expansion, by default that of the ring's material",
        "speed": "angular speed of the drum; a table of `friction` over `speed` needs it"}),
    ("`out_of_round` of `[drum]`: tables", OutOfRoundHarmonic, {
        "order": "number of waves around the drum: 0 growth of a hot drum, 1 run-out, 2 ovality",
        "amplitude": "largest distance of the surface outside the circle",
        "phase": "angle of a wave crest"}),
    ("`[drum.ring]`", DrumRing, {
        **_KEY_MEANINGS_OF_SECTION, "thickness": "radial thickness, away from the shoes",
        "support": "of the edge away from the shoes: `fixed`, or `free` except for rigid motion"}),
    ("`[[shoe]]`", DrumShoe, {
        **_KEY_MEANINGS_OF_SHOE, "side": "whether the shoe is inside or outside of the drum"}),
    ("`groups` of a shoe: names or numbers in its mesh file", MeshGroups, {
        "lining": "elements of the lining", "backing": "elements of the backing",
        "table": "elements of the table of a T-section", "shoe": "elements of the body",
        "contact": "edges or nodes of the face that meets the drum",
        "hinge": "edges or nodes that the pin holds",
        "actuation": "edges or nodes on which the force acts"}),
    ("`[shoe.abutment]`", Abutment, {
        "point": "point at which the foot of the shoe bears",
        "direction": "normal of the face: direction of the force on the foot without friction",
        "friction": "friction coefficient between foot and face; friction opposes the slide"}),
    ("`[[shoe.anchor]]`", Anchor, {
        "point": "point at which the shoe bears",
        "direction": "direction of the force of the face on the shoe",
        "clearance": "distance between face and shoe while nothing acts"}),
    ("`[shoe.guide]`", Guide, {"direction": "direction in which the shoe moves without turning"}),
    ("`[shoe.lining]`", DrumLining, {
        **_KEY_MEANINGS_OF_ARC, "thickness": "radial thickness", "width": "width of the lining",
        "material": "material of the lining",
        "clearance": "gap of the unloaded lining, positive if open, besides the gap that an "
            "adjuster leaves: one value, or rows of angle and gap",
        "misfit": "further deviation of the surface from the drum's circle; see below",
        "friction": "friction coefficient of this lining, or its table, by default that of the "
            "brake", **_KEY_MEANINGS_OF_HEAT}),
    ("`misfit` of `[shoe.lining]`", Misfit, {
        "radius": "radius of the lining's own circle, by default the drum's radius",
        "offset": "vector by which the circle is moved",
        "taper": "additional distance of the lining from the drum at its end away from the hinge",
        "blocks": "rows of angle and depth: from each angle to the next the lining lies back by "
            "this depth"}),
    ("`[shoe.backing]`", Backing, {
        "thickness": "thickness of the layer between lining and shoe; behind a straight beam the "
            "block fills the space",
        "material": "material of the layer", **_KEY_MEANINGS_OF_HEAT}),
    ("`[shoe.body]`, an arc", ArcBody, {
        "shape": "an arc with a constant section, the default",
        **_KEY_MEANINGS_OF_ARC, **_KEY_MEANINGS_OF_SHOE_BODY,
        "thickness": "radial thickness; of a T-section the depth of the web"}),
    ("`table` of `[shoe.body]`", SectionTable, {
        "thickness": "thickness of the plate between lining and web",
        "width": "width of the plate"}),
    ("`[shoe.body]`, a straight beam", BeamBody, {
        **_KEY_MEANINGS_OF_SECTION,
        "shape": "a straight beam from the hinge to the actuation's point",
        "bending_stiffness": "EI, one value or rows over the distance from the hinge; replaces "
            "the EI of the section",
        "offset": "distance of a weakly curved neutral axis behind the straight line, as rows over "
            "the distance from the hinge", **_KEY_MEANINGS_OF_HEAT}),
    ("`[shoe.actuation]`", Actuation, {
        "force": "force on the shoe or its lever; left out if `[actuation]` gives the force",
        "direction": "angle of the force",
        "point": "any point of the line of action; for a beam its loaded end"}),
    ("`[[shoe.force]]`: a further force", FurtherForceOnShoe, {
        "force": "force on the shoe, beside its actuation",
        "direction": "angle of the force",
        "point": "any point of the line of action"}),
    ("`mass` of a shoe", ShoeMass, {
        "mass": "mass of shoe and lining together",
        "point": "centre of mass, while the shoe is at the drum"}),
    ("`pattern` of a shoe", DrumPattern, {
        "count": "number of shoes, with the first one; they are called NAME 1, NAME 2 and so on",
        "linked": "whether the abutment of each shoe bears on a strap to the next shoe; then only "
            "the first shoe has an actuation",
        "step": "angle from each shoe to the next"}),
    ("`pattern` of a shoe on a plane", FlatPattern, {
        "count": "number of shoes, with the first one",
        "linked": "whether the abutment of each shoe bears on a strap to the next shoe",
        "step": "length from each shoe to the next"}),
    ("`[[spring]]`: a spring", Spring, {
        "shoe": "name of the shoe at which the spring begins",
        "point": "point of the spring at this shoe",
        "to": "name of the shoe at which the spring ends; left out for the frame",
        "end": "point of the spring at that shoe or at the frame",
        "preload": "force while the shoes stand as in the file: positive if the spring pulls, "
            "negative if it pushes",
        "rate": "increase of the pull per length by which the points move apart"}),
    ("`[[lever]]`: a lever with a strut", Lever, {
        "shoe": "name of the shoe on which the lever turns",
        "pivot": "pin of the lever on this shoe",
        "to": "name of the shoe that the strut pushes",
        "strut": "point at which the strut bears on the lever",
        "end": "point at which the strut bears on the other shoe",
        "force": "pull of the cable on the lever",
        "direction": "direction of the pull",
        "point": "point of the lever at which the cable pulls"}),
    ("`[gravity]`", Gravity, {
        "direction": "direction in which weight acts",
        "acceleration": "acceleration of free fall"}),
    ("`[actuation]`: a cylinder, a cam or a wedge", DriveOfAllShoes, {
        "pressure": "pressure in a wheel cylinder",
        "diameter": "diameter of the piston; each shoe has one piston",
        "threshold": "pressure up to which the cylinder does not push: seals and springs in it",
        "chamber": "the table `[actuation.chamber]`: a brake chamber that turns a cam of this "
            "`radius`, or pushes a wedge of this `wedge_angle`",
        "wedge_angle": "angle between the two faces of a wedge",
        "force": "sum of the forces of a cam on both shoes",
        "torque": "torque on a cam, together with `radius`, in place of `force`",
        "radius": "radius of the base circle of the cam",
        "efficiency": "share of the force that arrives at the shoes"}),
    ("`[actuation.chamber]`: a brake chamber", BrakeChamber, {
        "area": "effective area of the membrane; a chamber of type 30 has 30 square inches",
        "pressure": "pressure of the air",
        "return_force": "force of the return spring on the rod",
        "lever": "length of the slack adjuster, square to the rod; a wedge has none"}),
    ("`[[link]]`: a strut", StrutOrStrapBetweenShoes, {
        "from": "name of the shoe that bears on the strut",
        "to": "name of the shoe that the strut pushes"}),
    ("A material", Material, {
        "E": "Young's modulus", "nu": "Poisson's ratio",
        "expansion": "coefficient of thermal expansion, for heated parts"}),
    ("An orthotropic material", OrthotropicMaterial, {
        "E_along": "Young's modulus along the layer",
        "E_through": "Young's modulus through the thickness",
        "G_along_through": "shear modulus between both directions",
        "nu_along_through": "Poisson's ratio: contraction through the thickness per strain along "
            "the layer, under tension along the layer",
        "E_across": "Young's modulus across the width; give this key and the next four, or none of "
            "the five",
        "G_along_across": "shear modulus between the directions along and across",
        "G_through_across": "shear modulus between the directions through and across",
        "nu_along_across": "Poisson's ratio: contraction across the width per strain along",
        "nu_through_across": "Poisson's ratio: contraction across the width per strain through",
        "expansion_along": "coefficient of thermal expansion along the layer",
        "expansion_through": "coefficient of thermal expansion through the thickness"}),
    ("A point: x and y, or `{ radius = ..., angle = ... }`", Point, {
        "x": "distance from the drum's centre in x", "y": "distance from the drum's centre in y"}),
    ("A brake on a plane", FlatBrake, {
        "title": "title of tables, figures and reports",
        "friction": "friction coefficient μ of linings that have none of their own, or its table",
        "plane": "the table `[plane]`, in place of `[drum]`",
        "shoe": "the tables `[[shoe]]`", **_KEY_MEANINGS_OF_EVERY_BRAKE}),
    ("`[plane]`", Plane, {
        "sliding": "direction in which the plane slides under the linings",
        "speed": "sliding speed; a table of `friction` over `speed` needs it"}),
    ("`[[shoe]]` on a plane", FlatShoe, _KEY_MEANINGS_OF_SHOE),
    ("`[shoe.lining]` on a plane", FlatLining, {
        "start": "place x at which the lining begins", "end": "place x at which the lining ends",
        "width": "width of the lining",
        "thickness": "thickness of the lining, for finite elements",
        "material": "material of the lining, for finite elements",
        "clearance": "gap between the unloaded lining and the plane: one value, or rows of place "
            "x and gap",
        "misfit": "further deviation of the face from the plane; see below",
        "friction": "friction coefficient of this lining, or its table, by default that of the "
            "brake", **_KEY_MEANINGS_OF_HEAT}),
    ("`misfit` of `[shoe.lining]` on a plane", FlatMisfit, {
        "radius": "radius of a face that is ground to a circle and meets the plane in its middle: "
            "positive for a crowned face, negative for a hollow face; by default the face is flat",
        "offset": "vector by which the circle is moved",
        "taper": "additional distance of the lining from the plane at its end away from the hinge",
        "blocks": "rows of place x and depth: from each place to the next the lining lies back by "
            "this depth"}),
    ("`[shoe.body]` on a plane", FlatBody, {
        "start": "place x at which the body begins",
        "end": "place x at which the body ends", **_KEY_MEANINGS_OF_SHOE_BODY,
        "thickness": "thickness of the bar; of a T-section the depth of the web"}),
)  # fmt: skip


def add_key_meanings_to_json_schema(
    parts: dict[str, Any], tables: Iterable[KeyMeaningsOfPart]
) -> None:
    """Write the meaning of each key into the descriptions of a JSON schema.

    Text editors show the description of a key. If the schema already describes how the value is
    written, this description follows in brackets after the meaning.

    Parameters
    ----------
    parts : schemas of the classes by the names of the classes; they are changed in place
    tables : the meanings; classes that the schema does not have are ignored
    """
    for _, kind, meanings in tables:
        written = parts.get(kind.__name__, {}).get("properties", {})
        for key, schema in written.items():
            form = schema.get("description")
            schema["description"] = meanings[key] + (f" ({form})" if form else "")
