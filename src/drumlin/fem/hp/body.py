"""The condensed body of a parametric shoe of columns, as contact, sweeps and wear need it."""

from functools import partial
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf, dtrtrs, solve_lower
from drumlin.brake.brake import Shoe
from drumlin.fem.hp import shoe as shoes
from drumlin.fem.hp.division import ShoeDivision
from drumlin.fem.hp.grid import Block, ColumnGrid
from drumlin.fem.hp.shoe import EndLoads, LoadedEnd, line_of, unit_actuations
from drumlin.fem.substructure.body import FRAME, CondensedBody, Constraints, InnerSystem, constrain
from drumlin.fem.substructure.elasticity import layers_of
from drumlin.fem.substructure.elimination import SINGULAR_BODY
from drumlin.fem.substructure.interface import ContactLine
from drumlin.response.response import own_edge_zone


def grid_of(shoe: Shoe, radius: float, div: ShoeDivision) -> ColumnGrid:
    """All nodes and elements of a shoe, with the sets "hinge" and, if it is elastic, "actuation".

    The nodes of a set stand from the lining's side on.
    """
    p, first, layers = div.degree, div.first, div.layers
    depth, along = line_of(div.depths, p), line_of(div.angles, p)
    rows, n = len(depth), len(along)
    under = np.arange(rows * n).reshape(rows, n)
    blocks, count = [Block(under, depth, along, div.part)], rows * n
    # The faces at which the body continues beyond the lining, before and behind it.
    faces = [under[first * p :, 0], under[first * p :, -1]]
    if first == layers:
        return ColumnGrid(p, tuple(blocks), shoes.map_of(shoe, radius), {"hinge": under[-1]}, count)
    for k, ends in enumerate((div.before, div.after)):
        if len(ends) == 1:
            continue
        places = line_of(ends, p)
        inner = np.arange(count, count + (rows - first * p) * (len(places) - 1)).reshape(
            rows - first * p, -1
        )
        count += inner.size
        nodes = np.concatenate([faces[k][:, None], inner], axis=1)
        blocks.append(Block(nodes, depth[first * p :], places, div.part[first:]))
        faces[k] = inner[:, -1]
    grip = shoe.grip(radius)
    if grip is None:
        sets = {"hinge": faces[0], "actuation": faces[1]}
    else:
        sets = {"hinge": under[-1, (along > grip[0] - 1e-9) & (along < grip[1] + 1e-9)]}
    return ColumnGrid(p, tuple(blocks), shoes.map_of(shoe, radius), sets, count)


def condensed(
    shoe: Shoe,
    div: ShoeDivision,
    found: shoes.CondensedShoe,
    line: ContactLine,
    grid: ColumnGrid,
    end_loads: EndLoads = unit_actuations,
) -> CondensedBody:
    """The condensed body that `shoe.condense` has found.

    Parameters
    ----------
    shoe, div : the shoe and its division
    found : the condensed shoe, with unit loads of `end_loads`
    line : contact line of the shoe
    grid : all nodes and elements of the shoe
    end_loads : makes the unit loads on the loaded end

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    S, loads = found.S, found.loads
    L, info = dpotrf(S[FRAME:, FRAME:], lower=1)
    if info:
        raise NoAnswer(SINGULAR_BODY)
    L_fc = solve_lower(L, S[FRAME:, :FRAME]).T
    # The forces that round-off leaves on the rigid-body modes move the contact.
    half_error = solve_lower(L, found.rigid_mode_forces)
    rigid_mode_error = dtrtrs(L, half_error, lower=1, trans=1)[0]
    return CondensedBody(
        L,
        L_fc,
        load_on_contact=loads[FRAME:],
        load_on_frame=loads[:FRAME],
        load_work=found.work,
        inside=partial(_inside, shoe, div, grid, end_loads),
        recover=partial(_recovered, shoe, div, grid, end_loads),
        columns=found.columns,
        force_imbalance=found.force_imbalance,
        rigid_mode_error=rigid_mode_error,
    )


def _inside(shoe: Shoe, div: ShoeDivision, grid: ColumnGrid, end_loads: EndLoads) -> InnerSystem:
    """The whole system of a shoe."""
    K = grid.stiffness(layers_of(shoe))
    constraints = constrain(grid, np.arange(div.contact_nodes), grid.sets["hinge"], shoe.own_pin)
    return _reduced(K, constraints, _on_nodes(div, grid, end_loads))


def _recovered(
    shoe: Shoe,
    div: ShoeDivision,
    grid: ColumnGrid,
    end_loads: EndLoads,
    nodal: Floats,
    frame: Floats,
    loads: Floats,
) -> Floats:
    """The displacements of `CondensedBody`, with the insides of elements eliminated one by one."""
    layers, sides = layers_of(shoe), grid.skeleton
    constraints = constrain(
        sides, sides.place[: div.contact_nodes], sides.place[grid.sets["hinge"]], shoe.own_pin
    )
    load = _on_nodes(div, grid, end_loads)
    inside = _reduced(
        sides.stiffness(layers), constraints, None if load is None else load[sides.dofs]
    )
    return sides.everywhere(layers, inside.displacements(nodal, frame, loads))


def end_load_of(div: ShoeDivision, grid: ColumnGrid) -> tuple[Floats, Floats]:
    """Nodal forces (2 N, 3) of the unit actuations on the loaded end, and its centre (2,) [m]."""
    end = _loaded_end(div, grid, unit_actuations)
    return _spread(grid, end.forces), end.centre


def _loaded_end(div: ShoeDivision, grid: ColumnGrid, end_loads: EndLoads) -> LoadedEnd:
    """The unit loads on the nodes of the loaded end."""
    depths = line_of(div.depths[div.first :], div.degree)
    return end_loads(grid.doflocs[:, grid.sets["actuation"]], depths, div.degree)


def _spread(grid: ColumnGrid, forces: Floats) -> Floats:
    """Nodal forces (2 N, l) of the whole grid, from those (2n, l) on the loaded end."""
    nodes, count = grid.sets["actuation"], forces.shape[1]
    full = np.zeros((grid.N, 2, count))
    full[nodes] = forces.reshape(-1, 2, count)
    return full.reshape(-1, count)


def _on_nodes(div: ShoeDivision, grid: ColumnGrid, end_loads: EndLoads) -> Floats | None:
    """Nodal forces (2 N, l) of all unit loads; None where they act on the frame."""
    if "actuation" not in grid.sets:
        return None
    return _spread(grid, _loaded_end(div, grid, end_loads).forces)


def _reduced(K: Any, constraints: Constraints, load: Floats | None) -> InnerSystem:
    """The whole system on reduced unknowns.

    Parameters
    ----------
    K : (2 nodes, 2 nodes) stiffness
    constraints : the reduced unknowns
    load : (2 nodes, l) unit loads; with None the three unit actuations act on the frame
    """
    if load is None:
        loads = np.zeros((constraints.matrix.shape[1], FRAME))
        loads[-FRAME:] = np.eye(FRAME)
    else:
        loads = constraints.matrix.T @ load
    return InnerSystem((constraints.matrix.T @ K @ constraints.matrix).tocsc(), constraints, loads)


def contact_line(shoe: Shoe, radius: float, div: ShoeDivision) -> ContactLine:
    """The contact line of a divided shoe; its nodes come first in the grid."""
    p = div.degree
    phi = line_of(div.angles, p)
    m = len(div.angles) - 1
    pieces = np.arange(m) * p + np.arange(p + 1)[:, None]
    return ContactLine(
        np.arange(len(phi)),
        shoe.at(np.zeros(1), phi, radius),
        phi,
        pieces,
        edge=own_edge_zone(shoe, radius),
    )
