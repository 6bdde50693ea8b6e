# SPDX-License-Identifier: LGPL-3.0-or-later
"""Hooks of MkDocs that make the links of the documents work in the site as they do in the source tree.

A document links to a file by its path in the tree. In the site, a Markdown file outside docs/ is the page source/PATH,
a public header is its page of the programming interface, and any other file or folder is a page that shows it.
"""
import json
import logging
import pathlib
import posixpath
import re
import xml.etree.ElementTree

from mkdocs.structure.files import File

LINK = re.compile(r"(?P<before>\]\()(?P<target>[^)\s]+)(?=\))|(?P<define>^\[[^\]]+\]:\s+)(?P<at>\S+)", re.MULTILINE)
FENCE = re.compile(r"^(```.*?^```[^\n]*$)", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"(`[^`\n]+`)")
ITEM = re.compile(r"^(- |\d+\. )")
HEADERS = "libruntime/include/mauve"
SKIPPED = {"build", ".git", ".cache", "site.d"}
LANGUAGES = {".cpp": "cpp", ".h": "cpp", ".def": "cpp", ".json": "json", ".py": "python", ".service": "ini", "": "sh"}


class Tree:
    """Where the files of the source tree are in the site."""

    def __init__(self, config):
        self.root = pathlib.Path(config["config_file_path"]).resolve().parent
        self.docs = pathlib.Path(config["docs_dir"]).resolve().relative_to(self.root).as_posix()
        self.generated = self.root / "build" / "site-pages"
        self.api = self.generated / "api"
        self.headers = self._headers()

    def _headers(self):
        """Page of each header, from the index that Doxygen writes."""
        index = self.api / "mauve.tag"
        if not index.is_file():
            return {}
        files = xml.etree.ElementTree.parse(index).getroot().findall("compound[@kind='file']")
        pages = {}
        for file in files:
            header = pathlib.Path(file.findtext("path"), file.findtext("name"))
            pages[header.relative_to(self.root).as_posix()] = file.findtext("filename")
        return pages

    def in_tree(self, page):
        """Path in the source tree of a page of the site."""
        if not page.startswith("source/"):
            return f"{self.docs}/{page}"
        path = page.removeprefix("source/")
        return path if (self.root / path).exists() else path.removesuffix(".md")

    def in_site(self, path):
        """Page of a path of the source tree, or none if nothing is there."""
        if path in self.headers:
            return f"api/{self.headers[path]}"
        if path == HEADERS and self.headers:
            return "api/index.html"
        at = self.root / path
        if at.is_dir() and (at / "README.md").is_file():
            path, at = f"{path}/README.md", at / "README.md"
        if not at.exists() or not at.is_relative_to(self.root):
            return None
        if path.startswith(f"{self.docs}/"):
            return path.removeprefix(f"{self.docs}/")
        return f"source/{path}" if at.suffix == ".md" else f"source/{path}.md"


def documents(tree):
    for path in sorted(tree.root.rglob("*.md")):
        if not SKIPPED & set(path.relative_to(tree.root).parts):
            yield path.relative_to(tree.root).as_posix(), path.read_text("utf-8")


def prose(text, change):
    """Applies a function to all of a document but its code."""
    parts = FENCE.split(text)
    for i in range(0, len(parts), 2):
        parts[i] = change(parts[i])
    return "".join(parts)


def target_of(match):
    return match["target"] or match["at"]


def resolve(document, target):
    """Path in the tree and anchor that a link of a document leads to; none if it leaves the tree."""
    if re.match(r"[a-z]+:|#", target):
        return None
    path, _, anchor = target.partition("#")
    return posixpath.normpath(posixpath.join(posixpath.dirname(document), path)), anchor


def linked_files(tree):
    """Files and folders outside docs/ that are no Markdown and that a document links to."""
    found = set()

    def look(text, document):
        for match in LINK.finditer(text):
            to = resolve(document, target_of(match))
            if to and (tree.in_site(to[0]) or "").startswith("source/") and not (tree.root / to[0]).suffix == ".md":
                found.add(to[0])
        return text

    for document, text in documents(tree):
        prose(text, lambda part, document=document: look(part, document))
    return {path for path in found if not (tree.root / path / "README.md").is_file()}


def show(tree, path):
    """A page with the content of a file, or the list of a folder."""
    at = tree.root / path
    if at.is_dir():
        lines = "\n".join(f"- `{inner.name}`" for inner in sorted(at.iterdir()))
        return f"# {path}\n\nThis folder of the source tree holds:\n\n{lines}\n"
    language = LANGUAGES.get(at.suffix, "text")
    return f"# {path}\n\n`````{language}\n{at.read_text('utf-8')}\n`````\n"


def expand(tree, entries):
    """The navigation, with the pages of each folder and without pages that are not there yet."""
    for entry in entries:
        (title, value), = entry.items() if isinstance(entry, dict) else ((None, entry),)
        if isinstance(value, list):
            yield {title: list(expand(tree, value))}
        elif value.endswith("/"):
            pages = sorted((tree.root / tree.docs / value).glob("*.md"), key=lambda at: (at.name != "README.md", at.name))
            if pages:
                yield {title: [value + page.name for page in pages]}
        elif not value.endswith("?"):
            yield entry
        elif (tree.root / tree.docs / value[:-1]).is_file():
            yield {title: value[:-1]}


def on_config(config):
    if config["nav"]:
        config["nav"] = list(expand(Tree(config), config["nav"]))
    return config


def add(files, config, name, folder, at=None):
    file = File(name, str(folder), config["site_dir"], config["use_directory_urls"])
    if at:
        file.abs_src_path = str(at)
    files.append(file)


def on_files(files, config):
    tree = Tree(config)
    for document, _ in documents(tree):
        if not document.startswith(f"{tree.docs}/"):
            add(files, config, f"source/{document}", tree.root, tree.root / document)
    for path in linked_files(tree):
        page = tree.generated / "source" / f"{path}.md"
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(show(tree, path), "utf-8")
        add(files, config, f"source/{path}.md", tree.generated)
    for page in sorted(tree.api.glob("**/*")):
        if page.is_file() and page.suffix != ".tag":
            add(files, config, page.relative_to(tree.generated).as_posix(), tree.generated)
    return files


def on_nav(nav, config, files):
    """A page of docs/ that the navigation leaves out is found by nobody."""
    in_navigation = {page.file.src_path for page in nav.pages}
    for file in files.documentation_pages():
        if not file.src_path.startswith(("source/", "api/")) and file.src_path not in in_navigation:
            logging.getLogger("mkdocs.hooks").warning("%s has no place in the navigation of mkdocs.yml", file.src_path)


def separate_lists(text):
    """A list or a table after a line of text or after a block of code begins there, as it does for other readers of Markdown."""
    lines = []
    for line in text.split("\n"):
        before = lines[-1] if lines else ""
        if ITEM.match(line) and before.strip() and not ITEM.match(before) and not before.startswith((" ", "|", "#")):
            lines.append("")
        if line.startswith("|") and not before.startswith("|"):
            lines.append("")
        lines.append(line)
    return "\n".join(lines)


def on_page_markdown(markdown, page, config, files):
    tree = Tree(config)
    document = tree.in_tree(page.file.src_path)

    def lead(match):
        before, target = match["before"] or match["define"], target_of(match)
        to = resolve(document, target)
        at = to and tree.in_site(to[0])
        if not at:
            return before + target
        anchor = f"#{to[1]}" if to[1] and at.endswith(".md") else ""
        return before + posixpath.relpath(at, posixpath.dirname(page.file.src_path) or ".") + anchor

    return prose(markdown, lambda text: separate_lists(LINK.sub(lead, text)))


def on_post_build(config):
    """Leaves code out of the search, which a browser would take seconds to prepare for."""
    index = pathlib.Path(config["site_dir"]) / "search" / "search_index.json"
    if not index.is_file():
        return
    content = json.loads(index.read_text("utf-8"))
    shown = re.compile(r"^source/.*\.(?:cpp|h|def|json|py)\.html")
    content["docs"] = [part for part in content["docs"] if not shown.match(part["location"])]
    index.write_text(json.dumps(content, ensure_ascii=False, separators=(",", ":")), "utf-8")
