#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when the structure of the source grows beyond its budget.

Usage: structure.py [ROOT]      prints one line for each violation: file[:line]: what, and what to do instead
       structure.py --figures   prints today's figures: medians, the largest, and how many are over the budget

Five budgets: how deep the own includes of a file go, how many functions a class has, how many parameters a function
has, how many files a folder holds, and that a function is defined in the source that is named like its header.
An exception has a ceiling, which is today's value. The value may fall, and the ceiling then falls with it; it may
not rise.
"""
import collections
import functools
import pathlib
import re
import statistics
import sys

import command_line
from declarations import functions_of
from layers import INCLUDE, layer_of, resolve, sources
from lines import TOKENS

INCLUDE_DEPTH = 12
CLASS_FUNCTIONS = 25
PARAMETERS = 6
FOLDER_FILES = 25
PLUGIN_LINES = 50  # a goal for the median; no budget

# Layer: the depth that its files reach today.
DEEP_LAYERS = {}
# Class: its functions today.
LARGE_CLASSES = {
    "daemon/state/state_store.h:StateStore": 33,
    "libruntime/exec/commit/commit.h:Commit": 40,
    "libruntime/exec/recovery/probation_period.h:ProbationPeriod": 34,
    "libruntime/exec/run/threads.cpp:Threads": 29,
    "libruntime/include/mauve/host/deployer.h:Deployer": 57,
    "libruntime/include/mauve/detail/resource_lock.h:ResourceLock": 33,
    "libruntime/include/mauve/detail/latest_value.h:LatestValue": 31,
    "serial/include/mauve/serial/line_thread.h:LineThread": 29,
}
# Function: its parameters today.
MANY_PARAMETERS = {
    "ProbationPeriod::ProbationPeriod": 7,
}
# Folder: its files today.
CROWDED_FOLDERS = {}
# Headers that are a list: they declare one function of each of many sources, so that one table can name them all.
LISTS = {
    "ctl/commands/actions.h",
    "ctl/doctor/checks.h",
    "ctl/mtrace/findings.h",
    "ctl/render/render.h",
    "daemon/commands/command.h",
    "plugins/drivers/parts.h",
    "plugins/guidance/cores.h",
    "plugins/navigation/parts.h",
    "plugins/ros/parts.h",
    "plugins/teleop/parts.h",
}
# Folder: the list that declares the functions of the rows in its files NAME.def. Group 1 of ROW is the function.
TABLES = {"daemon/protocol/table": "daemon/commands/command.h"}
ROW = re.compile(r'^MAUVE_METHOD\("[\w.]+", (\w+),', re.MULTILINE)
# Source: functions that other headers declare, today.
STRAYS = {
    "ctl/cli/help.cpp": 1,
    "ctl/doctor/checks.cpp": 1,
    "ctl/picture/graph_dot.cpp": 3,
    "ctl/picture/graph_mermaid.cpp": 3,
    "ctl/picture/graph_svg.cpp": 1,
    "ctl/picture/layers_columns.cpp": 1,
    "ctl/picture/layers_place.cpp": 1,
    "ctl/picture/layers_split.cpp": 1,
    "ctl/picture/layers_trunks.cpp": 1,
    "ctl/picture/machine_svg.cpp": 1,
    "ctl/top/top_frame.cpp": 2,
    "ctl/top/top_keys.cpp": 2,
    "ctl/top/top_rows.cpp": 4,
    "daemon/check.cpp": 1,
    "daemon/commands/change/kept.cpp": 1,
    "daemon/commands/config.cpp": 1,
    "daemon/commands/look/log.cpp": 1,
    "daemon/commands/look/log_level.cpp": 1,
    "daemon/commands/recovery/probation.cpp": 2,
    "daemon/log/journal.cpp": 1,
    "libruntime/exec/commit/commit_books.cpp": 13,
    "libruntime/exec/task/job_runner.cpp": 2,
    "libruntime/model/element/elements.cpp": 2,
    "libruntime/rt/time/measured.cpp": 2,
    "libruntime/rt/ring/trace_names.cpp": 5,
    "libruntime/rules/parse_condition.cpp": 1,
    "plugins/navigation/pgm.cpp": 1,
}

# Registers a core, component or resource, or is the class of a core that another source registers.
KIND = re.compile(r"\bplugin\.(?:core|component|resource)<|\b(?:class|struct) \w+ final : public [\w:]*(?:Core|Driver)\b")
CLASS = re.compile(r"^\s*(?:class|struct) \w+[^;]*?\{", re.MULTILINE)


def lines_of_code(text):
    """How many lines hold more than a comment or nothing."""
    bare = TOKENS.sub(lambda match: "" if match[0].startswith("/") else match[0], text)
    return sum(bool(line.strip()) for line in bare.split("\n"))


class Tree:
    """The product's sources below a folder: their texts, includes and functions."""

    def __init__(self, root):
        self.root = root
        self.text = {path: (root / path).read_text(encoding="utf-8") for path in sources(root)
                     if not path.startswith(("tests/", "scripts/"))}

    @functools.cached_property
    def includes(self):
        return {path: [target for name in INCLUDE.findall(text)
                       if (target := resolve(self.root, path, name)) and target != path]
                for path, text in self.text.items()}

    @functools.cached_property
    def functions(self):
        return {path: functions_of(text) for path, text in self.text.items()}

    @functools.cached_property
    def depths(self):
        """File: the longest way through own headers that begins there; a circle counts once."""
        known, open_files = {}, set()

        def depth(path):
            if path not in known:
                open_files.add(path)
                known[path] = max((1 + depth(target) for target in self.includes.get(path, ())
                                   if target not in open_files), default=0)
                open_files.discard(path)
            return known[path]

        sys.setrecursionlimit(10000)
        return {path: depth(path) for path in self.text}

    @functools.cached_property
    def class_sizes(self):
        """(file, class): its functions, but for those that the compiler writes or that are deleted."""
        return collections.Counter((path, function.in_class) for path, functions in self.functions.items()
                                   for function in functions if function.in_class and not function.defaulted)

    @functools.cached_property
    def folders(self):
        return collections.Counter(str(pathlib.PurePosixPath(path).parent) for path in self.text)

    @functools.cached_property
    def plugin_sizes(self):
        """Source without ending: lines of code, for each source below plugins/ that defines a kind of component or
        resource, or a core; the header of the same name counts with it. A mere list of registrations does not count."""
        groups = collections.defaultdict(list)
        for path, text in self.text.items():
            if path.startswith("plugins/"):
                groups[str(pathlib.PurePosixPath(path).with_suffix(""))].append(text)
        return {name: sum(map(lines_of_code, texts)) for name, texts in groups.items()
                if any(map(KIND.search, texts)) and any(map(CLASS.search, texts))}

    @functools.cached_property
    def definitions(self):
        """(source, function, the headers that declare it) of each function that other sources can call."""
        declared = collections.defaultdict(set)
        for path, functions in self.functions.items():
            for function in functions:
                if path.endswith(".h") and not function.body and not function.defaulted:
                    declared[function.name].add(path)
        for folder, header in TABLES.items():
            for table in (self.root / folder).glob("*.def"):
                for name in ROW.findall(table.read_text(encoding="utf-8")):
                    declared[name].add(header)
        found = []
        for path, functions in self.functions.items():
            for function in functions:
                if path.endswith(".cpp") and function.body and not function.hidden and not function.in_class:
                    headers = declared.get(function.name)
                    if headers:
                        found.append((path, function, headers))
        return found

    @functools.cached_property
    def strays(self):
        """The definitions that stand in a source that is not named like a header that declares them."""
        return [(path, function, headers) for path, function, headers in self.definitions
                if not headers & LISTS and
                pathlib.PurePath(path).stem not in {pathlib.PurePath(header).stem for header in headers}]


def ceiling_problem(what, value, budget, ceilings, key):
    """Why a value breaks its budget or its ceiling, or None."""
    ceiling = ceilings.get(key)
    if ceiling is None:
        return None if value <= budget else f"{what.format(value)}, the limit is {budget}"
    if value > ceiling:
        return f"{what.format(value)}, today's ceiling of this exception is {ceiling}"
    if value <= budget:
        return f"{what.format(value)} and is no exception any more: remove it from scripts/structure.py"
    return None if value == ceiling else f"{what.format(value)}: lower the ceiling in scripts/structure.py from {ceiling}"


def depth_problems(tree):
    deepest = {}
    for path, depth in tree.depths.items():
        layer = layer_of(path)
        if depth > deepest.get(layer, ("", -1))[1]:
            deepest[layer] = (path, depth)
    for layer, (path, depth) in sorted(deepest.items(), key=str):
        problem = ceiling_problem("its own includes are {} deep", depth, INCLUDE_DEPTH, DEEP_LAYERS, layer)
        if problem:
            yield f"{path}: {problem}; declare what a header only names, and include it in the source"


def class_problems(tree):
    for (path, name), size in sorted(tree.class_sizes.items()):
        problem = ceiling_problem("has {} functions", size, CLASS_FUNCTIONS, LARGE_CLASSES, f"{path}:{name}")
        if problem:
            yield f"{path}: class {name} {problem}; split it by noun"


def parameter_problems(tree):
    for path, functions in tree.functions.items():
        for function in functions:
            problem = ceiling_problem("has {} parameters", function.parameters, PARAMETERS, MANY_PARAMETERS,
                                      function.name)
            if problem:
                yield f"{path}:{function.line}: {function.name} {problem}; give them a structure"


def folder_problems(tree):
    for folder, count in sorted(tree.folders.items()):
        problem = ceiling_problem("holds {} files", count, FOLDER_FILES, CROWDED_FOLDERS, folder)
        if problem:
            yield f"{folder}: {problem}; give what belongs together a folder"


def definition_problems(tree):
    counts = collections.Counter(path for path, _, _ in tree.strays)
    for path, function, headers in tree.strays:
        if counts[path] > STRAYS.get(path, 0):
            yield (f"{path}:{function.line}: {function.name} is declared in {', '.join(sorted(headers))}; "
                   "define it in the source that is named like that header")
    for path, ceiling in STRAYS.items():
        if path in tree.text and counts[path] < ceiling:
            yield f"{path}: {counts[path]} strays: lower the ceiling in scripts/structure.py from {ceiling}"


def spread(name, values, budget):
    values = sorted(values)
    over = sum(value > budget for value in values)
    print(f"{name}: median {statistics.median_low(values)}, largest {values[-1]}, "
          f"{over} of {len(values)} over {budget}")


def figures(tree):
    spread("depth of own includes", tree.depths.values(), INCLUDE_DEPTH)
    spread("functions of a class", tree.class_sizes.values(), CLASS_FUNCTIONS)
    spread("parameters of a function",
           [function.parameters for functions in tree.functions.values() for function in functions], PARAMETERS)
    spread("files of a folder", tree.folders.values(), FOLDER_FILES)
    if tree.plugin_sizes:
        spread("lines of code of a shipped plugin, its header included", tree.plugin_sizes.values(), PLUGIN_LINES)
    for room in ("", "libruntime", "libruntime/exec", "daemon", "ctl", "plugins"):
        total = sum(path.startswith(room) for path, _, _ in tree.definitions)
        strays = sum(path.startswith(room) for path, _, _ in tree.strays)
        print(f"functions defined in another source than their header's, {room or 'all'}: "
              f"{strays} of {total}, {100 * strays / max(total, 1):.1f} %")


def main():
    arguments = command_line.tree(__doc__, "--figures")
    tree = Tree(arguments.root)
    if arguments.figures and tree.text:
        figures(tree)
        return 0
    problems = [problem for rule in (depth_problems, class_problems, parameter_problems, folder_problems,
                                     definition_problems) for problem in rule(tree)]
    return command_line.result(tree.text, problems, f"structure: {len(tree.text)} files are within the budget")


if __name__ == "__main__":
    sys.exit(main())
