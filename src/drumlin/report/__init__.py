"""Figures, field pictures and HTML pages. The imports of heavy libraries stay in this package."""
