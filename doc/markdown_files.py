"""What the link check and Doxygen's filter need to know of Markdown as GitHub reads it."""

import re

_FENCE = re.compile(r"^\s{0,3}(```+|~~~+)\s*([^`]*)$")
_HEADING = re.compile(r"^(#{1,6})\s+(.*?)\s*#*\s*$")
# An inline link or picture: its text, and its target.
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
CODE_SPAN = re.compile(r"(`+)(.+?)(?<!`)\1(?!`)")


def split_lines(text):
    """Yields (number, line, language): the language is None outside of blocks of code, "" or the
    fence's word in them; fences themselves are in them."""
    fence, language = None, None
    for number, line in enumerate(text.splitlines(), 1):
        match = _FENCE.match(line)
        if fence is None and match:
            fence, language = match.group(1), match.group(2).strip()
            yield number, line, language
        elif fence is not None:
            yield number, line, language
            if match and match.group(1).startswith(fence) and not match.group(2).strip():
                fence, language = None, None
        else:
            yield number, line, None


def without_code(line):
    """The line with its code spans blanked."""
    return CODE_SPAN.sub(lambda match: " " * len(match.group(0)), line)


def heading(line):
    """(level, text) of a heading's line, or None."""
    match = _HEADING.match(line)
    return (len(match.group(1)), match.group(2)) if match else None


def plain_text(text):
    """The text of a heading as it is read."""
    text = LINK.sub(lambda match: match.group(2), text)
    text = CODE_SPAN.sub(lambda match: match.group(2).strip(), text)
    return re.sub(r"<[^>]+>|\*\*|(?<!\w)[*_]|[*_](?!\w)", "", text)


def anchor(text):
    """GitHub's anchor for the text of a heading."""
    kept = "".join(c for c in plain_text(text).lower() if c.isalnum() or c in "-_ ")
    return kept.replace(" ", "-")


def headings(text):
    """(number, level, text, anchor) of all headings; anchors that would repeat are numbered."""
    seen, found = {}, []
    for number, line, language in split_lines(text):
        match = heading(line) if language is None else None
        if match is None:
            continue
        name = anchor(match[1])
        repeat = seen.get(name, 0)
        seen[name] = repeat + 1
        found.append((number, *match, name if repeat == 0 else f"{name}-{repeat}"))
    return found


def explicit_anchors(text):
    """Anchors that are written as HTML."""
    return set(re.findall(r"<a\s+(?:name|id)=\"([^\"]+)\"", text))


def code_blocks(text):
    """(number of the first line, language, lines) of all blocks of code."""
    blocks, current = [], None
    for number, line, language in split_lines(text):
        if language is None:
            current = None
        elif current is None or _FENCE.match(line) and current[3]:
            current = [number + 1, language, [], False]
            blocks.append(current)
        elif _FENCE.match(line):
            current[3] = True
            current = None
        else:
            current[2].append(line)
    return [tuple(block[:3]) for block in blocks]
