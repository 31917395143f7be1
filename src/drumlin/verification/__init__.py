"""What judges drumlin from outside: a second solver that shares nothing with its finite elements but the brake."""
