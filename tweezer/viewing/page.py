"""A page: one HTML file with everything it needs, made from a `Content`."""

from __future__ import annotations

import base64
import html
import json
import re
import tempfile
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tweezer.values.errors import ResultError
from tweezer.values.files import replacing
from tweezer.values.saved import SHOWN, check_ending
from tweezer.values.signs import typeset
from tweezer.values.version import __version__
from tweezer.viewing.content import Content

_STATIC = Path(__file__).with_name("static")
_THREE = "vendor/three.module.min.js"
#: Common files of pages, by the names under which JavaScript modules import them
_MODULES = {
    "three": _THREE,
    **{
        f"tweezer/{name}": f"{name}.js"
        for name in ("shell", "stage", "flat", "clock", "plot", "chart", "field", "arrays")
    },
}
_STYLES = ("page.css", "chart.css")
#: Height of a page in a notebook, pixels
_HEIGHT = 760


@dataclass(frozen=True)
class Page:
    """An interactive page: one HTML file that requires no server and no network."""

    content: Content
    """what the page shows"""

    @property
    def html(self) -> str:
        """The whole page as HTML text."""
        from jinja2 import Environment, StrictUndefined

        kind = self.content.kind
        modules = {**_MODULES, "tweezer/kind": f"{kind}.js"}
        imports = {name: _address(_STATIC / path) for name, path in modules.items()}
        styles = [*_STYLES, *(f"{kind}.css",) * (_STATIC / f"{kind}.css").exists()]
        environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
        template = environment.from_string(_text(_STATIC / "page.html"))
        page = template.render(
            title=typeset(self.content.title),
            version=__version__,
            licence=_text(_STATIC / "vendor/LICENSE").strip(),
            styles="\n".join(_text(_STATIC / name) for name in styles),
            imports=_in_script({"imports": imports}),
            content=_in_script(_as_json(self.content)),
        )
        # lone surrogates, as in file names that are not UTF-8, become the replacement character
        return re.sub("[\ud800-\udfff]", "\N{REPLACEMENT CHARACTER}", page)

    def save(self, path: str | Path) -> Path:
        """Write the page to a file, replacing a page that exists.

        Parameters
        ----------
        path : str or Path
            Name of the file, ending in .html.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        ResultError
            If it cannot be written, or its name does not end in .html.
        """
        path = Path(path)
        check_ending(path, ("html",))
        with replacing(path) as whole:
            whole.write(self.html.encode())
        return path

    def open(self) -> Path:
        """Show the page in a browser; return the path of the temporary file that it opens."""
        folder = Path(tempfile.mkdtemp(prefix="tweezer-"))
        path = self.save(folder / f"{self.content.kind}.html")
        webbrowser.open(path.as_uri())
        return path

    def _repr_html_(self) -> str:
        """Return the page in a frame, for display in Jupyter."""
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" title="{html.escape(self.content.title)}" '
            f'style="width: 100%; height: {_HEIGHT}px; border: 0" allowfullscreen></iframe>'
        )

    def __repr__(self) -> str:
        return f"Page({self.content.kind!r}, {self.content.title!r})"


def _as_json(content: Content) -> dict[str, Any]:
    """Return the content of a page as a JSON object for its JavaScript."""
    return {
        "kind": content.kind,
        "shows": next(kind.told for kind in SHOWN if kind.name == content.kind),
        "title": typeset(content.title),
        "warning": typeset(content.warning),
        "facts": content.facts,
        "arrays": {name: packed.as_json() for name, packed in content.arrays.items()},
        "summary": [row._asdict() | {"value": typeset(row.value)} for row in content.summary],
        "notes": [typeset(note) for note in content.notes],
        "version": __version__,
    }


def _in_script(value: object) -> str:
    """Return a value as JSON for a script in HTML.

    The character `<`, which could end the script, is escaped. Raises `ResultError` for numbers that
    are not finite.
    """
    try:
        text = json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    except ValueError:
        raise ResultError("contains a number that is not finite and cannot be shown") from None
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _address(path: Path) -> str:
    """Return a data URL that contains a script, so that the page requires no other file."""
    return "data:text/javascript;base64," + base64.b64encode(path.read_bytes()).decode()


def _text(path: Path) -> str:
    """Return the text of a UTF-8 file."""
    return path.read_text(encoding="utf-8")
