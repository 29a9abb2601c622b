"""Chromium without a screen; WebGL is computed by its own software."""

import shutil
from contextlib import contextmanager

from playwright.sync_api import sync_playwright

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")


@contextmanager
def browser_page(**options):
    """An empty page; ``asked`` is what it loaded of a network or a disk, ``wrong`` what its scripts complained of."""
    path = next(filter(None, map(shutil.which, NAMES)), None)
    assert path, "there is no Chromium to try pages in; install one: apt-get install chromium-headless-shell"
    how = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=path, args=how)
        page = browser.new_page(**options)
        page.asked, page.wrong = [], []
        page.on("requestfinished", lambda request: page.asked.append(request.url))
        page.on("pageerror", lambda error: page.wrong.append(str(error)))
        yield page
        browser.close()
