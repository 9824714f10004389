#!/usr/bin/python3
"""Installed programs and libraries are hardened, and look for libraries beside themselves only.

    test_hardening.py <cmake> <build folder> <scratch folder> <component>...
"""

import pathlib
import re
import subprocess
import sys
import tempfile

cmake, build, scratch, *components = sys.argv[1:]
wanted = {
    "position-independent": r"Type:\s+DYN ",
    "read-only relocations": r"GNU_RELRO",
    "bound at start": r"\(FLAGS(_1)?\).*\b(BIND_)?NOW\b",
    "stack protected": r"__stack_chk_fail",
    "stack not executable": r"GNU_STACK(\s+0x[0-9a-f]+){5} RW ",
}
places = r"\(R(?:UN)?PATH\).*\[(.*)\]"
faults = []
files = 0
with tempfile.TemporaryDirectory(dir=scratch) as prefix:
    for component in components:
        subprocess.run([cmake, "--install", build, "--prefix", prefix, "--component", component],
                       check=True, stdout=subprocess.DEVNULL)
    for path in sorted(pathlib.Path(prefix).rglob("*")):
        if path.is_symlink() or not path.is_file() or path.read_bytes()[:4] != b"\x7fELF":
            continue
        files += 1
        text = subprocess.run(["readelf", "-W", "-h", "-l", "-d", "--dyn-syms", path], check=True,
                              capture_output=True, text=True, env={"LC_ALL": "C"}).stdout
        faults += [f"{path.name}: not {what}" for what, pattern in wanted.items() if not re.search(pattern, text)]
        faults += [f"{path.name}: looks for libraries in {place}"
                   for found in re.findall(places, text) for place in found.split(":")
                   if not place.startswith("$ORIGIN")]
if files < len(components):
    faults.append(f"only {files} files were checked")
sys.exit("\n".join(faults) or 0)
