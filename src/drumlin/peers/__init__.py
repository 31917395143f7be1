"""Peers: public solvers that get the same brake on drumlin's own mesh, and answer with the same
kind of response.
"""

from typing import Any

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.peers.peer import Peer, PeerMissing
from drumlin.response.merit import with_merits

PEERS = {"calculix": "CalculiX", "getfem": "GetFEM"}
"""The peers, and how they write their names."""

__all__ = ["PEERS", "Peer", "PeerMissing", "missing", "solve"]


def solve(name: str, brake: Brake, **options: Any) -> Peer:
    """A brake by the peer `name`; options: `elements`, `kind`, `mesher`, and the peer's own.

    GetFEM takes shoes however they are held, CalculiX those on hinges of a drum. Raises BadInput
    for a brake that the peer does not take and for another name, PeerMissing where it is not
    installed, NoAnswer where it has none.
    """
    from drumlin.peers import calculix, getfem  # noqa: PLC0415  (finite elements load only where they are used)

    if name not in PEERS:
        raise BadInput(f"peer = {name!r}: unknown; allowed: {', '.join(PEERS)}")
    found = (calculix if name == "calculix" else getfem).solve(brake, **options)
    return found._replace(response=with_merits(brake, found.response))


def missing(name: str) -> str | None:
    """The line that says how to install a peer that is not there; None where it is."""
    from drumlin.peers import calculix, getfem  # noqa: PLC0415

    try:
        (calculix.version if name == "calculix" else getfem.python)()
    except PeerMissing as error:
        return str(error)
    return None
