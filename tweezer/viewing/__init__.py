"""Interactive pages: one HTML file each, with an animation and a picture to rotate.

`content.py` defines the content of a page, `of_run.py` and its neighbours derive it from a result,
and `page.py` combines it with the scripts in `static/`. `kinds.py` chooses the module for a kind of
result. `arrays.py` encodes numbers as text and measures the rounding error.
"""

from tweezer.viewing.look import view
from tweezer.viewing.page import Page

__all__ = ["Page", "view"]
