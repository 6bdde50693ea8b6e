// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes: parse() answers with a Spec or with problems that have a place; what it accepts as
// JSON is the same after writing and reading it again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "arch/parse/parse.h"
#include "arch/text/json.h"
#include "arch/text/value_json.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace arch = mauve::arch;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  arch::Problems problems;
  const auto spec = arch::parse(text, problems);
  require(spec.has_value() || !problems.empty());
  for (const arch::Problem& problem : problems.sorted()) {
    require(problem.where.line > 0 && problem.where.column > 0);
    require(!problem.error.message.empty());
  }
  arch::Problems none;
  if (const auto node = arch::parse_json(text, none); node && none.empty()) {
    const mauve::Value value = arch::to_value(*node);
    arch::JsonLimits wide;
    wide.bytes = std::size_t{1} << 30U;
    const auto again = arch::parse_json(arch::to_json_text(value), none, wide);
    require(again.has_value() && arch::to_value(*again) == value);
  }
  return 0;
}
