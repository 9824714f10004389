"""doc/doxygen_markdown.py makes of GitHub's Markdown what Doxygen 1.9 understands."""

import pathlib
import unittest

import doxygen_markdown

ROOT = pathlib.Path("/tree")


def filtered(text, path="doc/stages/a.md"):
    return doxygen_markdown.Filter(ROOT, path).run(text)


class Filter(unittest.TestCase):
    def test_headings_get_ids_and_the_first_that_of_the_page(self):
        out = filtered("# A `b`\n\n## In C++\n")
        self.assertIn("# A b {#page_doc_stages_a}", out)
        self.assertIn("## In C++ {#page_doc_stages_a__in_c}", out)

    def test_links_to_pages_headings_and_headers_become_references(self):
        self.assertIn("[b](@ref page_doc_stages_b)", filtered("[b](b.md)"))
        self.assertIn("[r](@ref page_readme__the_tools)", filtered("[r](../../README.md#the-tools)"))
        self.assertIn("[here](@ref page_doc_stages_a__x)", filtered("[here](#x)"))
        self.assertIn("[t.h](@ref spherical_param/t.h)", filtered("[t.h](../../include/spherical_param/t.h)"))

    def test_a_link_over_two_lines_is_one_link(self):
        self.assertIn("[two words](@ref page_doc_stages_b)", filtered("see [two\nwords](b.md) here"))

    def test_external_links_stay(self):
        self.assertIn("[x](https://example.org/a#b)", filtered("[x](https://example.org/a#b)"))

    def test_files_that_the_site_does_not_have_are_named(self):
        self.assertIn("`doc/stages/x.cpp`", filtered("[x.cpp](x.cpp)"))

    def test_pictures_are_found_by_their_name(self):
        self.assertIn("![p](p.png)", filtered("![p](../pictures/p.png)"))

    def test_boxes_become_those_of_doxygen(self):
        out = filtered("> [!WARNING]\n> **No guarantees.**\n> - one\n\nText\n")
        self.assertIn("\\warning\n**No guarantees.**\n", out)
        self.assertIn("- one", out)
        self.assertNotIn("> ", out)

    def test_what_looks_like_a_command_is_escaped_in_sentences_and_spans(self):
        self.assertIn("\\@ref", filtered("the word @ref"))
        self.assertIn("<code>a \\| \\@b</code>", filtered("`a | @b`"))
        self.assertIn("&lt;vector&gt;", filtered("`<vector>`"))

    def test_blocks_of_code_stay_as_they_are(self):
        block = "```cpp\n#include <x>  // [a](b.md) @c\n```\n"
        self.assertEqual(filtered(block), block)


if __name__ == "__main__":
    unittest.main()
