"""The surface on which a brake runs, a drum or a plane: its coordinate, geometry and words.

There is one class `Brake` and one class `Shoe`. They, or their `surface` DRUM or PLANE, know the
differences between a drum and a plane. Nothing outside `drumlin.brake` looks at the class of a
brake.

The coordinate q counts along the surface: the angle theta [rad] on a drum, the place x [m] on a
plane. Linings, tables of clearances, pressures and contact arcs of a shoe are given in q. Three
numbers of a brake tie q to lengths:

- `Brake.scale_factor` is ds/dq, the length of the surface per unit of q: the radius R on a drum, 1
  on a plane. By virtual work it is also the effect of the brake per friction force. The effect is
  conjugate to q: a torque on a drum, a braking force on a plane.
- `Brake.size` [m] is the length to which others are relative, and with which bodies are compared: R
  on a drum, the length of the first lining on a plane.
- `ShoeFrame.unit` is q per unit of phi. Finite elements use phi = s/size, the coordinate of a
  shoe's own frame. On a drum phi is an angle and the unit is 1; on a plane phi is a length in
  sizes.

`ShoeFrame.theta` and `ShoeFrame.phi` convert between q and phi, so that a response needs no
conversion. A `Shoe` knows the rest of the geometry: where its frame lies, and how its points and
depths lie to the surface. Formulas that hold on one surface only refuse the other surface by its
`word`: those of the laws of hinged shoes and of the foundation model.

A brake file has two shapes of data, one with [drum] and one with [plane]. `DrumBrake` and
`FlatBrake` are these two shapes. They are named where a file is read, and nowhere else.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.units import deg, mm


@dataclass(frozen=True)
class FrictionSurface:
    """The units and words of a surface, and its geometry.

    Parameters
    ----------
    word : what the surface is called
    moving : what moves
    moves : that it moves, before a direction
    sense : a direction as a table of results has it, with {} for the direction
    coordinate : the name of the coordinate q
    unit : its SI unit
    shown_unit : the unit in which a person sees q
    shown : how many of that unit are one SI unit
    place : a value of q in words
    axis, figure_axis, page_axis : label of an axis of q in a session, in a report, in the explorer
    moved : how far the surface has moved, in a word
    held : what holds it, in a word
    effect : what a brake does to the surface
    effect_unit : the unit of the effect
    symbol : the sign of the effect in a derivative
    key : the effect as the key of a table
    short : the effect in a narrow column of text
    heading : the head of a narrow column with the effect and its unit
    factor : what a brake factor is the ratio of
    period : a full turn in q, after which places repeat; 0 where they never do
    """

    word: str
    moving: str
    moves: str
    sense: str
    coordinate: str
    unit: str
    shown_unit: str
    shown: float
    place: Callable[[float], str]
    axis: str
    figure_axis: str
    page_axis: str
    moved: str
    held: str
    effect: str
    effect_unit: str
    symbol: str
    key: str
    short: str
    heading: str
    factor: str
    period: float

    @property
    def straight(self) -> bool:
        """Whether the surface is a plane: its normal is the same everywhere."""
        return self.period == 0

    def unlike(self, other: "FrictionSurface") -> str | None:
        """Text of a refusal that the surface is not the wanted `other`; None if it is."""
        return None if self == other else f"its shoes press on a {self.word}, not on a {other.word}"

    def along(self, q: Floats) -> Floats:
        """Unit vectors (2, ...) along growing q at the places q."""
        if self.straight:
            return np.array([np.ones(np.shape(q)), np.zeros(np.shape(q))])
        return np.array([-np.sin(q), np.cos(q)])

    def outwards(self, q: Floats) -> Floats:
        """Unit normals (2, ...) of an internal lining at the places q, into the surface."""
        if self.straight:
            return np.array([np.zeros(np.shape(q)), -np.ones(np.shape(q))])
        return np.array([np.cos(q), np.sin(q)])

    def levers(self, q: Floats, size: float) -> Floats:
        """Moments (2, ...) [m] about the origin of unit forces `outwards` and `along` at q."""
        zero = np.zeros(np.shape(q))
        if self.straight:
            return np.array([-np.asarray(q), zero])
        return np.array([zero, zero + size])

    def turns(self, twice: float) -> float:
        """Whole turns, in q, nearest to half of `twice`.

        For two linings `twice` is the sum of the ends of the first less that of the second.
        """
        return 0.0 if self.straight else self.period * round(twice / (2 * self.period))

    def nearest(self, q: float, middle: float) -> float:
        """The place q, moved by whole turns, that is nearest to `middle`."""
        return q if self.straight else middle + math.remainder(q - middle, self.period)


DRUM = FrictionSurface(
    word="drum",
    moving="drum",
    moves="drum turns",
    sense="{}",
    coordinate="theta",
    unit="rad",
    shown_unit="deg",
    shown=math.degrees(1),
    place=deg,
    axis="angle θ [deg]",
    figure_axis="angle on the drum θ [deg]",
    page_axis="angle on the drum θ [deg]",
    effect="torque",
    effect_unit="N m",
    symbol="T",
    key="torque",
    short="torque",
    heading="torque\n[N m]",
    moved="rotation",
    held="moment",
    factor="T/(F R)",
    period=2 * math.pi,
)
PLANE = FrictionSurface(
    word="plane",
    moving="body",
    moves="body slides along",
    sense="slides {}",
    coordinate="x",
    unit="m",
    shown_unit="mm",
    shown=1e3,
    place=mm,
    axis="place x [mm]",
    figure_axis="place x [mm]",
    page_axis="place on the plane x [mm]",
    effect="braking force",
    effect_unit="N",
    symbol="F",
    key="braking_force",
    short="braking",
    heading="braking\nforce [N]",
    moved="slide",
    held="force",
    factor="B/F",
    period=0.0,
)
