"""Broken brake files, meshes, tables and command lines, and checks of how drumlin ends on them.

These modules attack drumlin's command line and import it. No other package imports these modules.
"""
