"""Fuzzing: random broken brake files, meshes, tables and command lines are given to drumlin.

These modules run drumlin's command line on broken inputs, and judge how the runs end. drumlin
itself does not import these modules.
"""
