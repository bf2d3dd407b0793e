"""Generated parts of the site: notebooks, scene keys, commands, and formulas as MathML.

Figures of notebooks become files, with the alternative text that the metadata of their cells
contain. The gallery shows each shipped scene with its interactive page, which `plays.py` makes in
the background. If TWEEZER_PLAYS is set, the gallery contains only the scenes that it names.

mkdocs calls this module (`hooks` in mkdocs.yml).
"""

from __future__ import annotations

import base64
import hashlib
import html
import itertools
import json
import logging
import os
import re
import struct
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import griffe
from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from tweezer.scene import Scene
from tweezer.scene.sections import ALTERNATIVES, BELONGING

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted(f"notebooks/{path.name}" for path in (ROOT / "notebooks").glob("*.ipynb"))
#: shipped scenes; those of the thesis, which come first by their names otherwise, last
SCENES = sorted(
    (ROOT / "tweezer/scenes").glob("*.toml"), key=lambda path: ("thesis" in path.stem, path)
)
#: the folder of their pages, in the site
PLAYS = "plays"
#: weights of pages in the search, by the tab of the navigation; 1 for the others
SEARCHED = {"Start": 4, "Guides": 4, "API": 0.1, "Evidence": 0.3}
#: pages that are no files of docs/
ELSEWHERE = ("CHANGELOG.md", "CONTRIBUTING.md", "derivation/README.md", *NOTEBOOKS)

_log = logging.getLogger("mkdocs.hooks.tweezer")  # a warning fails a strict build

#: page that lists all commands
INDEX = "commands.md"
#: pages of the commands: title and commands
COMMANDS = {
    "commands-runs.md": (
        "Commands for runs and traps", "new scenes run view trap detect optimise tune"
    ),
    "commands-series.md": (
        "Commands for ensembles and sweeps", "ensemble sweep rotation stretch compare"
    ),
    "commands-recordings.md": (
        "Commands for recordings", "examples calibrate rheology fit fit-depth"
    ),
    "commands-machine.md": (
        "Commands for caches and checks", "reproduce map warmup info cache bench"
    ),
}  # fmt: skip
#: pages of the keys of a scene: title and sections
KEYS = {
    "scenes.md": ("Scene files", "bead tether medium heat lens beam"),
    "scenes-motion.md": (
        "Scene files: motion and computation",
        "start wall mirror forces camera detector lock_in feedback optics simulation",
    ),
}  # fmt: skip

#: Pages that are generated from a source file, by its path; links in docs/ use this path
MADE = {
    "tweezer/scene/scene.py": "scenes.md", "tweezer/cli/": INDEX,
    "tweezer/scenes/": "gallery.md",
}  # fmt: skip

#: code, and its copy that a button takes
_CODE = (
    r"<(?P<tag>pre|code|script|style)\b.*?</(?P=tag)>"
    r'|<div class="clipboard-copy-txt".*?</div>'
)
#: a cell that answers an exercise, which is folded, up to the text that follows it
_ANSWER = re.compile(
    r'(<div class="jp-Cell [^"]*celltag_answer[^"]*">.*?)(?=<div class="jp-Cell jp-MarkdownCell)',
    flags=re.DOTALL,
)
#: code as it is; formulas of pages, between brackets by arithmatex; of notebooks, between dollars
_FORMULA = re.compile(
    rf"(?P<code>{_CODE})"
    r'|<div class="arithmatex">\\\[(.+?)\\\]</div>|\$\$(.+?)\$\$'
    r'|<span class="arithmatex">\\\((.+?)\\\)</span>|\$(?! )([^$]+?)(?<! )\$',
    re.DOTALL,
)
_DRAWN = re.compile(rf"{_CODE}|<math\b.*?</math>", re.DOTALL)
#: what MathML spaces otherwise than TeX: names of functions, bars, slashes, a sign
_SPACING = (
    (r"<(m[io])[^>]*>(sin|cos|tan|exp|det)</\1>", r'<mo lspace=".17em" rspace=".1em">\2</mo>'),
    (r'<mo stretchy="false">(&#x0007C;)</mo>', r"<mi>\1</mi>"),
    (r"<mo>(&#x0002F;)</mo>", r'<mo lspace="0" rspace="0">\1</mo>'),
    (r"(?<=&#x00(?:03D|02C|028);</mo>)<mo>(&#x02212;)</mo>", r'<mo form="prefix">\1</mo>'),
)
#: browsers draw its letters, not the attribute
_BOLD_GREEK = re.compile(r'(?<=<mi) mathvariant="bold-italic">&#x00(3[BC][0-9A-F]);')

#: beginnings of the names of pages with tables of numbers, which scroll on a phone; others stack
NUMBERS = ("evidence-", "fluid.md", "physics.md", "scaling.md")
_TABLE = re.compile(r"<table>\n<thead>.*?</table>", re.DOTALL)

#: code of a notebook with its prompts and buttons, which the search ignores
_INPUT = re.compile(
    r'<clipboard-copy|<pre(?=><span></span>)|<div class="(?:jp-\w+Prompt |clipboard-copy-txt)[^"]*"'
)
#: figures within a notebook, which nbconvert gives no text
_FIGURE = re.compile(r'<img alt="[^"]*"([^>]*?) src="data:image/png;base64,([^"]*)"')


def on_config(config: MkDocsConfig) -> None:
    """List the pages that are made here, and the notebooks, in the navigation."""
    made = {"Notebooks": NOTEBOOKS, "Scene files": [*KEYS], "Command line": [INDEX, *COMMANDS]}
    for tab in config.nav:
        for entries in tab.values():
            for section in entries:
                if isinstance(section, dict):
                    section.update({name: made[name] for name in section if name in made})


def on_post_build(config: MkDocsConfig) -> None:
    """Wait for the pages that play."""
    if config.extra["plays"].wait():
        _log.warning("pages that play could not be made")


@event_priority(50)  # before mkdocs-jupyter looks for notebooks
def on_files(files: Files, config: MkDocsConfig) -> None:
    """Add the pages that stand elsewhere and those that are made here."""
    for path in ELSEWHERE:
        files.append(File(path, str(ROOT), config.site_dir, config.use_directory_urls))
    plays = [sys.executable, str(ROOT / "docs/plays.py"), str(Path(config.site_dir, PLAYS))]
    names = os.environ.get("TWEEZER_PLAYS", " ".join(path.stem for path in SCENES)).split()
    config.extra["plays"] = subprocess.Popen([*plays, *names], cwd=ROOT)
    made = {"gallery.md": gallery(), **scene_reference(), **command_reference()}
    for uri, text in made.items():
        files.append(File.generated(config, uri, content=text))


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Set the weight of the page in the search, and complete the page.

    Links out of and into docs/ lead to pages of the site, and the index of the API lists its names.
    """
    page.meta["search"] = {"boost": SEARCHED.get(page.ancestors[-1].title, 1)}
    if page.file.src_uri in NOTEBOOKS:  # wider, so that they are not so long
        page.meta["hide"] = ["navigation"]
    if page.file.src_uri in ELSEWHERE:
        return markdown.replace("](docs/", "](")
    if page.file.src_uri == "api/index.md":
        markdown = with_names(markdown)
    up = "../" * page.file.src_uri.count("/")

    def on_the_site(link: re.Match[str]) -> str:
        return f"]({up}{MADE.get(link[1], link[1])}{link[2] or ''})"

    return re.sub(rf"\]\({up}\.\./(?!\.)([^)#]+)(#.*?)?\)", on_the_site, markdown)


@event_priority(50)  # before figures are made to enlarge
def on_page_content(content: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Replace LaTeX in pages and notebooks by MathML, which browsers draw without a library.

    Parameters
    ----------
    content : str
        HTML of the page.
    page : Page
        The page.
    config : MkDocsConfig
        Configuration of the site.
    files : Files
        Files of the site.
    """
    if page.file.src_uri in NOTEBOOKS:
        content = _of_a_notebook(content, page, config, files)

    def drawn(found: re.Match[str]) -> str:
        if found["code"]:
            return found[0]
        display, inline = found[3] or found[4], found[5] or found[6]
        latex = " ".join(html.unescape(display or inline).split())
        # MathML has no numbers of equations
        plain = re.sub(r"\\tag\{(.*?)\}", r"\\qquad\\text{(\1)}", latex)
        plain = re.sub(r"\\mathbf (\w)", r"\\mathbf{\1}", plain)  # for latex2mathml
        formula = convert(plain, display="block" if display else "inline")
        if "<" in (display or inline) or not _understood(formula):
            _log.warning("%s: no MathML for %s", page.file.src_uri, latex)
        for written, as_in_tex in _SPACING:
            formula = re.sub(written, as_in_tex, formula)
        formula = _BOLD_GREEK.sub(
            lambda found: ">" + chr(int(found[1], 16) + 0x1D736 - 0x3B1), formula
        )
        formula = formula.replace("<math", f'<math alttext="{html.escape(latex)}"', 1)
        return f'<div class="formula">{formula}</div>' if display else formula

    content = re.sub(r'href="(\w+)\.ipynb"', r'href="\1.html"', content)  # to the next notebook
    content = _ANSWER.sub(r"<details><summary>Answer, computed</summary>\1</details>", content)
    content = _FORMULA.sub(drawn, content)
    for dollar in re.finditer(r".{0,40}\$.{0,40}", _DRAWN.sub("", content)):
        _log.warning("%s: a formula without its end: %s", page.file.src_uri, dollar[0])
    if not page.file.src_uri.startswith(NUMBERS):
        content = _TABLE.sub(_labelled, content)

    def sized(image: re.Match[str]) -> str:
        path = ROOT / "docs" / image[1]  # mkdocs reports a missing file
        return f"<img {_size(path.read_bytes())} " if path.is_file() else image[0]

    return re.sub(r'<img (?=[^>]*src="(figures/[^"]*))', sized, content)


def _size(png: bytes) -> str:
    """Attributes of an image, so that nothing moves when it is loaded."""
    return 'width="{}" height="{}"'.format(*struct.unpack(">II", png[16:24]))


def _labelled(table: re.Match[str]) -> str:
    """A table of three columns or more whose cells say what they are, for extra.css to stack."""
    names = [
        html.escape(html.unescape(re.sub(r"<[^>]*>", "", name)).strip())
        for name in re.findall(r"<th\b[^>]*>(.*?)</th>", table[0], re.DOTALL)
    ]
    if len(names) < 3:
        return table[0]
    column = itertools.cycle(names)
    return re.sub(
        r"<td([^>]*)>(.*?)</td>",
        lambda cell: f'<td data-label="{next(column)}"{cell[1]}><span>{cell[2]}</span></td>',
        table[0],
        flags=re.DOTALL,
    )


def _of_a_notebook(content: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """A notebook with figures and styles in files of the site, and how to open it.

    No cell is a stop of the keyboard, as nbconvert makes it.
    """
    name = Path(page.file.src_uri).stem
    cells = json.loads((ROOT / page.file.src_uri).read_text(encoding="utf-8"))["cells"]
    texts = [
        cell["metadata"].get("alt", "")
        for cell in cells
        for output in cell.get("outputs", [])
        if "image/png" in output.get("data", {})
    ]
    drawn = enumerate(texts, start=1)

    def apart(found: re.Match[str]) -> str:
        number, text = next(drawn)
        address = f"figures/{name}-{number}.png"
        data = base64.b64decode(found[2])
        files.append(File.generated(config, f"notebooks/{address}", content=data))
        if not text:
            _log.warning("%s: figure %d has no text", page.file.src_uri, number)
        about = f'alt="{html.escape(text)}" {_size(data)}'
        return f'<img loading="lazy" {about}{found[1]} src="{address}"'

    def shared(found: re.Match[str]) -> str:
        # each notebook brings half a megabyte of the same
        uri = f"assets/notebook-{hashlib.sha256(found[1].encode()).hexdigest()[:12]}.css"
        if files.get_file_from_path(uri) is None:
            files.append(File.generated(config, uri, content=found[1]))
        return f'<link rel="stylesheet" href="../{uri}">'

    content = re.sub(r'<style type="text/css">(.*?)</style>', shared, content, flags=re.DOTALL)
    content = _FIGURE.sub(apart, content).replace(' tabindex="0"', "")
    content = _INPUT.sub(r"\g<0> data-search-exclude", content)
    opened = (
        f'<p><a href="{name}.ipynb" download>{name}.ipynb</a> runs in Jupyter: '
        '<a href="../index.html#the-notebooks">how to open it</a>.</p>'
    )
    return re.sub(r"(</h1>)", rf"\1{opened}", content, count=1)


def _understood(formula: str) -> bool:
    """Whether all LaTeX became MathML: what latex2mathml does not know, it leaves as it is."""
    try:
        ET.fromstring(formula)
    except ET.ParseError:
        return False
    return "\\" not in formula


def gallery() -> str:
    """Return the gallery: a card for each shipped scene, with a picture of its interactive page."""
    lines = [
        "---",
        "hide: [navigation, toc]",
        "---",
        "",
        "# Gallery",
        "",
        "These scenes come with tweezer. A picture opens the [interactive page](view.md) of its "
        "scene, on which you can turn the view and drag the time. Copy the scene that resembles "
        "your experiment and change it: `tweezer scenes` prints where the files are, and "
        "[Scene files](scenes.md) describes every key.",
        "",
        '<div class="cards" markdown>',
    ]
    for path in SCENES:
        name, text = path.stem, path.read_text(encoding="utf-8")
        why = " ".join(line.removeprefix("#").strip() for line in _opening(text))
        what = tomllib.loads(text)["description"]
        lines += ["", "<div markdown>", "", f'<a href="{PLAYS}/{name}.html">']
        lines += [
            f'<img src="figures/gallery/{name}-{scheme}.webp#only-{scheme}" width="360" '
            f'height="270" loading="lazy" alt="Interactive page of {name}">'
            for scheme in ("light", "dark")
        ]
        lines += [
            "</a>", "", f"## {name}", "", f"{what[0].upper()}{what[1:]}. {why}", "",
            f'<a href="{PLAYS}/{name}.html">Interactive page</a> · '
            f"[Figure of the run](figures/gallery/{name}.png)", "",
            "```sh", f"tweezer run {name} --plot {name}.png", f"tweezer view {name}.nc", "```",
            "", "</div>",
        ]  # fmt: skip
    return "\n".join([*lines, "", "</div>"]) + "\n"


def _opening(text: str) -> list[str]:
    """The comments that a scene begins with."""
    return list(itertools.takewhile(lambda line: line.startswith("#"), text.splitlines()))


def with_names(index: str) -> str:
    """Return the index of the API with the names of each page, and what they are, below its link.

    A name is described by the first sentence of its docstring.
    """
    package = griffe.load("tweezer", search_paths=[ROOT], allow_inspection=False)

    def names(heading: re.Match[str]) -> str:
        lines = [heading[0], ""]
        text = (ROOT / "docs/api" / heading[1]).read_text(encoding="utf-8")
        for name in re.findall(r"^::: tweezer\.(\S+)$", text, re.MULTILINE):
            docstring = package[name].docstring
            first = re.split(r"(?<=\.)\s", docstring.value if docstring else "", maxsplit=1)[0]
            lines.append(f"- [`{name}`][tweezer.{name}]: {' '.join(first.split())}")
        return "\n".join(lines)

    return re.sub(r"^## \[.*\]\((\w+\.md)\)$", names, index, flags=re.MULTILINE)


def command_reference() -> dict[str, str]:
    """Return pages with each command and its options, from Typer, by their names."""
    module = [sys.executable, "-m", "typer", "tweezer.cli", "utils", "docs", "--name", "tweezer"]
    printed = subprocess.run(module, check=True, capture_output=True, text=True, cwd=ROOT).stdout
    overview, *commands = re.split(r"^(?=## )", printed, flags=re.MULTILINE)
    by_name = {re.search(r"tweezer ([\w-]+)", text)[1]: text for text in commands}
    overview = overview.replace("# `tweezer`", "# Command line", 1)
    pages = {}
    for uri, (title, names) in COMMANDS.items():
        pages[uri] = f"# {title}\n\n" + "".join(by_name.pop(name) for name in names.split())
        for name in names.split():
            overview = overview.replace(f"* `{name}`", f"* [`{name}`]({uri}#tweezer-{name})")
    if by_name:
        _log.warning("no page describes these commands: %s", ", ".join(by_name))
    return {INDEX: overview, **pages}


def scene_reference() -> dict[str, str]:
    """Return pages with each key of a scene, from the schema, by their names.

    A key has its unit, the allowed values, the default and its meaning.
    """
    schema = Scene.model_json_schema()
    named = " ".join(names for _, names in KEYS.values()).split()
    top = {
        key: of for key, of in schema["properties"].items()
        if not _section_of(of) and key not in named
    }  # fmt: skip
    tables, headings = {}, {}
    for name, of in schema["properties"].items():
        if name not in top:
            section, headings[name] = _section_of(of), f"[{name}]"
            if not section:  # a list, such as [[tether]], has its section in the items
                section, headings[name] = _section_of(of["items"]), f"[[{name}]]"
            keys = schema["$defs"][section]
            tables[name] = _section_tables(headings[name], name, keys, schema["$defs"])
    introduction = [
        "A scene is a TOML file with sections and keys. `tweezer scenes` prints the paths of the "
        "shipped scenes. A value is a number in the named unit, or text with any unit convertible "
        'to it, such as `"500 nm"`. A key without a default is required. This page is made from '
        "the schema that reads the files.", "",
        *(f"- {', '.join(f'`{headings[name]}`' for name in names.split())}: [{title}]({uri})"
          for uri, (title, names) in KEYS.items()),
        "", "## At the top", "", *_rows("", top, schema["required"]),
    ]  # fmt: skip
    pages = {}
    for uri, (title, names) in KEYS.items():
        lines = [f"# {title}", "", *(introduction if uri == "scenes.md" else [])]
        for name in names.split():
            lines += tables.pop(name)
        pages[uri] = "\n".join(lines) + "\n"
    if tables:
        _log.warning("no page describes these sections: %s", ", ".join(tables))
    return pages


def _section_tables(
    heading: str, name: str, section: dict[str, Any], definitions: dict[str, Any]
) -> list[str]:
    """Return the tables of a section and of the sections within it."""
    lines = _table(heading, name, section)
    for key, nested in section["properties"].items():
        named = f"{name}.{key}"
        if within := _section_of(nested):
            lines += _table(f"[{named}]", named, definitions[within])
        elif within := _section_of(_given(nested)[0].get("items", {})):
            lines += _table(f"[[{named}]]", named, definitions[within])
    return lines


def _table(heading: str, name: str, section: dict[str, Any]) -> list[str]:
    """The keys of a section, by their schema, under a heading."""
    rows = _rows(name, section["properties"], section.get("required", []))
    return ["", f"## `{heading}`", "", section["description"], "", *rows]


def _rows(section: str, keys: dict[str, Any], required: list[str]) -> list[str]:
    rows = ["| key | unit | allowed | default | what it is |", "| --- | --- | --- | --- | --- |"]
    for key, of in keys.items():
        unit, allowed = _kind(of)
        cells = (
            f"`{key}`", unit, allowed, "" if key in required else _default(of.get("default")),
            _cell(of["description"]) + _conditions(section, key),
        )  # fmt: skip
        rows.append("| " + " | ".join(cells) + " |")
    for key, other in ALTERNATIVES.get(section, ()):
        if other not in keys:
            rows.append(f"| `{other}` | m | | | twice `{key}`, given in its place |")
    return rows


def _conditions(section: str, key: str) -> str:
    """Return the conditions under which a key is required, as text."""
    told = ""
    for pair in ALTERNATIVES.get(section, ()):
        if key in pair:
            told += f"; exactly one of `{pair[0]}` and `{pair[1]}` is given"
    if key in BELONGING.get(section, {}):
        chooser, choices = BELONGING[section][key]
        told += f"; only with `{chooser}` = {' or '.join(f'`{choice}`' for choice in choices)}"
    return told


def _section_of(of: dict[str, Any]) -> str:
    """Name of the section that a property of a JSON schema is; nothing for others."""
    refs = [choice["$ref"] for choice in of.get("anyOf", [of]) if "$ref" in choice]
    return refs[0].rpartition("/")[2] if refs else ""


def _given(of: dict[str, Any]) -> list[dict[str, Any]]:
    """The forms that a property of a JSON schema has where it is given."""
    if "anyOf" not in of:
        return [of]
    return [form for each in of["anyOf"] if each.get("type") != "null" for form in _given(each)]


def _kind(of: dict[str, Any]) -> tuple[str, str]:
    """Unit and allowed values of a property of a JSON schema."""
    if section := _section_of(of):
        return "", f"keys of {section}"
    of, *others = _given(of)
    if others:
        units, allowed = zip(*map(_kind, (of, *others)), strict=True)
        return " or ".join(filter(None, dict.fromkeys(units))), ", or ".join(allowed)
    if "enum" in of:
        return "", ", ".join(f"`{choice}`" for choice in of["enum"])
    if of["type"] == "array":
        entries = of.get("prefixItems") or [of["items"]]
        unit, allowed = _kind(entries[0])
        each = [_kind(entry)[1] for entry in entries]
        if len(set(each)) > 1:
            return unit, f"[{'; '.join(each)}]"
        return unit, f"{len(entries) if 'prefixItems' in of else 'a list'} of: {allowed}"
    if "minimum" in of:
        return of.get("unit", ""), f"{of['minimum']:g} to {of['maximum']:g}"
    return "", {"boolean": "`true`, `false`", "string": "text"}.get(of["type"], of["type"])


def _default(value: Any) -> str:
    if value is None:
        return "none"
    if value == "":
        return "empty"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f"`{list(value) if isinstance(value, tuple | list) else value}`"


def _cell(text: str) -> str:
    return html.escape(" ".join(text.split()).replace("|", "\\|"), quote=False)
