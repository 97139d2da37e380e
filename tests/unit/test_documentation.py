"""Links of the documents lead somewhere, and the documentation site builds and loads nothing from outside."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
LINK = re.compile(r"\]\(([^)\s]+)\)")
LOADED = re.compile(r"<(?:script|img|link|iframe)[^>]*(?:src|href)=\"(https?:[^\"]*)\"")


def prose(document: Path) -> str:
    """A document without its code."""
    text = re.sub(r"^```.*?^```", "", document.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`\n]*`", "code", text)


def anchors(document: Path) -> set[str]:
    """Anchors of a document's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", document.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def build_site(folder: Path, config: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", str(config), "-d", str(folder)],
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_relative_links_lead_somewhere(document: Path) -> None:
    for link in LINK.findall(prose(document)):
        if not link.startswith(("http://", "https://")):
            name, _, anchor = link.partition("#")
            target = (document.parent / name).resolve() if name else document
            assert target.is_relative_to(ROOT)
            assert target.exists(), link
            assert not anchor or anchor in anchors(target), link


def test_the_site_builds_and_loads_nothing_from_elsewhere(tmp_path: Path) -> None:
    done = build_site(tmp_path, ROOT / "mkdocs.yml")
    assert done.returncode == 0, done.stderr
    pages = list(tmp_path.rglob("*.html"))
    assert {path.relative_to(tmp_path) for path in pages} >= {Path("index.html"), Path("api/models.html")}
    for page in pages:
        assert not LOADED.findall(page.read_text(encoding="utf-8"))
    assert 'href="files/CITATION.cff"' in (tmp_path / "index.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("broken", ["missing.md", "index.md#nowhere", "../sim/missing.py"])
def test_a_broken_link_fails_the_build(tmp_path: Path, broken: str) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "README.md").write_text("# Home\n")
    (tmp_path / "docs" / "page.md").write_text(f"# Page\n\n[there]({broken})\n")
    validation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("\nvalidation:")[1]
    hook = ROOT / "scripts" / "site_pages.py"
    config = tmp_path / "mkdocs.yml"
    config.write_text(f"site_name: small\nhooks: [{hook}]\nvalidation:{validation}")
    done = build_site(tmp_path / "site", config)
    assert done.returncode != 0
    assert broken.split("#")[0].removeprefix("../") in done.stderr


def test_troubleshooting_knows_what_the_doctor_knows() -> None:
    sources = (path.read_text(encoding="utf-8") for path in (ROOT / "src/preshape/health").glob("*.py"))
    checks = {name for source in sources for name in re.findall(r'Finding\(\s*"([^"]+)"', source)}
    page = (ROOT / "docs" / "troubleshooting.md").read_text(encoding="utf-8")
    table = page.split("| check |")[1].split("\n\n")[0]
    assert {line.split("|")[1].strip() for line in table.splitlines()[2:]} == checks
    assert len(checks) == 10
