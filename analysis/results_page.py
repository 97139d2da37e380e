"""The results page: Markdown with sections that commands write."""

import re
from pathlib import Path

from preshape.errors import InputError
from preshape.files import atomic_path


def put_section(page: Path, name: str, text: str) -> None:
    """Replace a section of a page, or put it at the end; what stands around it is left alone.

    Args:
        page: Markdown file; made if it is missing.
        name: name of the section, in the comments that mark where it begins and ends.
        text: its new content.

    Raises:
        InputError: if the page cannot be read or written.
    """
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    section = f"{begin}\n{text}\n{end}"
    try:
        before = page.read_text(encoding="utf-8") if page.exists() else "# Results\n"
    except (OSError, ValueError) as error:
        raise InputError(f"The page cannot be read ({error})", where=page, fix="check the path") from error
    pattern = re.compile(re.escape(begin) + ".*?" + re.escape(end), re.DOTALL)
    if pattern.search(before):
        after = pattern.sub(lambda _: section, before, count=1)
    else:
        after = f"{before.rstrip()}\n\n{section}\n"
    with atomic_path(page) as temporary:
        temporary.write_text(after, encoding="utf-8")
