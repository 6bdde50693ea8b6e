// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes as what a Hokuyo scanner says. The first four bytes choose the scans that are asked
// for; everything that is believed stays within what was asked, and becomes a scan of numbers.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "../../plugins/drivers/laser/scip_write.h"

namespace {

namespace scip = drivers::scip;

void require(bool condition) {
  if (!condition) std::abort();
}

void check_scan(const scip::ReplyReader& reader, const scip::Limits& limits) {
  const auto values = reader.values();
  require(values.size() == reader.request().values());
  for (const std::uint32_t value : values) require(value < (1U << 18U));
  rover::LaserScan scan;
  scip::show(reader.request(), limits, values, scan);
  require(std::isfinite(scan.angle_min) && std::isfinite(scan.angle_increment));
  for (const float range : scan.ranges) require(std::isfinite(range) && range >= 0.0F);
  // The writer writes a scan as it was read.
  if (reader.request().cluster != 1) return;
  scip::ReplyWriter writer;
  scip::ReplyReader again;
  again.expect(reader.request());
  bool same = false;
  for (const char byte : writer.scan(reader.request(), reader.stamp(), values)) {
    if (again.push(byte) != scip::ReplyReader::Event::scan) continue;
    same = again.stamp() == reader.stamp() &&
           std::equal(values.begin(), values.end(), again.values().begin(), again.values().end());
  }
  require(same);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  const int first = data[0];
  scip::Request request{first, first + data[1] % 64, 1 + data[2] % 3, data[3] % 2 == 0 ? 3 : 2};
  scip::Limits limits{20, 5600, 1024, 44, 725, 384, 600};
  scip::ReplyReader reader;
  reader.expect(request);
  for (std::size_t i = 4; i < size; ++i) {
    switch (reader.push(static_cast<char>(data[i]))) {
      case scip::ReplyReader::Event::scan:
        check_scan(reader, limits);
        break;
      case scip::ReplyReader::Event::reply:
        if (reader.command() != "PP" || reader.status() != "00" || !reader.limits().usable()) break;
        limits = reader.limits();
        request = scip::Request::all(limits, request.characters);
        require(request.values() > 0 && request.values() <= scip::kMostValues);
        break;
      case scip::ReplyReader::Event::bad:
      case scip::ReplyReader::Event::none:
        break;
    }
  }
  // The request as a simulated scanner would hear it.
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto heard = scip::Request::parse(text)) {
    const auto words = heard->text();
    require(scip::Request::parse({words.data(), words.size()}) == heard);
  }
  return 0;
}
