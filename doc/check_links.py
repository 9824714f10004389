#!/usr/bin/python3
"""Checks the links of the documentation, and what it says of options and code.

    check_links.py [--root ROOT] [--tools FOLDER] [--site FOLDER] [--external]

In all Markdown files of ROOT (default: this checkout): relative links lead to files, anchors to
headings as GitHub names them, pictures exist, and each picture is used; external addresses are well
formed (the network is not asked; --external lists them). In those of doc/: functions that are named
like `this()` are in a public header, and blocks of C++ and CMake are those of the examples, word
for word.
--tools: options in command lines are in the help of the tools in FOLDER, and so are those that doc/
names. --site: all links and anchors of the HTML files in FOLDER lead somewhere.
The exit code is 0 if all is well, 1 if not, 2 for a wrong command line.
"""

import argparse
import html.parser
import os
import pathlib
import re
import shlex
import subprocess
import sys
import urllib.parse

sys.dont_write_bytecode = True
import markdown_files as md  # noqa: E402

_SKIPPED = re.compile(r"^(build.*|demo_output|\.git|\.cache|node_modules|__pycache__)$")
_PICTURES = (".png", ".svg", ".jpg", ".jpeg", ".gif")
_DEFINITION = re.compile(r"^\s{0,3}\[[^\]]+\]:\s+<?(\S+?)>?\s*$")
_TOOL = re.compile(r"^(?:.*/)?pcl_spherical_param_([a-z]+)$")
_OPTION = re.compile(r"^--?([a-zA-Z][\w-]*)(?:=.*)?$")


def files_of(root):
    """All files below a folder but for builds, as paths relative to it."""
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders if not _SKIPPED.match(name))
        found += [pathlib.Path(folder, name).relative_to(root).as_posix() for name in sorted(names)]
    return found


def address_fault(link):
    """What is wrong with an external address, or None."""
    try:
        parts = urllib.parse.urlsplit(link)
        host = parts.hostname or ""
    except ValueError as error:
        return str(error)
    if parts.scheme == "mailto":
        return None if re.fullmatch(r"[^@\s]+@[^@\s]+\.[^@\s]+", parts.path) else "no mail address"
    if parts.scheme not in ("http", "https"):
        return f"unknown scheme '{parts.scheme}'"
    if not re.fullmatch(r"[A-Za-z0-9-]+(\.[A-Za-z0-9-]+)+|localhost", host):
        return f"no host name: '{host}'"
    return None


def is_external(link):
    return re.match(r"[a-zA-Z][a-zA-Z0-9+.-]*:|//", link) is not None


class Sources:
    """The Markdown files of a checkout."""

    def __init__(self, root):
        self.root = root
        self.files = files_of(root)
        self.known = set(self.files)
        self.folders = {parent.as_posix() for name in self.files
                        for parent in pathlib.PurePosixPath(name).parents}  # fmt: skip
        self.pages = [name for name in self.files if name.endswith(".md")]
        self.texts = {name: (root / name).read_text("utf-8") for name in self.pages}
        self.faults = []
        self.external = {}
        self.checked = 0

    def fault(self, page, number, message):
        self.faults.append(f"{page}:{number}: {message}")

    def anchors(self, page):
        text = self.texts[page]
        return {heading[3] for heading in md.headings(text)} | md.explicit_anchors(text)

    def links(self, page):
        """(line, target, is a picture); a link may go on in the next line."""
        prose = []
        for number, line, language in md.split_lines(self.texts[page]):
            if language is None:
                definition = _DEFINITION.match(line)
                if definition:
                    yield number, definition.group(1), False
                for source in re.findall(r"<img\s[^>]*src=\"([^\"]+)\"", line):
                    yield number, source, True
                prose.append((number, line))
            else:
                prose.append((number, ""))
        text = "\n".join(line for _, line in prose)
        spans = "\n".join(md.without_code(line) for _, line in prose)
        for match in md.LINK.finditer(text):
            # What is within a code span is no link; a link whose text has code is one.
            if spans[match.end() - 1] == ")":
                yield text.count("\n", 0, match.start()) + 1, match.group(3), bool(match.group(1))

    def check_links(self):
        used = set()
        for page in self.pages:
            for number, link, _ in self.links(page):
                self.checked += 1
                if is_external(link):
                    self.external.setdefault(link, f"{page}:{number}")
                    fault = address_fault(link)
                    if fault:
                        self.fault(page, number, f"'{link}': {fault}")
                    continue
                name, _, anchor = urllib.parse.unquote(link).partition("#")
                target = os.path.normpath(os.path.join(os.path.dirname(page), name)) if name else page
                if name.startswith("/") or target.startswith(".."):
                    self.fault(page, number, f"'{link}' leaves the tree")
                elif target not in self.known and target not in self.folders:
                    self.fault(page, number, f"'{link}': there is no {target}")
                elif anchor and target not in self.texts:
                    self.fault(page, number, f"'{link}': {target} has no anchors")
                elif anchor and anchor not in self.anchors(target):
                    self.fault(page, number, f"'{link}': {target} has no heading '{anchor}'")
                used.add(target)
        for name in self.files:
            if name.startswith(("doc/", ".github/")) and name.endswith(_PICTURES) and name not in used:
                self.faults.append(f"{name}: no page shows this picture")

    def spans(self, page):
        for number, line, language in md.split_lines(self.texts[page]):
            if language is None:
                for match in md.CODE_SPAN.finditer(line):
                    yield number, match.group(2).strip()

    def check_code(self):
        """What pages of doc/ show of the code."""
        examples = [name for name in self.files
                    if name.startswith("doc/tutorials/") and name.endswith((".cpp", ".txt"))]  # fmt: skip
        examples = [(self.root / name).read_text("utf-8").splitlines() for name in examples]
        headers = "".join((self.root / name).read_text("utf-8")
                          for name in self.files if name.startswith("include/"))  # fmt: skip
        for page in self.pages:
            if not page.startswith("doc/"):
                continue
            for number, language, lines in md.code_blocks(self.texts[page]):
                if language in ("cpp", "cmake"):
                    size = len(lines)
                    if not any(code[i : i + size] == lines for code in examples
                               for i in range(len(code) - size + 1)):  # fmt: skip
                        self.fault(page, number, "this block is in no file of doc/tutorials")
            for number, span in self.spans(page):
                match = re.fullmatch(r"(?:spherical_param::)?([A-Za-z]\w*)\(\)", span)
                # Migration names what other classes have.
                if match and page != "doc/migration.md":
                    name = match.group(1)
                    # Those that an example of the page defines, or a class of PCL has.
                    elsewhere = name in self.texts[page].replace(f"`{span}`", "")
                    if not re.search(rf"\b{name}\(", headers) and not elsewhere and name not in ("setIndices", "setSearchMethod"):  # fmt: skip
                        self.fault(page, number, f"no public header has '{span}'")

    def check_options(self, tools):
        known = {}
        for name in sorted(os.listdir(tools)):
            match = _TOOL.match(name)
            if match:
                done = subprocess.run([tools / name, "-h"], capture_output=True, text=True, check=False)
                if done.returncode != 0:
                    self.faults.append(f"{name} -h failed: {done.stderr.strip()}")
                known[match.group(1)] = _options(done.stdout)
        if not known:
            self.faults.append(f"{tools}: there are no tools here")
            return
        for page in self.pages:
            for number, language, lines in md.code_blocks(self.texts[page]):
                if language in ("sh", "bash", "console"):
                    self.check_commands(page, number, lines, known)
            if page.startswith("doc/"):
                for number, span in self.spans(page):
                    match = re.match(r"-([a-z][a-z-]*)(?=\s|$)", span)
                    if match and not any(match.group(1) in options for options in known.values()):
                        self.fault(page, number, f"no tool has the option '-{match.group(1)}'")

    def check_commands(self, page, number, lines, known):
        text = "\n".join(lines).replace("\\\n", " " * 2)
        for line in text.splitlines():
            try:
                words = shlex.split(line, comments=True)
            except ValueError:
                continue  # a part of a longer construct of the shell
            tool = None
            for word in words:
                match = _TOOL.match(word)
                if match:
                    tool = match.group(1)
                    if tool not in known:
                        # Other programs of the project that are not in this build.
                        tool = None
                elif word in ("|", "||", "&&", ";", "&"):
                    tool = None
                elif tool:
                    option = _OPTION.match(word)
                    if option and option.group(1) not in known[tool]:
                        self.fault(page, number, f"'{word}': pcl_spherical_param_{tool} has no such option")


def _options(text):
    """The options that a help names, at the beginning of a line or after 'also'."""
    return set(re.findall(r"^\s+-([a-zA-Z][\w-]*)", text, re.M)) | set(
        re.findall(r"also -([a-zA-Z][\w-]*)", text)
    )


class Page(html.parser.HTMLParser):
    """Links and anchors of an HTML file."""

    def __init__(self, text):
        super().__init__()
        self.links = []
        self.anchors = set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if value is None:
                continue
            if name == "id" or (name == "name" and tag == "a"):
                self.anchors.add(value)
            elif name in ("href", "src") and tag != "base":
                self.links.append((self.getpos()[0], value))


def check_site(site):
    """The faults of a built site, how many links it has, and its external addresses."""
    pages = {name: Page((site / name).read_text("utf-8"))
             for name in files_of(site) if name.endswith(".html")}  # fmt: skip
    faults, checked, external = [], 0, {}
    if "index.html" not in pages:
        faults.append(f"{site}: there is no index.html here")
    for page, content in pages.items():
        for number, link in content.links:
            if link.startswith(("javascript:", "data:")):
                continue
            checked += 1
            if is_external(link):
                external.setdefault(link, f"{page}:{number}")
                fault = address_fault(link)
                if fault:
                    faults.append(f"{page}:{number}: '{link}': {fault}")
                continue
            name, _, anchor = urllib.parse.unquote(link).partition("#")
            target = os.path.normpath(os.path.join(os.path.dirname(page), name)) if name else page
            if not (site / target).is_file():
                faults.append(f"{page}:{number}: '{link}': there is no {target}")
            elif anchor and target in pages and anchor not in pages[target].anchors:
                faults.append(f"{page}:{number}: '{link}': {target} has no anchor '{anchor}'")
    return faults, checked, external


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    default = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--root", type=pathlib.Path, default=default, help="the checkout")
    parser.add_argument("--tools", type=pathlib.Path, help="folder of the tools")
    parser.add_argument("--site", type=pathlib.Path, help="folder of the built site")
    parser.add_argument("--external", action="store_true", help="list external addresses")
    options = parser.parse_args(arguments)
    for folder in (options.root, options.tools, options.site):
        if folder is not None and not folder.is_dir():
            parser.error(f"{folder} is no folder")

    sources = Sources(options.root.resolve())
    sources.check_links()
    sources.check_code()
    if options.tools:
        sources.check_options(options.tools.resolve())
    faults, external, checked = sources.faults, sources.external, sources.checked
    print(f"{len(sources.pages)} Markdown files, {checked} links")
    if options.site:
        site_faults, checked, site_external = check_site(options.site.resolve())
        faults, external = faults + site_faults, {**site_external, **external}
        print(f"site: {checked} links")
    if options.external:
        for link in sorted(external):
            print(f"external: {link}")
    for fault in faults:
        print(fault)
    if not faults:
        print(f"no faults; {len(external)} external addresses are well formed")
    else:
        print(f"{len(faults)} fault{'' if len(faults) == 1 else 's'}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
