"""What misfit makes of a brake: one at a time, over a turn of the drum, and drawn from tolerances;
rows of tables.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.brake import Brake
from drumlin.brake.clearance import ground_to, set_off
from drumlin.brake.file import vary
from drumlin.response.norms import relative
from drumlin.response.response import Response
from drumlin.sweeps.cases import Row, row_of
from drumlin.sweeps.tolerances import PERCENTILES, ManufacturingTolerance, Shares, numbers, spread

DRAWN_QUANTITIES = {
    "torque": "torque [N m]",
    "brake_factor": "brake factor T/(F R)",
    "peak_pressure": "peak pressure [MPa]",
}
STATES = ("new", "worn in")
LOBES = {"run-out": 1, "oval": 2, "three lobes": 3, "five lobes": 5}  # orders
EXPANSION, WARMING = 11e-6, 100.0  # of the drum [1/K], [K]


def single_rows(
    brake: Brake, law: Response, solve: Callable[[Brake], Response]
) -> list[dict[str, Any]]:
    """One misfit at a time, against the lining that fits and against the law."""
    fits = solve(brake)
    growth = clearance.thermal_growth(brake.size, EXPANSION, WARMING)

    def stepped(depth: float) -> dict[str, Any]:
        return {
            f"shoe[{i}].lining.misfit.blocks": [[shoe.lining.middle, depth * shoe.frame.sense]]
            for i, shoe in enumerate(brake.shoes)
        }

    hot = {"drum.out_of_round": [{"order": 0, "amplitude": growth}]}
    several: Mapping[str, Mapping[str, Any]] = {
        "fits": {},
        "linings 50 µm larger in radius": ground_to(brake, 50e-6),
        "linings 50 µm smaller in radius": ground_to(brake, -50e-6),
        "linings moved 50 µm along the pin's radius, outwards": set_off(brake, 50e-6),
        "linings moved 50 µm along the pin's radius, inwards": set_off(brake, -50e-6),
        "taper: 50 µm thinner away from the pin": {"shoe.lining.misfit.taper": 50e-6},
        "taper: 50 µm thicker away from the pin": {"shoe.lining.misfit.taper": -50e-6},
        "two blocks: the one away from the pin 20 µm lower": stepped(20e-6),
        "two blocks: the one away from the pin 20 µm higher": stepped(-20e-6),
        f"drum {WARMING:g} K hotter than the shoes: {growth * 1e6:.0f} µm larger": hot,
    }
    rows = []
    for name, changes in several.items():
        response = solve(vary(brake, changes))
        peak = max(shoe.peak_pressure for shoe in response.shoes)
        rows.append(
            {
                "misfit": name,
                "torque": response.torque,
                "from_fit": relative(response.torque, fits.torque),
                "from_law": relative(response.torque, law.torque),
                "peak": peak,
                "peak_from_law": relative(peak, max(shoe.peak_pressure for shoe in law.shoes)),
                "touching": touching(brake, response),
            }
        )
    return rows


def touching(brake: Brake, response: Response) -> float:
    """The part of all linings that touches."""
    arcs = sum(end - start for shoe in response.shoes for start, end in shoe.contact_arcs)
    return arcs / sum(shoe.lining.end - shoe.lining.start for shoe in brake.shoes)


def turn_torques(
    brake: Brake, solve: Callable[[Brake], Response], amplitude: float, angles: Sequence[float]
) -> dict[str, Floats]:
    """Torque [N m] (angles,) as a drum with lobes of the amplitude [m] stands at the angles [rad],
    by their names.
    """
    found = {}
    for name, order in LOBES.items():
        lobed = vary(brake, {"drum.out_of_round": [{"order": order, "amplitude": amplitude}]})
        responses = clearance.one_turn(lobed, solve, angles)
        found[name] = np.array([response.torque for response in responses])
    return found


def peak_to_valley(torques: Mapping[str, Floats]) -> dict[str, float]:
    """The range of each torque over one turn, over its mean."""
    return {name: float(np.ptp(torque) / np.mean(torque)) for name, torque in torques.items()}


def over_law(
    rows: Sequence[Row], brake: Brake, law: Response, shape: tuple[int, int]
) -> dict[str, Floats]:
    """Torque and peak pressure of rows over those of the law, minus 1, as maps of a shape."""
    nominal = row_of(brake, law)
    return {
        name: numbers(rows, name).reshape(shape) / nominal[name] - 1
        for name in ("torque", "peak_pressure")
    }


@dataclass(frozen=True)
class DrawnBrakes:
    """Brakes drawn from tolerances: rows by state ("new", "worn in", "law": the same brakes by the
    sine law).

    The first 2 n rows of each state are the independent samples A and B of `tolerances.draw`.
    """

    rows: Mapping[str, Sequence[Row]]
    n: int

    def sample(self, state: str, name: str) -> Floats:
        """A quantity of the independent samples (2 n,); pressures in MPa."""
        values = numbers(self.rows[state][: 2 * self.n], name)
        return values * 1e-6 if name == "peak_pressure" else values

    def off_law(self, state: str) -> Floats:
        """Torque of each drawn brake over the torque of the sine law for that very brake (2 n,)."""
        ratio: Floats = self.sample(state, "torque") / self.sample("law", "torque")
        return ratio

    def law_error(self, state: str) -> tuple[float, float]:
        """The error of the law's torque against the brake's, as a fraction: 5th and 95th
        percentile.
        """
        low, high = np.percentile(1 / self.off_law(state), (5, 95))
        return low - 1, high - 1

    def relative_spread(self, state: str) -> float:
        """Standard deviation of the torque over its mean."""
        return spread(self.sample(state, "torque")).relative

    def peaks_over(self, pressure: float) -> tuple[float, float]:
        """Mean and 95th percentile of the new brakes' peak pressure over a pressure [MPa]."""
        peaks = self.sample("new", "peak_pressure") / pressure
        return float(peaks.mean()), float(np.percentile(peaks, 95))

    def healed_variance(self) -> float:
        """The share of the torque's variance that run-in takes away: all but friction, force,
        levers and the drum.
        """
        new, worn = (spread(self.sample(state, "torque")).deviation for state in STATES)
        return 1 - (worn / new) ** 2


def nominal(brake: Brake, law: Response) -> dict[str, float]:
    """What the law says of the nominal brake, as `Drawn.sample` has it."""
    row = row_of(brake, law)
    return {name: row[name] * (1e-6 if name == "peak_pressure" else 1) for name in DRAWN_QUANTITIES}


def spread_rows(drawn: DrawnBrakes) -> list[dict[str, Any]]:
    """Distributions as rows; the last ones: torque over that of the sine law for the same friction,
    force and pins.
    """
    values = {
        (DRAWN_QUANTITIES[name], state): drawn.sample(state, name)
        for name in DRAWN_QUANTITIES
        for state in (*STATES, "law")
    }
    for state in STATES:
        values["torque over the sine law's of the same brake", state] = drawn.off_law(state)
    rows = []
    for (quantity, state), sample in values.items():
        found = spread(sample)
        row: dict[str, Any] = {
            "quantity": quantity,
            "state": state if state != "law" else "sine law",
        }
        row |= {"mean": found.mean, "deviation": found.deviation, "relative": found.relative}
        rows.append(
            row | {f"p{k}": value for k, value in zip(PERCENTILES, found.percentiles, strict=True)}
        )
    return rows


def share_rows(
    tolerances: Sequence[ManufacturingTolerance],
    shares: Mapping[str, Mapping[str, Sequence[Shares]]],
) -> list[dict[str, Any]]:
    """Total Sobol indices as rows; shares: by state and quantity."""
    return [
        {"name": tolerance.name}
        | {
            f"{state}_{name}": found[name][i].total.value
            for state, found in shares.items()
            for name in DRAWN_QUANTITIES
        }
        for i, tolerance in enumerate(tolerances)
    ]


def healed_after(distances: Sequence[float], torque: Floats, within: float) -> float:
    """The distance from which on the 5th, 50th and 95th percentile of torque (brakes, distances)
    stay within a fraction of their last values.
    """
    ends = np.percentile(torque, (5, 50, 95), axis=0)
    off = np.abs(ends / ends[:, -1:] - 1).max(axis=0)
    return next(s for k, s in enumerate(distances) if off[k:].max() < within)
