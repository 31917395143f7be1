"""What each key of a brake file and of a sweep file means, in words, beside what its type says."""

from drumlin.brake.components import (
    Actuation,
    ArcBody,
    Backing,
    Beam,
    Drum,
    DrumLining,
    Lobes,
    Misfit,
    Ring,
)
from drumlin.brake.components import Table as SectionTable
from drumlin.brake.drive import Drive, Link
from drumlin.brake.drum_brake import DrumBrake, DrumShoe
from drumlin.brake.fields import Material, Orthotropic, Part, Point
from drumlin.brake.plane_brake import FlatBody, FlatBrake, FlatLining, FlatMisfit, FlatShoe, Plane
from drumlin.brake.support import Abutment, Guide, MeshGroups
from drumlin.sweeps.file import Normal, Range, SweepFile, Triangular, TruncatedNormal, Uniform
from drumlin.sweeps.options import FemOptions, FoundationOptions, SolidOptions

Table = tuple[str, type[Part], dict[str, str]]  # heading, the class that reads it, key -> meaning

_SECTION = {
    "thickness": "depth of the section in the plane",
    "width": "width of the section across the plane",
    "material": "material of the section",
    "bending_stiffness": "EI; overrules that of the section, or stands alone",
}
_ARC = {"start": "angle at which it begins", "end": "angle at which it ends, greater than `start`"}

_HELD = {
    "name": "in tables and file names",
    "hinge": "the pin about which it turns, or that of its lever",
    "pivot": "where it turns on a lever besides, whose pin is the hinge",
    "abutment": "the table `[shoe.abutment]`, in place of a hinge",
    "guide": "the table `[shoe.guide]`, in place of a hinge",
    "lining": "the table `[shoe.lining]`",
    "backing": "the table `[shoe.backing]`",
    "body": "the table `[shoe.body]`; without it the shoe is rigid",
    "actuation": "the table `[shoe.actuation]`; left out where a strut pushes the shoe",
    "mesh": "a mesh file in place of the parametric mesh",
    "mesh_unit": "of the mesh's coordinates",
    "mesh_frame": "whose coordinates: the brake's or the shoe's own",
    "groups": "names or numbers that the mesh file has for its groups: `{ lining = 1, contact = "
    '"FRICTION" }`',
    "mesh_interference": "says that a contact line deep in the drum or the plane is meant",
}
_SHARED = {
    "actuation": "the table `[actuation]`: one cylinder or cam for all shoes",
    "link": "the tables `[[link]]`: struts between shoes",
}
_GRIP = (
    "length of its back that a pivot or a guide holds, by default its thickness; "
    "of a hinge, bolted to its lever"
)
_BAR = {
    "width": "of its rectangle or web, across the plane", "material": "its material", "grip": _GRIP,
    "table": "makes the section a T: the plate between lining and web, `{ thickness = ..., width = "
        "... }`",
    "bending_stiffness": "EI; in place of width and material, or overruling them"}  # fmt: skip

BRAKE: tuple[Table, ...] = (
    ("The brake", DrumBrake, {
        "title": "heads tables, figures and reports", "rotation": "how the drum turns",
        "friction": "friction coefficient μ, the same on all linings", "drum": "the table `[drum]`",
        "shoe": "the tables `[[shoe]]`, one a shoe", **_SHARED}),
    ("`[drum]`", Drum, {
        "radius": "of its friction surface, R",
        "ring": "the table `[drum.ring]`; without it the drum is rigid",
        "out_of_round": "harmonics of its surface off the circle, below",
        "angle": "how far the drum has turned"}),
    ("`out_of_round` of `[drum]`: tables", Lobes, {
        "order": "waves around the drum: 0 growth of a hot drum, 1 run-out, 2 ovality",
        "amplitude": "how far the surface lies outside its circle at most",
        "phase": "angle of a crest"}),
    ("`[drum.ring]`", Ring, {
        **_SECTION, "thickness": "radial, away from the shoes",
        "support": "its far edge: held, or only against rigid motion"}),
    ("`[[shoe]]`", DrumShoe, {
        **_HELD, "side": "inside or outside of the drum"}),
    ("`groups` of a shoe: names or numbers in its mesh file", MeshGroups, {
        "lining": "elements of the lining", "backing": "elements of the backing",
        "table": "elements of the table of a T-section", "shoe": "elements of the body",
        "contact": "edges or nodes of the face that meets the drum",
        "hinge": "those that the pin holds",
        "actuation": "those that the force acts on"}),
    ("`[shoe.abutment]`", Abutment, {
        "point": "where its foot bears",
        "direction": "normal of the face: of the force on the foot without friction",
        "friction": "of the foot on the face, opposing the slide"}),
    ("`[shoe.guide]`", Guide, {"direction": "along which the shoe moves without turning"}),
    ("`[shoe.lining]`", DrumLining, {
        **_ARC, "thickness": "radial", "width": "across the plane", "material": "its material",
        "clearance": "gap of the unloaded lining, positive is open: one value, or rows of angle "
            "and gap",
        "misfit": "how its surface is off the drum's circle besides, below"}),
    ("`misfit` of `[shoe.lining]`", Misfit, {
        "radius": "of the lining's own circle, by default the drum's",
        "offset": "by which that circle is moved",
        "taper": "how much farther the lining stands back at its end away from the hinge",
        "blocks": "rows of angle and depth: from each angle on the lining stands back by this "
            "depth"}),
    ("`[shoe.backing]`", Backing, {
        "thickness": "of the layer between lining and shoe; behind a straight beam the block fills "
            "the space",
        "material": "its material"}),
    ("`[shoe.body]`, an arc", ArcBody, {
        "shape": "an arc of constant section, the default", **_ARC, **_BAR,
        "thickness": "radial, of a T-section's web"}),
    ("`table` of `[shoe.body]`", SectionTable, {
        "thickness": "of the T-section's plate between lining and web",
        "width": "of the plate, across the plane"}),
    ("`[shoe.body]`, a straight beam", Beam, {
        **_SECTION, "shape": "a straight beam from the hinge to the actuation's point",
        "bending_stiffness": "EI, one value or rows over the distance from the hinge; overrules "
            "that of the section",
        "offset": "how far a weakly curved neutral axis lies behind the straight line, rows over "
            "the distance"}),
    ("`[shoe.actuation]`", Actuation, {
        "force": "on the shoe or its lever; left out where `[actuation]` gives it",
        "direction": "angle of the force",
        "point": "any point of its line of action; of a beam its loaded end"}),
    ("`[actuation]`: a cylinder, or a cam or wedge", Drive, {
        "pressure": "of a cylinder", "diameter": "of its piston, one for each shoe",
        "force": "of a cam: the sum of its forces on both shoes",
        "torque": "of a cam, with `radius`, in place of `force`",
        "radius": "of the cam's base", "efficiency": "what part of it arrives"}),
    ("`[[link]]`: a strut", Link, {
        "from": "name of the shoe that bears on it", "to": "name of the shoe that it pushes"}),
    ("A material", Material, {"E": "Young's modulus", "nu": "Poisson's ratio"}),
    ("An orthotropic material", Orthotropic, {
        "E_along": "Young's modulus along the layer", "E_through": "through its thickness",
        "G_along_through": "shear modulus between both",
        "nu_along_through": "what the layer shrinks through its thickness per strain along it, as "
            "it is pulled along",
        "E_across": "Young's modulus across the width; this key and the next four together or none "
            "of them",
        "G_along_across": "shear modulus between along and across",
        "G_through_across": "between through and across",
        "nu_along_across": "what it shrinks across the width per strain along it",
        "nu_through_across": "what it shrinks across the width per strain through it"}),
    ("A point: x and y, or `{ radius = ..., angle = ... }`", Point, {
        "x": "from the drum's centre", "y": "from the drum's centre"}),
    ("A brake on a plane", FlatBrake, {
        "title": "as above", "friction": "as above",
        "plane": "the table `[plane]`, in place of `[drum]`",
        "shoe": "the tables `[[shoe]]`", **_SHARED}),
    ("`[plane]`", Plane, {"sliding": "the direction in which the body slides"}),
    ("`[[shoe]]` on a plane", FlatShoe, _HELD),
    ("`[shoe.lining]` on a plane", FlatLining, {
        "start": "place x at which it begins", "end": "place x at which it ends",
        "width": "across the plane",
        "thickness": "for finite elements", "material": "for finite elements",
        "clearance": "how far the unloaded lining stands off the plane: one value, or rows of "
            "place x and clearance",
        "misfit": "how its face is off the plane besides, below"}),
    ("`misfit` of `[shoe.lining]` on a plane", FlatMisfit, {
        "radius": "of a face that is ground to a circle and meets the plane in its middle: "
            "positive of a crowned "
                  "face, negative of a hollow one; by default the face is flat",
        "offset": "by which that circle is moved",
        "taper": "how much farther the lining stands back at its end away from the hinge",
        "blocks": "rows of place x and depth: from each place on the lining stands back by this "
            "depth"}),
    ("`[shoe.body]` on a plane", FlatBody, {
        "start": "place x at which it begins", "end": "place x at which it ends", **_BAR,
        "thickness": "of the bar, of a T-section's web"}),
)  # fmt: skip

_DRAW = {"distribution": "its name", "each_shoe": "whether each shoe draws its own value"}
_ENDS = {"from": "lower end", "to": "upper end"}
_MEAN = {
    "mean": "by default the brake file's value",
    "deviation": "standard deviation, or in % of the mean",
}

SWEEP: tuple[Table, ...] = (
    ("The sweep", SweepFile, {
        "title": "by default the brake's",
        "brake": "path of a brake file, or the brake itself as a table",
        "combine": "lists: every value with every other, side by side, or drawn",
        "cases": "how many draws",
        "seed": "of the draws",
        "pressure": "unit of stresses in the table and its heads",
        "model": "one table `[model.NAME]` for each model, with its options",
        "vary": "the table `[vary]`: key of the brake file, such as "
            "`\"shoe[0].lining.thickness\"`, and its values: a "
                "list, a range or a distribution"}),
    ("A range", Range, {**_ENDS, "count": "how many values",
    "scale": "evenly spread, or by equal factors"}),
    ('`distribution = "uniform"`', Uniform, {**_DRAW, **_ENDS}),
    ('`distribution = "triangular"`', Triangular, {
        **_DRAW, **_ENDS, "mode": "most often; by default the brake file's value"}),
    ('`distribution = "normal"` or `"lognormal"`', Normal, {**_DRAW, **_MEAN}),
    ('`distribution = "truncated-normal"`', TruncatedNormal, {**_DRAW, **_MEAN, **_ENDS}),
    ("`[model.fem]`", FemOptions, {
        "elements": "along each lining", "kind": "of the elements",
        "penalty": "contact stiffness over E/t",
        "tolerance": "of p and torque, in place of `elements`",
        "finite_width": "whether the lining's modulus is corrected for the widths",
        "model_error": "whether the error of plane stress itself is stated"}),
    ("`[model.solid]`", SolidOptions, {
        "elements": "along each lining", "across": "over half a lining's width",
        "penalty": "contact stiffness over E/t"}),
    ("`[model.foundation]`", FoundationOptions, {
        "sections": "of each beam", "lift": "simplifications to lift, by name"}),
)  # fmt: skip
