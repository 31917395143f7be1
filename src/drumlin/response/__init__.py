"""What every model returns: one Response with a ShoeResponse a shoe, its figures of merit,
resultants and distances.

Imports the brake and nothing that computes one.
"""

from drumlin.response.response import EDGE_ZONE, Balance, Response, ShoeResponse

__all__ = ["EDGE_ZONE", "Balance", "Response", "ShoeResponse"]
