"""Unilateral contact with friction as complementarity problems on arrays: full slip (`active_set`),
stick and slip increment by increment (`stick_slip`), and the friction at which no equilibrium is
left (`self_locking`).

Knows nothing of brakes or meshes and imports nothing of drumlin but errors and arrays.
"""
