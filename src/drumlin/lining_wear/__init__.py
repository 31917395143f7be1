"""Wear of linings: running a brake in by Archard's law, and solving a brake with worn-in linings.

The module `archard` wears linings in steps of sliding distance, and each step solves contact
problems. The module `linings` makes these contact problems from a brake, by finite elements or the
foundation model. The modules `run_in` and `whole_brake` run a brake in and report on the run. The
module `worn_in` computes the worn-in state directly, without wear steps.
"""
