"""The command line: commands in `main`, what a person at the terminal sees in `terminal`."""
