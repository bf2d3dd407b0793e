"""Film of a page: screenshots at successive times, encoded by ffmpeg."""

from __future__ import annotations

import base64
import importlib.util
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from tweezer.values.errors import ResultError
from tweezer.values.files import replacing

if TYPE_CHECKING:
    from selenium.webdriver.remote.webdriver import WebDriver

    from tweezer.viewing.page import Page

#: Size of a film, pixels
_WIDTH, _HEIGHT = 1280, 800
#: Frames per second, and the options of ffmpeg for encoding, by file format
FORMATS: dict[str, tuple[int, list[str]]] = {
    "mp4": (25, ["-pix_fmt", "yuv420p"]),
    "gif": (12, ["-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse"]),
}
#: Names of the browser on different systems
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
#: Options of the browser: no window, and 3-D drawing without a graphics card
_OPTIONS = (
    "--headless=new", "--hide-scrollbars", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
)  # fmt: skip


def options_of_browser() -> tuple[str, ...]:
    """Return the options to start the browser with.

    For the user root they disable its sandbox, because the browser refuses to run as root with it.
    """
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    return (*_OPTIONS, *("--no-sandbox",) * root)


def programs() -> dict[str, str]:
    """Return the paths of browser, chromedriver and ffmpeg, by name.

    Raises `ResultError` that lists the missing programs, or selenium if that is missing.
    """
    found = {
        "Chromium": next(filter(None, map(shutil.which, _BROWSERS)), None),
        "chromedriver": shutil.which("chromedriver"),
        "ffmpeg": shutil.which("ffmpeg"),
    }
    missing = [name for name, path in found.items() if path is None]
    if missing:
        raise ResultError(
            f"a film requires {' and '.join(missing)}, not found on PATH; install them"
        )
    if importlib.util.find_spec("selenium") is None:
        raise ResultError('a film requires selenium; install it with pip install "tweezer[movie]"')
    return {name: path for name, path in found.items() if path is not None}


def film(
    page: Page, path: Path, seconds: float, progress: Callable[[float], None] | None = None
) -> Path:
    """Write a film of a page as .mp4 or .gif, which covers its whole time span.

    Parameters
    ----------
    page : Page
        The page.
    path : Path
        File to write.
    seconds : float
        Duration of the film, s.
    progress : callable, optional
        Called with the completed fraction.

    Raises
    ------
    ResultError
        If a program is missing or fails, and for a page without time.
    """
    where = programs()
    rate, how = FORMATS[path.suffix[1:].lower()]
    count = max(2, round(rate * seconds))
    with tempfile.TemporaryDirectory(prefix="tweezer-film-") as name:
        folder = Path(name)
        new = folder / path.name
        options = ["-loglevel", "error", "-f", "image2pipe", "-framerate", str(rate), "-i", "-"]
        with subprocess.Popen(
            [where["ffmpeg"], *options, *how, str(new)],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        ) as writer:  # fmt: skip
            assert writer.stdin is not None
            assert writer.stderr is not None
            try:
                for done, picture in enumerate(_pictures(page, folder, where, count), start=1):
                    writer.stdin.write(picture)
                    if progress:
                        progress(done / count)
                writer.stdin.close()
            except BrokenPipeError:
                pass  # ffmpeg reports the reason itself
            said = writer.stderr.read().decode(errors="replace").strip()
        if writer.returncode:
            reason = said.splitlines()[-1] if said else "it failed"
            raise ResultError(f"{path}: ffmpeg could not write the film: {reason}")
        with replacing(path) as whole:
            whole.write(new.read_bytes())
    return path


def _pictures(page: Page, folder: Path, where: dict[str, str], count: int) -> Iterator[bytes]:
    """Yield PNG images of the page at `count` times, taken by a browser started for this purpose.

    `folder` is for temporary files, and `where` has the paths of the programs by name.
    """
    from selenium import webdriver
    from selenium.common import WebDriverException

    options = webdriver.ChromeOptions()
    options.binary_location = where["Chromium"]
    for argument in options_of_browser():
        options.add_argument(argument)
    source = page.save(folder / "page.html")
    try:
        driver = webdriver.Chrome(options, webdriver.ChromeService(where["chromedriver"]))
    except WebDriverException as error:
        raise ResultError(f"a film requires Chromium, which does not start: {error.msg}") from None
    try:
        yield from frames(driver, source, count)
    finally:
        driver.quit()


def frames(driver: WebDriver, source: Path, count: int) -> Iterator[bytes]:
    """Yield PNG images of the page saved at `source`, at `count` times from its first to its last.

    Raises `ResultError` for a page without time.
    """
    screen = {"width": _WIDTH, "height": _HEIGHT, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
    driver.get(source.absolute().as_uri())
    ends = driver.execute_script("return window.tweezer?.duration")
    if not ends:
        title = driver.title.removesuffix(" · tweezer")
        raise ResultError(
            f"{title}: the page shows no change in time; a film requires a run or trajectories"
        )
    first, last = ends
    for i in range(count):
        time = first + (last - first) * i / (count - 1)
        driver.execute_script("tweezer.seek(arguments[0])", time)
        taken = driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
        yield base64.b64decode(taken["data"])
