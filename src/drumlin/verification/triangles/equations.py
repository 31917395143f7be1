"""The equations between nodal contact forces and gaps of shoes that are solved together."""

from typing import NamedTuple

from drumlin.base.arrays import Bools, Floats


class ContactEquations(NamedTuple):
    """The equations w = q + A f + B y and C f + G y = h of n contact nodes and k unknowns y.

    Here f are the nodal contact forces, w the gaps at the nodes, and y the coordinates of the
    rigid-body modes. With one-sided supports, y also has the forces of the supports that bear.

    Attributes
    ----------
    A : (n, n) opening of the gaps by nodal forces [m/N]
    q : (n,) gaps without contact forces [m]
    B : (n, k) change of the gaps per unknown y
    C : (k, n) work of unit nodal forces in the test modes (virtual rigid-body motions); in the rows
        of supports, openings of the supports by unit nodal forces
    G : (k, k) work of the supports' unit forces in the test modes; in the rows of supports,
        openings of the supports per unknown y
    h : (k,) minus the work of the loads in the test modes; in the rows of supports, minus the
        openings of the supports without y and f
    weight : (n,) area of each node [m^2], which scales gaps to forces
    is_force : (k,) whether each unknown y is the force of a support and not a motion
    """

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    G: Floats
    h: Floats
    weight: Floats
    is_force: Bools
