#!/usr/bin/python3
"""Checks that the relative links and anchors of all Markdown files of a folder lead somewhere.

    check_links.py FOLDER
    check_links.py --site PAGE    prints a page with the labels by which Doxygen knows its anchors
"""

import pathlib
import re
import sys
import urllib.parse

LINK = re.compile(r"!?\[(?:[^][]|\[[^][]*\])*\]\(<?([^()\s>]+)>?\)")
CODE = re.compile(r"^```.*?^```$|`[^`\n]+`", re.MULTILINE | re.DOTALL)
IGNORED = {"build", "demo_output"}


def anchor(heading):
    """The anchor that GitHub gives to a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def anchors(text):
    """The anchors of a page."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    return {anchor(heading) for heading in re.findall(r"^#+ +(.*)$", text, re.MULTILINE)}


def for_site(page):
    """A page in which headings and links have labels that are unique in the site."""
    text = re.sub(r"^##+ +(.*)$", lambda heading: f"{heading[0]} {{#{page.stem}-{anchor(heading[1])}}}",
                  page.read_text(), flags=re.MULTILINE)  # fmt: skip
    text = re.sub(r"\]\([\w./]+/(\w+\.png)\)", r"](\1)", text)  # found by IMAGE_PATH
    return re.sub(r"\]\((?:[\w./]*?(\w+)\.md)?#([\w-]+)\)",
                  lambda link: f"](#{link[1] or page.stem}-{link[2]})", text)  # fmt: skip


def main(root):
    pages = [page for page in root.rglob("*.md") if not IGNORED & set(page.relative_to(root).parts)
             and not any(part.startswith(".") for part in page.relative_to(root).parts)]  # fmt: skip
    broken = []
    for page in pages:
        for link in LINK.findall(re.sub(CODE, "", page.read_text())):
            path, _, place = urllib.parse.unquote(link).partition("#")
            target = page.parent / path if path else page
            if not link.startswith(("http://", "https://", "mailto:")) and (
                    not target.exists() or (place and place not in anchors(target.read_text()))):  # fmt: skip
                broken.append(f"{page.relative_to(root)}: {link} leads nowhere")
    print("\n".join(broken or [f"{len(pages)} pages, all links lead somewhere"]))
    return int(bool(broken) or not pages)


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--site":
        print(for_site(pathlib.Path(sys.argv[2])), end="")
    else:
        sys.exit(main(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) == 2 else __doc__)
