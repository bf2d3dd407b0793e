"""The site builds without a warning, and its pages are whole, in a browser too."""

import html
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from html.parser import HTMLParser
from pathlib import Path
from typing import get_args
from urllib.parse import unquote, urlsplit

import nbformat
import pytest
import typer
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.wait import WebDriverWait

import tweezer
from tweezer import cli

ROOT = Path(__file__).parents[1]
#: what it is made of, but for the notebooks
PAGES = [
    ROOT / "CONTRIBUTING.md",
    ROOT / "derivation/README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs/api").glob("*.md")),
]


#: shipped scenes, and those whose pages that play are made here; `make docs` makes all
SCENES = {path.stem: path for path in (ROOT / "tweezer/scenes").glob("*.toml")}
PLAYED = ("silica-1um", "two-traps")


def build(source, site, plays):
    """Build the site of a checkout as `make docs` does, with pages that play of these scenes; what
    was said, and the exit code.
    """
    return subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--site-dir", str(site)], check=False,
        cwd=source, capture_output=True, text=True,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1", "TWEEZER_PLAYS": " ".join(plays)},
    )  # fmt: skip


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The folder of the site, built once."""
    folder = tmp_path_factory.mktemp("site")
    done = build(ROOT, folder, PLAYED)
    assert done.returncode == 0, done.stderr
    return folder


def test_site_is_whole(site):
    notebooks = {path.stem for path in (ROOT / "notebooks").glob("*.ipynb")}
    assert {path.stem for path in (site / "notebooks").glob("*.html")} == notebooks
    reference = "".join(page.read_text() for page in (site / "api").glob("*.html"))
    names = set(tweezer.__all__) - {"__version__"}
    assert all(f'id="tweezer.{name}"' in reference for name in names)
    index = (site / "api/index.html").read_text()
    assert all(f'#tweezer.{name}"><code>{name}<' in index for name in names)
    scene_keys = "".join(page.read_text() for page in site.glob("scenes*.html"))
    for section, of in tweezer.Scene.model_fields.items():
        kinds = (of.annotation, *get_args(of.annotation))  # a section that need not be given
        keys = next(
            (kind.model_fields for kind in kinds if hasattr(kind, "model_fields")), [section]
        )
        for key in keys:
            assert f"<code>{key}</code>" in scene_keys, (section, key)
    commands = "".join(page.read_text() for page in site.glob("commands*.html"))
    for name, command in typer.main.get_command(cli.app).commands.items():
        assert f'id="tweezer-{name}"' in commands
        for parameter in command.params:
            option = parameter.opts[0]
            assert f"<code>{option}" in commands or not option.startswith("--"), (name, option)


def formulas(source):
    """LaTeX of a page or a notebook, in its order."""
    if source.suffix == ".md":
        text = re.sub(r"^```.*?^```|`[^`]*`", "", source.read_text(), flags=re.DOTALL | re.M)
        texts, between = [text], r"\\\[(.*?)\\\]|\\\((.*?)\\\)"
    else:
        texts, between = [], r"\$\$(.*?)\$\$|\$(.*?)\$"
        for cell in nbformat.read(source, as_version=4).cells:
            if cell.cell_type == "markdown":
                texts.append(re.sub(r"`[^`]*`", "", cell.source))
            shown = [output.get("data", {}) for output in cell.get("outputs", [])]
            texts += [data["text/latex"] for data in shown if "text/latex" in data]
    return [
        " ".join("".join(each).split())
        for text in texts
        for each in re.findall(between, text, re.DOTALL)
    ]


def test_computed_answers_are_folded(site):
    """Each in one folded part, with its code and what it printed."""
    for page in (site / "notebooks").glob("*.html"):
        text = page.read_text(encoding="utf-8")
        folded = re.findall(
            "<details><summary>Answer, computed</summary>(.*?)</details>", text, re.S
        )
        assert len(folded) == 2
        for part in folded:
            assert "celltag_answer" in part
            assert "jp-OutputArea" in part
            assert part.count("<div") == part.count("</div")


def test_every_formula_arrives_whole(site):
    """As one formula each, in their order, with the LaTeX that the source has."""
    sources = [*PAGES, *(ROOT / "notebooks").glob("*.ipynb")]
    found = {}
    for source in sources:
        page = source.relative_to(ROOT / "docs" if ROOT / "docs" in source.parents else ROOT)
        page = page.with_name("index") if page.name == "README.md" else page
        drawn = re.findall(r'<math alttext="(.*?)"', (site / page.with_suffix(".html")).read_text())
        found[source.name] = formulas(source)
        assert [html.unescape(latex) for latex in drawn] == found[source.name], source
    assert len(found["physics.md"]) > 30
    assert len(found["01_euler_parameters.ipynb"]) > 30


class Links(HTMLParser):
    """Addresses that a page leads to, those that it loads, and its anchors."""

    def __init__(self, page):
        super().__init__()
        self.leads, self.loads, self.anchors = set(), set(), {""}
        self.feed(page.read_text())

    def handle_starttag(self, tag, attrs):
        of = dict(attrs)
        self.anchors |= {of.get("id"), of.get("name")}
        if tag == "a" and of.get("href"):
            self.leads.add(of["href"])
        elif tag == "link" and of.get("rel") not in ("canonical", "prev", "next"):
            self.loads.add(of["href"])
        elif of.get("src"):
            self.loads.add(of["src"])


def test_links_lead_somewhere_and_nothing_is_loaded_from_elsewhere(site):
    links = {page: Links(page) for page in site.rglob("*.html") if page.name != "404.html"}
    left_out = {(site / f"plays/{name}.html").resolve() for name in SCENES if name not in PLAYED}
    assert len(links) > 20
    for page, of in links.items():
        for address in of.leads | of.loads:
            place = urlsplit(address)
            if place.scheme or place.netloc:
                assert address in of.leads or place.scheme == "data", (page.name, address)
                continue
            target = (page.parent / unquote(place.path)).resolve() if place.path else page
            assert target.is_file() or target in left_out, (page.name, address)
            if target in links:
                assert unquote(place.fragment) in links[target].anchors, (page.name, address)


#: what keeps a reader from a page: a function, and of nothing if it is called
ACCESSIBLE = "(" + (ROOT / "tests/accessible.js").read_text().partition("*/")[2].strip() + ")"
#: of the page and of the window, in pixels
WIDTHS = "return [document.documentElement.scrollWidth, window.innerWidth]"
#: formulas that are not drawn; matrices, and those whose bracket is lower than they are; the font
LAYOUT = """
const height = element => element.getBoundingClientRect().height;
const low = [...document.querySelectorAll("math mtable")].filter(table => {
  const bracket = table.previousElementSibling;
  return bracket && height(bracket) < 0.9 * height(table);
});
return {
  empty: [...document.querySelectorAll("math")].filter(formula => height(formula) < 4).length,
  low: low.length,
  matrices: document.querySelectorAll("math mtable").length,
  font: document.fonts.check("16px 'TeX Gyre Termes Math'"),
};
"""


def test_pages_opened_from_a_folder(site, browser):
    """On a wide screen in the light and on a phone's in the dark: none is wider than the screen,
    formulas are drawn in their font, and nothing keeps a reader or a keyboard out: of every other
    page in the light, of the rest in the dark, of one that plays in both.
    """
    matrices, complaints = 0, {}
    for number, page in enumerate(sorted(site.rglob("*.html"))):
        if page.name == "404.html":  # for a server: its addresses begin at the root
            continue
        plays = page.parent.name == "plays"
        if plays and page.stem != PLAYED[0]:  # one is as the others
            continue
        for width, scheme in ((1280, "light"), (400, "dark")):
            screen = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
            media = [{"name": "prefers-color-scheme", "value": scheme}]
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
            browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": media})
            if width == 1280:
                browser.get(page.as_uri())
                browser.execute_async_script("document.fonts.ready.then(arguments[0])")
            WebDriverWait(browser, 30, poll_frequency=0.02).until(  # sidebars move in and out
                lambda driver, width=width: driver.execute_script(WIDTHS) == [width, width],
                f"{page.name} is not {width} pixels wide",
            )
            layout = browser.execute_script(LAYOUT)
            assert (layout["empty"], layout["low"]) == (0, 0), page.name
            if plays or (scheme == "light") == (number % 2 == 0):  # what pages share is on many
                for complaint in browser.execute_script(f"return {ACCESSIBLE}()"):
                    complaints.setdefault(complaint, []).append((page.name, scheme))
        assert plays or layout["font"] or "<math" not in page.read_text(), page.name
        assert browser.get_log("browser") == [], page.name
        matrices += layout["matrices"]
    assert complaints == {}
    assert matrices > 20


def test_what_keeps_a_reader_out_is_found(tmp_path, browser):
    page = tmp_path / "page.html"
    page.write_text(
        """<!doctype html><title>x</title><body style="background: #fff; color: #777">
        <h1>one</h1><p>grey on white</p><h3>three</h3><img src="data:,"><button></button><input>
        <p style="background: #ddd">grey on grey</p><p style="color: #0000">not there</p>
        <a href="#" style="outline: none">no outline</a>
        <a href="#" class="far" style="position: absolute; left: -90px">far</a></body>"""
    )
    browser.get(page.as_uri())
    found = browser.execute_script(f"return {ACCESSIBLE}()")
    for what in (
        "no language", "no description", "no viewport", "h1 before h3: three", "no main part",
        "no alt text: data:,", "no name: button", "no name: input",
        'contrast 4.48: p "grey on white', 'contrast 3.30: p "grey on grey',
        'contrast 1.00: p "not there"', 'focus not seen: a "no outline"',
        'focus off the screen: a.far "far"',
    ):  # fmt: skip
        assert any(line.startswith(what) for line in found), (what, found)
    assert not any('h1 "one' in line for line in found)  # of large text 3 is enough


def test_a_figure_enlarges_by_the_keyboard(site, browser):
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    browser.get((site / "trap.html").as_uri())
    link = browser.find_element("css selector", "a.glightbox")
    browser.execute_script("arguments[0].focus()", link)
    link.send_keys(Keys.ENTER)
    wait = WebDriverWait(browser, 30, poll_frequency=0.02)
    shown = wait.until(lambda driver: driver.find_elements("css selector", ".gslide.current img"))
    wait.until(lambda driver: driver.execute_script("return arguments[0].naturalWidth", shown[0]))
    assert shown[0].get_attribute("src") == link.get_attribute("href")
    browser.switch_to.active_element.send_keys(Keys.ESCAPE)
    wait.until(lambda driver: not driver.find_elements("css selector", ".gslide"))


def test_a_phone_by_the_keyboard(site, browser):
    """The navigation opens, leads in and shuts; the page that plays is as dark as the site."""
    screen = {"width": 400, "height": 800, "deviceScaleFactor": 1, "mobile": True}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
    media = [{"name": "prefers-color-scheme", "value": "light"}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": media})
    browser.get((site / "index.html").as_uri())
    opener = browser.find_element("css selector", ".md-header__button[for=__drawer]")
    within = "return document.activeElement.closest('.md-sidebar--primary') !== null"
    for key, inside in ((Keys.ENTER, True), (Keys.ESCAPE, False), (Keys.SPACE, True)):
        (opener if inside else browser.switch_to.active_element).send_keys(key)
        assert browser.execute_script(within) is inside
    frame = browser.find_element("css selector", "iframe.plays")
    browser.execute_script("arguments[0].scrollIntoView()", frame)  # it is loaded when it is near
    browser.execute_script("document.body.dataset.mdColorScheme = 'slate'")
    browser.switch_to.frame(frame)
    WebDriverWait(browser, 30, poll_frequency=0.02).until(
        lambda driver: driver.execute_script(
            "return document.documentElement.dataset.theme === 'dark'"
        )
    )
    browser.switch_to.default_content()


def test_gallery_has_every_scene(site):
    page = (site / "gallery.html").read_text()
    for name, path in SCENES.items():
        assert f'id="{name}"' in page
        for scheme in "light", "dark":
            assert f'src="figures/gallery/{name}-{scheme}.webp#only-{scheme}"' in page
        assert f'href="figures/gallery/{name}.png"' in page
        assert f'href="plays/{name}.html"' in page
        description = tomllib.loads(path.read_text())["description"]
        assert description[1:] in html.unescape(page)
        if name in PLAYED:
            title = re.search("<title>(.*?) · ", (site / f"plays/{name}.html").read_text())[1]
            assert html.unescape(title).replace("µm", "um") == description


#: pages that answer a question
GUIDES = {"first-trap", "first-recording", "how-do-i", "trap", "trapping-diagram", "calibration"}


@pytest.mark.parametrize("query", ["stiffness", "NA", "trap", "blur"])
def test_search_from_a_folder_answers_with_a_guide_first(site, browser, query):
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    browser.set_window_size(1280, 900)
    browser.get((site / "index.html").as_uri())
    browser.find_element("class name", "md-search__input").send_keys(query)
    results = WebDriverWait(browser, 30).until(
        lambda driver: driver.find_elements("css selector", "a.md-search-result__link")
    )
    addresses = [urlsplit(result.get_attribute("href")) for result in results]
    assert len(addresses) > 3
    assert all(Path(unquote(address.path)).is_file() for address in addresses)
    assert Path(addresses[0].path).stem in GUIDES


def test_search_ignores_the_code_of_notebooks(site):
    index = json.loads((site / "search/search_index.json").read_text())
    told = "".join(entry["text"] for entry in index["docs"] if "notebooks/" in entry["location"])
    assert "Euler" in told
    assert not re.search(r"Copied!|In.{0,6}\[\d+\]:|import matplotlib", told)


def test_what_is_broken_fails(tmp_path):
    """A link to nothing, a name that is not there, and formulas that are none."""
    for name in ("docs", "derivation", "notebooks", "tweezer"):
        (tmp_path / name).mkdir()
    for name in (  # a page is enough
        "mkdocs.yml", "CHANGELOG.md", "CONTRIBUTING.md", "derivation/README.md", "docs/hooks.py",
        "docs/plays.py", "docs/index.md", "docs/knobs.json",
    ):  # fmt: skip
        shutil.copy(ROOT / name, tmp_path / name)
    shutil.copytree(ROOT / "docs/templates", tmp_path / "docs/templates")
    with (tmp_path / "docs/index.md").open("a") as page:
        page.write("\n[one](nowhere.md) [two][tweezer.nothing] \\(\\nonsense\\)\n")
    broken = nbformat.v4.new_notebook(
        cells=[
            nbformat.v4.new_markdown_cell("# Broken\n\n$e_0$, and a list: $a\n+ b$"),
            nbformat.v4.new_markdown_cell("Two parts: $c\n\nd"),
        ],
        metadata=nbformat.read(next(iter((ROOT / "notebooks").glob("*.ipynb"))), 4).metadata,
    )
    nbformat.write(broken, tmp_path / "notebooks/broken.ipynb")
    done = build(tmp_path, tmp_path / "site", ())
    assert done.returncode != 0
    for complaint in (
        "nowhere.md", "tweezer.nothing", "no MathML for \\nonsense", "no MathML for a</p>",
        "a formula without its end: <p>Two parts: $c",
    ):  # fmt: skip
        assert complaint in done.stderr
