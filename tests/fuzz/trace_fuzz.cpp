// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes as a trace file: it is refused with a reason, or all that is done with traces ends
// well.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "mtrace/check.h"
#include "mtrace/chrome.h"
#include "mtrace/ctf.h"
#include "mtrace/file.h"
#include "mtrace/timeline.h"

namespace {

using namespace mauve::ctl::mtrace;

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  Reader reader;
  reader.feed(text.substr(0, size / 2));
  reader.feed(text.substr(size / 2));
  const auto trace = reader.finish();
  if (!trace) {
    require(!trace.error().message.empty());
    return 0;
  }
  // A trace that is written and read again stays the same.
  std::ostringstream first;
  write(*trace, first);
  Reader again;
  again.feed(first.str());
  const auto same = again.finish();
  require(same.has_value() && same->reading.complete && same->reading.broken == 0);
  std::ostringstream second;
  write(*same, second);
  require(first.str() == second.str());
  std::ostringstream chrome;
  write_chrome(*trace, chrome);
  require(mauve::protocol::parse_json(chrome.str()).has_value());
  require(!ctf_stream(*trace).empty() && !ctf_metadata(*trace).empty());
  const Verdict verdict = check(*trace);
  require(verdict.holds() == !verdict.first);
  require(draw_timeline(*trace, {}).svg.size() < 4'000'000);
  return 0;
}
