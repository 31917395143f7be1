"""The fastest method for each accuracy, and how long the peers take for the same accuracy.

A target is the largest allowed relative error of a quantity. For each brake and target the fastest
method is chosen whose error is below the target. Peers are other finite element programs. A row is
the result of one method on one brake: its errors and times, with the name of the brake under
`brake`. Errors are differences from a reference solution. The floors of a brake are the
uncertainties of this solution. An error below its floor counts as not known.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from drumlin_studies.work_precision import PEER_KEYS_BY_NAME_IN_TABLES, fastest_rows_within_error

LARGEST_ALLOWED_ERRORS_OF_RECOMMENDED_METHODS = {
    "torque_error": (0.1, 0.05, 0.01, 1e-3, 1e-4),
    "pressure_error": (0.1, 0.05, 0.01, 5e-3, 1e-3, 1e-4),
}
"""Targets: largest allowed relative errors, by the error's key in a row. A method is recommended
for each target.
"""
QUANTITY_NAMES_BY_ERROR_KEY = {"torque_error": "torque", "pressure_error": "p (L2)"}
"""Names of the quantities of LARGEST_ALLOWED_ERRORS_OF_RECOMMENDED_METHODS in tables, by the
error's key in a row.
"""
LARGEST_COMPARED_PEER_PRESSURE_ERROR = 5e-3
"""Largest relative error of a peer's pressure with which the peer is compared with drumlin on the
same mesh.
"""
AIMED_PEER_TIME_OVER_DRUMLIN_TIME: Mapping[
    str, Mapping[float, tuple[float | None, float | None]]
] = {
    "GetFEM": {LARGEST_COMPARED_PEER_PRESSURE_ERROR: (20, 100), 1e-3: (25, 100), 1e-4: (50, 100)},
    "CalculiX": {LARGEST_COMPARED_PEER_PRESSURE_ERROR: (1000, None), 1e-3: (1000, None)},
}
"""The aims of the project for the ratio of a peer's time to drumlin's time.

The keys are the name of the peer and the allowed relative error of the pressure. The first number
is the aim for a cold solve, which starts without a prepared model. The second number is the aim for
a further load case on a prepared model. None means that there is no aim.
"""

MethodResultRow = Mapping[str, Any]
"""The result of a method on a brake: its errors and times by key."""
ReferenceUncertaintyByErrorKey = Mapping[str, float]
"""Relative uncertainty of a brake's reference solution, by the error's key in a row."""


def method_rows_of_brake_with_given_name(
    rows: Iterable[MethodResultRow], name: str
) -> list[MethodResultRow]:
    """The rows whose brake has the given name."""
    return [row for row in rows if row["brake"] == name]


def rows_of_methods_that_may_be_recommended(
    rows: Iterable[MethodResultRow],
) -> list[MethodResultRow]:
    """The rows whose methods may be recommended.

    The rows of peers and of penalty contact are left out. Penalty contact takes at least as long as
    exact contact on the same mesh and is there only for comparison.
    """
    left_out = {*PEER_KEYS_BY_NAME_IN_TABLES, "weak penalty", "pointwise penalty"}
    return [row for row in rows if row["family"] not in left_out]


def rows_of_fastest_methods_by_target(
    rows: Sequence[MethodResultRow], floors: Mapping[str, ReferenceUncertaintyByErrorKey]
) -> list[dict[str, Any]]:
    """A row for each brake and target with the fastest method whose error is below the target.

    rows : rows of all methods and brakes; floors : uncertainties of each brake's reference, by the
        brake's name.
    """
    best = []
    for name in floors:
        candidates = rows_of_methods_that_may_be_recommended(
            method_rows_of_brake_with_given_name(rows, name)
        )
        for key, targets in LARGEST_ALLOWED_ERRORS_OF_RECOMMENDED_METHODS.items():
            for target in targets:
                row = {
                    "brake": name,
                    "quantity": QUANTITY_NAMES_BY_ERROR_KEY[key],
                    "target": target,
                }
                best.append(
                    row
                    | _fastest_method_within_error_or_reason(candidates, key, target, floors[name])
                )
    return best


def _fastest_method_within_error_or_reason(
    rows: Sequence[MethodResultRow], key: str, target: float, floors: ReferenceUncertaintyByErrorKey
) -> dict[str, Any]:
    """The fastest method on a brake with an error below a target, as keys and values of a row.

    If no method has an error below the target, the row has the reason under `family`.

    rows : rows of the brake; key : key of the error; floors : uncertainties of the brake's
        reference.
    """
    fit = fastest_rows_within_error(rows, key, target, floors)
    if not fit:
        below = target < floors[key]
        reason = "not claimed: below what the reference knows" if below else "none of those tried"
        return {"family": reason}
    fastest = fit[0]
    best = {name: fastest.get(name) for name in ("family", "method", "seconds", "ratio", "further")}
    best["error"] = fastest[key]
    if fastest["family"] == "law":
        # All laws take the same time, so every law whose error is below the target is named.
        best["method"] = " or ".join(row["model"] for row in fit if row["family"] == "law")
    return best


class RecommendedMethodCell(NamedTuple):
    """A cell of a table: the method that is recommended on a brake for a target.

    Attributes
    ----------
    what : str
        The method in words, or the reason why no method is recommended.
    sort : str
        "law", "foundation", "elastic" or "none": the CSS class of the cell on the report's page.
    row : mapping
        The row of `rows_of_fastest_methods_by_target`.
    """

    what: str
    sort: str
    row: MethodResultRow


class RecommendedMethodTable(NamedTuple):
    """The recommended methods for one quantity, for each brake and target.

    Attributes
    ----------
    quantity : str
        A value of QUANTITY_NAMES_BY_ERROR_KEY.
    targets : tuple of float
        Largest allowed relative errors.
    lines : dict
        Lists of cells, one cell for each target, by the brake's name.
    by_law : list of int
        For each target the number of brakes for which a law is recommended.
    """

    quantity: str
    targets: tuple[float, ...]
    lines: dict[str, list[RecommendedMethodCell]]
    by_law: list[int]


def recommended_methods_by_brake_and_target(
    best: Sequence[MethodResultRow],
) -> list[RecommendedMethodTable]:
    """The table of recommended methods for each quantity, from the rows of fastest methods."""
    found = []
    for key, targets in LARGEST_ALLOWED_ERRORS_OF_RECOMMENDED_METHODS.items():
        lines: dict[str, list[RecommendedMethodCell]] = {}
        for row in best:
            if row["quantity"] == QUANTITY_NAMES_BY_ERROR_KEY[key]:
                lines.setdefault(row["brake"], []).append(_matrix_cell_with_recommended_method(row))
        # For each target the number of brakes on which a law is recommended.
        by_law = []
        for k in range(len(targets)):
            by_law.append(sum(cells[k].sort == "law" for cells in lines.values()))
        found.append(
            RecommendedMethodTable(QUANTITY_NAMES_BY_ERROR_KEY[key], targets, lines, by_law)
        )
    return found


def _matrix_cell_with_recommended_method(row: MethodResultRow) -> RecommendedMethodCell:
    """The cell of a table with the recommended method in a row of fastest methods."""
    family, method = row["family"], row.get("method")
    if method is None:
        return RecommendedMethodCell(family, "none", row)
    if family == "law":
        return RecommendedMethodCell(f"{method} law", "law", row)
    return RecommendedMethodCell(
        f"{family}: {method}", "foundation" if family == "foundation" else "elastic", row
    )


def fastest_solve_times_within_error(
    rows: Sequence[MethodResultRow],
    floors: Mapping[str, ReferenceUncertaintyByErrorKey],
    target: float,
) -> list[float]:
    """Time [s] on each brake of the fastest method with an error of the pressure below a target.

    Brakes without a method that meets the target are left out.

    rows : rows of all methods and brakes; floors : uncertainties of each brake's reference; target
        : relative error.
    """
    seconds = []
    for name, known in floors.items():
        fastest = _fastest_row_within_pressure_error(
            rows_of_methods_that_may_be_recommended(
                method_rows_of_brake_with_given_name(rows, name)
            ),
            target,
            known,
        )
        if fastest is not None:
            seconds.append(fastest["seconds"])
    return seconds


class TimesOfPeerAndDrumlinOnBrake(NamedTuple):
    """The times of a peer and of drumlin on one brake, for an error of the pressure.

    Attributes
    ----------
    peer : str
        Name of the peer.
    target : float
        Largest allowed relative error of the pressure.
    best, own : mapping or None
        Rows of the fastest solve of the peer (best) and of drumlin (own) with an error below the
        target; None if no solve meets the target.
    aims : tuple of two
        Ratios of the peer's time to drumlin's time that the project aims at: for a cold solve, and
        for a further load case.
    """

    peer: str
    target: float
    best: MethodResultRow | None
    own: MethodResultRow | None
    aims: tuple[float | None, float | None]


class ComparisonWithPeersOnBrake(NamedTuple):
    """The comparison of drumlin with the peers on one brake.

    Attributes
    ----------
    brake : str
        Name of the brake.
    times : list of TimesOfPeerAndDrumlinOnBrake
        The times for each peer and each error of the pressure.
    alike : list of pairs
        Pairs of rows of a peer and of drumlin on the same mesh, where the peer's error of the
        pressure is at most LARGEST_COMPARED_PEER_PRESSURE_ERROR.
    even : pair or None
        The row of a peer on the finest uniform mesh, and the row of drumlin's fastest solve with an
        error of the pressure of at most LARGEST_COMPARED_PEER_PRESSURE_ERROR. None if one of them
        is missing.
    """

    brake: str
    times: list[TimesOfPeerAndDrumlinOnBrake]
    alike: list[tuple[MethodResultRow, MethodResultRow]]
    even: tuple[MethodResultRow, MethodResultRow] | None


def compare_times_with_peer_programs(
    rows: Sequence[MethodResultRow], floors: Mapping[str, ReferenceUncertaintyByErrorKey]
) -> list[ComparisonWithPeersOnBrake]:
    """The comparison of drumlin with the peers for each brake that a peer has solved.

    rows : rows of all methods and brakes; floors : uncertainties of each brake's reference, by the
        brake's name.
    """
    names = dict.fromkeys(
        row["brake"] for row in rows if row["family"] in PEER_KEYS_BY_NAME_IN_TABLES
    )
    comparisons = []
    for name in names:
        own = method_rows_of_brake_with_given_name(rows, name)
        comparisons.append(_compare_times_with_peers_on_brake(name, own, floors[name]))
    return comparisons


def _compare_times_with_peers_on_brake(
    name: str, rows: Sequence[MethodResultRow], floors: ReferenceUncertaintyByErrorKey
) -> ComparisonWithPeersOnBrake:
    """The comparison of drumlin with the peers, other finite element programs, on one brake.

    name : name of the brake; rows : rows of the brake; floors : uncertainties of the brake's
        reference.
    """
    own = rows_of_methods_that_may_be_recommended(rows)
    # The fastest solves of each peer and of drumlin for each allowed error, without uniform meshes.
    times = []
    for peer, aims in AIMED_PEER_TIME_OVER_DRUMLIN_TIME.items():
        theirs = [row for row in rows if row["family"] == peer and not row.get("even")]
        for target, aim in aims.items():
            best = _fastest_row_within_pressure_error(theirs, target, floors)
            times.append(
                TimesOfPeerAndDrumlinOnBrake(
                    peer, target, best, _fastest_row_within_pressure_error(own, target, floors), aim
                )
            )
    # A peer's finest solve on a uniform mesh is compared with the fastest solve of drumlin.
    of_peers = [row for row in rows if row["family"] in PEER_KEYS_BY_NAME_IN_TABLES]
    of_peers = [row for row in of_peers if row["status"] == "converged"]
    even = [row for row in of_peers if row.get("even")]
    finest = max(even, key=lambda row: row["elements"], default=None)
    fastest = _fastest_row_within_pressure_error(own, LARGEST_COMPARED_PEER_PRESSURE_ERROR, floors)
    finest_and_own = (finest, fastest) if finest and fastest else None
    return ComparisonWithPeersOnBrake(
        name, times, _row_pairs_of_peer_and_drumlin_on_mesh(of_peers, own), finest_and_own
    )


def _row_pairs_of_peer_and_drumlin_on_mesh(
    of_peers: Sequence[MethodResultRow], own: Sequence[MethodResultRow]
) -> list[tuple[MethodResultRow, MethodResultRow]]:
    """Pairs of a peer's row and of drumlin's row on the same graded mesh.

    Rows of peers with an error of the pressure above LARGEST_COMPARED_PEER_PRESSURE_ERROR are left
    out.
    """
    # Rows of drumlin on graded meshes, by the mesh: kind and number of elements.
    meshes = {(row["kind"], row["elements"]): row for row in own if row["family"] == "graded mesh"}
    pairs = []
    for row in of_peers:
        mesh = row["kind"], row["elements"]
        is_graded = not row.get("even") and not row.get("layers")
        if (
            is_graded
            and row["pressure_error"] <= LARGEST_COMPARED_PEER_PRESSURE_ERROR
            and mesh in meshes
        ):
            pairs.append((row, meshes[mesh]))
    return pairs


def _fastest_row_within_pressure_error(
    rows: Sequence[MethodResultRow], target: float, floors: ReferenceUncertaintyByErrorKey
) -> MethodResultRow | None:
    """The row of the fastest solve with an error of the pressure below a target, or None."""
    return next(iter(fastest_rows_within_error(rows, "pressure_error", target, floors)), None)
