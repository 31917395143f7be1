"""Tests of drumlin: random brakes, known answers, run times, true errors and broken inputs.

Only studies and tests import this package. It imports `drumlin`, and no module of `drumlin` imports
it.
"""
