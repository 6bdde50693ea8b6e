// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/methods.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "base/name.h"
#include "protocol/row.h"

namespace mauve::protocol {
namespace row {
namespace {

template <typename... Fields>
constexpr std::array<Field, sizeof...(Fields)> fields(Fields... all) {
  return {all...};
}

#define PARAMS(...) fields(__VA_ARGS__)
#define ANSWER(...) fields(__VA_ARGS__)

// The fields of every record and of every method.
#define MAUVE_RECORD(id, name, text, ...)             \
  constexpr auto kFieldsOf##id = fields(__VA_ARGS__); \
  constexpr Record id{name, text, kFieldsOf##id};
#define MAUVE_METHOD(name, handler, role, lane, effect, help, params, answer) \
  constexpr auto params_of_##handler = params;                                \
  constexpr auto answer_of_##handler = answer;
#include "protocol/methods.def"

constexpr Method kMethods[] = {
#define MAUVE_RECORD(...)
#define MAUVE_METHOD(name, handler, role, lane, effect, help, params, answer) \
  {name, Role::role, Lane::lane, Effect::effect, help, params_of_##handler, answer_of_##handler},
#include "protocol/methods.def"
};

#undef PARAMS
#undef ANSWER

constexpr Field kMutationParams[] = {
    may("if_generation", count, "The change is refused with conflict if another generation runs"),
    may("reason", text,
        "The reason, for the log and the saved generations, at most 1000 characters"),
    may("deadline_ms", in(count, "ms"),
        "The request is answered at most some 20 ms after this time; a change that has not begun "
        "to take effect by then is dropped: timed_out, state unchanged; while it takes effect "
        "the state is unknown, and config.history shows the outcome")};
constexpr Field kMutationAnswers[] = {
    may("saved", boolean,
        "Whether the disk took the generation, and of a stop the stop itself; absent where nothing "
        "is kept")};

}  // namespace
}  // namespace row

namespace {

constexpr std::array<std::string_view, 4> kRoles = {"none", "viewer", "operator", "admin"};
constexpr std::array<std::string_view, 7> kLanes = {"any",    "read",    "later", "aside",
                                                    "urgent", "factory", "change"};
constexpr std::array<Effect, 7> kEffects = {Effect::reads,   Effect::out_of_band, Effect::records,
                                            Effect::changes, Effect::adjusts,     Effect::ends,
                                            Effect::stops};
struct EffectText {
  std::string_view word;
  std::string_view text;
};
constexpr std::array<EffectText, 7> kEffectTexts = {{
    {"reads", "The method changes nothing"},
    {"out_of_band",
     "The method changes nothing and is served out of band, also when all connection slots are in "
     "use"},
    {"records", "The method begins or ends a recording; the components run on as they were"},
    {"changes", "The method changes the running system, as far as the lock permits"},
    {"adjusts",
     "The method changes only what mauved counts, logs or locks, and is permitted under "
     "any lock"},
    {"ends",
     "The method ends a probation, also when all connection slots are in use. To confirm is "
     "permitted under "
     "any lock; the differences that an undo makes are judged like those of any change"},
    {"stops",
     "The method stops components, and is permitted under any lock, out of band, never "
     "limited"},
}};

std::vector<Field> together(std::span<const Field> own, std::span<const Field> more, bool also) {
  std::vector<Field> all(own.begin(), own.end());
  if (also) all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// The greatest lengths of texts that a client sends, in characters: looking for a text takes time
/// of [control], and reasons are kept. Those that differ from the one of names and addresses.
constexpr std::size_t kLongestText = 500;
constexpr std::size_t kLongestTime = 64;  ///< of "50ms" and the like
constexpr std::array<std::pair<std::string_view, std::size_t>, 4> kLongerTexts = {{
    {"text", kMaxLine},  // a file
    {"file", 4096},      // its name
    {"condition", 4000},
    {"reason", 1000},
}};

/// Of a list or a map that a client sends: each item takes time of [control] too.
constexpr std::size_t kMostItems = 1024;

std::size_t longest_of(const Field& param) {
  if (param.type.kind == Type::Kind::duration || param.type.kind == Type::Kind::time) {
    return kLongestTime;
  }
  const auto longer =
      std::ranges::find(kLongerTexts, param.name, &std::pair<std::string_view, std::size_t>::first);
  return longer == kLongerTexts.end() ? kLongestText : longer->second;
}

std::size_t characters(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }));
}

/// Of the longest text among those that the table describes: the value itself, or an item of a
/// list, or a name of a map. Values of properties have the limits of their properties.
std::size_t longest_in(const Json& value, const Type& type) {
  std::size_t longest = 0;
  if (type.shape == Type::Shape::map) {
    for (const auto& [name, unused] : value.items()) longest = std::max(longest, characters(name));
    return longest;
  }
  const bool texts = type.kind == Type::Kind::text || type.kind == Type::Kind::duration ||
                     type.kind == Type::Kind::time;
  if (!texts || value.is_null()) return 0;
  if (value.is_string()) return characters(value.get_ref<const std::string&>());
  for (const Json& item : value) {
    longest = std::max(longest, characters(item.get_ref<const std::string&>()));
  }
  return longest;
}

std::optional<Fault> too_many(const Method& method, const Field& param, const Json& value) {
  const std::size_t given = value.size();
  if (param.type.shape == Type::Shape::one || given <= kMostItems) return std::nullopt;
  return fault_of(kInvalidParams,
                  "argument '" + std::string(param.name) + "' has " + std::to_string(given) +
                      " items, and at most " + std::to_string(kMostItems) + " are read",
                  std::string(method.name));
}

std::optional<Fault> too_long(const Method& method, const Field& param, const Json& value) {
  const std::size_t given = longest_in(value, param.type);
  const std::size_t most = longest_of(param);
  if (given <= most) return std::nullopt;
  return fault_of(kInvalidParams,
                  "argument '" + std::string(param.name) + "' has a text of " +
                      std::to_string(given) + " characters, and at most " + std::to_string(most) +
                      " are read",
                  std::string(method.name));
}

Fault unknown_argument(const Method& method, const std::string& name,
                       const std::vector<Field>& known) {
  std::vector<std::string> names;
  for (const Field& param : known) names.emplace_back(param.name);
  return fault_of(kInvalidParams, "unknown argument '" + name.substr(0, 64) + "'",
                  std::string(method.name), did_you_mean(name, names, "'"));
}

}  // namespace

std::string_view to_string(Role role) { return kRoles.at(static_cast<std::size_t>(role)); }
std::string_view to_string(Lane lane) { return kLanes.at(static_cast<std::size_t>(lane)); }
std::string_view to_string(Effect effect) {
  return kEffectTexts.at(static_cast<std::size_t>(effect)).word;
}
std::string_view text_of(Effect effect) {
  return kEffectTexts.at(static_cast<std::size_t>(effect)).text;
}
std::span<const Effect> effects() { return kEffects; }

std::span<const Method> methods() { return row::kMethods; }
std::span<const Field> every_mutation_takes() { return row::kMutationParams; }
std::span<const Field> every_mutation_answers() { return row::kMutationAnswers; }

std::vector<Field> all_params(const Method& method) {
  return together(method.params, row::kMutationParams, method.mutation());
}

std::vector<Field> all_answer_fields(const Method& method) {
  return together(method.answer, row::kMutationAnswers, method.mutation());
}

const Method* find_method(std::string_view name) {
  if (name == "status") name = "status.get";
  const auto found = std::ranges::find(row::kMethods, name, &Method::name);
  return found == std::end(row::kMethods) ? nullptr : found;
}

Fault unknown_method(std::string_view name) {
  std::vector<std::string> names;
  for (const Method& method : methods()) names.emplace_back(method.name);
  std::string hint = did_you_mean(name, names, "'");
  if (hint.empty()) hint = "mauvectl protocol lists all methods";
  return fault_of(kUnknownMethod, "unknown method '" + std::string(name.substr(0, 64)) + "'", {},
                  std::move(hint));
}

std::optional<Fault> check_params(const Method& method, const Json& params) {
  const auto known = all_params(method);
  for (const auto& [name, value] : params.items()) {
    const auto param = std::ranges::find(known, name, &Field::name);
    if (param == known.end()) return unknown_argument(method, name, known);
    if (fits(value, param->type)) {
      if (auto refused = too_many(method, *param, value)) return refused;
      if (auto refused = too_long(method, *param, value)) return refused;
      continue;
    }
    return fault_of(kInvalidParams,
                    "argument '" + name + "' must be " + expected_words(param->type),
                    std::string(method.name));
  }
  for (const Field& param : known) {
    if (param.optional || params.contains(param.name)) continue;
    return fault_of(kInvalidParams, "argument '" + std::string(param.name) + "' is missing",
                    std::string(method.name));
  }
  return std::nullopt;
}

}  // namespace mauve::protocol
