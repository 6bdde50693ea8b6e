// SPDX-License-Identifier: LGPL-3.0-or-later
/// The text of a condition:
///   either     = both { "or" both }
///   both       = one { "and" one }
///   one        = "not" one | "(" either ")" | comparison
///   comparison = address [ ("<" | "<=" | ">" | ">=" | "==" | "!=") value ]
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "base/address.h"
#include "base/duration.h"
#include "rules/condition.h"

namespace mauve::rules {
namespace {

constexpr std::string_view kAnExample = "such as gnss.core.satellites < 4";

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// A hint at the word that a sign of another language stands for.
std::string_view meant_by(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kMeant{
      {{"=", "write =="},
       {"&", "write and"},
       {"|", "write or"},
       {"!", "write not"},
       {"\"", "words are written without quotes"}}};
  for (const auto& [sign, hint] : kMeant) {
    if (text.starts_with(sign)) return hint;
  }
  return {};
}

std::optional<Compare> compare_from(std::string_view text) {
  for (int i = 0; i <= static_cast<int>(Compare::not_equal); ++i) {
    if (to_string(static_cast<Compare>(i)) == text) return static_cast<Compare>(i);
  }
  return std::nullopt;
}

template <typename T>
std::optional<T> all_of(std::string_view text) {
  T value{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

/// A piece of the text. Empty at its end.
struct Token {
  std::string_view text;
  std::size_t place = 1;

  [[nodiscard]] bool is_end() const { return text.empty(); }
  [[nodiscard]] bool is_word() const { return !is_end() && is_letter(text[0]); }
  [[nodiscard]] bool is_number() const {
    return !is_end() && (is_digit(text[0]) || (text.size() > 1 && text[0] == '-'));
  }
};

/// Reads one condition; stops at the first error.
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) { advance(); }

  Result<Condition> run() {
    if (text_.size() > Condition::kLongest) {
      return refuse(
          {Errc::limit, "condition_too_large"}, {},
          "the condition is longer than " + std::to_string(Condition::kLongest) + " characters");
    }
    if (next_.is_end()) {
      return refuse({Errc::invalid_value, "condition_syntax"}, {}, "the condition is empty",
                    "write one, " + std::string(kAnExample));
    }
    if (either() && !next_.is_end()) {
      static_cast<void>(
          fail("expected and, or, or the end, got " + quoted(), std::string(meant_by(next_.text))));
    }
    if (!done_) return done_.error();
    condition_.text_ = text_;
    return std::move(condition_);
  }

 private:
  bool either() { return chain(&Parser::both, "or", Condition::Step::either); }
  bool both() { return chain(&Parser::one, "and", Condition::Step::both); }

  bool chain(bool (Parser::*part)(), std::string_view word, Condition::Step step) {
    if (!(this->*part)()) return false;
    while (next_.text == word) {
      advance();
      if (!(this->*part)()) return false;
      condition_.steps_.push_back(step);
    }
    return true;
  }

  bool one() {
    if (next_.text != "not" && next_.text != "(") return comparison();
    if (++depth_ > Condition::kDeepest)
      return fail("too deep within each other", {}, {Errc::limit, "condition_too_large"});
    const bool negates = next_.text == "not";
    const std::size_t opened = next_.place;
    advance();
    if (!(negates ? one() : either())) return false;
    if (negates) {
      condition_.steps_.push_back(Condition::Step::negate);
    } else if (next_.text != ")") {
      return fail("expected \")\" for the \"(\" at character " + std::to_string(opened) + ", got " +
                  quoted());
    } else {
      advance();
    }
    --depth_;
    return true;
  }

  bool comparison() {
    if (condition_.comparisons_.size() == Condition::kComparisons) {
      return fail("more than " + std::to_string(Condition::kComparisons) + " comparisons", {},
                  {Errc::limit, "condition_too_large"});
    }
    Comparison comparison;
    comparison.place = next_.place;
    if (!address(comparison.address)) return false;
    if (const auto compare = compare_from(next_.text)) {
      comparison.compare = *compare;
      advance();
      if (!operand(comparison.operand)) return false;
    }
    condition_.comparisons_.push_back(std::move(comparison));
    condition_.steps_.push_back(Condition::Step::compare);
    return true;
  }

  bool address(std::string& into) {
    if (next_.is_number()) {
      return fail("expected an address, got " + quoted(),
                  "write the address first, " + std::string(kAnExample));
    }
    const auto address = next_.is_word() ? Address::parse(next_.text) : Result<Address>(Error{});
    if (!address || address->size() < 2) {
      std::string hint(meant_by(next_.text));
      if (hint.empty()) hint = "an address has dots, " + std::string(kAnExample);
      return fail("expected an address, got " + quoted(), std::move(hint));
    }
    into = address->text();
    advance();
    return true;
  }

  bool operand(Operand& into) {
    if (next_.is_number()) return number(into);
    if (!next_.is_word() || next_.text == "and" || next_.text == "or" || next_.text == "not") {
      return fail("expected a value, got " + quoted(), std::string(meant_by(next_.text)));
    }
    if (next_.text.find('.') != std::string_view::npos) {
      return fail("expected a value, got the address " + quoted(),
                  "compare with a number, a duration, a word, true or false");
    }
    if (next_.text == "true" || next_.text == "false") {
      into = next_.text == "true";
    } else {
      into = std::string(next_.text);
    }
    advance();
    return true;
  }

  bool number(Operand& into) {
    if (const auto integer = all_of<std::int64_t>(next_.text)) {
      into = *integer;
    } else if (const auto large = all_of<std::uint64_t>(next_.text)) {
      into = *large;
    } else if (const auto real = all_of<double>(next_.text); real && std::isfinite(*real)) {
      into = *real;
    } else if (const auto duration = parse_duration(next_.text)) {
      into = *duration;
    } else {
      return fail(quoted() + " is neither a number nor a duration",
                  "units are ns, us, ms, s, min, h");
    }
    advance();
    return true;
  }

  void advance() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    next_ = {text_.substr(at_, length()), at_ + 1};
    at_ += next_.text.size();
  }

  /// Of the token that begins here.
  [[nodiscard]] std::size_t length() const {
    const std::string_view rest = text_.substr(at_);
    if (rest.empty()) return 0;
    const auto run = [&](auto belongs) {
      const auto* const end = std::find_if_not(rest.begin() + 1, rest.end(), belongs);
      return static_cast<std::size_t>(end - rest.begin());
    };
    if (is_letter(rest[0])) {
      return run([](char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '/'; });
    }
    if (is_digit(rest[0]) || rest[0] == '-') {
      return run(
          [](char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '+'; });
    }
    const auto is_sign = [](char c) { return std::string_view("<>=!&|").find(c) < 6; };
    return is_sign(rest[0]) ? run(is_sign) : 1;
  }

  [[nodiscard]] std::string quoted() const {
    constexpr std::size_t kLongest = 64;
    if (next_.is_end()) return "the end";
    // One byte of a character beyond ASCII would be no text.
    if (static_cast<unsigned char>(next_.text[0]) >= 0x80)
      return "a character that belongs nowhere";
    return '"' + std::string(next_.text.substr(0, kLongest)) + '"';
  }

  bool fail(const std::string& message, std::string hint = {},
            Reason reason = {Errc::invalid_value, "condition_syntax"}) {
    done_ = refuse(reason, {}, message + ", at character " + std::to_string(next_.place),
                   std::move(hint));
    return false;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t depth_ = 0;
  Token next_;
  Condition condition_;
  Status done_;
};

Result<Condition> Condition::parse(std::string_view text) { return Parser(text).run(); }

}  // namespace mauve::rules
