"""Tables of friction over the pressure, and brakes that have them."""

from typing import Any

from drumlin.brake.file import vary

FALLING: dict[str, Any] = {"pressure": ["0 MPa", "1 MPa"], "mu": [0.45, 0.3]}
KINKED: dict[str, Any] = {"pressure": ["0 MPa", "0.3 MPa", "1 MPa"], "mu": [0.4, 0.42, 0.25]}
EVEN = {"pressure": ["0 MPa", "1 MPa"], "mu": [0.35, 0.35]}


def over_pressure(brake, table=FALLING, **changes):
    """The brake with a table of friction over the pressure, and with further changes."""
    return vary(brake, {"friction": table} | changes)
