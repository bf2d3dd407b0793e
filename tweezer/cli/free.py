"""What the command calibrate prints of a bead that is not trapped."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tweezer.cli.console import OUT

if TYPE_CHECKING:
    from tweezer.analysis import Diffusion


def print_free(free: Diffusion, unit: str) -> None:
    """One line of verdict; below it what was left out and what speaks against it."""
    from tweezer.analysis.wording import diffusion_in_words

    OUT.print(diffusion_in_words(free, unit), highlight=False, soft_wrap=True)
    for text in (*free.remarks, *(f"not trusted: {each.text}" for each in free.findings)):
        OUT.print(f"   {text}", highlight=False, soft_wrap=True)
