"""What every figure must be: as wide as one or two columns, legible, with nothing cut off."""

from __future__ import annotations

import itertools

from matplotlib.figure import Figure
from matplotlib.text import Text

#: widths in mm, and the smallest text in points
WIDTHS, SMALLEST = (85.0, 178.0), 7.0


def check(figure: Figure) -> None:
    """Draw `figure`, and see that its text is large enough, lies within, and that no two numbers of
    an axis overlap.
    """
    figure.draw_without_rendering()
    width = 25.4 * figure.get_figwidth()
    assert min(abs(width - each) for each in WIDTHS) < 0.1
    for text in figure.findobj(Text):
        if not text.get_visible() or not text.get_text().strip():
            continue
        assert text.get_fontsize() >= SMALLEST, text
    for text in (*figure.texts, *(t for axes in figure.axes for t in _told(axes))):
        if text.get_visible() and text.get_text().strip():
            box = text.get_window_extent()
            assert box.x0 > -1, text
            assert box.x1 < figure.bbox.x1 + 1, text
            assert box.y0 > -1, text
            assert box.y1 < figure.bbox.y1 + 1, text
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            boxes = [
                tick.label1.get_window_extent()
                for tick in axis.get_major_ticks()
                if low <= tick.get_loc() <= high
                and tick.label1.get_visible()
                and tick.label1.get_text()
                and tick.label1.get_rotation() == 0
            ]
            for one, two in itertools.pairwise(boxes):
                assert not one.overlaps(two), (axes.get_title(), axis.get_label_text())


def _told(axes):
    """Title, labels and notes of axes."""
    return (axes.title, axes.xaxis.label, axes.yaxis.label, *axes.texts)
