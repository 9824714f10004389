#!/usr/bin/python3
"""Doxygen's input filter for Markdown: makes of what GitHub shows what Doxygen 1.9 understands.

    doxygen_markdown.py ROOT FILE      the filtered text, on the standard output

Headings get GitHub's anchors; links to other pages, with or without an anchor, to headers and to
files that are no pages become Doxygen's; what only looks like a command of Doxygen is escaped;
boxes ("> [!WARNING]") become Doxygen's.
"""

import pathlib
import re
import sys

import markdown_files as md

# Folders and files that are the site's pages; see INPUT in Doxyfile.in.
PAGES = ("doc/", "README.md", "CONTRIBUTING.md", "CHANGELOG.md")


def page_id(path):
    """An id for a page, from its path in the tree; that of doc/README.md is the main page."""
    return "page_" + re.sub(r"[^a-z0-9]+", "_", path.lower().removesuffix(".md")).strip("_")


def anchor_id(path, anchor):
    return page_id(path) + "__" + re.sub(r"[^A-Za-z0-9_]", "_", anchor)


def is_page(path):
    return path.endswith(".md") and path.startswith(PAGES)


class Filter:
    def __init__(self, root, path):
        self.root = root
        self.path = path

    def target(self, link):
        """(path in the tree, anchor) of a relative link."""
        name, _, anchor = link.partition("#")
        if not name:
            return self.path, anchor
        file = (self.root / self.path).parent.joinpath(name).resolve()
        return file.relative_to(self.root).as_posix(), anchor

    def link(self, match):
        picture, text, link = match.groups()
        text = " ".join(text.split())
        if re.match(r"[a-z]+:", link):
            return match.group(0)
        path, anchor = self.target(link)
        if picture:
            return f"![{text}]({pathlib.PurePosixPath(path).name})"
        if is_page(path):
            name = anchor_id(path, anchor) if anchor else page_id(path)
            return f"[{self.plain(text)}](@ref {name})"
        if path.endswith(".h"):
            return f"[{self.plain(text)}](@ref {path.removeprefix('include/')})"
        # A file that the site does not have: said by its name.
        shown = md.plain_text(text)
        return f"`{path}`" if shown in ("", path, pathlib.PurePosixPath(path).name) else f"{shown} (`{path}`)"

    def plain(self, text):
        # Doxygen takes no code in the text of a reference.
        return md.CODE_SPAN.sub(lambda match: match.group(2), text)

    def prose(self, line):
        """A line outside of blocks of code."""
        parts, last = [], 0
        # Links first: their text may have code.
        for match in md.LINK.finditer(line):
            parts.append(self.spans(line[last : match.start()]))
            parts.append(self.link(match))
            last = match.end()
        parts.append(self.spans(line[last:]))
        return "".join(parts)

    def spans(self, text):
        parts, last = [], 0
        for match in md.CODE_SPAN.finditer(text):
            parts.append(self.words(text[last : match.start()]))
            code = match.group(2).replace("\\|", "|")
            parts.append("<code>" + self.html(code) + "</code>")
            last = match.end()
        parts.append(self.words(text[last:]))
        return "".join(parts)

    def html(self, code):
        """Code, for HTML, with nothing left that Doxygen would see."""
        code = code.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
        code = code.replace("\\", "\\\\").replace("@", "\\@").replace("#", "\\#").replace("|", "\\|")
        for char in "*_[]":
            code = code.replace(char, "\\" + char)
        # \~ would choose a language.
        code = code.replace("~", "&#126;")
        return code.replace("--", "\\--").replace("::", "\\::").replace("%", "\\%").replace('"', "&quot;")

    def words(self, text):
        text = re.sub(r"(?<![\\\w])@(?=\w)", r"\\@", text)
        return re.sub(r"(?<![\\&])#(?=\w)", r"\\#", text)

    def run(self, text):
        anchors = {number: (level, title, name) for number, level, title, name in md.headings(text)}
        first = min(anchors, default=0)
        out, box, prose = [], False, []

        def flush():
            # Together: a link may go on in the next line.
            if prose:
                out.append(self.prose("\n".join(prose)))
                prose.clear()

        for number, line, language in md.split_lines(text):
            is_box = line.startswith(">") and (box or line.startswith("> [!"))
            if language is not None or number in anchors or is_box or line.startswith("<!--"):
                flush()
            if language is not None:
                out.append(line)
            elif number in anchors:
                level, title, name = anchors[number]
                title = md.plain_text(title)
                name = page_id(self.path) if number == first else anchor_id(self.path, name)
                out.append(f"{'#' * level} {title} {{#{name}}}")
            elif line.startswith("<!--") and line.endswith("-->"):
                out.append("")
            elif re.match(r"> \[!(NOTE|WARNING|IMPORTANT|TIP|CAUTION)\]", line):
                kind = "warning" if "WARNING" in line or "CAUTION" in line else "note"
                out += ["", f"\\{kind}"]
                box = True
            elif box and line.startswith(">"):
                out.append(self.prose(line[1:].lstrip() if not line.startswith("> -") else line[2:]))
            else:
                if box:
                    out.append("")
                box = False
                prose.append(line)
        flush()
        return "\n".join(out) + "\n"


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__.strip())
    root = pathlib.Path(arguments[0]).resolve()
    path = pathlib.Path(arguments[1]).resolve()
    sys.stdout.write(Filter(root, path.relative_to(root).as_posix()).run(path.read_text("utf-8")))


if __name__ == "__main__":
    main(sys.argv[1:])
