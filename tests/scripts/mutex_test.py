#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""clang refuses code that uses guarded data without its mutex (libruntime/base/mutex.h)."""
import pathlib
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
COUNTER = """
#include "base/mutex.h"
namespace mauve {
class Counter {
 public:
  void add() { BODY }

 private:
  void add_locked() MAUVE_REQUIRES(mutex_) { ++count_; }
  Mutex mutex_;
  int count_ MAUVE_GUARDED_BY(mutex_) = 0;
};
void use() { Counter().add(); }
}
"""


class GuardedData(unittest.TestCase):
    def compile(self, body):
        done = subprocess.run(
            ["clang++", "-std=c++20", "-Werror", "-Wthread-safety", "-fsyntax-only", "-x", "c++",
             f"-I{ROOT / 'libruntime'}", "-"],
            input=COUNTER.replace("BODY", body), capture_output=True, text=True, check=False)
        return done.returncode, done.stderr

    def test_is_used_while_the_mutex_is_held(self):
        self.assertEqual(self.compile("const MutexLock lock(mutex_); ++count_; add_locked();"), (0, ""))

    def test_is_refused_without_the_mutex(self):
        for body in ("++count_;", "add_locked();", "MutexLock lock(mutex_); lock.unlock(); ++count_;"):
            code, errors = self.compile(body)
            self.assertNotEqual(code, 0, body)
            self.assertIn("holding mutex 'mutex_'", errors)


if __name__ == "__main__":
    unittest.main()
