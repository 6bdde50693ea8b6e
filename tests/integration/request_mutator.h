// SPDX-License-Identifier: LGPL-3.0-or-later
/// Requests of all methods that are almost right, or right, or no requests at all.
#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "protocol/message.h"
#include "protocol/methods.h"

namespace mauve::test {

class RequestMutator {
 public:
  using Json = protocol::Json;

  /// `values`: sensible ones of arguments, by their names.
  RequestMutator(std::map<std::string, std::vector<Json>> values, std::uint64_t seed)
      : values_(std::move(values)), random_(seed) {}

  /// One line, without its end.
  [[nodiscard]] std::string next() {
    const protocol::Method& method = some_method();
    Json params = params_of(method);
    while (below(3) == 0) mutate(params);
    // A trace is the witness of the campaign: these are always refused.
    const bool guarded = method.name == "trace.start" || method.name == "trace.stop";
    if (guarded) params["x"] = 1;
    Json request = {{"jsonrpc", "2.0"},
                    {"id", static_cast<int>(below(1000))},
                    {"method", std::string(method.name)},
                    {"params", std::move(params)}};
    if (below(20) == 0) request[some_word()] = some_value(3);
    if (below(20) == 0) request["id"] = some_value(2);
    if (!guarded && below(40) == 0) request.erase(one_of({"id", "jsonrpc", "method", "params"}));
    if (below(40) == 0) request = Json::array({request, request});
    std::string line = request.dump(-1, ' ', false, Json::error_handler_t::replace);
    while (below(6) == 0) damage(line);
    std::replace(line.begin(), line.end(), '\n', ' ');
    return line;
  }

 private:
  /// Methods are rare that start a process, move all code, or keep the system from running or
  /// changing.
  const protocol::Method& some_method() {
    for (;;) {
      const auto& method = protocol::methods()[below(protocol::methods().size())];
      const bool slow = method.name == "config.check" || method.name == "architecture.diff" ||
                        method.name == "config.compare" || method.name == "architecture.apply" ||
                        method.name == "config.rollback" || method.name == "daemon.doctor" ||
                        method.name.starts_with("plugin.");
      const bool hinders = method.name == "component.stop" || method.name == "lock.set";
      if ((!slow && !hinders) || below(20) == 0) return method;
    }
  }
  Json params_of(const protocol::Method& method) {
    Json params = Json::object();
    for (const auto& param : method.params) {
      const std::string name(param.name);
      if (param.optional && below(3) > 0) continue;
      const auto known = values_.find(name);
      if (known != values_.end() && below(8) > 0) {
        params[name] = known->second[below(known->second.size())];
      } else {
        params[name] = of_type(param.type);
      }
    }
    if (method.mutation() && below(8) == 0) params["if_generation"] = below(100);
    if (method.mutation() && below(8) == 0) params["deadline_ms"] = below(100);
    return params;
  }
  Json of_type(const protocol::Type& type) {
    using Kind = protocol::Type::Kind;
    if (type.shape == protocol::Type::Shape::map) return {{some_word(), some_value(2)}};
    if (type.shape == protocol::Type::Shape::list) {
      return type.kind == Kind::text ? Json::array({some_word(), some_word()})
                                     : Json::array({some_value(1)});
    }
    switch (type.kind) {
      case Kind::boolean:
        return below(2) == 0;
      case Kind::count:
        return below(2) == 0 ? below(10) : random_();
      case Kind::text:
        return choice_or_word(type);
      default:
        return some_word();
    }
  }
  Json choice_or_word(const protocol::Type& type) {
    const auto words = protocol::choices_of(type);
    return words.empty() || below(4) == 0 ? some_word() : one_of(words);
  }
  Json some_value(std::size_t depth) {
    switch (below(depth > 0 ? 9 : 7)) {
      case 0:
        return nullptr;
      case 1:
        return below(2) == 0;
      case 2:
        return -static_cast<std::int64_t>(random_() >> 1U);
      case 3:
        return random_();
      case 4:
        return 1.5e300 * static_cast<double>(below(3));
      case 5:
        return some_word();
      case 6:
        return std::string(below(3) == 0 ? 20'000 : 70, 'x');
      case 7:
        return Json::array({some_value(depth - 1), some_value(depth - 1)});
      default:
        return {{some_word(), some_value(depth - 1)}};
    }
  }
  std::string some_word() {
    return one_of({"",
                   "first",
                   "a",
                   "a.core.gain",
                   "a.core",
                   "a.ports.output",
                   "signal.read",
                   "..",
                   "../../etc/passwd",
                   "a.b.c.d",
                   "\x01\x1b[31m",
                   "\xc3\xa4",
                   "\xff\xfe",
                   "%s%n",
                   "trial/steady",
                   "0",
                   "-1s",
                   "1h",
                   "99999999999999999999s",
                   "off",
                   "all",
                   "none",
                   "drop",
                   "barrier"});
  }
  void mutate(Json& params) {
    if (params.empty() || below(4) == 0) {
      params[some_word()] = some_value(3);
      return;
    }
    auto param = params.begin();
    std::advance(param, static_cast<std::ptrdiff_t>(below(params.size())));
    if (below(3) == 0) {
      params.erase(param);
    } else if (param->is_string() && below(2) == 0) {
      auto text = param->get<std::string>();
      damage(text);
      *param = text;
    } else {
      *param = some_value(3);
    }
  }
  void damage(std::string& text) {
    if (text.empty()) return;
    const std::size_t at = below(text.size());
    switch (below(4)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        return;
      case 1:
        text.erase(at, 1 + below(8));
        return;
      case 2:
        text.insert(at, text.substr(below(text.size()), below(40)));
        return;
      default:
        text.resize(at);
    }
  }

  std::size_t below(std::size_t limit) { return random_() % limit; }
  std::string one_of(const std::vector<std::string>& choices) {
    return choices[below(choices.size())];
  }

  const std::map<std::string, std::vector<Json>> values_;
  std::mt19937_64 random_;
};

}  // namespace mauve::test
