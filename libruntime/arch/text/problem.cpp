// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/problem.h"

#include <algorithm>
#include <utility>

namespace mauve::arch {

std::string to_string(const Problem& problem, std::string_view file) {
  std::string text(file);
  if (problem.where.line != 0) {
    text += ':' + std::to_string(problem.where.line) + ':' + std::to_string(problem.where.column);
  }
  if (!text.empty()) text += ": ";
  return text + to_string(problem.error);
}

std::string summary(const std::vector<Problem>& problems) {
  const Problem& first = problems.front();
  const bool more = problems.size() > 1;
  std::string text =
      "has " + std::to_string(problems.size()) + (more ? " errors, the first" : " error");
  if (first.where.line != 0) text += " in line " + std::to_string(first.where.line);
  text += ": ";
  if (!first.error.at.empty()) text += first.error.at + ": ";
  return text + first.error.message;
}

void Problems::add(Position where, Error error) { found_.push_back({where, std::move(error)}); }

void Problems::add(Position where, Reason reason, std::string at, std::string message,
                   std::string hint) {
  add(where, refuse(reason, std::move(at), std::move(message), std::move(hint)));
}

std::vector<Problem> Problems::sorted() const {
  std::vector<Problem> problems = found_;
  const auto order = [](const Problem& problem) {
    return std::pair(problem.where.line == 0, problem.where);
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Problem& a, const Problem& b) { return order(a) < order(b); });
  return problems;
}

}  // namespace mauve::arch
