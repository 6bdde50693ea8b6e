// SPDX-License-Identifier: LGPL-3.0-or-later
#include "scip.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace drivers::scip {
namespace {

constexpr char kZero = 0x30;
constexpr int kBits = 6;
constexpr int kMostStep = 9999;  // four digits

struct KnownLimit {
  std::string_view name;
  int Limits::*limit;
};
constexpr std::array<KnownLimit, 7> kLimits{{{"DMIN", &Limits::dmin},
                                             {"DMAX", &Limits::dmax},
                                             {"ARES", &Limits::ares},
                                             {"AMIN", &Limits::amin},
                                             {"AMAX", &Limits::amax},
                                             {"AFRT", &Limits::afrt},
                                             {"SCAN", &Limits::scan}}};
constexpr unsigned kAllLimits = (1U << kLimits.size()) - 1;

constexpr bool is_character(char byte) { return byte >= kZero && byte < kZero + (1 << kBits); }

std::optional<int> number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) return {};
  return value;
}

/// A line without its last character, when that is the checksum of the rest.
std::optional<std::string_view> checked(std::string_view line) {
  if (line.empty()) return {};
  const std::string_view text = line.substr(0, line.size() - 1);
  if (checksum(text) != line.back()) return {};
  return text;
}

/// "DMIN:20" of "DMIN:20;4". The UTM-30LX leaves a comment that begins with "<-" out of its sum.
std::optional<std::string_view> checked_field(std::string_view line) {
  if (line.size() < 2 || line[line.size() - 2] != ';') return {};
  const std::string_view text = line.substr(0, line.size() - 2);
  const std::string_view bare = text.substr(0, std::min(text.find("<-"), text.size()));
  if (checksum(text) != line.back() && checksum(bare) != line.back()) return {};
  return bare;
}

void digits(int value, std::span<char> into) {
  for (std::size_t i = into.size(); i > 0; --i) {
    into[i - 1] = static_cast<char>('0' + value % 10);
    value /= 10;
  }
}

}  // namespace

char checksum(std::string_view text) {
  unsigned sum = 0;
  for (const char byte : text) sum += static_cast<unsigned char>(byte);
  return static_cast<char>((sum & 0x3fU) + kZero);
}

void encode(std::uint32_t value, std::span<char> into) {
  for (std::size_t i = into.size(); i > 0; --i) {
    into[i - 1] = static_cast<char>((value & 0x3fU) + kZero);
    value >>= kBits;
  }
}

std::optional<std::uint32_t> decode(std::string_view characters) {
  std::uint32_t value = 0;
  for (const char byte : characters) {
    if (!is_character(byte)) return {};
    value = (value << kBits) | static_cast<std::uint32_t>(byte - kZero);
  }
  return value;
}

bool Limits::usable() const {
  return dmin >= 0 && dmin < dmax && ares > 0 && amin >= 0 && amin <= amax && amax <= kMostStep &&
         amax - amin < ares && afrt <= kMostStep && scan > 0;
}

Request Request::all(const Limits& limits, int characters) {
  const auto most = static_cast<int>(kMostValues);
  const int steps = limits.amax - limits.amin + 1;
  return {limits.amin, limits.amax, std::max(1, (steps + most - 1) / most), characters};
}

std::size_t Request::values() const {
  const int steps = last - first + 1;
  return static_cast<std::size_t>((steps + cluster - 1) / cluster);
}

std::array<char, 15> Request::text() const {
  std::array<char, 15> text{'M', characters == 2 ? 'S' : 'D'};
  const std::span<char> all(text);
  digits(first, all.subspan(2, 4));
  digits(last, all.subspan(6, 4));
  digits(cluster, all.subspan(10, 2));
  digits(0, all.subspan(12, 3));
  return text;
}

std::optional<Request> Request::parse(std::string_view text) {
  if (text.size() != 15 || text[0] != 'M' || (text[1] != 'D' && text[1] != 'S')) return {};
  const bool plain = std::all_of(text.begin() + 2, text.end(),
                                 [](char byte) { return byte >= '0' && byte <= '9'; });
  if (!plain || text[12] != '0') return {};
  const Request request{*number(text.substr(2, 4)), *number(text.substr(6, 4)),
                        std::max(1, *number(text.substr(10, 2))), text[1] == 'S' ? 2 : 3};
  if (request.last < request.first || request.values() > kMostValues) return {};
  return request;
}

void show(const Request& request, const Limits& limits, std::span<const std::uint32_t> values,
          rover::LaserScan& scan) {
  const double step = 2.0 * std::numbers::pi / limits.ares;
  const double first = request.first - limits.afrt + (request.cluster - 1) / 2.0;
  const int most = request.characters == 2 ? std::min(limits.dmax, 0xfff) : limits.dmax;
  scan.angle_min = static_cast<float>(first * step);
  scan.angle_increment = static_cast<float>(request.cluster * step);
  scan.range_min = static_cast<float>(limits.dmin) / 1000.0F;
  scan.range_max = static_cast<float>(most) / 1000.0F;
  scan.ranges.resize(values.size());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const bool error = values[i] < static_cast<std::uint32_t>(limits.dmin);
    scan.ranges[i] = error ? 0.0F : static_cast<float>(values[i]) / 1000.0F;
  }
}

bool blind(const Limits& limits, std::span<const std::uint32_t> values) {
  const auto least = static_cast<std::uint32_t>(limits.dmin);
  return std::none_of(values.begin(), values.end(),
                      [least](std::uint32_t value) { return value >= least && value > 0; });
}

bool TextReader::push(char byte) {
  if (ended_) {
    ended_ = too_long_ = false;
    size_ = 0;
  }
  if (byte == '\n') return ended_ = true;
  if (size_ == kLongest) {
    too_long_ = true;
  } else {
    text_[size_++] = byte;
  }
  return false;
}

ReplyReader::Event ReplyReader::push(char byte) {
  const bool ended = lines_.push(byte);
  if (lines_.too_long()) return lose();  // at once: such a line may never end
  return ended ? end_line(lines_.line()) : Event::none;
}

ReplyReader::Event ReplyReader::end_line(std::string_view line) {
  switch (place_) {
    case Place::echo:
      return on_echo(line);
    case Place::status:
      return on_status(line);
    case Place::body:
      return on_body(line);
    case Place::stamp:
      return on_stamp(line);
    case Place::data:
      return on_data(line);
    case Place::lost:
      break;
  }
  if (line.empty()) finish(true, Event::none);
  return Event::none;
}

ReplyReader::Event ReplyReader::on_echo(std::string_view line) {
  if (line.empty()) {
    counted_ = false;
    return Event::none;
  }
  const auto letter = [&](std::size_t i) { return line[i] >= 'A' && line[i] <= 'Z'; };
  if (line.size() < 2 || !letter(0) || !letter(1)) return lose();
  echo_size_ = std::min(line.size(), echo_.size());
  std::copy_n(line.begin(), echo_size_, echo_.begin());
  place_ = Place::status;
  return Event::none;
}

ReplyReader::Event ReplyReader::on_status(std::string_view line) {
  const auto text = checked(line);
  if (!text || text->size() != 2) return lose();
  std::copy_n(text->begin(), 2, status_.begin());
  const bool of_scans = command() == "MD" || command() == "MS";
  if (of_scans && status() == "99") {
    // The echo has no checksum of its own: only the echo of the request is believed.
    if (Request::parse({echo_.data(), echo_size_}) != request_) return lose();
    count_ = 0;
    begun_ = 0;
    begun_size_ = 0;
    place_ = Place::stamp;
    return Event::none;
  }
  limits_seen_ = 0;
  place_ = Place::body;
  return Event::none;
}

ReplyReader::Event ReplyReader::on_body(std::string_view line) {
  const bool of_limits = command() == "PP" && status() == "00";
  if (line.empty()) return finish(!of_limits || limits_seen_ == kAllLimits, Event::reply);
  if (!of_limits) return Event::none;
  const auto field = checked_field(line);
  return field && take_limit(*field) ? Event::none : lose();
}

bool ReplyReader::take_limit(std::string_view field) {
  if (field.size() < 5 || field[4] != ':') return false;
  for (std::size_t i = 0; i < kLimits.size(); ++i) {
    if (field.substr(0, 4) != kLimits[i].name) continue;
    const auto value = number(field.substr(5));
    if (!value) return false;
    limits_.*kLimits[i].limit = *value;
    limits_seen_ |= 1U << i;
  }
  return true;  // others, such as the name of the model
}

ReplyReader::Event ReplyReader::on_stamp(std::string_view line) {
  const auto text = checked(line);
  const auto value = text && text->size() == 4 ? decode(*text) : std::nullopt;
  if (!value) return lose();
  stamp_ = *value;
  place_ = Place::data;
  return Event::none;
}

ReplyReader::Event ReplyReader::on_data(std::string_view line) {
  if (line.empty()) return finish(count_ == request_.values() && begun_size_ == 0, Event::scan);
  const auto text = checked(line);
  if (!text || text->size() > kBlock) return lose();
  for (const char byte : *text) {
    if (!is_character(byte) || count_ == request_.values()) return lose();
    begun_ = (begun_ << kBits) | static_cast<std::uint32_t>(byte - kZero);
    if (++begun_size_ < request_.characters) continue;
    values_[count_++] = begun_;
    begun_ = 0;
    begun_size_ = 0;
  }
  return Event::none;
}

/// At an empty line: the next reply begins.
ReplyReader::Event ReplyReader::finish(bool complete, Event event) {
  place_ = Place::echo;
  const bool counted = counted_;
  counted_ = false;
  if (complete) return event;
  return counted ? Event::none : Event::bad;
}

ReplyReader::Event ReplyReader::lose() {
  place_ = Place::lost;
  if (counted_) return Event::none;
  counted_ = true;
  return Event::bad;
}

}  // namespace drivers::scip
