"""A rigid shoe whose lining is a layer of springs: its wear has closed forms."""

import numpy as np

from drumlin.contact.equations import ContactProblem
from drumlin.fem.substructure.interface import (
    ContactLine,
    coupling_matrices_of_contact_line,
    function_that_returns_drum_normals_and_tangents,
)
from drumlin.lining_wear.archard import (
    WearContactProblem,
    WearLaw,
)

K, RADIUS, WIDTH, PIN, FORCE, MU = 4e10, 0.15, 0.04, 0.125, 250.0, 0.25
LAW = WearLaw(1e-13)
UNIT = 1 / (LAW.coefficient * K)


def winkler(gap, *, elements=24, mu=MU, arc=(0.3, 2.2)):
    """A rigid shoe on a hinge at (PIN, 0) with a Winkler lining, and the angles phi of its nodes.

    Springs of stiffness K per area; FORCE is the moment of the actuation.
    """
    phi = np.linspace(*arc, 2 * elements + 1)
    xy = RADIUS * np.array([np.cos(phi), np.sin(phi)])
    pieces = np.arange(0, 2 * elements, 2) + np.arange(3)[:, None]
    coupling = coupling_matrices_of_contact_line(
        ContactLine(np.arange(len(phi)), xy, phi, pieces),
        WIDTH,
        function_that_returns_drum_normals_and_tangents(1),
    )
    turned = np.column_stack([-xy[1], xy[0] - PIN]).ravel()
    approach = coupling.N @ turned
    problem = ContactProblem(
        A=coupling.M / K,
        q=coupling.M @ gap(phi),
        B=-approach[:, None],
        C=(mu * (coupling.T @ turned) - approach)[None],
        # The shoe presses as it turns clockwise.
        h=np.array([FORCE]),
    )
    interface = WearContactProblem(
        problem,
        np.zeros(len(phi)),
        coupling.M,
        np.ones(len(phi)),
        coupling.areas_of_contact_nodes,
        mu * coupling.lever,
    )
    return interface, phi
