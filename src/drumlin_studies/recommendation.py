"""Which method is enough for an accuracy: the fastest that keeps a target on each brake, and what
peers take for it.

Rows are those of `work_precision`, with the `brake` that they belong to; floors are by
brake, what its reference does not know.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from drumlin_studies.work_precision import PEER_FAMILIES, enough

TARGETS = {
    "torque_error": (0.1, 0.05, 0.01, 1e-3, 1e-4),
    "pressure_error": (0.1, 0.05, 0.01, 5e-3, 1e-3, 1e-4),
}
TARGET_NAMES = {"torque_error": "torque", "pressure_error": "p (L2)"}
HALF_PERCENT = 5e-3  # of p, at which peers are compared
AIMS: Mapping[str, Mapping[float, tuple[float | None, float | None]]] = {
    "GetFEM": {HALF_PERCENT: (20, 100), 1e-3: (25, 100), 1e-4: (50, 100)},
    "CalculiX": {HALF_PERCENT: (1000, None), 1e-3: (1000, None)},
}
"""Of an error of p, how many times as long as drumlin the peers are to take, cold and for a further
load case.
"""

Row = Mapping[str, Any]
Floors = Mapping[str, float]


def of_brake(rows: Iterable[Row], name: str) -> list[Row]:
    """The rows of one brake."""
    return [row for row in rows if row["brake"] == name]


def offered(rows: Iterable[Row]) -> list[Row]:
    """The rows among which one is recommended: not the peers, nor the penalties that are there to
    be compared, which cost what the exact contact on the same mesh costs, or more.
    """
    return [
        row
        for row in rows
        if row["family"] not in (*PEER_FAMILIES, "weak penalty", "pointwise penalty")
    ]


def best_rows(rows: Sequence[Row], floors: Mapping[str, Floors]) -> list[dict[str, Any]]:
    """For each brake and target the fastest method whose error is at most the target."""
    found = []
    for name in floors:
        there = offered(of_brake(rows, name))
        for key, targets in TARGETS.items():
            for target in targets:
                fit = enough(there, key, target, floors[name])
                row = {"brake": name, "quantity": TARGET_NAMES[key], "target": target}
                if fit:
                    row |= {
                        k: fit[0].get(k)
                        for k in ("family", "method", "seconds", "ratio", "further")
                    }
                    row["error"] = fit[0][key]
                    if fit[0]["family"] == "law":
                        row["method"] = " or ".join(r["model"] for r in fit if r["family"] == "law")
                else:
                    below = target < floors[name][key]
                    row["family"] = (
                        "not claimed: below what the reference knows"
                        if below
                        else "none of those tried"
                    )
                found.append(row)
    return found


class Cell(NamedTuple):
    """What to use on a brake for a target: in words, its sort as a class of the page, the `row` of
    `best_rows`.
    """

    what: str
    sort: str
    row: Row


class Matrix(NamedTuple):
    """What to use for a quantity, brake by target: `lines` by brake, a cell each target; `by_law`:
    on how many brakes a law keeps each.
    """

    quantity: str
    targets: tuple[float, ...]
    lines: dict[str, list[Cell]]
    by_law: list[int]


def matrices(best: Sequence[Row]) -> list[Matrix]:
    """`best_rows` as a matrix of brake and target for each quantity."""
    found = []
    for key, targets in TARGETS.items():
        lines: dict[str, list[Cell]] = {}
        for row in best:
            if row["quantity"] == TARGET_NAMES[key]:
                lines.setdefault(row["brake"], []).append(_cell(row))
        by_law = [
            sum(cells[k].sort == "law" for cells in lines.values()) for k in range(len(targets))
        ]
        found.append(Matrix(TARGET_NAMES[key], targets, lines, by_law))
    return found


def _cell(row: Row) -> Cell:
    family, method = row["family"], row.get("method")
    if method is None:
        return Cell(family, "none", row)
    if family == "law":
        return Cell(f"{method} law", "law", row)
    return Cell(f"{family}: {method}", "foundation" if family == "foundation" else "elastic", row)


def fastest_seconds(
    rows: Sequence[Row], floors: Mapping[str, Floors], target: float
) -> list[float]:
    """Seconds of the fastest method with at most this error of p, of each brake that has one."""
    fit = [
        enough(offered(of_brake(rows, name)), "pressure_error", target, known)
        for name, known in floors.items()
    ]
    return [found[0]["seconds"] for found in fit if found]


class PeerTimes(NamedTuple):
    """A peer on a brake for an error of p: its fastest solve that keeps the `target` and drumlin's,
    None where there is none, and how many times longer the peer is to take, cold and for a further
    load case.
    """

    peer: str
    target: float
    best: Row | None
    own: Row | None
    aims: tuple[float | None, float | None]


class AgainstPeers(NamedTuple):
    """What the peers take on one brake; `alike`: (peer's, drumlin's) rows on the same mesh within
    HALF_PERCENT; `even`: the finest row of a peer on a mesh that is graded nowhere, and drumlin's fastest
    within HALF_PERCENT, or None.
    """

    brake: str
    times: list[PeerTimes]
    alike: list[tuple[Row, Row]]
    even: tuple[Row, Row] | None


def against_peers(rows: Sequence[Row], floors: Mapping[str, Floors]) -> list[AgainstPeers]:
    """The peers on each brake on which some were tried."""
    names = dict.fromkeys(row["brake"] for row in rows if row["family"] in PEER_FAMILIES)
    return [_against_peers(name, of_brake(rows, name), floors[name]) for name in names]


def _against_peers(name: str, rows: Sequence[Row], floors: Floors) -> AgainstPeers:
    mine = offered(rows)
    times = [
        PeerTimes(
            peer, target, _fastest(theirs, target, floors), _fastest(mine, target, floors), aims
        )
        for peer, wanted in AIMS.items()
        for theirs in [[row for row in rows if row["family"] == peer and not row.get("even")]]
        for target, aims in wanted.items()
    ]
    there = [row for row in rows if row["family"] in PEER_FAMILIES and row["status"] == "converged"]
    meshes = {(row["kind"], row["elements"]): row for row in mine if row["family"] == "graded mesh"}
    alike = [
        (row, meshes[place])
        for row in there
        for place in [(row["kind"], row["elements"])]
        if row["pressure_error"] <= HALF_PERCENT
        and place in meshes
        and not row.get("even")
        and not row.get("layers")
    ]
    even = [row for row in there if row.get("even")]
    last, own = (
        max(even, key=lambda row: row["elements"], default=None),
        _fastest(mine, HALF_PERCENT, floors),
    )
    return AgainstPeers(name, times, alike, (last, own) if last and own else None)


def _fastest(rows: Sequence[Row], target: float, floors: Floors) -> Row | None:
    """The row that keeps an error of p in the shortest time."""
    return next(iter(enough(rows, "pressure_error", target, floors)), None)
