"""The result of every model: a Response with a ShoeResponse for each shoe.

The package also derives figures of merit, resultants, balances and distances from responses. It
imports the brake and nothing that computes a response.
"""

from drumlin.response.response import EDGE_ZONE, Balance, Response, ShoeResponse

__all__ = ["EDGE_ZONE", "Balance", "Response", "ShoeResponse"]
