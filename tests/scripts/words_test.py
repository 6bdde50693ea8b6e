#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The check of retired words on made-up trees."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "words.py"
GLOSSARY = """# Glossary

| word | meaning | retired |
|---|---|---|
| standby core | takes over | `Oldword` `oldword_of` |
| slot | has one owner | `*spot*` `*long_gone*` `*Bygone*` |

| key | other table |
|---|---|
| `kept` | `Kept` |
"""


class Words(unittest.TestCase):
    def check(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in {"docs/glossary.md": GLOSSARY, **files}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text, "utf-8")
            done = subprocess.run([sys.executable, SCRIPT, root], capture_output=True, text=True, check=False)
            return done.returncode, done.stdout + done.stderr

    def test_accepts_words_that_are_not_retired(self):
        self.assertEqual(self.check({"ctl/a.cpp": "int kept, oldword, Oldwords, my_Oldword;\n"}),
                         (0, "words: no retired word is in use\n"))

    def test_refuses_an_identifier(self):
        code, output = self.check({"daemon/a.h": "\nclass Oldword;\n"})
        self.assertEqual(code, 1)
        self.assertIn("daemon/a.h:2: Oldword is retired; write 'standby core'", output)

    def test_refuses_a_key_of_json_a_message_and_a_document(self):
        for name, text in (("etc/a.json", '{"Oldword": 1}'), ("ctl/a.cpp", 'f("no Oldword here");'),
                           ("README.md", "`oldword_of` is"), ("scripts/a.py", "# Oldword")):
            with self.subTest(name):
                self.assertEqual(self.check({name: text})[0], 1)

    def test_refuses_a_marked_word_within_an_identifier_of_any_style(self):
        for name in ("was_long_gone_by", "kLongGone", "LongGone", "long_gone", "is_spot", "spot_", "FreeSpot", "kSpot",
                     "BygoneThing", "is_bygone"):
            with self.subTest(name):
                code, output = self.check({"daemon/a.h": f"int {name};\n"})
                self.assertEqual(code, 1)
                self.assertIn(f"daemon/a.h:1: {name} is retired; write 'slot'", output)

    def test_accepts_a_marked_word_of_ordinary_english_in_prose_and_within_other_words(self):
        self.assertEqual(self.check({"daemon/a.h": "/// The spot is bygone. Spot on: long gone, spotless, spots.\n"
                                                   "int spotless, is_spotless, FreeSpots, gone_long;\n"})[0], 0)

    def test_refuses_a_retired_word_in_the_name_of_a_file(self):
        for name in ("ctl/spot_test.cpp", "docs/long-gone.md", "ctl/oldword.cpp", "ctl/oldword_of.h", "ctl/spot.h"):
            with self.subTest(name):
                code, output = self.check({name: "\n"})
                self.assertEqual(code, 1)
                self.assertIn(f"{name}: a file is named", output)

    def test_accepts_the_names_of_other_files(self):
        self.assertEqual(self.check({"ctl/spotless.cpp": "\n", "ctl/gone_long.cpp": "\n"})[0], 0)

    def test_leaves_the_past_as_it_was(self):
        past = {"CHANGELOG.md": "Oldword", "docs/decisions/0001-a.md": "Oldword"}
        self.assertEqual(self.check(past)[0], 0)

    def test_refuses_a_glossary_that_retires_nothing(self):
        code, output = self.check({"docs/glossary.md": "# Glossary\n"})
        self.assertEqual(code, 1)
        self.assertIn("no table has a column", output)


if __name__ == "__main__":
    unittest.main()
