"""Runs as datasets: variables, required contents of each kind of result, and files."""
