"""Unilateral contact with friction, as complementarity problems on plain arrays.

The module `equations` factorises the linear equations of a contact set. `active_set` finds the
nodes in contact if all of them slip, and `pressure_friction` does the same for a friction
coefficient that depends on the pressure. `stick_slip` finds which nodes stick and which slip, one
load increment after the other. `self_locking` finds the friction coefficient above which there is
no equilibrium.

This package knows nothing of brakes or meshes, and imports nothing of drumlin but `drumlin.base`.
"""
