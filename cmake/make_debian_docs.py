#!/usr/bin/python3
"""Makes what every Debian package has in its folder of /usr/share/doc: changelog.Debian.gz from
CHANGELOG.md, and copyright, in Debian's machine-readable format, from LICENSE."""

import argparse
import calendar
import email.utils
import gzip
import pathlib
import re
import sys
import textwrap
import time


EXPAT = """\
 Permission is hereby granted, free of charge, to any person obtaining a copy of this software and
 associated documentation files (the "Software"), to deal in the Software without restriction,
 including without limitation the rights to use, copy, modify, merge, publish, distribute,
 sublicense, and/or sell copies of the Software, and to permit persons to whom the Software is
 furnished to do so, subject to the following conditions:
 .
 The above copyright notice and this permission notice shall be included in all copies or
 substantial portions of the Software.
 .
 THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT
 NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND
 NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM,
 DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM, OUT
 OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.
"""


def read_releases(text, version, date):
    """Version, seconds since 1970 and changes of each release; the changes that are not released
    are those of the version at hand."""
    releases = []
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        title, _, body = section.partition("\n")
        match = re.match(r"\[?([^\]\s]+)\]?(?: - (\d+-\d+-\d+))?", title)
        name, day = match[1], match[2]
        when = calendar.timegm(time.strptime(day, "%Y-%m-%d")) if day else date
        if name.lower() == "unreleased":
            name = version
        changes = []
        for part in re.split(r"^### ", body, flags=re.MULTILINE):
            kind = part.partition("\n")[0].strip()
            for item in re.findall(r"^- (.*(?:\n  .*)*)", part, flags=re.MULTILINE):
                # What is new; the rest is for the readers of CHANGELOG.md.
                sentence = re.split(r"(?<=[a-z)`])\.(?:\s|$)", " ".join(item.split()))[0]
                changes.append((kind, sentence.replace("`", "").rstrip(".:") + "."))
        if changes and releases and releases[-1][0] == name:
            releases[-1][2].extend(changes)
        elif changes:
            releases.append((name, when, changes))
    return releases


def debian_changelog(releases, arguments):
    entries = []
    for version, when, changes in releases:
        lines = [f"{arguments.name} ({version}-{arguments.revision}) unstable; urgency=medium", ""]
        kinds = sorted({kind for kind, _ in changes}, key=[kind for kind, _ in changes].index)
        for kind in kinds:
            lines.append(f"  * {kind}:")
            for _, sentence in filter(lambda change, kind=kind: change[0] == kind, changes):
                lines += textwrap.wrap(sentence, 78, initial_indent="    - ",
                                       subsequent_indent="      ", break_on_hyphens=False)
        date = email.utils.formatdate(when)  # ends in -0000, which Debian writes as +0000
        lines += ["", f" -- {arguments.maintainer}  {date.replace('-0000', '+0000')}", ""]
        entries.append("\n".join(lines))
    return "\n".join(entries)


def debian_copyright(license_text, arguments):
    title, _, rest = license_text.strip().partition("\n\n")
    holder, _, terms = rest.partition("\n\n")
    match = re.match(r"Copyright \(c\) (.*)\nAll rights reserved\.$", holder)
    if not match or not title.startswith("BSD 3-Clause"):
        sys.exit("LICENSE is not the text that is expected: BSD 3-Clause, with one holder")
    body = "\n".join(f" {line}" if line else " ." for line in terms.split("\n"))
    return (
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n"
        f"Upstream-Name: {arguments.name.replace('-', '_')}\n"
        f"Upstream-Contact: {arguments.maintainer}\n"
        "\n"
        "Files: *\n"
        f"Copyright: {match[1]}\n"
        "License: BSD-3-clause\n"
        f"{body}\n"
        "\n"
        "Files: usr/bin/pcl_spherical_param_reconstruction\n"
        "Comment: three.js is part of the pages that it writes.\n"
        f"Copyright: {match[1]}\n"
        " 2010-2017 three.js authors\n"
        "License: BSD-3-clause and Expat\n"
        "\n"
        "License: Expat\n"
        f"{EXPAT}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("source", "output"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    for name in ("name", "version", "revision", "maintainer"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("--date", type=int, required=True)
    arguments = parser.parse_args()

    releases = read_releases((arguments.source / "CHANGELOG.md").read_text(encoding="utf-8"),
                             arguments.version, arguments.date)
    if not releases or releases[0][0] != arguments.version:
        sys.exit(f"CHANGELOG.md does not begin with the changes of {arguments.version}")
    changelog = debian_changelog(releases, arguments).encode("utf-8")
    # As gzip -9n: without name and time.
    (arguments.output / "changelog.Debian.gz").write_bytes(gzip.compress(changelog, 9, mtime=0))
    license_text = (arguments.source / "LICENSE").read_text(encoding="utf-8")
    (arguments.output / "copyright").write_text(debian_copyright(license_text, arguments),
                                                encoding="utf-8")


if __name__ == "__main__":
    main()
