// SPDX-License-Identifier: LGPL-3.0-or-later
/// The contract of the plugins here: cores that give a number, so that a test sees whose code runs.
#pragma once

#include <cstdint>
#include <string_view>
#include <tuple>

#include <mauve/plugin.h>

namespace zoo {

struct Number {
  std::int64_t value = 0;
};

struct NumberShell : mauve::Shell {};

class NumberCore : public mauve::Core<NumberShell> {
 public:
  using Contract = NumberCore;
  static constexpr const char* contract = "zoo/number/1";

  virtual int number() = 0;
  void update() {}

  mauve::State<Number> state{*this};
};

struct NumberFsm : mauve::Fsm<NumberCore> {
  Exec update{*this, "update", &NumberCore::update};
  Sync period{*this, "period", std::chrono::milliseconds(10)};

  mauve::Status on_configure() override {
    start_at(update);
    update.then(period);
    period.then(update);
    return mauve::ok();
  }
};

struct NumberInterface : mauve::Interface<NumberCore> {};

}  // namespace zoo

template <>
struct mauve::Described<zoo::Number> {
  static constexpr std::string_view name = "zoo_number/1";
  static constexpr auto fields() { return std::tuple{mauve::field("value", &zoo::Number::value)}; }
};
