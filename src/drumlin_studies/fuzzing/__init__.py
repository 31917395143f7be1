"""Broken inputs and a judge of how the command line ends on them: brake files, meshes, tables,
command lines.

Stands above the command line, which it attacks; nothing stands on it.
"""
