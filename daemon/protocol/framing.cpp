// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/framing.h"

#include <utility>
#include <vector>

#include "base/terminal_text.h"

namespace mauve::protocol {
namespace {

std::string at_byte(std::size_t position) { return "byte " + std::to_string(position); }

/// The part of the library's message about the text, without the characters that it read: they may
/// be many, and are the sender's own.
std::string reason_of(std::string text) {
  if (const auto cut = text.find("; last read"); cut != std::string::npos) text.resize(cut);
  for (const std::string_view before : {"] ", "column ", ": "}) {
    if (const auto end = text.find(before); end != std::string::npos) {
      text.erase(0, end + before.size());
    }
  }
  return "not JSON: " + text;
}

/// Builds the value while it is read, so that a refusal comes before the memory is spent.
class StrictReader final : public nlohmann::json_sax<Json> {
 public:
  explicit StrictReader(std::size_t most_values) : most_values_(most_values) {}

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return fail("binary data is not JSON", {}); }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    auto [place, is_new] = open_.back()->emplace(name, nullptr);
    if (!is_new) return fail("key '" + name.substr(0, 64) + "' stands twice in one object", {});
    member_ = &*place;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    return fail(reason_of(error.what()), at_byte(position));
  }

  [[nodiscard]] Result<Json> take() {
    if (error_) return std::move(*error_);
    return std::move(root_);
  }

 private:
  bool fail(std::string message, std::string at) {
    error_ = refuse({Errc::invalid_value, "line_not_json"}, std::move(at), std::move(message),
                    "one JSON object a line, in UTF-8");
    return false;
  }

  /// Null: there are too many.
  Json* place(Json value) {
    if (values_++ == most_values_) {
      static_cast<void>(fail("has more than " + std::to_string(most_values_) + " values", {}));
      return nullptr;
    }
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    if (open_.back()->is_array()) {
      open_.back()->push_back(std::move(value));
      return &open_.back()->back();
    }
    *member_ = std::move(value);
    return member_;
  }

  bool put(Json value) { return place(std::move(value)) != nullptr; }

  bool open(Json value) {
    if (open_.size() == kMaxDepth) {
      return fail("nested deeper than " + std::to_string(kMaxDepth), {});
    }
    open_.push_back(place(std::move(value)));
    return open_.back() != nullptr;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  const std::size_t most_values_;
  std::size_t values_ = 0;
  Json root_;
  // An element that is open never moves: nothing is added beside it before it is closed.
  std::vector<Json*> open_;
  Json* member_ = nullptr;
  std::optional<Error> error_;
};

}  // namespace

Status LineFramer::feed(std::string_view bytes) {
  while (!bytes.empty() && !overflown_) {
    const auto end = bytes.find('\n');
    const auto piece = bytes.substr(0, end);
    // One byte more than the limit may still be the "\r" of the end.
    overflown_ = partial_.size() + piece.size() > limit_ + 1;
    if (overflown_) break;
    partial_ += piece;
    if (end == std::string_view::npos) break;
    finish_line();
    bytes.remove_prefix(end + 1);
  }
  if (!overflown_) return ok();
  partial_ = {};
  return refuse({Errc::limit, "request_too_long"}, {},
                "the line is longer than " + std::to_string(limit_) + " bytes, so it was dropped",
                "send less at a time");
}

void LineFramer::finish_line() {
  if (!partial_.empty() && partial_.back() == '\r') partial_.pop_back();
  overflown_ = partial_.size() > limit_;
  if (!partial_.empty() && !overflown_) lines_.push_back(std::move(partial_));
  partial_.clear();
}

std::optional<std::string> LineFramer::next() {
  if (lines_.empty()) return std::nullopt;
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

Result<Json> parse_json(std::string_view text, std::size_t most_values) {
  StrictReader reader(most_values);
  Json::sax_parse(text.begin(), text.end(), &reader);
  return reader.take();
}

std::string to_line(const Json& value) {
  return json_for_terminals(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace mauve::protocol
