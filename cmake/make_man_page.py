#!/usr/bin/python3
"""Makes the manual page of a tool from what the tool itself says with -h, -version and, where it
has that option, -list.

    make_man_page.py TOOL OUTPUT.1.gz --date SECONDS [--see-also NAME]...

The help is read by its shape, so that it needs no marks: a paragraph; "  name:  text" describes a
word of the command line; "  -name ARGUMENT  text" is an option; a line that ends in ":" begins a
section or, among options, a group of them. Whatever has another shape becomes a paragraph:
nothing of the help is lost.
"""

import argparse
import gzip
import os
import re
import subprocess
import sys
import textwrap
import time

OPTION = re.compile(r"^ {1,4}(-{1,2}[A-Za-z][\w-]*(?:[ =]\S+)*)(?: {2,}(.*))?$")
WORD = re.compile(r"^ {1,4}([A-Za-z][\w ]*?): {1,}(\S.*)$")
ITEM = re.compile(r"^ {1,4}([\w-]+) {2,}(\S.*)$")
HEADING = re.compile(r"^([A-Z][^\n]*):$", re.DOTALL)


def escape(text):
    """The text with all that troff would take for its own."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")
    text = text.replace("^", "\\(ha").replace("~", "\\(ti").replace('"', "\\(dq")
    return re.sub(r"^([.])", r"\\&\1", text, flags=re.MULTILINE)


def prose(text):
    """A paragraph: options are bold; a hyphen between letters stays one."""
    words = []
    for word in text.split():
        match = re.match(r"^(\(?)(-[A-Za-z][\w-]*)(.*)$", word)
        if match:
            words.append(f"{escape(match[1])}\\fB{escape(match[2])}\\fP{escape(match[3])}")
        else:
            words.append(re.sub(r"(?<=[A-Za-z])\\-(?=[A-Za-z])", "-", escape(word)))
    lines = textwrap.wrap(" ".join(words), 79, break_long_words=False, break_on_hyphens=False)
    return "\n".join(re.sub(r"^([.])", r"\\&\1", line) for line in lines)


def usage_of_word(word):
    """A word of the synopsis: names in bold, what the user puts in their place in italics."""
    if word in ("[", "]", "|", "..."):
        return escape(word)
    match = re.match(r"^(\[?)(.*?)(\]?(?:\.\.\.)?)$", word)
    font = "B" if match[2].startswith("-") else "I"
    return f"{escape(match[1])}\\f{font}{escape(match[2])}\\fP{escape(match[3])}"


def option_tag(text):
    name, *arguments = text.split(" ")
    return " ".join([f"\\fB{escape(name)}\\fP"] + [f"\\fI{escape(a)}\\fP" for a in arguments])


def tagged(tag, text):
    return [".TP", tag, prose(text) if text else "\\&"]


def joined_lines(lines):
    """The lines of a block, those that are indented further than the first one's text appended to
    the line before."""
    result = []
    for line in lines:
        indent = len(line) - len(line.lstrip())
        if result and indent > 5:
            result[-1] += " " + line.strip()
        else:
            result.append(line)
    return result


class Page:
    def __init__(self, tool):
        self.tool = tool
        self.synopsis = []
        self.summary = ""
        self.description = []
        self.options = []
        self.examples = []
        self.exit_status = []
        self.sections = []  # title, lines

    def read_help(self, text):
        blocks = [block.split("\n") for block in re.split(r"\n{2,}", text.strip("\n"))]
        for block in blocks:
            self.read_block(block)
        if not (self.synopsis and self.summary and self.options):
            sys.exit(f"{self.tool}: its help has no usage, description or options")

    def read_block(self, block):
        if block[0].startswith("Usage:"):
            self.read_usage(block)
            return
        if block[0].startswith("Exit code:"):
            codes = re.findall(r"(\d+) ([^,.]+(?:\([^)]*\))?)", " ".join(block))
            for code, meaning in codes:
                self.exit_status += tagged(f"\\fB{code}\\fP", meaning.strip().capitalize() + ".")
            return
        head = []
        while block and not block[0].startswith(" "):
            head.append(block.pop(0).strip())
        title = " ".join(head)
        rest = joined_lines(block)
        if title.startswith("Examples") and title.endswith(":"):
            self.read_examples(block)
        elif any(OPTION.match(line) for line in rest):
            self.read_options(title, rest)
        elif not self.summary:
            self.summary = re.split(r"(?<=[a-z)])\.(?:\s|$)", title)[0].strip()
            self.description += [prose(title)] + self.items(rest)
        elif HEADING.match(title) and rest:
            self.sections.append((title[:-1].upper(), self.items(rest)))
        else:
            self.description += [".PP", prose(title)] + self.items(rest)

    def read_usage(self, block):
        for line in [block[0][len("Usage:"):]] + block[1:]:
            words = line.split()
            if words and words[0] == "or:":
                words.pop(0)
            if words:
                if self.synopsis:
                    self.synopsis.append(".br")
                self.synopsis.append(
                    " ".join([f"\\fB{escape(words[0])}\\fP"] + [usage_of_word(w) for w in words[1:]]))

    def read_options(self, title, lines):
        match = re.match(r"^Options(?: \((.*)\))?:$", title)
        if match:
            if match[1]:
                about = match[1][0].upper() + match[1][1:]
                self.options += [prose(f"{about}.")]
        elif title:
            self.options += [f".SS {escape(title.rstrip(':'))}"]
        for line in lines:
            option = OPTION.match(line)
            if option:
                self.options += tagged(option_tag(option[1].strip()), option[2] or "")
            else:
                self.options += [".PP", prose(line)]

    def read_examples(self, lines):
        for line in lines:
            if len(line) - len(line.lstrip()) <= 2:
                self.examples += [".PP", prose(line)]
            else:
                self.examples += [".PP", ".RS", ".nf", escape(line.strip()), ".fi", ".RE"]

    def items(self, lines):
        result = []
        for line in lines:
            match = WORD.match(line) or ITEM.match(line)
            if match:
                result += tagged(f"\\fI{escape(match[1])}\\fP", match[2])
            else:
                result += [".PP", prose(line)]
        return result

    def read_list(self, text):
        """What -list says: headings with items below."""
        title, lines = "", []
        for line in text.rstrip("\n").split("\n") + [":"]:
            if line.startswith(" "):
                lines.append(line)
                continue
            if lines:
                self.sections.append((title.upper(), self.items(joined_lines(lines))))
            title, lines = line.rstrip(":"), []

    def text(self, version, date, see_also):
        day = time.strftime("%Y-%m-%d", time.gmtime(date))
        name = os.path.basename(self.tool)
        summary = self.summary[0].lower() + self.summary[1:]
        lines = [
            f'.TH {escape(name).upper()} 1 {day} "{escape(version)}" "User Commands"',
            ".SH NAME", prose(f"{name} \0 {summary}").replace("\0", "\\-"),
            ".SH SYNOPSIS", *self.synopsis,
            ".SH DESCRIPTION", *self.description,
            ".SH OPTIONS", *self.options,
        ]
        for title, content in self.sections:
            lines += [f".SH {escape(title)}", *content]
        if self.exit_status:
            lines += [".SH EXIT STATUS", *self.exit_status]
            lines += [".PP", "A failure prints its cause and a remedy, and leaves no file behind."]
        if self.examples:
            lines += [".SH EXAMPLES", *self.examples]
        if see_also:
            lines += [".SH SEE ALSO"]
            lines += [f".BR {escape(other)} (1)," for other in see_also[:-1]]
            lines += [f".BR {escape(see_also[-1])} (1)"]
        # A paragraph right after a heading is one already.
        text = "\n".join(lines) + "\n"
        return re.sub(r"(\n\.S[HS] [^\n]*)\n\.PP\n", r"\1\n", text)


def ask(tool, option):
    return subprocess.run([tool, option], check=True, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, encoding="utf-8").stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("tool")
    parser.add_argument("output")
    parser.add_argument("--date", type=int, required=True)
    parser.add_argument("--see-also", action="append", default=[])
    arguments = parser.parse_args()

    page = Page(arguments.tool)
    help_text = ask(arguments.tool, "-h")
    page.read_help(help_text)
    if re.search(r"^  -list( |$)", help_text, re.MULTILINE):
        page.read_list(ask(arguments.tool, "-list"))
    others = sorted(set(arguments.see_also) - {os.path.basename(arguments.tool)})
    text = page.text(ask(arguments.tool, "-version").strip(), arguments.date, others)
    # As gzip -9n: without name and time.
    content = text.encode("utf-8")
    if arguments.output.endswith(".gz"):
        content = gzip.compress(content, 9, mtime=0)
    with open(arguments.output + ".part", "wb") as file:
        file.write(content)
    os.replace(arguments.output + ".part", arguments.output)


if __name__ == "__main__":
    main()
