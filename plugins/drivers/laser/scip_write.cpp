// SPDX-License-Identifier: LGPL-3.0-or-later
#include "scip_write.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace drivers::scip {

std::string_view ReplyWriter::reply(std::string_view echo, std::string_view status) {
  size_ = 0;
  add(echo.substr(0, TextReader::kLongest));
  add("\n");
  add_summed(status);
  add("\n");
  return {buffer_.data(), size_};
}

std::string_view ReplyWriter::limits(std::string_view echo, const Limits& limits) {
  reply(echo, "00");
  --size_;  // the empty line comes after the fields
  field("DMIN", limits.dmin);
  field("DMAX", limits.dmax);
  field("ARES", limits.ares);
  field("AMIN", limits.amin);
  field("AMAX", limits.amax);
  field("AFRT", limits.afrt);
  field("SCAN", limits.scan);
  add("\n");
  return {buffer_.data(), size_};
}

std::string_view ReplyWriter::scan(const Request& request, std::uint32_t stamp,
                                   std::span<const std::uint32_t> steps) {
  const std::array<char, 15> echo = request.text();
  reply({echo.data(), echo.size()}, "99");
  --size_;
  std::array<char, 4> clock{};
  encode(stamp & 0xffffffU, clock);
  add_summed({clock.data(), clock.size()});
  const std::uint32_t largest = request.characters == 2 ? 0xfffU : 0x3ffffU;
  const auto cluster = static_cast<std::size_t>(request.cluster);
  std::array<char, kBlock> block{};
  std::size_t in_block = 0;
  for (std::size_t at = 0; at < steps.size(); at += cluster) {
    const auto group = steps.subspan(at, std::min(cluster, steps.size() - at));
    std::array<char, 3> value{};
    const std::span<char> characters(value.data(), static_cast<std::size_t>(request.characters));
    encode(std::min(*std::min_element(group.begin(), group.end()), largest), characters);
    for (const char character : characters) {
      block[in_block++] = character;
      if (in_block < kBlock) continue;
      add_summed({block.data(), in_block});
      in_block = 0;
    }
  }
  if (in_block > 0) add_summed({block.data(), in_block});
  add("\n");
  return {buffer_.data(), size_};
}

void ReplyWriter::add(std::string_view text) {
  const std::size_t room = std::min(text.size(), buffer_.size() - size_);
  std::copy_n(text.begin(), room, buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += room;
}

void ReplyWriter::add_summed(std::string_view text) {
  const std::array<char, 2> tail{checksum(text), '\n'};
  add(text);
  add({tail.data(), tail.size()});
}

void ReplyWriter::field(std::string_view name, int value) {
  std::array<char, 24> text{};
  std::copy(name.begin(), name.end(), text.begin());
  text[name.size()] = ':';
  char* const begin = text.data() + name.size() + 1;
  const char* const end = std::to_chars(begin, text.data() + text.size(), value).ptr;
  const std::string_view said(text.data(), static_cast<std::size_t>(end - text.data()));
  const std::array<char, 3> tail{';', checksum(said), '\n'};
  add(said);
  add({tail.data(), tail.size()});
}

std::size_t measure(const rover::LaserScan& scan, std::uint32_t nothing,
                    std::span<std::uint32_t> steps) {
  const std::size_t count = std::min(scan.ranges.size(), steps.size());
  for (std::size_t i = 0; i < count; ++i) {
    const float range = scan.ranges[i];
    if (scan.valid(i)) {
      steps[i] = static_cast<std::uint32_t>(std::lround(range * 1000.0F));
    } else {
      steps[i] = range >= scan.range_max ? nothing : 0;
    }
  }
  return count;
}

Limits limits_of(const rover::LaserScan& scan, int turns_a_minute) {
  if (scan.ranges.empty() || !(scan.angle_increment > 1e-4F) || !(scan.range_max < 250.0F))
    return {};
  const auto whole = [](double value) { return static_cast<int>(std::lround(value)); };
  const auto increment = static_cast<double>(scan.angle_increment);
  Limits limits;
  limits.dmin = whole(static_cast<double>(scan.range_min) * 1000.0);
  limits.dmax = whole(static_cast<double>(scan.range_max) * 1000.0);
  limits.ares = whole(2.0 * std::numbers::pi / increment);
  limits.afrt = limits.ares / 2;
  limits.amin = limits.afrt + whole(static_cast<double>(scan.angle_min) / increment);
  limits.amax = limits.amin + static_cast<int>(scan.ranges.size()) - 1;
  limits.scan = turns_a_minute;
  return limits;
}

}  // namespace drivers::scip
