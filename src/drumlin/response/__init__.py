"""The result of every model: a Response with a ShoeResponse per shoe, and values derived from them.

Figures of merit, resultants, balances and distances between responses are derived from a response.
The package imports the brake and nothing that computes a response.
"""

from drumlin.response.response import EDGE_ZONE, Balance, Response, ShoeResponse

__all__ = ["EDGE_ZONE", "Balance", "Response", "ShoeResponse"]
