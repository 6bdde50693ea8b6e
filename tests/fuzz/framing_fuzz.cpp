// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes come in any pieces. The same lines come out, and every line is a request or a refusal
// that can be answered. An accepted request survives being written again, and its arguments are
// checked.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/methods.h"

namespace {

using namespace mauve::protocol;

void require(bool condition) {
  if (!condition) std::abort();
}

std::vector<std::string> lines_of(std::string_view stream, std::size_t piece) {
  LineFramer framer(4096);
  while (!stream.empty()) {
    const auto size = std::min(piece, stream.size());
    if (!framer.feed(stream.substr(0, size))) break;
    stream.remove_prefix(size);
  }
  std::vector<std::string> lines;
  while (auto line = framer.next()) lines.push_back(*line);
  return lines;
}

void check_request(const std::string& line) {
  auto parsed = parse_request(line);
  if (auto* refusal = std::get_if<Refusal>(&parsed)) {
    require(refusal->fault.code < 0 && !refusal->fault.message.empty());
    require(parse_server_message(to_line(make_error(refusal->id, refusal->fault))).has_value());
    return;
  }
  const auto& request = std::get<Request>(parsed);
  const auto again =
      parse_request(to_line(make_request(request.id, request.method, request.params)));
  require(std::holds_alternative<Request>(again));
  if (const Method* method = find_method(request.method)) {
    [[maybe_unused]] const auto fault = check_params(*method, request.params);
  } else {
    require(unknown_method(request.method).code == kUnknownMethod);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view stream(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto lines = lines_of(stream, 1 + data[0]);
  require(lines == lines_of(stream, stream.size() + 1));
  for (const auto& line : lines) {
    check_request(line);
    [[maybe_unused]] const auto message = parse_server_message(line);
  }
  return 0;
}
