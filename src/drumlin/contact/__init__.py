"""Unilateral contact with friction, as complementarity problems on plain arrays.

The module `equations` factorises the linear equations of a contact set. `active_set` finds the
contact set in full slip. `stick_slip` follows stick and slip, one load increment at a time.
`self_locking` finds the friction coefficient at which the equilibrium ends.

This package knows nothing of brakes or meshes, and imports nothing of drumlin but `drumlin.base`.
"""
