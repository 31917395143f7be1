"""drumlin: shoe brakes by the pressure laws and by finite elements in frictional contact, side by side."""

__version__ = "0.1.0"
