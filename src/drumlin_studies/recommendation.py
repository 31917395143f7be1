"""Which method is enough for an accuracy, and how long the peers take for the same accuracy.

Enough is the fastest method that keeps a target on a brake. Rows are those of `work_precision` with
the name of their `brake`. Floors are the uncertainties of the references, by brake.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from drumlin_studies.work_precision import PEER_FAMILIES, rows_within_error

TARGETS = {
    "torque_error": (0.1, 0.05, 0.01, 1e-3, 1e-4),
    "pressure_error": (0.1, 0.05, 0.01, 5e-3, 1e-3, 1e-4),
}
"""Relative errors for which a method is recommended, by key of a row."""
TARGET_NAMES = {"torque_error": "torque", "pressure_error": "p (L2)"}
"""Names of these errors in tables."""
HALF_PERCENT = 5e-3
"""Relative error of p at which peers are compared with drumlin on one mesh."""
AIMS: Mapping[str, Mapping[float, tuple[float | None, float | None]]] = {
    "GetFEM": {HALF_PERCENT: (20, 100), 1e-3: (25, 100), 1e-4: (50, 100)},
    "CalculiX": {HALF_PERCENT: (1000, None), 1e-3: (1000, None)},
}
"""The aims of the project, by peer and relative error of p: time of the peer over that of drumlin.

The first number is for a cold solve, the second for a further load case.
"""

Row = Mapping[str, Any]
Floors = Mapping[str, float]


def rows_of_brake(rows: Iterable[Row], name: str) -> list[Row]:
    """The rows of one brake."""
    return [row for row in rows if row["brake"] == name]


def rows_to_recommend(rows: Iterable[Row]) -> list[Row]:
    """The rows among which a method is recommended.

    Peers and penalties are left out. A penalty costs at least as much as the exact contact on the
    same mesh; it is there only for comparison.
    """
    left_out = {*PEER_FAMILIES, "weak penalty", "pointwise penalty"}
    return [row for row in rows if row["family"] not in left_out]


def fastest_rows(rows: Sequence[Row], floors: Mapping[str, Floors]) -> list[dict[str, Any]]:
    """For each brake and target a row with the fastest method that keeps the target."""
    best = []
    for name in floors:
        candidates = rows_to_recommend(rows_of_brake(rows, name))
        for key, targets in TARGETS.items():
            for target in targets:
                row = {"brake": name, "quantity": TARGET_NAMES[key], "target": target}
                best.append(row | _fastest_row_or_reason(candidates, key, target, floors[name]))
    return best


def _fastest_row_or_reason(
    rows: Sequence[Row], key: str, target: float, floors: Floors
) -> dict[str, Any]:
    """The fastest of some rows on one brake that keeps a target, or why there is no such row."""
    fit = rows_within_error(rows, key, target, floors)
    if not fit:
        below = target < floors[key]
        reason = "not claimed: below what the reference knows" if below else "none of those tried"
        return {"family": reason}
    fastest = fit[0]
    best = {name: fastest.get(name) for name in ("family", "method", "seconds", "ratio", "further")}
    best["error"] = fastest[key]
    if fastest["family"] == "law":
        # Laws are equally fast, so that all that keep the target are named.
        best["method"] = " or ".join(row["model"] for row in fit if row["family"] == "law")
    return best


class Cell(NamedTuple):
    """What to use on a brake for a target.

    Attributes
    ----------
    what : str
        The method in words.
    sort : str
        "law", "foundation", "elastic" or "none", the class of the cell on the page.
    row : mapping
        The row of `fastest_rows`.
    """

    what: str
    sort: str
    row: Row


class Matrix(NamedTuple):
    """What to use for a quantity, by brake and target.

    Attributes
    ----------
    quantity : str
        A value of TARGET_NAMES.
    targets : tuple of float
        Relative errors.
    lines : dict
        By brake a cell for each target.
    by_law : list of int
        For each target the number of brakes on which a law keeps it.
    """

    quantity: str
    targets: tuple[float, ...]
    lines: dict[str, list[Cell]]
    by_law: list[int]


def recommendation_matrices(best: Sequence[Row]) -> list[Matrix]:
    """`fastest_rows` as a matrix of brake and target for each quantity."""
    found = []
    for key, targets in TARGETS.items():
        lines: dict[str, list[Cell]] = {}
        for row in best:
            if row["quantity"] == TARGET_NAMES[key]:
                lines.setdefault(row["brake"], []).append(_matrix_cell(row))
        by_law = []
        for k in range(len(targets)):
            by_law.append(sum(cells[k].sort == "law" for cells in lines.values()))
        found.append(Matrix(TARGET_NAMES[key], targets, lines, by_law))
    return found


def _matrix_cell(row: Row) -> Cell:
    """The cell of the matrix for a row of `fastest_rows`."""
    family, method = row["family"], row.get("method")
    if method is None:
        return Cell(family, "none", row)
    if family == "law":
        return Cell(f"{method} law", "law", row)
    return Cell(f"{family}: {method}", "foundation" if family == "foundation" else "elastic", row)


def fastest_seconds(
    rows: Sequence[Row], floors: Mapping[str, Floors], target: float
) -> list[float]:
    """Times [s] of the fastest method with at most an error of p, on each brake that has one."""
    seconds = []
    for name, known in floors.items():
        fastest = _fastest_within_error(rows_to_recommend(rows_of_brake(rows, name)), target, known)
        if fastest is not None:
            seconds.append(fastest["seconds"])
    return seconds


class PeerTimes(NamedTuple):
    """The times of a peer and of drumlin on one brake, for an error of p.

    Attributes
    ----------
    peer : str
        Name of the peer.
    target : float
        Relative error of p.
    best, own : mapping or None
        Rows of the fastest solves of the peer and of drumlin that keep the target.
    aims : tuple of two
        Time of the peer over that of drumlin that the project aims at, as in AIMS.
    """

    peer: str
    target: float
    best: Row | None
    own: Row | None
    aims: tuple[float | None, float | None]


class AgainstPeers(NamedTuple):
    """How long the peers take on one brake.

    Attributes
    ----------
    brake : str
        Name of the brake.
    times : list of PeerTimes
        The times for each peer and error.
    alike : list of pairs
        Rows of a peer and of drumlin on the same mesh, with an error of p within HALF_PERCENT.
    even : pair or None
        The finest row of a peer on a uniform mesh, and the fastest row of drumlin within
        HALF_PERCENT.
    """

    brake: str
    times: list[PeerTimes]
    alike: list[tuple[Row, Row]]
    even: tuple[Row, Row] | None


def compare_with_peers(rows: Sequence[Row], floors: Mapping[str, Floors]) -> list[AgainstPeers]:
    """The peers on each brake on which some were tried."""
    names = dict.fromkeys(row["brake"] for row in rows if row["family"] in PEER_FAMILIES)
    return [
        _compare_with_peers_on_brake(name, rows_of_brake(rows, name), floors[name])
        for name in names
    ]


def _compare_with_peers_on_brake(name: str, rows: Sequence[Row], floors: Floors) -> AgainstPeers:
    """Times of the peers on one brake, and of drumlin on the same meshes."""
    own = rows_to_recommend(rows)
    times = []
    for peer, aims in AIMS.items():
        theirs = [row for row in rows if row["family"] == peer and not row.get("even")]
        for target, aim in aims.items():
            best = _fastest_within_error(theirs, target, floors)
            times.append(
                PeerTimes(peer, target, best, _fastest_within_error(own, target, floors), aim)
            )
    of_peers = [row for row in rows if row["family"] in PEER_FAMILIES]
    of_peers = [row for row in of_peers if row["status"] == "converged"]
    even = [row for row in of_peers if row.get("even")]
    finest = max(even, key=lambda row: row["elements"], default=None)
    fastest = _fastest_within_error(own, HALF_PERCENT, floors)
    finest_and_own = (finest, fastest) if finest and fastest else None
    return AgainstPeers(name, times, _pairs_on_same_mesh(of_peers, own), finest_and_own)


def _pairs_on_same_mesh(of_peers: Sequence[Row], own: Sequence[Row]) -> list[tuple[Row, Row]]:
    """Rows of peers within HALF_PERCENT, each with the row of drumlin on the same graded mesh."""
    meshes = {(row["kind"], row["elements"]): row for row in own if row["family"] == "graded mesh"}
    pairs = []
    for row in of_peers:
        mesh = row["kind"], row["elements"]
        is_graded = not row.get("even") and not row.get("layers")
        if is_graded and row["pressure_error"] <= HALF_PERCENT and mesh in meshes:
            pairs.append((row, meshes[mesh]))
    return pairs


def _fastest_within_error(rows: Sequence[Row], target: float, floors: Floors) -> Row | None:
    """The row that keeps an error of p in the shortest time, or None."""
    return next(iter(rows_within_error(rows, "pressure_error", target, floors)), None)
