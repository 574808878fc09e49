#!/usr/bin/env python3
"""The site is built, every link in it leads to a page and a place on it, and it needs nothing from the network.

    tests/tools/site.py FOLDER     (made anew)
"""
import html.parser
import pathlib
import shutil
import subprocess
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SKIPPED = 77  # exit code that CTest knows
LOADED = {"script": "src", "img": "src", "link": "href", "iframe": "src"}


class Page(html.parser.HTMLParser):
    """Links, loaded files and ids of a page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.loaded, self.ids = [], [], set()
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.ids |= {given[key] for key in ("id", "name") if given.get(key)}
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if tag in LOADED and given.get(LOADED[tag]) and given.get("rel") != "canonical":
            self.loaded.append(given[LOADED[tag]])


def faults(site):
    pages = {path.resolve(): Page(path) for path in site.rglob("*.html")}
    for path, page in pages.items():
        name = path.relative_to(site)
        if path.name == "404.html":
            continue  # its links are from the root of a server
        yield from (f"{name}: loads {url}" for url in page.loaded if urllib.parse.urlparse(url).netloc)
        for url in page.links + page.loaded:
            parts = urllib.parse.urlparse(url)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists():
                yield f"{name}: there is no {url}"
            elif parts.fragment and target in pages and parts.fragment not in pages[target].ids:
                yield f"{name}: there is no such place: {url}"


def main():
    if not shutil.which("mkdocs"):
        print("mkdocs is not there (tools/setup docs)")
        sys.exit(SKIPPED)
    site = pathlib.Path(sys.argv[1]).resolve()
    subprocess.run([ROOT / "tools" / "make_site", site], check=True)
    found = sorted(set(faults(site)))
    if found:
        sys.exit("\n".join(found))


main()
