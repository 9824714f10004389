#!/usr/bin/python3
"""Checks that the relative links and anchors of all Markdown files of a folder lead somewhere.

    check_links.py FOLDER
"""

import pathlib
import re
import sys
import urllib.parse

LINK = re.compile(r"!?\[(?:[^][]|\[[^][]*\])*\]\(<?([^()\s>]+)>?\)")
CODE = re.compile(r"^```.*?^```$|`[^`\n]+`", re.MULTILINE | re.DOTALL)
IGNORED = {"build", "demo_output"}


def anchors(text):
    """The anchors that GitHub gives to headings."""
    headings = re.findall(r"^#+ +(.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def main(root):
    pages = [page for page in root.rglob("*.md") if not IGNORED & set(page.relative_to(root).parts)
             and not any(part.startswith(".") for part in page.relative_to(root).parts)]  # fmt: skip
    broken = []
    for page in pages:
        for link in LINK.findall(re.sub(CODE, "", page.read_text())):
            path, _, anchor = urllib.parse.unquote(link).partition("#")
            target = page.parent / path if path else page
            if not link.startswith(("http://", "https://", "mailto:")) and (
                    not target.exists() or (anchor and anchor not in anchors(target.read_text()))):  # fmt: skip
                broken.append(f"{page.relative_to(root)}: {link} leads nowhere")
    print("\n".join(broken or [f"{len(pages)} pages, all links lead somewhere"]))
    return int(bool(broken) or not pages)


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) == 2 else __doc__)
