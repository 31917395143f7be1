"""Peers: the finite-element programs CalculiX and GetFEM solve a brake on drumlin's own mesh.

The results of a peer are returned as a `Response`, like the results of drumlin's own models.
"""

from typing import TYPE_CHECKING, Any

from drumlin.base.errors import BadInput
from drumlin.base.moved import make_getattr_function_for_renamed_functions
from drumlin.brake.brake import Brake
from drumlin.peers.peer import PeerMissing, PeerResult
from drumlin.response.merit import response_with_figures_of_merit

NAMES_OF_PEER_PROGRAMS = {"calculix": "CalculiX", "getfem": "GetFEM"}
"""The finite-element programs that solve a brake: their names in options, and their own names."""

__all__ = [
    "NAMES_OF_PEER_PROGRAMS",
    "PeerMissing",
    "PeerResult",
    "install_hint_if_missing",
    "solve_brake_by_calculix_or_getfem",
]


def solve_brake_by_calculix_or_getfem(name: str, brake: Brake, **options: Any) -> PeerResult:
    """Solve a brake by a peer, another finite-element program.

    Parameters
    ----------
    name : "calculix" for hinged shoes of a drum brake, "getfem" for all kinds of shoes
    brake : the brake
    options : `elements`, `kind` and `mesher` of the mesh, and other options of the peer

    Raises
    ------
    BadInput
        for a brake that the peer cannot solve, and for an unknown name
    PeerMissing
        if the peer is not installed
    NoAnswer
        if the peer finds no solution
    """
    # Importing the peers also imports the finite elements, which takes long.
    from drumlin.peers import calculix, getfem  # noqa: PLC0415

    if name not in NAMES_OF_PEER_PROGRAMS:
        raise BadInput(f"peer = {name!r}: unknown; allowed: {', '.join(NAMES_OF_PEER_PROGRAMS)}")
    solve = (
        calculix.solve_brake_by_calculix
        if name == "calculix"
        else getfem.solve_brake_in_getfem_process
    )
    peer: PeerResult = solve(brake, **options)
    return peer._replace(response=response_with_figures_of_merit(brake, peer.response))


def install_hint_if_missing(name: str) -> str | None:
    """How to install a peer, in one line, or None if the peer is installed."""
    from drumlin.peers import calculix, getfem  # noqa: PLC0415

    try:
        (calculix.calculix_version if name == "calculix" else getfem.path_of_python_with_getfem)()
    except PeerMissing as error:
        return str(error)
    return None


if not TYPE_CHECKING:
    # Programs of users may still import functions of this module by their former names.
    __getattr__ = make_getattr_function_for_renamed_functions(
        __name__,
        {
            "solve": "solve_brake_by_calculix_or_getfem",
            "missing": "install_hint_if_missing",
        },
    )
