#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The harness of the pages (tests/external) is checked on made-up pages: it must find what is wrong with one."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "external"))
import change_file  # noqa: E402
import page_test  # noqa: E402


def wrong(text):
    """The complaints about a page in an empty home folder."""
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder) / "page.md"
        page.write_text(text, "utf-8")
        steps = page_test.steps_of(str(page))
        done, _ = page_test.run("true", [command for command, _ in steps], folder)
        return list(page_test.judge(steps, done))


class Pages(unittest.TestCase):
    def test_agree_where_only_times_and_attempts_differ(self):
        self.assertEqual(wrong("```console\n$ echo 'pause 7 us, 2 attempts, done'\npause 61 ns, done\n```\n"), [])

    def test_disagree_where_the_output_is_another_one(self):
        self.assertEqual(len(wrong("```console\n$ echo red\ngreen\n$ echo red\nred\n```\n")), 1)

    def test_disagree_where_a_command_without_output_fails(self):
        self.assertEqual(len(wrong("```console\n$ false\n```\n")), 1)

    def test_disagree_where_a_command_with_any_output_fails(self):
        self.assertEqual(len(wrong("```console\n$ echo red; false\n...\n```\n")), 1)
        self.assertEqual(wrong("```console\n$ echo red; false\nred\n```\n"), [])

    def test_run_the_lines_of_a_block_that_is_marked(self):
        block = "```sh\nx=1 &&\n  test $x = 1\ntest $x = 2  # not so\n```\n"
        self.assertEqual(wrong(block), [])
        self.assertEqual(len(wrong("<!-- run -->\n" + block)), 1)
        self.assertEqual(len(wrong("<!-- run -->\n```sh\ntest $x = 1\n```\n")), 1)
        self.assertEqual(wrong("<!-- run after: x=1; cd / -->\n```sh\ntest $x = 1\n```\n"), [])
        self.assertEqual(len(wrong("<!-- run -->\n```\n$ echo red\ngreen\n```\n")), 1)

    def test_end_a_command_as_a_reader_does(self):
        self.assertEqual(wrong("<!-- run -->\n```sh\nsleep 60  # Ctrl-C ends it\n```\n"), [])

    def test_write_change_and_compare_files(self):
        page = ("Write this into `a/b.txt`:\n```text\none\ntwo\n```\n"
                "Change `a/b.txt`:\n```diff\n one\n-two\n+three\n```\n"
                "The file `a/b.txt` contains:\n```text\none\nWORD\n```\n")
        self.assertEqual(wrong(page.replace("WORD", "three")), [])
        self.assertEqual(len(wrong(page.replace("WORD", "two"))), 1)

    def test_change_a_file_only_where_the_place_is_clear(self):
        self.assertEqual(change_file.changed("a\nb\na\n", " b\n-a\n+c\n"), "a\nb\nc\n")
        self.assertEqual(change_file.changed("a\nb\n", "-a\n@@\n+c\n b\n"), "c\nb\n")
        for block in ("-a\n", "-z\n+y\n"):
            self.assertRaises(ValueError, change_file.changed, "a\nb\na\n", block)

    def test_begin_with_the_files_of_the_page_before(self):
        with tempfile.TemporaryDirectory() as folder:
            first, second = pathlib.Path(folder) / "1.md", pathlib.Path(folder) / "2.md"
            first.write_text("Write this into `x`:\n```text\none\n```\n```console\n$ false\n```\n", "utf-8")
            second.write_text("Begin with the files of\n[page 1](1.md).\n```console\n$ cat ~/x\none\n```\n", "utf-8")
            steps = page_test.steps_of(str(second))
            done, _ = page_test.run("true", [command for command, _ in steps], folder)
            self.assertEqual(list(page_test.judge(steps, done)), [])
            self.assertEqual(len(steps), 2)


if __name__ == "__main__":
    unittest.main()
