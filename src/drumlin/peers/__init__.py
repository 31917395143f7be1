"""Peers: public solvers that get the same brake on drumlin's own mesh.

They answer with the same kind of response as drumlin's models.
"""

from typing import Any

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.peers.peer import Peer, PeerMissing
from drumlin.response.merit import with_merits

PEERS = {"calculix": "CalculiX", "getfem": "GetFEM"}
"""The names that the peers give themselves, by their names in options and files."""

__all__ = ["PEERS", "Peer", "PeerMissing", "missing", "solve"]


def solve(name: str, brake: Brake, **options: Any) -> Peer:
    """Solve a brake by a peer.

    Parameters
    ----------
    name : "calculix" for shoes on hinges of a drum, "getfem" for all shoes
    brake : the brake
    options : `elements`, `kind`, `mesher`, and the peer's own

    Raises
    ------
    BadInput
        for a brake that the peer does not take, and for another name
    PeerMissing
        where the peer is not installed
    NoAnswer
        where the peer has no answer
    """
    # The peers load the finite elements, which other users of this package do not need.
    from drumlin.peers import calculix, getfem  # noqa: PLC0415

    if name not in PEERS:
        raise BadInput(f"peer = {name!r}: unknown; allowed: {', '.join(PEERS)}")
    peer = (calculix if name == "calculix" else getfem).solve(brake, **options)
    return peer._replace(response=with_merits(brake, peer.response))


def missing(name: str) -> str | None:
    """A line that says how to install a missing peer; None where the peer is installed."""
    from drumlin.peers import calculix, getfem  # noqa: PLC0415

    try:
        (calculix.version if name == "calculix" else getfem.python)()
    except PeerMissing as error:
        return str(error)
    return None
