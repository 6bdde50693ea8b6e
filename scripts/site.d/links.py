#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a page of a site links to a page or an anchor that is not there, or loads anything from the network, or shows
a table as raw text.

Usage: links.py SITE    prints one line for each violation: page: what
"""
import html.parser
import pathlib
import posixpath
import re
import sys
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import command_line  # noqa: E402

CODE = ("code", "pre", "script", "style")
LOADS = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src", "object": "data"}
NETWORK = re.compile(r"(?:[a-z]+:)?//", re.IGNORECASE)
STYLE = re.compile(r"(?:url\(|@import)\s*['\"]?((?:https?:)?//[^'\")\s]+)")


class Page(html.parser.HTMLParser):
    """Anchors, links and loaded files of one page, and whether a table is text there."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loads = {"", "top", "__skip"}, set(), set()
        self.inside_code, self.raw_table = 0, False
        self.feed(text)

    def handle_data(self, data):
        self.raw_table |= not self.inside_code and "|---" in data

    def handle_endtag(self, tag):
        self.inside_code -= tag in CODE

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.inside_code += tag in CODE
        self.anchors |= {values[key] for key in ("id", "name") if values.get(key)}
        if tag in ("a", "area") and values.get("href"):
            self.links.add(values["href"])
        load = values.get(LOADS.get(tag))
        if load and values.get("rel") not in ("canonical", "alternate", "prev", "next"):
            self.loads.add(load)


def problems(site):
    files = {path.relative_to(site).as_posix() for path in site.rglob("*") if path.is_file()}
    pages = {path.relative_to(site).as_posix(): Page(path.read_text("utf-8", errors="replace"))
             for path in sorted(site.rglob("*.html"))}
    for name, page in pages.items():
        if page.raw_table:
            yield f"{name}: a table is shown as raw text: |---"
        for target in sorted(page.links | page.loads):
            if NETWORK.match(target):
                if target in page.loads:
                    yield f"{name}: loads {target} from the network"
                continue
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            path, anchor = urllib.parse.unquote(path.partition("?")[0]), urllib.parse.unquote(anchor)
            # 404.html is shown in place of any page, so that its paths begin at the root of the site.
            to = posixpath.normpath(posixpath.join(posixpath.dirname(name), path)) if path else name
            to = to.lstrip("/")
            if to not in files and posixpath.normpath(posixpath.join(to, "index.html")) not in files:
                yield f"{name}: {target} is not there"
            elif anchor and to in pages and anchor not in pages[to].anchors:
                yield f"{name}: {target}: that page has no such anchor"
    for path in sorted(site.rglob("*.css")):
        for target in STYLE.findall(path.read_text("utf-8", errors="replace")):
            yield f"{path.relative_to(site)}: loads {target} from the network"


def main():
    arguments = command_line.Arguments(__doc__)
    arguments.add_argument("site", type=command_line.folder)
    site = arguments.parse_args().site
    pages = len(list(site.rglob("*.html")))
    return command_line.result(pages, problems(site), f"site: the links of {pages} pages lead to pages")


if __name__ == "__main__":
    sys.exit(main())
