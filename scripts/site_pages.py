"""Pages of the documentation site that are not below docs/: README.md, and files that pages link to."""

import posixpath
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

LINK = re.compile(r"(\]\()([^)#\s]+)")
FILES = "files"
"""Folder of the site for files of the repository that pages link to."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the overview, and what the pages link to outside docs/."""
    root = Path(config.docs_dir).parent
    overview = (root / "README.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "index.md", content=overview))
    pages = [(page.src_uri, page.content_string) for page in files.documentation_pages()]
    for place in sorted({place for uri, text in pages for place in _outside(root, uri, text)}):
        content = (root / place).read_bytes()
        files.append(File.generated(config, f"{FILES}/{place}", content=content))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, **_: object) -> str:
    """Let links that lead through the repository lead through the site."""
    root = Path(config.docs_dir).parent
    start = posixpath.dirname(page.file.src_uri) or "."

    def moved(link: re.Match[str]) -> str:
        place = _place(page.file.src_uri, link[2])
        if (root / place).is_file() and not place.startswith("docs/"):
            place = f"docs/{'index.md' if place == 'README.md' else f'{FILES}/{place}'}"
        inside = place.removeprefix("docs/")
        return link[1] + (posixpath.relpath(inside, start) if inside != place else link[2])

    return LINK.sub(moved, markdown)


def _outside(root: Path, uri: str, text: str) -> set[str]:
    """Files of the repository outside docs/ that a page links to."""
    places = {_place(uri, link[2]) for link in LINK.finditer(text)} - {"README.md"}
    return {place for place in places if not place.startswith("docs/") and (root / place).is_file()}


def _place(uri: str, link: str) -> str:
    """Where a link of a page leads, from the top of the repository."""
    folder = "" if uri == "index.md" else posixpath.dirname(f"docs/{uri}")
    return posixpath.normpath(posixpath.join(folder, link))
