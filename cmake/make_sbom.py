#!/usr/bin/python3
"""Writes a software bill of materials, SPDX 2.3 as JSON: what a build, or a component of its
installation, is made of and depends on.

What is linked is read from the files themselves; what is only compiled in, or builds, from what
CMake found (cmake/Sbom.cmake writes the description of the build). The same files give the same
bytes; no path of this machine is in it.
"""

import argparse
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import urllib.parse

# What the project may depend on: name, licence, where it is had, libraries (beginning of the file
# name). Headers alone have no libraries.
KNOWN = {
    "eigen": ("Eigen", "MPL-2.0", "https://eigen.tuxfamily.org/", ()),
    "qhull": ("qhull", "Qhull", "http://www.qhull.org/", ("libqhull",)),
    "libgomp": ("libgomp", "GPL-3.0-or-later WITH GCC-exception-3.1", "https://gcc.gnu.org/",
                ("libgomp",)),
    "libomp": ("LLVM OpenMP", "Apache-2.0 WITH LLVM-exception", "https://openmp.llvm.org/",
               ("libomp",)),
    "libstdcxx": ("libstdc++", "GPL-3.0-or-later WITH GCC-exception-3.1", "https://gcc.gnu.org/",
                  ("libstdc++",)),
    "libcxx": ("libc++", "Apache-2.0 WITH LLVM-exception", "https://libcxx.llvm.org/", ("libc++",)),
    "libgcc": ("libgcc", "GPL-3.0-or-later WITH GCC-exception-3.1", "https://gcc.gnu.org/",
               ("libgcc_s", "libatomic")),
    "glibc": ("GNU C Library", "LGPL-2.1-or-later", "https://www.gnu.org/software/libc/",
              ("libc.so", "libm.so", "libmvec.so", "libpthread.so", "libdl.so", "librt.so",
               "libutil.so", "ld-linux")),
    "pcl": ("Point Cloud Library", "BSD-3-Clause", "https://pointclouds.org/", ("libpcl_",)),
    "flann": ("FLANN", "BSD-2-Clause", "https://github.com/flann-lib/flann", ("libflann",)),
    "lz4": ("lz4", "BSD-2-Clause", "https://lz4.org/", ("liblz4",)),
    "boost": ("Boost", "BSL-1.0", "https://www.boost.org/", ("libboost_",)),
    "vtk": ("VTK", "BSD-3-Clause", "https://vtk.org/", ("libvtk",)),
    "nlohmann_json": ("JSON for Modern C++", "MIT", "https://github.com/nlohmann/json", ()),
    "zlib": ("zlib", "Zlib", "https://zlib.net/", ("libz.so",)),
    # What PCL and VTK are linked with, where the linker keeps what is not needed.
    "openni": ("OpenNI", "Apache-2.0", "https://structure.io/openni", ("libOpenNI",)),
    "libusb": ("libusb", "LGPL-2.1-or-later", "https://libusb.info/", ("libusb-1.0",)),
    "tbb": ("oneTBB", "Apache-2.0", "https://github.com/oneapi-src/oneTBB", ("libtbb.so",)),
    "jsoncpp": ("JsonCpp", "MIT", "https://github.com/open-source-parsers/jsoncpp",
                ("libjsoncpp.so",)),
    "freetype": ("FreeType", "FTL OR GPL-2.0-or-later", "https://freetype.org/", ("libfreetype.so",)),
    "x11": ("libX11", "MIT", "https://www.x.org/", ("libX11.so",)),
    "qt": ("Qt", "LGPL-3.0-only OR GPL-2.0-or-later", "https://www.qt.io/", ("libQt5",)),
    "glew": ("GLEW", "BSD-3-Clause AND MIT", "https://glew.sourceforge.net/", ("libGLEW.so",)),
    "pybind11": ("pybind11", "BSD-3-Clause", "https://github.com/pybind/pybind11", ()),
    "python": ("Python", "PSF-2.0", "https://www.python.org/", ("libpython",)),
    "three": ("three.js", "MIT", "https://threejs.org/", ()),
    "cmake": ("CMake", "BSD-3-Clause", "https://cmake.org/", ()),
    "gcc": ("GCC", "GPL-3.0-or-later WITH GCC-exception-3.1", "https://gcc.gnu.org/", ()),
    "clang": ("Clang", "Apache-2.0 WITH LLVM-exception", "https://clang.llvm.org/", ()),
}


def find(program):
    """ldconfig is not in the path of every user."""
    return shutil.which(program) or shutil.which(program, path="/usr/sbin:/sbin")


def run(program, *arguments):
    """What a program prints; nothing where it is missing or fails."""
    path = find(program)
    if not path:
        return ""
    return subprocess.run([path, *arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          check=False, encoding="utf-8", errors="replace",
                          env={**os.environ, "LC_ALL": "C"}).stdout


def needed_libraries(binary):
    return re.findall(r"\(NEEDED\).*\[(.+)\]", run("readelf", "-d", "-W", str(binary)))


class DebianPackages:
    """Which Debian package has a file, and its version."""

    def __init__(self, paths):
        self.packages = {}
        by_path = {}
        # Where /lib is a link to /usr/lib, dpkg knows one of the two names.
        paths = sorted({str(pathlib.Path(path).resolve()) for path in paths})
        asked = paths + [path[len("/usr"):] for path in paths if path.startswith("/usr/lib")]
        for line in run("dpkg-query", "-S", *asked).splitlines() if asked else ():
            names, _, path = line.rpartition(": ")
            if not names.startswith("diversion "):
                by_path[str(pathlib.Path(path).resolve())] = names.split(", ")[0]
        if by_path:
            shown = run("dpkg-query", "-W", "-f",
                        "${binary:Package}\t${Package}\t${Version}\t${Architecture}\n",
                        *sorted(set(by_path.values())))
            facts = {}
            for line in shown.splitlines():
                name, *rest = line.split("\t")
                facts[name] = rest
                facts[rest[0]] = rest
            self.packages = {path: facts[name] for path, name in by_path.items() if name in facts}

    def of(self, path):
        return self.packages.get(str(pathlib.Path(path).resolve())) if path else None


def loader_paths():
    """File of each shared library that the loader knows."""
    paths = {}
    for name, path in re.findall(r"^\s*(\S+) \(.*\) => (\S+)$", run("ldconfig", "-p"),
                                 re.MULTILINE):
        paths.setdefault(name, path)
    return paths


def distribution():
    try:
        text = pathlib.Path("/etc/os-release").read_text(encoding="utf-8")
    except OSError:
        return "debian", ""
    facts = dict(re.findall(r'^(\w+)="?([^"\n]*)"?$', text, re.MULTILINE))
    return facts.get("ID", "debian"), facts.get("VERSION_ID", "")


def spdx_id(text):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]+", "-", text).strip("-")


def checksums(path):
    content = path.read_bytes()
    return [{"algorithm": name.upper(), "checksumValue": hashlib.new(name, content).hexdigest()}
            for name in ("sha1", "sha256")]


class Document:
    def __init__(self, build, arguments):
        self.build = build
        self.packages = {}
        self.files = []
        self.relationships = []
        self.arguments = arguments

    def relate(self, one, kind, other):
        entry = {"spdxElementId": one, "relationshipType": kind, "relatedSpdxElement": other}
        if entry not in self.relationships:
            self.relationships.append(entry)

    def add_dependency(self, key, version, debian):
        """A package, named by key; the version of the first that tells it."""
        name, licence, home, _ = KNOWN.get(key, (key, "NOASSERTION", "NOASSERTION", ()))
        package = self.packages.setdefault(key, {
            "name": name,
            "SPDXID": spdx_id("Package-" + key),
            "supplier": "NOASSERTION",
            "downloadLocation": home,
            "filesAnalyzed": False,
            "licenseConcluded": "NOASSERTION",
            "licenseDeclared": licence,
            "copyrightText": "NOASSERTION",
        })
        if not version and debian:
            version = re.sub(r"^\d+:|(\.?dfsg|[-+~]).*$", "", debian[1])
        if version and "versionInfo" not in package:
            package["versionInfo"] = version
        references = []
        if debian:
            system, release = distribution()
            package["supplier"] = "Organization: " + system.capitalize()
            purl = (f"pkg:deb/{system}/{urllib.parse.quote(debian[0], safe='')}"
                    f"@{urllib.parse.quote(debian[1], safe='')}?arch={debian[2]}")
            references.append(purl + (f"&distro={system}-{release}" if release else ""))
        listed = package.setdefault("externalRefs", [])
        for purl in references:
            entry = {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                     "referenceLocator": purl}
            if entry not in listed:
                listed.append(entry)
                listed.sort(key=lambda reference: reference["referenceLocator"])
        return package["SPDXID"]

    def text(self):
        arguments = self.arguments
        what = f"-{arguments.component}" if arguments.component else ""
        packages = sorted(self.packages.values(), key=lambda package: package["SPDXID"])
        for package in packages:
            if not package.get("externalRefs", True):
                del package["externalRefs"]
        document = {
            "spdxVersion": "SPDX-2.3",
            "dataLicense": "CC0-1.0",
            "SPDXID": "SPDXRef-DOCUMENT",
            "name": f"{self.build['name']}{what}-{self.build['version']}",
            "documentNamespace": "",
            "creationInfo": {
                "created": time.strftime("%Y-%m-%dT%H:%M:%SZ",
                                         time.gmtime(int(self.build["date"]))),
                "creators": [f"Tool: {self.build['name']}-make_sbom-{self.build['version']}"],
            },
            "packages": packages,
            "files": sorted(self.files, key=lambda file: file["SPDXID"]),
            "relationships": sorted(
                self.relationships,
                key=lambda entry: (entry["spdxElementId"], entry["relationshipType"],
                                   entry["relatedSpdxElement"])),
        }
        # One name for one content, as SPDX wants it, without anything random.
        digest = hashlib.sha256(json.dumps(document, sort_keys=True).encode("utf-8")).hexdigest()
        document["documentNamespace"] = (
            f"https://spdx.org/spdxdocs/{document['name']}-{digest[:32]}")
        return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def make(build, arguments):
    document = Document(build, arguments)
    components = build["components"]
    if arguments.component:
        components = {arguments.component: components[arguments.component]}

    # The files: those of the build, or of the installation.
    found = []
    for component in sorted(components):
        for entry in components[component]:
            path = pathlib.Path(entry["file"])
            name = path.name
            if arguments.prefix:
                name = entry["installed"]
                path = arguments.prefix / name
            if not path.is_file():
                sys.exit(f"make_sbom.py: there is no '{path}'")
            found.append((component, name, path, needed_libraries(path)))

    ours = {pathlib.Path(entry["file"]).name: component
            for component, entries in build["components"].items() for entry in entries}
    paths = loader_paths()
    external = sorted({library for _, _, _, libraries in found for library in libraries
                       if not any(name.startswith(library) for name in ours)})
    declared = [entry for entry in build["dependencies"]
                if set(entry["components"]) & set(components)]
    debian = DebianPackages([paths[library] for library in external if library in paths] +
                            [entry["file"] for entry in declared if entry["file"]])
    versions = {entry["key"]: entry["version"] for entry in build["dependencies"]}

    root = {
        "name": build["name"] + (f"-{arguments.component}" if arguments.component else ""),
        "SPDXID": spdx_id("Package-" + build["name"]),
        "versionInfo": build["version"],
        "supplier": f"Organization: {build['supplier']}",
        "downloadLocation": build["url"] or "NOASSERTION",
        "filesAnalyzed": bool(found),
        "licenseConcluded": build["licence"],
        "licenseDeclared": build["licence"],
        "copyrightText": build["copyright"],
    }
    if not find("readelf"):
        root["comment"] = "What is linked could not be read from the files: there is no readelf."
    document.packages[""] = root
    document.relate("SPDXRef-DOCUMENT", "DESCRIBES", root["SPDXID"])

    def of_library(library):
        for key, (_, _, _, prefixes) in KNOWN.items():
            if library.startswith(prefixes):
                return key
        return library.split(".so")[0]

    for _, name, path, libraries in found:
        file_id = spdx_id("File-" + name)
        document.files.append({
            "fileName": "./" + name,
            "SPDXID": file_id,
            "fileTypes": ["BINARY"],
            "checksums": checksums(path),
            "licenseConcluded": build["licence"],
            "licenseInfoInFiles": ["NOASSERTION"],
            "copyrightText": build["copyright"],
        })
        document.relate(root["SPDXID"], "CONTAINS", file_id)
        for library in libraries:
            if library not in external:
                component = next(of for file, of in ours.items() if file.startswith(library))
                if component in components:
                    other = next(spdx_id("File-" + name) for of, name, path, _ in found
                                 if of == component and path.name.startswith(library))
                else:
                    other = document.add_dependency(f"{build['name']}-{component}",
                                                    build["version"], None)
                    package = document.packages[f"{build['name']}-{component}"]
                    package["downloadLocation"] = root["downloadLocation"]
                    package["licenseDeclared"] = root["licenseDeclared"]
                    package["supplier"] = root["supplier"]
                    document.relate(root["SPDXID"], "DEPENDS_ON", other)
            else:
                key = of_library(library)
                other = document.add_dependency(key, versions.get(key),
                                                debian.of(paths.get(library)))
                document.relate(root["SPDXID"], "DEPENDS_ON", other)
            document.relate(file_id, "DYNAMIC_LINK", other)
    if found:
        sums = sorted(file["checksums"][0]["checksumValue"] for file in document.files)
        root["packageVerificationCode"] = {"packageVerificationCodeValue": hashlib.sha1(
            "".join(sums).encode("ascii")).hexdigest()}

    for entry in declared:
        other = document.add_dependency(entry["key"], entry["version"], debian.of(entry["file"]))
        if entry["kind"] == "BUILD_TOOL_OF":
            document.relate(other, "BUILD_TOOL_OF", root["SPDXID"])
        else:
            document.relate(root["SPDXID"], entry["kind"], other)
    return document.text()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=pathlib.Path, help="description of the build, JSON")
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--component", help="of the installation; else the whole build")
    parser.add_argument("--prefix", type=pathlib.Path, help="where the files are installed")
    arguments = parser.parse_args()
    build = json.loads(arguments.build.read_text(encoding="utf-8"))
    text = make(build, arguments)
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    arguments.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
