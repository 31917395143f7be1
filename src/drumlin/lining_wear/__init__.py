"""Wear of linings: running a brake in by Archard's law, and solving a brake with worn-in linings.

The module `archard` wears linings in steps, each of which is a contact problem. The module
`linings` makes these contact problems from a brake, by finite elements or the foundation model. The
modules `run_in` and `whole_brake` run a brake in and report on the run. The module `worn_in` finds
the state in which wear ends without the steps before.
"""
