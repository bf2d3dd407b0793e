"""Pages to look at: one file of HTML each, with time to play and the picture to turn.

`content.py` says what a page shows, `of_run.py` and its neighbours make that of a result, and
`page.py` puts it together with the scripts of `static/`. `kinds.py` has the table of kinds. Numbers
travel as text in `arrays.py`, which measures what their rounding changes.
"""

from tweezer.viewing.look import view
from tweezer.viewing.page import Page

__all__ = ["Page", "view"]
