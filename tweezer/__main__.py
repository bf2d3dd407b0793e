"""`python -m tweezer`: the command line."""

from tweezer.cli import main

main()
