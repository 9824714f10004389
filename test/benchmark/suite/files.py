"""Files that are there whole or not at all."""

import os


def write_file(path, text):
    """Writes a file under a temporary name, so that there is never half of it."""
    temporary = path.with_name(path.name + ".part")
    temporary.write_text(text)
    os.replace(temporary, path)
