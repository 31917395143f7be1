"""The result of every model: a Response for the brake with a ShoeResponse for each shoe.

Other modules of the package compute figures of merit, resultants, imbalances and differences from
responses. The package imports `drumlin.brake`, but no model that computes a response.
"""

from drumlin.response.response import (
    UNCOMPARED_EDGE_ZONE_IN_RADIANS,
    ForceAndMomentImbalance,
    Response,
    ShoeResponse,
)

__all__ = ["UNCOMPARED_EDGE_ZONE_IN_RADIANS", "ForceAndMomentImbalance", "Response", "ShoeResponse"]
