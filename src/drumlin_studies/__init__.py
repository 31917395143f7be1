"""What judges drumlin: random brakes, ladders of known answers, error against run time, true errors
and broken inputs.

Only studies and tests import this package. It stands on `drumlin`, and nothing in `drumlin` stands
on it.
"""
