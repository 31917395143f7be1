"""What judges drumlin: random brakes, known answers, run times, true errors and broken inputs.

Only studies and tests import this package. It stands on `drumlin`, and nothing in `drumlin` stands
on it.
"""
