"""Fuzzing: random broken brake files, meshes, tables and command lines, and checks of how runs end.

These modules run drumlin's command line on broken inputs. drumlin itself does not import them.
"""
