"""Where the contact ends, inside an element."""

from drumlin.arrays import Floats
from drumlin.statics import integrate


def contact_arcs(theta: Floats, pressure: Floats, order: int) -> tuple[tuple[float, float], ...]:
    """Arcs [rad] in which the lining is pressed; theta (n,) [rad], pressure (n,) [Pa], piecewise of degree `order`.

    Nodes next to a pressed one belong to its arc; an end without pressure is then located within its step.
    """
    pressed = pressure > 0
    steps = pressed[:-1] | pressed[1:]
    last = len(theta) - 1
    arcs = []
    for i in range(last):
        if steps[i] and not (i and steps[i - 1]):
            start = i
        if steps[i] and not (i + 1 < last and steps[i + 1]):
            first = _end(theta, pressure, start, order)
            arcs.append((first, -_end(-theta[::-1], pressure[::-1], last - i - 1, order)))
    return tuple(arcs)


def _end(theta: Floats, pressure: Floats, node: int, order: int) -> float:
    """The end between `node` and the next one of an arc that begins at `node`.

    The pressure of a smooth contact falls to its end e as sqrt(theta - e), so that F = Int_e p dtheta has
    F^(2/3) linear in theta: the line through its values at the ends of the first two elements gives e. Integrals
    of the pressure scatter far less than its nodal values.
    """
    i = node // order * order
    if pressure[node] > 0 or i + 2 * order >= len(theta):
        return float(theta[node])
    near, far = i + order, i + 2 * order
    f = [integrate(theta[i : k + 1], pressure[i : k + 1], order) ** (2 / 3) for k in (near, far)]
    if f[1] <= f[0]:
        return float(theta[node])
    end = theta[near] - f[0] * (theta[far] - theta[near]) / (f[1] - f[0])
    return float(min(max(end, theta[node]), theta[node + 1]))
