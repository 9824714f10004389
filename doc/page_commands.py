#!/usr/bin/python3
"""Prints the commands of a page that are marked to be run, as they stand there.

    page_commands.py PAGE.md MARK      the blocks that follow a line <!-- run: MARK -->
"""

import pathlib
import sys

sys.dont_write_bytecode = True
import markdown_files as md  # noqa: E402


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__.strip())
    text = pathlib.Path(arguments[0]).read_text("utf-8")
    lines = text.splitlines()
    mark = f"<!-- run: {arguments[1]} -->"
    found = [block for block in md.code_blocks(text) if block[0] > 2 and lines[block[0] - 3] == mark]
    if not found:
        sys.exit(f"{arguments[0]} has no commands marked {mark}")
    for _, _, commands in found:
        print("\n".join(commands))


if __name__ == "__main__":
    main(sys.argv[1:])
