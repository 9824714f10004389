"""doc/check_links.py finds each kind of fault, and nothing in a tree that has none."""

import contextlib
import io
import pathlib
import tempfile
import unittest

import check_links
import markdown_files as md

HELP = """#!/bin/sh
cat <<'END'
Usage: pcl_spherical_param_scan SHAPE output [options]

  -points N    number of points
  -h           show this help (also -help)
END
"""

GOOD = {
    "README.md": """# A project

See [the guide](doc/guide.md), [its end](doc/guide.md#the-end), [here](#a-project), a link whose text
[goes on in the
next line](doc), <https://example.org>, [out](https://example.org/x?y=1#z) and `[no link](in code)`.

```sh
pcl_spherical_param_scan hand out.ply \\
  -points 20 --points=30   # -unknown in a comment
other_program -whatever
```
""",
    "doc/guide.md": """# Guide

![A picture](pictures/a.png) and `build()`, with `-points N`.

```cpp
int main() {
```

## The end
""",
    "doc/pictures/a.png": "",
    "doc/tutorials/x/x.cpp": "// x\nint main() {\n}\n",
    "include/x.h": "void build(int);\n",
    "build/release/old.md": "[broken](nowhere.md)\n",
}


class Trees(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        for name, text in GOOD.items():
            self.write(name, text)
        self.write("bin/pcl_spherical_param_scan", HELP)
        (self.root / "bin/pcl_spherical_param_scan").chmod(0o755)

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def add(self, name, text):
        self.write(name, GOOD[name] + text)

    def check(self, *more):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            code = check_links.main(["--root", str(self.root), *more])
        return code, out.getvalue()

    def finds(self, expected, *more):
        code, out = self.check(*more)
        self.assertEqual(code, 1, out)
        self.assertIn(expected, out)
        self.assertIn("\n1 fault\n", out)


class Sources(Trees):
    def test_nothing_is_found_where_nothing_is_wrong(self):
        code, out = self.check("--tools", str(self.root / "bin"))
        self.assertEqual(code, 0, out)
        self.assertIn("2 Markdown files", out)

    def test_a_link_to_a_file_that_is_not_there(self):
        self.add("README.md", "[gone](doc/gone.md)\n")
        self.finds("README.md:12: 'doc/gone.md': there is no doc/gone.md")

    def test_the_same_in_other_letters_is_another_file(self):
        self.add("README.md", "[guide](doc/Guide.md)\n")
        self.finds("there is no doc/Guide.md")

    def test_a_link_that_goes_on_in_the_next_line(self):
        self.add("README.md", "[not\nhere](doc/gone.md)\n")
        self.finds("README.md:12: 'doc/gone.md'")

    def test_an_anchor_that_no_heading_has(self):
        self.add("README.md", "[end](doc/guide.md#end)\n")
        self.finds("doc/guide.md has no heading 'end'")

    def test_an_anchor_of_the_same_page(self):
        self.add("doc/guide.md", "[up](#top)\n")
        self.finds("doc/guide.md has no heading 'top'")

    def test_a_heading_in_a_block_of_code_is_none(self):
        self.add("doc/guide.md", "```\n## Hidden\n```\n\n[it](#hidden)\n")
        self.finds("has no heading 'hidden'")

    def test_a_definition_of_a_link(self):
        self.add("README.md", "[guide][1]\n\n[1]: doc/gone.md\n")
        self.finds("there is no doc/gone.md")

    def test_a_link_out_of_the_tree(self):
        self.add("README.md", "[up](../other/README.md)\n")
        self.finds("leaves the tree")

    def test_a_picture_that_is_not_there(self):
        self.add("doc/guide.md", "![b](pictures/b.png)\n")
        self.finds("there is no doc/pictures/b.png")

    def test_a_picture_that_no_page_shows(self):
        self.write("doc/pictures/b.png", "")
        self.finds("doc/pictures/b.png: no page shows this picture")

    def test_an_external_address_that_is_none(self):
        for link in ("https://", "https:/example.org", "http://example", "ftpp://example.org"):
            self.add("README.md", f"[out]({link})\n")
            self.finds(f"'{link}'")

    def test_external_addresses_are_listed(self):
        _, out = self.check("--external")
        self.assertIn("external: https://example.org/x?y=1#z", out)

    def test_an_option_that_the_tool_does_not_have(self):
        self.add("README.md", "```sh\npcl_spherical_param_scan hand out.ply -points 5 -smoth 3\n```\n")
        self.finds("'-smoth': pcl_spherical_param_scan has no such option", "--tools", str(self.root / "bin"))

    def test_an_option_in_the_second_line_of_a_command(self):
        self.add("README.md", "```sh\npcl_spherical_param_scan hand out.ply \\\n  --smoth=3\n```\n")
        self.finds("'--smoth=3'", "--tools", str(self.root / "bin"))

    def test_an_option_in_a_sentence(self):
        self.add("doc/guide.md", "Take `-smoth N`.\n")
        self.finds("no tool has the option '-smoth'", "--tools", str(self.root / "bin"))

    def test_a_folder_without_tools(self):
        self.finds("there are no tools here", "--tools", str(self.root / "doc"))

    def test_code_that_is_in_no_example(self):
        self.add("doc/guide.md", "```cpp\nint main()  {\n```\n")
        self.finds("this block is in no file of doc/tutorials")

    def test_a_function_that_no_header_has(self):
        self.add("doc/guide.md", "Call `unbuild()`.\n")
        self.finds("no public header has 'unbuild()'")


class Site(Trees):
    def setUp(self):
        super().setUp()
        self.write("site/index.html", '<a href="a.html#x">a</a><img src="i.png"><a href="#here" id="here">')
        self.write("site/a.html", '<h1 id="x">x</h1><a href="https://example.org">out</a>')
        self.write("site/i.png", "")
        self.site = ["--site", str(self.root / "site")]

    def test_nothing_is_found_where_nothing_is_wrong(self):
        code, out = self.check(*self.site)
        self.assertEqual(code, 0, out)
        self.assertIn("site: 4 links", out)

    def test_a_page_a_picture_and_an_anchor_that_are_not_there(self):
        self.write("site/b.html", '<a href="c.html">')
        self.finds("b.html:1: 'c.html': there is no c.html", *self.site)
        self.write("site/b.html", '<img src="j.png">')
        self.finds("'j.png': there is no j.png", *self.site)
        self.write("site/b.html", '<a href="a.html#y">')
        self.finds("a.html has no anchor 'y'", *self.site)

    def test_no_site(self):
        (self.root / "site/index.html").unlink()
        self.finds("there is no index.html here", *self.site)


class Anchors(unittest.TestCase):
    def test_are_those_of_github(self):
        for heading, anchor in (
            ("The map to the sphere", "the-map-to-the-sphere"),
            ("In C++", "in-c"),
            ("What is `-smooth N`?", "what-is--smooth-n"),
            ("[Link](x.md) and **bold**", "link-and-bold"),
            ("CGAL's advancing front", "cgals-advancing-front"),
            ("pcl_spherical_param_scan", "pcl_spherical_param_scan"),
            ("Größe & Form", "größe--form"),
        ):
            self.assertEqual(md.anchor(heading), anchor)

    def test_that_repeat_are_numbered(self):
        self.assertEqual([h[3] for h in md.headings("# A\n## A\n## B\n## A\n")], ["a", "a-1", "b", "a-2"])


if __name__ == "__main__":
    unittest.main()
